"""Judge works in a worker process: open a context and an engine, answer each request on it."""

from __future__ import annotations

import sys
from dataclasses import dataclass, field

from playground.engine.context import open_context
from playground.engine.engine import Engine
from playground.engine.plain_forms import silent
from playground.engine.plan import Step
from playground.engine.process.child import Parent, Service
from playground.engine.textures import is_lost
from playground.lessons.model import Challenge, Exercise
from playground.lessons.tasks.judge import Wanted, answers, judge
from playground.lessons.tasks.judge_process import Request
from playground.lessons.tasks.match import Ends, Match, ends_of, match
from playground.lessons.tasks.texts import answer_text
from playground.lessons.tasks.verdict import Verdict

_KNOWN = 16  # tasks whose answers are kept


def open_service(parent: Parent, options: tuple[bool, int | None]) -> Service:
    """Open a context: on a software renderer, on which device."""
    software, device = options
    engine = Engine(open_context(software=software, device=device), owns_context=True, notice=silent)

    def begin(step: Step) -> None:
        engine.ctx.finish()  # the time of a step is its own
        parent.report(step.path)

    engine.internal.runner.before_step = begin
    return Service(_Judge(engine).answer_or_end)


@dataclass
class _Judge:
    engine: Engine
    known: dict[tuple[str, ...], tuple[Wanted, ...] | Ends] = field(default_factory=dict)

    def answer_or_end(self, request: Request) -> Verdict | Match | Ends:
        """Answer; end the process where a work has cost it its context, which is of no more use."""
        try:
            return self.answer(request)
        finally:
            if is_lost(self.engine.ctx):
                sys.exit("the driver reset itself")

    def answer(self, request: Request) -> Verdict | Match | Ends:
        """Judge a work, or draw a challenge."""
        task = request.task
        if isinstance(task, Challenge):
            ends = self._ends(task, request.side)
            if request.work is None:
                return ends
            return match(self.engine, task, request.work, ends, request.side)
        assert request.work is not None
        return judge(self.engine, task, request.work, self._wanted(task))

    def _wanted(self, task: Exercise) -> tuple[Wanted, ...]:
        found = self.known.get(_key(task))
        if not isinstance(found, tuple):
            self._keep(_key(task), found := answers(self.engine, task))
        return found

    def _ends(self, task: Challenge, side: int) -> Ends:
        key = (*_key(task), str(side))
        found = self.known.get(key)
        if not isinstance(found, Ends):
            self._keep(key, found := ends_of(self.engine, task, side))
        return found

    def _keep(self, key: tuple[str, ...], found: tuple[Wanted, ...] | Ends) -> None:
        if len(self.known) >= _KNOWN:
            self.known.clear()
        self.known[key] = found


def _key(task: Exercise | Challenge) -> tuple[str, ...]:
    return type(task).__name__, task.name, task.text, answer_text(task)

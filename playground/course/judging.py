"""Judge works in a process of its own: one that never ends, or kills the driver, costs only that process."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from playground.course.judge import SIDE, Ends, Match, Wanted, answers, ends_of, judge, match
from playground.course.model import Challenge, Exercise
from playground.course.tasks import Verdict, Work, answer_text
from playground.engine.engine import Engine, open_engine
from playground.engine.plain_forms import silent
from playground.engine.plan import Step
from playground.engine.process.child import Outcome
from playground.engine.process.pool import Limits, Pool, PoolOwner
from playground.engine.process.worker import Parent, Service, summary_of
from playground.engine.textures import is_lost
from playground.errors import Diagnostic, PlaygroundError, SandboxCrash

LIMIT_SECONDS = 10.0
"""[s] that a pass of a work may take."""

LIMIT_BYTES = 4 * 2**30

_WHOLE = 6  # times that limit for all of a work
_KNOWN = 16  # tasks whose answers are kept


@dataclass(frozen=True)
class Request:
    """A work to judge; without one the two pictures that a challenge's score lies between are wanted."""

    task: Exercise | Challenge
    work: Work | None
    side: int = SIDE  # pixels of a challenge's pictures, the longer way


class JudgeProcess(PoolOwner):
    """Judges works in a worker process, which starts with the first and is replaced when it dies.

    ``check`` waits for the verdict; ``submit`` and ``poll`` do not. Use it with ``with``,
    or call ``close()``.
    """

    def __init__(
        self, *, limit_seconds: float = LIMIT_SECONDS, software: bool = False, device: int | None = None
    ) -> None:
        limits = Limits(seconds=limit_seconds, total_seconds=limit_seconds * _WHOLE, memory_bytes=LIMIT_BYTES)
        self._pool = Pool(__name__, limits, options=(software, device))

    def submit(self, task: Exercise | Challenge, work: Work | None, side: int = SIDE) -> None:
        """Send a work to be judged, or a challenge to be drawn; an earlier one is not answered."""
        self._replace(Request(task, work, side), 0.0)

    def poll(self) -> Verdict | Match | Ends | None:
        """Return what came of what was sent last, once; None while it is judged or drawn.

        A work that takes too long, or that ends the process, is judged too: it has no points. Raises
        ``PlaygroundError`` only where it is not the student's doing.
        """
        task = self._take()
        return None if task is None else _judgement(task.request, task.result())

    def check(self, task: Exercise | Challenge, work: Work) -> Verdict | Match:
        """Return what comes of a work; raise as ``poll`` does."""
        request = Request(task, work)
        judgement = _judgement(request, self._pool.run(request))
        assert not isinstance(judgement, Ends)
        return judgement


def _judgement(request: Any, outcome: Outcome) -> Verdict | Match | Ends:
    """Return what comes of a ``Request``, even if it ended its process or was stopped."""
    error = outcome.error
    if outcome.kind == "answer":
        assert isinstance(outcome.value, Verdict | Match | Ends)
        return outcome.value
    if not outcome.started or outcome.kind == "refused":
        raise outcome.failure("judging")
    if isinstance(error, MemoryError):
        message = "it needs more memory than it may have"
    elif isinstance(error, SandboxCrash):
        message = f"it {error.diagnostics[0].message}"
    elif error is not None:
        raise PlaygroundError(f"judging failed: {summary_of(error)}")
    elif outcome.kind == "hang":
        at = f"pass '{outcome.progress}'" if outcome.progress else "it"
        message = f"{at} took longer than {outcome.limit:g} s and was stopped; is there an endless loop?"
    else:
        message = f"it {outcome.cause()}"
    if request.work is None:
        raise PlaygroundError(f"challenge '{request.task.name}' cannot be drawn: {message}")
    diagnostics = (Diagnostic(message),)
    if isinstance(request.task, Challenge):
        return Match(0.0, request.task.goal, None, None, diagnostics)
    return Verdict((), diagnostics, 0.0, request.task.points)


# ── in the worker ────────────────────────────────────────────────────────────


def open_service(parent: Parent, options: tuple[bool, int | None]) -> Service:
    """Open a context: on a software renderer, on which device."""
    software, device = options
    engine = open_engine(software=software, device=device, notice=silent)

    def begin(step: Step) -> None:
        engine.ctx.finish()  # the time of a step is its own
        parent.report(step.path)

    engine.runner.before_step = begin
    return Service(_JudgeHandler(engine).answer_or_give_up)


@dataclass
class _JudgeHandler:
    engine: Engine
    expected: dict[tuple[str, ...], tuple[Wanted, ...] | Ends] = field(default_factory=dict)

    def answer_or_give_up(self, request: Request) -> Verdict | Match | Ends:
        """Answer; raise ``SandboxCrash`` where a work has cost the process its context."""
        try:
            return self.answer(request)
        finally:
            if is_lost(self.engine.ctx):
                raise SandboxCrash("made the driver reset itself")

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
        expected_results = self.expected.get(_key(task))
        if not isinstance(expected_results, tuple):
            self._keep(_key(task), expected_results := answers(self.engine, task))
        return expected_results

    def _ends(self, task: Challenge, side: int) -> Ends:
        key = (*_key(task), str(side))
        ends = self.expected.get(key)
        if not isinstance(ends, Ends):
            self._keep(key, ends := ends_of(self.engine, task, side))
        return ends

    def _keep(self, key: tuple[str, ...], result: tuple[Wanted, ...] | Ends) -> None:
        if len(self.expected) >= _KNOWN:
            self.expected.clear()
        self.expected[key] = result


def _key(task: Exercise | Challenge) -> tuple[str, ...]:
    return type(task).__name__, task.name, task.text, answer_text(task)

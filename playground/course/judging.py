"""Judge works in processes of their own: one that never ends, or kills the driver, costs only its process."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, TypeVar

from playground.course.library import Said
from playground.course.model import Challenge, Exercise
from playground.course.tasks import (
    SIDE,
    Ends,
    Match,
    Verdict,
    Wanted,
    Work,
    answer_text,
    answers,
    ends_of,
    judge,
    match,
)
from playground.engine.engine import Engine, open_engine
from playground.engine.plain_forms import silent
from playground.engine.plan import Step
from playground.engine.process.child import Outcome
from playground.engine.process.pool import Limits, Pool, PoolOwner, Task
from playground.engine.process.worker import Parent, Service, summary_of
from playground.engine.textures import is_lost
from playground.errors import Diagnostic, PlaygroundError, SandboxCrash

LIMIT_SECONDS = 10.0
"""[s] that a pass of a work may take."""

LIMIT_BYTES = 4 * 2**30
"""[bytes] that a process may take."""

_WHOLE = 6  # times that limit for all of a work
_KNOWN = 64  # tasks whose answers are kept

T = TypeVar("T", tuple[Wanted, ...], Ends)


@dataclass(frozen=True)
class Request:
    """A work to judge; without one the two pictures that a challenge's score lies between are wanted."""

    task: Exercise | Challenge
    work: Work | None
    side: int = SIDE  # pixels of a challenge's pictures, the longer way


class JudgeProcess(PoolOwner):
    """Judges works in a worker process, which starts with the first and is replaced when it dies.

    ``check`` waits for the verdict; ``submit`` does not. Use it with ``with``, or call ``close()``.
    """

    def __init__(
        self, *, limit_seconds: float = LIMIT_SECONDS, software: bool = False, device: int | None = None
    ) -> None:
        limits = Limits(seconds=limit_seconds, total_seconds=limit_seconds * _WHOLE, memory_bytes=LIMIT_BYTES)
        self._pool = Pool(__name__, limits, options=(software, device))

    def submit(self, request: Request) -> Task:
        """Send a work to be judged, or a challenge to be drawn; ``judgement`` reads what comes of it."""
        return self._pool.submit(request)

    def check(self, task: Exercise | Challenge, work: Work) -> Verdict | Match:
        """Return what comes of a work; raise as ``judgement`` does."""
        request = Request(task, work)
        result = judgement(request, self._pool.run(request))
        assert not isinstance(result, Ends)
        return result


def judgement(request: Any, outcome: Outcome) -> Verdict | Match | Ends:
    """Return what comes of a ``Request``.

    A work that takes too long, or that ends the process, is judged too: it has no points. Raises
    ``PlaygroundError`` only where it is not the student's doing.
    """
    if outcome.kind == "answer":
        assert isinstance(outcome.value, Verdict | Match | Ends)
        return outcome.value
    if not outcome.started or outcome.kind == "refused":
        raise outcome.failure("judging")
    if outcome.error is not None and not isinstance(outcome.error, MemoryError | SandboxCrash):
        raise PlaygroundError(f"judging failed: {summary_of(outcome.error)}")
    if outcome.kind == "hang":
        at = f"pass '{outcome.progress}'" if outcome.progress else "it"
        message = f"{at} took longer than {outcome.limit:g} s and was stopped; is there an endless loop?"
    else:
        message = f"it {cause_of(outcome)}"
    if request.work is None:
        raise PlaygroundError(f"challenge '{request.task.name}' cannot be drawn: {message}")
    diagnostics = (Diagnostic(message),)
    if isinstance(request.task, Challenge):
        return Match(0.0, request.task.goal, None, None, diagnostics)
    return Verdict((), diagnostics, 0.0, request.task.points)


def cause_of(crash: Outcome) -> str:
    """Return how a work ended its process, as a predicate: "ran out of memory"."""
    error = crash.error
    if error is None:
        return crash.cause()
    if isinstance(error, MemoryError):
        return Said("ran out of memory")
    if isinstance(error, SandboxCrash):
        return error.diagnostics[0].message
    return Said("could not be judged: {why}", why=summary_of(error))


# ── in the worker ────────────────────────────────────────────────────────────


def open_service(parent: Parent, options: tuple[bool, int | None]) -> Service:
    """Open a context: on a software renderer, on which device."""
    software, device = options
    engine = open_engine(software=software, device=device, notice=silent)
    judge = Judge(engine)

    def begin(step: Step) -> None:
        engine.ctx.finish()  # the time of a step is its own
        parent.report(step.path)

    def answer(request: Request) -> Verdict | Match | Ends:
        with surviving(engine):
            if request.work is None:
                assert isinstance(request.task, Challenge)
                return judge.ends(request.task, request.side)
            return judge.judge(request.task, request.work, request.side)

    engine.runner.before_step = begin
    return Service(answer)


@contextmanager
def surviving(engine: Engine) -> Iterator[None]:
    """Raise ``SandboxCrash`` where what is drawn inside costs the process its context."""
    try:
        yield
    finally:
        if is_lost(engine.ctx):
            raise SandboxCrash("made the driver reset itself")


class Judge:
    """Judges with one engine; what the model answers give is drawn once."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self._answers: dict[object, tuple[Wanted, ...]] = {}
        self._ends: dict[object, Ends] = {}

    def judge(self, task: Exercise | Challenge, work: Work, side: int = SIDE) -> Verdict | Match:
        """Judge a work; raise as ``judge`` and ``match``."""
        if isinstance(task, Challenge):
            return match(self.engine, task, work, self.ends(task, side), side)
        return judge(self.engine, task, work, self.answers(task))

    def answers(self, task: Exercise) -> tuple[Wanted, ...]:
        """Return what the model answer gives for each check."""
        return _once(self._answers, _key(task), lambda: answers(self.engine, task))

    def ends(self, task: Challenge, side: int = SIDE) -> Ends:
        """Return the two pictures that a score lies between."""
        return _once(self._ends, (*_key(task), side), lambda: ends_of(self.engine, task, side))


def _once(known: dict[object, T], key: object, draw: Callable[[], T]) -> T:
    if key not in known:
        if len(known) >= _KNOWN:
            known.clear()
        known[key] = draw()
    return known[key]


def _key(task: Exercise | Challenge) -> tuple[str, ...]:
    return task.name, task.text, answer_text(task)

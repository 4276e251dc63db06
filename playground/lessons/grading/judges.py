"""Judge many works side by side in worker processes; what stops one costs nobody else anything.

A work that takes too long, by the processor's time that it has had, ends with its process, and so does one
that crashes it or takes all memory. A process that died is replaced. A crash counts only if it happens again
in a new process: what went wrong there may be what an earlier work has left behind.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from playground.engine.context import ContextInfo
from playground.engine.process.child import Outcome as JudgingOutcome
from playground.engine.process.pool import Limits, Pool, PoolOwner
from playground.errors import SandboxCrash
from playground.lessons.grading.handler import PREPARING, Options, Request
from playground.lessons.grading.marks import Mark
from playground.lessons.translatable import Said

WORKERS = 2
"""Processes side by side."""

LIMIT = 10.0
"""[s] of a processor that judging one work may take, where the model answer is not slow itself."""

TIMES_ANSWER = 10.0
"""A work may take so many times as long as the model answer, if that is more."""

MEMORY = 4 * 2**30
"""[bytes] that a process may take."""

_ANSWER = 300.0  # [s] that drawing a model answer may take, which is not the student's time
_MAX_WORKS = 80  # of a process: a driver never forgets a shader


@dataclass(frozen=True)
class Stopped:
    """What ended the process that judged a work."""

    took_too_long: bool = False
    cause: str = ""  # of a crash


Outcome = Mark | Stopped


class Judges(PoolOwner):
    """Worker processes that judge; use it with ``with``, or call ``close()``."""

    def __init__(
        self, options: Options, workers: int = WORKERS, limit: float = LIMIT, memory_bytes: int = MEMORY
    ) -> None:
        self._limit = limit
        self._limits: dict[str, float] = {}  # [s] by exercise
        self.renderer = ""  # what draws, once something was judged
        self._pool = Pool(
            "playground.lessons.grading.handler",
            Limits(longer={PREPARING: _ANSWER}, memory_bytes=memory_bytes, requests=_MAX_WORKS, crashes=2),
            options=options,
            workers=workers,
            # Processes side by side: each draws on a processor of its own.
            environment={"LP_NUM_THREADS": "1"} if workers > 1 else {},
        )

    def judge_all(self, requests: Iterable[tuple[object, Request]]) -> Iterator[tuple[object, Outcome]]:
        """Yield what comes of each request, with its key, in their order.

        Raises ``PlaygroundError`` where it is nobody's work: no renderer, a model answer that fails.
        """
        tasks = [
            (key, request, self._pool.submit(request, seconds=self._seconds(request)))
            for key, request in requests
        ]
        for key, request, task in tasks:
            yield key, self._outcome(request, task.result())

    def limit_of(self, exercise: str) -> float:
        """Return how long judging a work of an exercise may take [s]."""
        return self._limits.get(exercise, self._limit)

    def _seconds(self, request: Request) -> float:
        return _ANSWER if request.text is None else self.limit_of(request.exercise)

    def _outcome(self, request: Request, outcome: JudgingOutcome) -> Outcome:
        if not outcome.started or (outcome.kind == "hang" and outcome.progress == PREPARING):
            raise outcome.failure(f"drawing the answer of {request.exercise}")
        if outcome.kind == "hang":
            return Stopped(took_too_long=True)
        if outcome.kind == "crash":
            return Stopped(cause=outcome.cause() if outcome.error is None else _cause(outcome.error))
        mark = outcome.get("judging")
        assert isinstance(mark, Mark) and isinstance(outcome.info, ContextInfo)
        self.renderer = outcome.info.renderer
        if request.text is None:
            # By its own clock, as the limit is kept: on a busy machine the wall's would give much more.
            longest = min(max(self._limit, TIMES_ANSWER * outcome.seconds), _ANSWER)
            self._limits[request.exercise] = float(round(longest))
        return mark


def _cause(error: Exception) -> str:
    if isinstance(error, MemoryError):
        return Said("ran out of memory")
    if isinstance(error, SandboxCrash):
        return error.diagnostics[0].message
    return Said("could not be judged: {why}", why=error.args[0])

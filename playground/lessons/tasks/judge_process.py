"""Judge works in a process of its own: one that never ends, or kills the driver, costs only that process."""

from __future__ import annotations

from dataclasses import dataclass

from playground.engine.process.messages import summary_of
from playground.engine.process.worker import START_SECONDS, Closing, Launch, Replaceable, Worker, WorkerDied
from playground.errors import Diagnostic, PlaygroundError, SandboxCrash, SandboxTimeout
from playground.lessons.model import Challenge, Exercise
from playground.lessons.tasks.judge import SIDE
from playground.lessons.tasks.match import Ends, Match
from playground.lessons.tasks.verdict import Verdict
from playground.lessons.tasks.work import Work

LIMIT_SECONDS = 10.0
"""[s] that a pass of a work may take."""

LIMIT_BYTES = 4 * 2**30

_HANDLER = "playground.lessons.tasks.judge_handler"
_WHOLE = 6  # times that limit for all of a work


@dataclass(frozen=True)
class Request:
    """A work to judge; without one the two pictures that a challenge's score lies between are wanted."""

    task: Exercise | Challenge
    work: Work | None
    side: int = SIDE  # pixels of a challenge's pictures, the longer way


class JudgeProcess(Closing):
    """Judges works in a worker process, which starts with the first and is replaced when it dies.

    ``check`` waits for the verdict; ``submit`` and ``poll`` do not. Use it with ``with``,
    or call ``close()``.
    """

    def __init__(
        self, *, limit_seconds: float = LIMIT_SECONDS, software: bool = False, device: int | None = None
    ) -> None:
        self.limit_seconds = limit_seconds
        self._workers = Replaceable(
            Launch(
                handler=_HANDLER,
                options=(software, device),
                memory_bytes=LIMIT_BYTES,
                limit_seconds=limit_seconds * _WHOLE,
            )
        )
        self._current: Request | None = None

    @property
    def busy(self) -> bool:
        """Whether a work waits for its verdict."""
        return self._current is not None

    def submit(self, task: Exercise | Challenge, work: Work | None, side: int = SIDE) -> None:
        """Send a work to be judged, or a challenge to be drawn; an earlier one is not answered."""
        worker = self._workers.worker
        if worker is not None and worker.busy:
            self._workers.end(kill=True)
        self._current = Request(task, work, side)
        self._workers.start().submit(self._current)

    def poll(self) -> Verdict | Match | Ends | None:
        """Return what came of what was sent last, once; None while it is judged or drawn.

        A work that takes too long, or that ends the process, is judged too: it has no points. Raises
        ``PlaygroundError`` only where it is not the student's doing.
        """
        return self._answer(0.0)

    def check(self, task: Exercise | Challenge, work: Work) -> Verdict | Match:
        """Return what comes of a work; raise as ``poll`` does."""
        self.submit(task, work)
        while (found := self._answer(0.05)) is None:
            pass
        assert not isinstance(found, Ends)
        return found

    def close(self) -> None:
        """End the process; the next work starts another."""
        self._current = None
        self._workers.close(patience=1.0)

    def _answer(self, timeout: float) -> Verdict | Match | Ends | None:
        request, worker = self._current, self._workers.worker
        if request is None or worker is None:
            return None
        try:
            answer = worker.poll(timeout)
        except WorkerDied as died:
            if died.report.was_ready:
                return self._failed(f"it {died.report.cause()}")
            self._end()
            raise SandboxCrash(f"the process that judges {died.report.ending}") from None
        if answer is None:
            return self._check_time(worker)
        if isinstance(answer.error, MemoryError):
            return self._failed("it needs more memory than it may have")
        self._current = None
        if isinstance(answer.value, Verdict | Match | Ends):
            return answer.value
        if isinstance(answer.error, PlaygroundError):
            raise answer.error
        raise PlaygroundError(f"judging failed: {summary_of(answer.error)}")

    def _check_time(self, worker: Worker) -> Verdict | Match | None:
        """End a process that takes too long."""
        if worker.starting_seconds > START_SECONDS:
            self._end()
            raise SandboxTimeout(f"the process that judges was not ready after {START_SECONDS:g} s")
        limit, whole = self.limit_seconds, self.limit_seconds * _WHOLE
        if worker.activity_seconds < limit and worker.seconds < whole:
            return None
        path = worker.progress
        at = f"pass '{path}'" if path else "it"
        took = limit if worker.activity_seconds >= limit else whole
        return self._failed(f"{at} took longer than {took:g} s and was stopped; is there an endless loop?")

    def _failed(self, message: str) -> Verdict | Match:
        """Return what comes of a work that ended its process, or that was stopped."""
        request = self._current
        assert request is not None
        self._end()
        if request.work is None:
            raise PlaygroundError(f"challenge '{request.task.name}' cannot be drawn: {message}")
        diagnostics = (Diagnostic(message),)
        if isinstance(request.task, Challenge):
            return Match(0.0, request.task.goal, None, None, diagnostics)
        return Verdict((), diagnostics, 0.0, request.task.points)

    def _end(self) -> None:
        self._current = None
        self._workers.end(kill=True)

"""Run a capture in a worker process, and report its progress and result to its parent."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

from playground.api import headless
from playground.capture.job import CaptureJob, do
from playground.engine.plain_forms import silent
from playground.engine.process.child import Outcome
from playground.engine.process.pool import Pool
from playground.engine.process.worker import Cancelled, Parent, Service, summary_of
from playground.errors import PlaygroundError


@dataclass(frozen=True)
class Finished:
    """How a job ended."""

    path: Path | None  # what was made
    error: str = ""  # in a sentence
    stopped: bool = False
    notes: tuple[str, ...] = ()


class JobProcess:
    """One job at work; call ``poll`` now and then."""

    def __init__(self, job: CaptureJob, *, software: bool = False, driver: str = "auto") -> None:
        self.job = job
        self.started = time.monotonic()
        self.stopping = False  # whether ``stop`` was called
        # It outlives its parent until its next part is done, to remove the files that it has begun.
        self._pool = Pool(__name__, options=(software, driver), ends_with_parent=False)
        self._task = self._pool.submit(job)
        self._pool.shutdown(wait=False)  # there is no other job

    @property
    def progress(self) -> tuple[int, int]:
        """How many parts are done, and of how many; (0, 0) while it begins."""
        return self._task.progress or (0, 0)

    def stop(self) -> None:
        """Cancel it; it removes what it has begun, for which it has a while until it is killed."""
        if not self.stopping:
            self.stopping = True
            self._task.cancel()

    def poll(self, timeout: float = 0.0) -> Finished | None:
        """Return how it ended, None while it continues; waits ``timeout`` seconds at the most."""
        return _finished(self._task.result()) if self._task.wait(timeout) else None

    def close(self) -> None:
        """Stop it and wait until it has removed what it has begun; kill it if that takes too long."""
        self.stop()
        self._task.result()


def _finished(outcome: Outcome) -> Finished:
    error = outcome.error
    if isinstance(error, Cancelled):
        return Finished(None, stopped=True)
    if isinstance(error, PlaygroundError):
        return Finished(None, str(error))
    if isinstance(error, MemoryError):
        return Finished(None, "there is not enough memory for a picture of that size")
    if error is not None:
        return Finished(None, f"a bug of the playground itself, {summary_of(error)}")
    if outcome.kind == "crash":
        return Finished(None, f"the capture {outcome.cause()}")
    assert isinstance(outcome.value, Finished)
    return outcome.value


def open_service(parent: Parent, options: tuple[bool, str]) -> Service:
    """Return the service that does a job: on a software renderer, by which driver."""
    software, driver = options

    def answer(job: CaptureJob) -> Finished:
        notes: list[str] = []
        with headless(software=software, driver=driver, notice=silent) as engine:
            path = do(job, engine, lambda done, of: parent.report((done, of)), notes.append)
        return Finished(path, notes=tuple(notes))

    return Service(answer)

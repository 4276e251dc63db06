"""Run a capture in a worker process, and report its progress and result to its parent."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

from playground.capture.job import CaptureJob
from playground.engine.process.messages import Answer, Cancelled, summary_of
from playground.engine.process.worker import Launch, Worker, WorkerDied
from playground.errors import PlaygroundError

_GRACE = 10.0  # [s] that a job may take to stop by itself


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
        self._stopped_at: float | None = None
        # It outlives its parent until its next part is done, to remove the files that it has begun.
        launch = Launch(
            handler="playground.capture.job_handler", options=(software, driver), ends_with_parent=False
        )
        self._worker = Worker(launch)
        self._worker.submit(job)
        self._finished: Finished | None = None

    @property
    def progress(self) -> tuple[int, int]:
        """How many parts are done, and of how many; (0, 0) while it begins."""
        progress = self._worker.progress
        return progress if isinstance(progress, tuple) else (0, 0)

    @property
    def stopping(self) -> bool:
        """Whether ``stop`` was called."""
        return self._stopped_at is not None

    def stop(self) -> None:
        """Cancel it; it removes what it has begun."""
        if self._stopped_at is None and self._finished is None:
            self._stopped_at = time.monotonic()
            self._worker.cancel()

    def poll(self, timeout: float = 0.0) -> Finished | None:
        """Return how it ended, None while it continues; waits ``timeout`` seconds at the most."""
        if self._finished is not None:
            return self._finished
        try:
            answer = self._worker.poll(timeout)
        except WorkerDied as died:
            self._finished = Finished(None, f"the capture {died.report.cause()}")
            return self._finished
        if answer is not None:
            self._finish(_finished(answer))
        elif self._stopped_at is not None and time.monotonic() - self._stopped_at > _GRACE:
            self._finish(Finished(None, stopped=True))
        return self._finished

    def close(self) -> None:
        """Stop it and wait until it has removed what it has begun; kill it if that takes too long."""
        self.stop()
        while self.poll(timeout=0.1) is None:
            pass

    def _finish(self, finished: Finished) -> None:
        self._finished = finished
        self._worker.end(kill=True)


def _finished(answer: Answer) -> Finished:
    try:
        found = answer.get()
    except Cancelled:
        return Finished(None, stopped=True)
    except PlaygroundError as error:
        return Finished(None, str(error))
    except MemoryError:
        return Finished(None, "there is not enough memory for a picture of that size")
    except Exception as error:
        return Finished(None, f"a bug of the playground itself, {summary_of(error)}")
    assert isinstance(found, Finished)
    return found

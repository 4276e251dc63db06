"""A capture at work in a process of its own, as whoever started it sees it: how far, and what came of it."""

from __future__ import annotations

import queue
import shutil
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from playground.capture.job import Job
from playground.engine.sandbox_process import Doing, Process

_GRACE = 10.0  # [s] that a job may take to stop by itself
_MODULE = "playground.capture.job_child"


@dataclass(frozen=True)
class Progress(Doing):
    """How far a job is."""

    done: int = 0
    of: int = 0


@dataclass(frozen=True)
class Finished:
    """How a job ended."""

    path: Path | None  # what was made
    error: str = ""  # in a sentence
    stopped: bool = False
    notes: tuple[str, ...] = ()


class Working:
    """One job at work; ask ``poll`` now and then."""

    def __init__(self, job: Job, *, software: bool = False, driver: str = "auto") -> None:
        self.job = job
        self.started = time.monotonic()
        self._stopped_at: float | None = None
        self._folder = Path(tempfile.mkdtemp(prefix="playground-capture-"))
        self._stop = self._folder / "stop"
        renderer = "software" if software else "usual"
        self._process: Process[Finished] = Process(_MODULE, [renderer, driver, str(self._stop)])
        self._process.hand_over(job)
        self._finished: Finished | None = None

    @property
    def progress(self) -> tuple[int, int]:
        """How many parts are done, and of how many; (0, 0) while it begins."""
        doing = self._process.doing
        return (doing.done, doing.of) if isinstance(doing, Progress) else (0, 0)

    @property
    def stopping(self) -> bool:
        """Whether it was asked to stop."""
        return self._stopped_at is not None

    def stop(self) -> None:
        """Ask it to stop; what it has begun it takes away."""
        if self._stopped_at is None and self._finished is None:
            self._stopped_at = time.monotonic()
            self._stop.touch()

    def poll(self) -> Finished | None:
        """Return how it ended, None while it goes on; never waits."""
        if self._finished is not None:
            return self._finished
        try:
            answer = self._process.answers.get_nowait()
        except queue.Empty:
            late = self._stopped_at is not None and time.monotonic() - self._stopped_at > _GRACE
            if not late:
                return None
            self._finish(Finished(None, stopped=True))
            return self._finished
        if answer is None:
            answer = Finished(None, f"the capture {self._process.cause_of_death()}")
        self._finish(answer)
        return self._finished

    def close(self) -> None:
        """Stop it and wait until it has taken away what it has begun; kill it if that takes too long."""
        self.stop()
        end = time.monotonic() + _GRACE
        while self.poll() is None and time.monotonic() < end:
            time.sleep(0.01)
        if self._finished is None:
            self._finish(Finished(None, stopped=True))

    def _finish(self, answer: Finished) -> None:
        self._finished = answer
        self._process.kill()
        shutil.rmtree(self._folder, ignore_errors=True)

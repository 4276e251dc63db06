"""A capture as one thing that can be sent to another process: a picture, pictures, a film or a sheet.

What is captured is the sketch of the job, with all user edits. A job
takes the first name that no file has, and leaves nothing behind when it is stopped or fails,
but for numbered pictures: those that are whole stay.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Any

from playground.api import headless
from playground.engine.engine import Engine
from playground.engine.plain_forms import silent
from playground.engine.process.child import Outcome
from playground.engine.process.pool import Pool
from playground.engine.process.worker import Cancelled, Parent, Service, summary_of
from playground.errors import DataError, PlaygroundError
from playground.files import new_name, reason
from playground.publish.large import save_picture
from playground.publish.series import NumberedFiles, Series, Sheet, Sink, write_series
from playground.publish.video import QUALITY, VideoFile
from playground.sketch.model import Sketch

PICTURE, PICTURES, FILM, SHEET = KINDS = ("picture", "pictures", "film", "sheet")


@dataclass(frozen=True, kw_only=True)
class CaptureJob:
    """What is to be captured, and where to."""

    kind: str  # one of KINDS
    sketch: Sketch
    folder: Path  # where the file or the folder of pictures goes
    size: tuple[int, int]  # [pixels] of each picture
    time: float = 0.0  # [s] of the picture, or of the first one
    steps: dict[str, int] = field(default_factory=dict)  # as in ``Engine.render``
    seconds: float | None = None  # of a film; None: to its last keyframe
    fps: Fraction = Fraction(30)
    ending: str = ".mp4"  # of a film
    quality: str = QUALITY
    sweeps: tuple[str, ...] = ()  # of a sheet

    def series(self) -> Series:
        """Return the pictures of a film or a sheet; raise ``ParameterError`` for none."""
        if self.kind == SHEET:
            return Series.of_values(self.sketch, self.sweeps, size=self.size, time=self.time)
        return Series.at_times(
            self.sketch,
            seconds=self.seconds,
            fps=self.fps,
            size=self.size,
            start=self.time,
            steps=self.steps,
        )

    def target(self) -> AbstractContextManager[Path]:
        """Reserve a new name for the file, or make a new folder for numbered pictures."""
        name = re.sub(r"[^\w.-]+", "-", self.sketch.name).strip("-.") or "picture"
        ends = {PICTURE: ".png", PICTURES: "-frames", FILM: self.ending, SHEET: "-sweep.png"}
        path = self.folder / f"{name}{ends[self.kind]}"
        return _new_folder(path) if self.kind == PICTURES else new_name(path)


Progress = Callable[[int, int], None]
"""Called with how many parts are done, and of how many; may raise to stop the job."""

Notice = Callable[[str], None]
"""Called with a sentence that is no mistake."""


def do(job: CaptureJob, engine: Engine, progress: Progress, notice: Notice) -> Path:
    """Do a job and return the new file, or of numbered pictures their folder.

    Raises ``PlaygroundError`` in a message.
    """
    parts = _Parts(progress)
    if job.kind == PICTURE:
        with job.target() as path:
            at: dict[str, Any] = {"size": job.size, "time": job.time, "steps": job.steps}
            save_picture(engine, job.sketch, path, **at, begin=parts.begin, done=parts.advance)
        return path
    series = job.series()
    with job.target() as path:
        sinks: dict[str, Sink] = {
            PICTURES: NumberedFiles(path / "%05d.png"),
            FILM: VideoFile(path, job.quality),
            SHEET: Sheet(path),
        }
        parts.begin(series.count)
        write_series(engine, series, sinks[job.kind], done=parts.advance, notice=notice)
    return path


class _Parts:
    """The parts of a job that are done, reported as they are counted."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._done = self._of = 0

    def begin(self, of: int) -> None:
        self._done, self._of = 0, of
        self._progress(0, of)

    def advance(self) -> None:
        self._done += 1
        self._progress(self._done, self._of)


@contextmanager
def _new_folder(path: Path) -> Iterator[Path]:
    """Make a folder of a new name; one that is still empty goes when the block fails."""
    for number in range(1, 10_000):
        folder = path if number == 1 else path.with_name(f"{path.name}-{number}")
        try:
            folder.mkdir()
        except FileExistsError:
            continue
        except OSError as error:
            raise DataError(f"nothing can be written here: {reason(error)}", file=path.parent) from None
        try:
            yield folder
        except BaseException:
            if not any(folder.iterdir()):
                folder.rmdir()
            raise
        return
    raise DataError("has ten thousand folders of pictures of this sketch", file=path.parent)


# ── in a worker process ──────────────────────────────────────────────────────


@dataclass(frozen=True)
class Finished:
    """How a job ended."""

    path: Path | None  # what was made
    error: str = ""  # in a message
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
        self.task = self._pool.submit(job)
        self._pool.shutdown(wait=False)  # there is no other job

    @property
    def progress(self) -> tuple[int, int]:
        """How many parts are done, and of how many; (0, 0) while it begins."""
        return self.task.progress or (0, 0)

    def stop(self) -> None:
        """Cancel it; it removes what it has begun, for which it has a while until it is killed."""
        if not self.stopping:
            self.stopping = True
            self.task.cancel()

    def poll(self, timeout: float = 0.0) -> Finished | None:
        """Return how it ended, None while it continues; waits ``timeout`` seconds at the most."""
        return _finished(self.task.result()) if self.task.wait(timeout) else None

    def close(self) -> None:
        """Stop it and wait until it has removed what it has begun; kill it if that takes too long."""
        self.stop()
        self.task.result()


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

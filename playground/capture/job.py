"""A capture as one thing that can be sent to another process: a picture, pictures, a film or a sheet.

What is captured is the sketch of the job, with all user edits. A job
takes the first name that no file has, and leaves nothing behind when it is stopped or fails,
but for numbered pictures: those that are whole stay.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Any

from playground.api import headless
from playground.capture.film import Film, film_of, write_film
from playground.capture.large import count_tiles, is_large, write_large
from playground.capture.sequence import write_sequence
from playground.capture.sheet import write_sheet
from playground.capture.sweep import DEFAULT_STEPS, read_sweep, swept
from playground.capture.video import QUALITY
from playground.engine.engine import Engine
from playground.engine.plain_forms import silent
from playground.engine.process.child import Outcome
from playground.engine.process.pool import Pool
from playground.engine.process.worker import Cancelled, Parent, Service, summary_of
from playground.errors import DataError, PlaygroundError
from playground.files import new_name, reason
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


Progress = Callable[[int, int], None]
"""Called with how many parts are done, and of how many; may raise to stop the job."""

Notice = Callable[[str], None]
"""Called with a sentence that is no mistake."""


def do(job: CaptureJob, engine: Engine, progress: Progress, notice: Notice) -> Path:
    """Do a job and return the new file, or of numbered pictures their folder.

    Raises ``PlaygroundError`` in a message.
    """
    work = _Work(job, engine, progress, notice)
    kinds = {PICTURE: work.picture, PICTURES: work.pictures, FILM: work.film, SHEET: work.sheet}
    return kinds[job.kind]()


class _Work:
    """A job at work: what does each kind, and counts the parts that are done."""

    def __init__(self, job: CaptureJob, engine: Engine, progress: Progress, notice: Notice) -> None:
        self.job, self.engine, self.notice = job, engine, notice
        self._progress = progress
        self._done = self._of = 0
        name = re.sub(r"[^\w.-]+", "-", job.sketch.name).strip("-.") or "picture"
        self._path = job.folder / name

    def _begin(self, of: int) -> None:
        self._done, self._of = 0, of
        self._progress(0, of)

    def _advance(self) -> None:
        self._done += 1
        self._progress(self._done, self._of)

    def picture(self) -> Path:
        job = self.job
        at: dict[str, Any] = {"time": job.time, "steps": job.steps}
        with new_name(f"{self._path}.png") as path:
            if is_large(self.engine, job.sketch, job.size):
                self._begin(count_tiles(job.size))
                return write_large(self.engine, job.sketch, path, job.size, **at, done=self._advance)
            self._begin(1)
            self.engine.render(job.sketch, size=job.size, **at).save(path)
            self._advance()
        return path

    def pictures(self) -> Path:
        film = self._film()
        if film.still:
            self.notice(film.still)
        with _new_folder(self._path.with_name(f"{self._path.name}-frames")) as folder:
            self._begin(film.count)
            write_sequence(self.engine, film, folder / "%05d.png", done=self._advance)
        return folder

    def film(self) -> Path:
        film, quality = self._film(), self.job.quality
        with new_name(f"{self._path}{self.job.ending}") as path:
            self._begin(film.count)
            return write_film(
                self.engine, film, path, quality=quality, done=self._advance, notice=self.notice
            )

    def _film(self) -> Film:
        job = self.job
        return film_of(
            job.sketch, seconds=job.seconds, fps=job.fps, size=job.size, start=job.time, steps=job.steps
        )

    def sheet(self) -> Path:
        job, sketch = self.job, self.job.sketch.at(self.job.time)
        rows = swept(sketch, [read_sweep(sketch, text, DEFAULT_STEPS) for text in job.sweeps])
        with new_name(f"{self._path}-sweep.png") as path:
            self._begin(sum(map(len, rows)))
            at: dict[str, Any] = {"size": job.size, "time": job.time}
            return write_sheet(self.engine, rows, path, **at, done=self._advance, notice=self.notice)


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

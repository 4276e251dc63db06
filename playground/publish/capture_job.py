"""What is shown of a sketch, as one thing that can be sent to another process: a picture, a film, a mesh.

What is written is the sketch of the job, with all user edits, as the commands ``render`` and ``export`` write
it. A job takes the first name that no file has. One that is stopped keeps the pictures that it has: a film of
fewer of them, or the numbered files; of a picture, a sheet, a page or a mesh nothing is left behind.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import takewhile
from pathlib import Path
from typing import Any

from playground.api import headless
from playground.engine.engine import Engine
from playground.engine.exaggeration import Exaggeration
from playground.engine.plain_forms import silent
from playground.engine.process.child import Outcome
from playground.engine.process.pool import CANCEL_SECONDS, Pool
from playground.engine.process.worker import Cancelled, Parent, Service, summary_of
from playground.errors import DataError, PlaygroundError
from playground.files import new_name, numbered_names, reason
from playground.publish.deep_picture import save_deep
from playground.publish.export_formats import ExportOptions
from playground.publish.large import save_picture
from playground.publish.series import NumberedFiles, Series, Sheet, Sink, write_series
from playground.publish.video import QUALITY, Stopped, VideoFile
from playground.sketch.model import Camera, Sketch

PICTURE, TURNTABLE, FILM, SHEET, PAGE, MESH = KINDS = (
    "picture",
    "turntable",
    "film",
    "sheet",
    "page",
    "mesh",
)
MOVING = (TURNTABLE, FILM)
NUMBERED = ".png"
"""The ending of films that are numbered PNG files in a folder of their own."""


@dataclass(frozen=True, kw_only=True)
class CaptureJob:
    """What is to be written, and where to."""

    kind: str  # one of KINDS
    sketch: Sketch
    folder: Path  # where the file or the folder of pictures goes
    ending: str  # of the file; of a film that is numbered pictures that of each
    size: tuple[int, int] = (0, 0)  # [pixels] of each picture
    time: float = 0.0  # [s] of the picture, or of the first one
    steps: dict[str, int] = field(default_factory=dict)  # as in ``Engine.render``
    seconds: float | None = None  # of a film or a turntable; None: to its last keyframe
    fps: Fraction = Fraction(30)
    quality: str = QUALITY
    sweeps: tuple[str, ...] = ()  # of a sheet
    is_deep: bool = False  # a picture of more than 8 bits a channel
    exaggeration: Exaggeration | None = None  # of what is drawn
    seen: Callable[[Camera], Camera] | None = None  # what stands for the sketch's camera at each time
    options: ExportOptions = field(default_factory=ExportOptions)  # of a page or a mesh

    def series(self) -> Series:
        """Return the pictures of a film, a turntable or a sheet; raise ``ParameterError`` for none."""
        if self.kind == SHEET:
            series = Series.of_values(self.sketch, self.sweeps, size=self.size, time=self.time)
        else:
            series = Series.at_times(
                self.sketch,
                seconds=self.seconds,
                fps=self.fps,
                size=self.size,
                start=self.time,
                steps=self.steps,
            )
        return replace(series, turns=self.kind == TURNTABLE, seen=self.seen)

    @property
    def is_folder(self) -> bool:
        """Whether it writes a folder of numbered pictures."""
        return self.kind in MOVING and self.ending == NUMBERED

    @property
    def first_name(self) -> Path:
        """The name that it would like, which a file may have already."""
        name = re.sub(r"[^\w.-]+", "-", self.sketch.name).strip("-.") or "picture"
        name += {TURNTABLE: "-turntable", SHEET: "-sweep"}.get(self.kind, "")
        return self.folder / (f"{name}-frames" if self.is_folder else f"{name}{self.ending}")

    @property
    def free_name(self) -> Path:
        """The name that it takes, unless somebody takes that first."""
        return next(path for path in numbered_names(self.first_name) if not path.exists())

    def target(self) -> AbstractContextManager[Path]:
        """Reserve a new name for the file, or make a new folder for numbered pictures."""
        return _new_folder(self.first_name) if self.is_folder else new_name(self.first_name)


Progress = Callable[[int, int], None]
"""Called with how many parts are done, and of how many; may raise ``Cancelled`` to stop the job."""

Notice = Callable[[str], None]
"""Called with a sentence that is no mistake."""


@dataclass(frozen=True)
class Made:
    """What a job has written: all of it, or what there was when it was stopped."""

    path: Path  # the new file, or the folder of numbered pictures
    stopped: bool = False
    count: int = 1  # pictures in it


def do(job: CaptureJob, engine: Engine, progress: Progress, notice: Notice) -> Made:
    """Do a job and return what was written.

    Raises ``PlaygroundError`` in a message, and ``Cancelled`` where it was stopped and nothing is kept.
    """
    before, engine.runner.exaggeration = engine.runner.exaggeration, job.exaggeration
    try:
        if job.kind == PICTURE:
            return _picture(job, engine, progress)
        if job.kind in (PAGE, MESH):
            return _export(job, engine, progress, notice)
        return _series(job, engine, progress, notice)
    finally:
        engine.runner.exaggeration = before


def _picture(job: CaptureJob, engine: Engine, progress: Progress) -> Made:
    parts, sketch = _Parts(progress), job.sketch
    if job.seen is not None:
        sketch = sketch.at(job.time)
        sketch = sketch.with_camera(job.seen(sketch.camera))
    at: dict[str, Any] = {"size": job.size, "time": job.time, "steps": job.steps}
    with job.target() as path:
        if job.is_deep:
            parts.begin(1)
            save_deep(engine, sketch, path, **at)
            parts.advance()
        else:
            save_picture(engine, sketch, path, **at, begin=parts.begin, done=parts.advance)
    return Made(path)


def _export(job: CaptureJob, engine: Engine, progress: Progress, notice: Notice) -> Made:
    from playground.publish.export import prepare, run  # loads what makes pages, which few jobs need

    progress(0, 1)
    with job.target() as path:
        prepared = prepare(engine, job.sketch, path, job.options, time=job.time, steps=job.steps)
        progress(0, 1)
        done = run(engine, prepared)
        for warning in done.warnings:
            notice(warning)
    progress(1, 1)
    return Made(path)


def _series(job: CaptureJob, engine: Engine, progress: Progress, notice: Notice) -> Made:
    parts, series = _Parts(progress, interrupts=job.kind in MOVING), job.series()
    with job.target() as path:
        sink: Sink
        if job.is_folder:
            sink = NumberedFiles(path / "%05d.png")
        elif job.kind == SHEET:
            sink = Sheet(path)
        else:
            sink = VideoFile(path, job.quality, names_shorter=False)
        try:
            parts.begin(series.count)
            write_series(engine, series, sink, done=parts.advance, notice=notice)
        except Stopped as stopped:
            if stopped.path is None:
                raise Cancelled from None
            return Made(path, stopped=True, count=stopped.count)
        except KeyboardInterrupt:
            if not job.is_folder or not sink.paths:
                raise Cancelled from None
            return Made(path, stopped=True, count=len(sink.paths))
    return Made(path, count=series.count)


class _Parts:
    """The parts of a job that are done, reported as they are counted.

    A job that ``interrupts`` ends as by Ctrl+C where it is stopped, so that what it has written stays.
    """

    def __init__(self, progress: Progress, *, interrupts: bool = False) -> None:
        self._progress, self._interrupts = progress, interrupts
        self._done = self._of = 0

    def begin(self, of: int) -> None:
        self._done, self._of = 0, of
        self._report()

    def advance(self) -> None:
        self._done += 1
        self._report()

    def _report(self) -> None:
        try:
            self._progress(self._done, self._of)
        except Cancelled:
            if self._interrupts and self._done < self._of:
                raise KeyboardInterrupt from None
            if self._done < self._of:
                raise


@contextmanager
def _new_folder(path: Path) -> Iterator[Path]:
    """Make a folder of a new name; one that is still empty goes when the block fails."""
    for folder in numbered_names(path):
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


# ── in a worker process ──────────────────────────────────────────────────────


@dataclass(frozen=True)
class Finished:
    """How a job ended."""

    path: Path | None  # what was made
    error: str = ""  # in a message
    stopped: bool = False
    count: int = 1  # pictures in what was made
    notes: tuple[str, ...] = ()


class JobProcess:
    """One job at work; call ``poll`` now and then."""

    def __init__(self, job: CaptureJob, *, software: bool = False, driver: str = "auto") -> None:
        self.job = job
        self.started, self._since = time.monotonic(), time.time()
        self._first = (0, 0.0)  # how many parts were done when the first were, and when that was
        self.stopping = False  # whether ``stop`` was called
        # It outlives its parent until its next part is done, to remove the files that it has begun.
        self._pool = Pool(__name__, options=(software, driver), ends_with_parent=False)
        self.task = self._pool.submit(job)
        self._pool.shutdown(wait=False)  # there is no other job

    @property
    def progress(self) -> tuple[int, int]:
        """How many parts are done, and of how many; (0, 0) while it begins."""
        return self.task.progress or (0, 0)

    @property
    def seconds_left(self) -> float | None:
        """How long it goes on, by what its parts took so far [s]; None before the first is done."""
        done, of = self.progress
        first, since = self._first
        if done > first:  # the first took longer: what all of them share was made for it
            return (time.monotonic() - since) * (of - done) / (done - first)
        return (since - self.started) * (of - done) / done if done else None

    def stop(self) -> None:
        """Stop it after its part, so that a film keeps its pictures; a second call ends it at once."""
        patience = _PATIENCE if self.job.kind in MOVING else CANCEL_SECONDS
        self.task.cancel(0.0 if self.stopping else patience)
        self.stopping = True

    def poll(self, timeout: float = 0.0) -> Finished | None:
        """Return how it ended, None while it continues; waits ``timeout`` seconds at the most."""
        if not self._first[0] and self.progress[0]:
            self._first = self.progress[0], time.monotonic()
        if not self.task.wait(timeout):
            return None
        finished = _finished(self.task.result())
        if finished.path is None:
            self._remove_reserved()
        return finished

    def close(self) -> None:
        """Stop it and wait until it has ended what it has begun; kill it if that takes too long."""
        self.task.cancel(CANCEL_SECONDS)
        if _finished(self.task.result()).path is None:
            self._remove_reserved()

    def _remove_reserved(self) -> None:
        """Remove the empty file or folder that holds the name of what a process that was killed had begun."""
        for path in takewhile(Path.exists, numbered_names(self.job.first_name)):
            with suppress(OSError):  # one that is in use
                status = path.stat()
                if status.st_mtime < self._since - 1.0:
                    continue
                if path.is_dir():
                    path.rmdir()  # if it is empty
                elif not status.st_size:
                    path.unlink()


_PATIENCE = 3600.0  # [s] that one picture of a film may take until its film is given up


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
            made = do(job, engine, lambda done, of: parent.report((done, of)), notes.append)
        return Finished(made.path, stopped=made.stopped, count=made.count, notes=tuple(notes))

    return Service(answer)

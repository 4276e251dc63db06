"""A capture as one thing that can be sent to another process: a picture, pictures, a film or a sheet.

What is captured is the sketch of the job, with all user edits. A job
takes the first name that no file has, and leaves nothing behind when it is stopped or fails,
but for numbered pictures: those that are whole stay.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path

from playground.capture.film import Film, film_of, write_film
from playground.capture.large import count_tiles, is_large, write_large
from playground.capture.sequence import write_sequence
from playground.capture.sheet import write_sheet
from playground.capture.sweep import USUAL_STEPS, read_sweep, swept
from playground.capture.video import QUALITY
from playground.engine.engine import Engine
from playground.errors import DataError
from playground.images.files import new_name, reason
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

    Raises ``PlaygroundError`` in a sentence.
    """
    name = re.sub(r"[^\w.-]+", "-", job.sketch.name).strip("-.") or "picture"
    work = {PICTURE: _picture, PICTURES: _pictures, FILM: _film, SHEET: _sheet}[job.kind]
    return work(job, engine, name, _Counter(progress), notice)


class _Counter:
    """Counts parts that are done."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._done = self._of = 0

    def begin(self, of: int) -> None:
        """Say how many parts there are."""
        self._done, self._of = 0, of
        self._progress(0, of)

    def __call__(self) -> None:
        self._done += 1
        self._progress(self._done, self._of)


def _picture(
    job: CaptureJob, engine: Engine, name: str, done: _Counter, notice: Callable[[str], None]
) -> Path:
    with new_name(job.folder / f"{name}.png") as path:
        if is_large(engine, job.sketch, job.size):
            done.begin(count_tiles(job.size))
            return write_large(engine, job.sketch, path, job.size, time=job.time, steps=job.steps, done=done)
        done.begin(1)
        engine.render(job.sketch, size=job.size, time=job.time, steps=job.steps).save(path)
        done()
    return path


def _pictures(
    job: CaptureJob, engine: Engine, name: str, done: _Counter, notice: Callable[[str], None]
) -> Path:
    film = _film_of(job)
    with _new_folder(job.folder / f"{name}-frames") as folder:
        done.begin(film.count)
        write_sequence(engine, film, folder / "%05d.png", done=done)
    return folder


def _film(job: CaptureJob, engine: Engine, name: str, done: _Counter, notice: Notice) -> Path:
    film = _film_of(job)
    with new_name(job.folder / f"{name}{job.ending}") as path:
        done.begin(film.count)
        return write_film(engine, film, path, quality=job.quality, done=done, notice=notice)


def _film_of(job: CaptureJob) -> Film:
    return film_of(
        job.sketch, seconds=job.seconds, fps=job.fps, size=job.size, start=job.time, steps=job.steps
    )


def _sheet(job: CaptureJob, engine: Engine, name: str, done: _Counter, notice: Notice) -> Path:
    sketch = job.sketch.at(job.time)
    rows = swept(sketch, [read_sweep(sketch, text, USUAL_STEPS) for text in job.sweeps])
    with new_name(job.folder / f"{name}-sweep.png") as path:
        done.begin(sum(map(len, rows)))
        return write_sheet(engine, rows, path, size=job.size, time=job.time, done=done, notice=notice)


@contextmanager
def _new_folder(wanted: Path) -> Iterator[Path]:
    """Make a folder of a new name; one that is still empty goes when the block fails."""
    for number in range(1, 10_000):
        folder = wanted if number == 1 else wanted.with_name(f"{wanted.name}-{number}")
        try:
            folder.mkdir()
        except FileExistsError:
            continue
        except OSError as error:
            raise DataError(f"nothing can be written here: {reason(error)}", file=wanted.parent) from None
        try:
            yield folder
        except BaseException:
            if not any(folder.iterdir()):
                folder.rmdir()
            raise
        return
    raise DataError("has ten thousand folders of pictures of this sketch", file=wanted.parent)

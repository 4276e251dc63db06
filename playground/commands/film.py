"""Videos, numbered pictures and sweeps, as ``render`` makes them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from playground.commands.arguments import Moment, Renderer, output_file, read_option
from playground.errors import ParameterError, counted
from playground.sketch.model import DEFAULT_PICTURE
from playground.terminal import note, progress

if TYPE_CHECKING:
    from playground.engine.engine import Engine

SWEEP_FPS = Fraction(4)
_FRAMES = re.compile(r"(\d{1,7})(?:\.\.(\d{1,7}))?")


@dataclass(frozen=True, kw_only=True)
class Series:
    """What ``render`` is to make besides one picture; "" and None where it is not."""

    video: str = ""
    seconds: float | None = None
    fps: Fraction | None = None
    quality: str = ""
    frames: range | None = None
    resume: bool = False
    sweeps: tuple[str, ...] = ()
    steps: int | None = None  # values of a sweep's range

    @property
    def many(self) -> bool:
        """Whether more than one picture is to be made."""
        return bool(self.video or self.frames is not None or self.sweeps)

    def check(self, output: str, texture: str, profile: bool) -> None:
        """Raise ``ParameterError`` for options that do not go together."""
        video, framed, swept = bool(self.video), self.frames is not None, bool(self.sweeps)
        timed = self.seconds is not None
        wrong = {
            "--seconds needs --video FILE": timed and not video,
            "--quality needs --video FILE": self.quality and not video,
            "--fps needs --video or --frames": self.fps is not None and not video and not framed,
            "--resume needs --frames FIRST..LAST": self.resume and not framed,
            "-n needs --sweep PATH=FROM..TO": self.steps is not None and not swept,
            "--video and --frames: a film is one file, or many": video and framed,
            "--video says which file to write; -o is for another kind": video and output,
            "--sweep and --frames: a sweep is a sheet, or with --video a film": swept and framed,
            "--seconds is for a film by time; a sweep has as many pictures as values": swept and timed,
            "--texture is for one pass's values, not for films and sweeps": self.many and texture,
            "--profile is for one picture": self.many and profile,
            "-o - is for one picture": self.many and output == "-",
        }
        for sentence, is_wrong in wrong.items():
            if is_wrong:
                raise ParameterError(sentence)


@dataclass(frozen=True, slots=True)
class SeriesJob:
    """A series, of which moment of a sketch it is, and where and by what it is drawn."""

    series: Series
    moment: Moment
    output: str
    size: tuple[int, int] | None
    renderer: Renderer
    driver: str

    @contextmanager
    def drawing(self, verb: str, total: int) -> Iterator[tuple[Engine, Callable[[], None]]]:
        """Open the engine, and show the progress of so many pictures."""
        with (
            self.renderer.open_engine(driver=self.driver) as engine,
            progress(f"{verb} {self.moment.sketch.name}", total) as done,
        ):
            yield engine, done

    def check_video(self, pixels: tuple[int, int], fps: Fraction) -> str:
        """Return the quality of the video; raise where none can be written like that."""
        from playground.capture.video import QUALITY, check_video

        quality = self.series.quality or QUALITY
        check_video(Path(self.series.video).expanduser(), pixels, fps, quality)
        return quality


def read_fps(text: str) -> Fraction | None:
    """Return the pictures a second of ``--fps``, as 30, 23.976 or 30000/1001; raise ``ParameterError``."""

    def read(text: str) -> Fraction | None:
        fraction = Fraction(text).limit_denominator(1001)
        return fraction if Fraction(1, 60) <= fraction <= 1000 else None

    return read_option("--fps", text, read, "pictures a second, 1/60 to 1000, as 30 or 30000/1001")


def read_frames(text: str) -> range | None:
    """Return the numbers of ``--frames``, as 0..299; raise ``ParameterError``."""

    def read(text: str) -> range | None:
        match = _FRAMES.fullmatch(text.strip())
        numbers = range(int(match[1]), int(match[2] or match[1]) + 1) if match else None
        return numbers or None

    return read_option("--frames", text, read, "FIRST..LAST, as 0..299")


def make_series(job: SeriesJob) -> None:
    """Make a video, numbered pictures or a sheet, and print the paths of what was written."""
    if job.series.sweeps:
        _make_sweep(job)
    elif job.series.frames is not None:
        _make_frames(job, job.series.frames)
    else:
        _make_video(job)


def _make_frames(job: SeriesJob, numbers: range) -> None:
    from playground.capture.film import FPS, Film
    from playground.capture.sequence import check_pattern, write_sequence

    moment = job.moment
    pattern = _pattern(job.output, moment.sketch.name)
    check_pattern(pattern)
    pixels = job.size or moment.size or DEFAULT_PICTURE
    fps = job.series.fps or Fraction(FPS)
    film = Film(
        sketch=moment.sketch,
        count=numbers[-1] + 1,
        fps=fps,
        size=pixels,
        start=moment.time,
        steps=moment.steps,
    )
    if film.still:
        note(film.still)
    with job.drawing("drawing", len(numbers)) as (engine, done):
        sequence = write_sequence(engine, film, pattern, numbers=numbers, resume=job.series.resume, done=done)
    if sequence.kept:
        note(f"{counted(len(sequence.kept), 'picture')} kept, {len(sequence.drawn)} drawn")
    for path in sorted(sequence.drawn + sequence.kept):
        print(path)


def _make_video(job: SeriesJob) -> None:
    from playground.capture.film import FPS, film_of, write_film

    series, moment = job.series, job.moment
    pixels, fps = job.size or moment.size or DEFAULT_PICTURE, series.fps or Fraction(FPS)
    film = film_of(
        moment.sketch, seconds=series.seconds, fps=fps, size=pixels, start=moment.time, steps=moment.steps
    )
    quality = job.check_video(pixels, fps)
    with job.drawing("filming", film.count) as (engine, done), _noting_stop():
        print(write_film(engine, film, series.video, quality=quality, done=done, notice=note))


def _make_sweep(job: SeriesJob) -> None:
    from playground.capture import sheet, sweep

    series, moment = job.series, job.moment
    sketch = moment.sketch.at(moment.time)
    if moment.steps:
        raise ParameterError("--steps is for one picture or a film by time, not for a sweep")
    sweeps = [sweep.read_sweep(sketch, text, series.steps or sweep.DEFAULT_STEPS) for text in series.sweeps]
    rows = sweep.swept(sketch, sweeps)
    count = sum(map(len, rows))
    if series.video:
        pixels, fps = job.size or DEFAULT_PICTURE, series.fps or SWEEP_FPS
        quality = job.check_video(pixels, fps)
        with job.drawing("sweeping", count) as (engine, done), _noting_stop():
            path = sheet.write_sweep_film(
                engine,
                rows,
                series.video,
                fps=fps,
                size=pixels,
                time=moment.time,
                quality=quality,
                done=done,
                notice=note,
            )
            print(path)
        return
    with (
        output_file(job.output, f"{sketch.name}-sweep.png", (".png",), "a sheet is") as path,
        job.drawing("sweeping", count) as (engine, done),
    ):
        size = job.size or sheet.DEFAULT_SIZE
        print(sheet.write_sheet(engine, rows, path, size=size, time=moment.time, done=done, notice=note))


def _pattern(output: str, name: str) -> str:
    """Return what names the files of a sequence: as it was given, or in the folder that was given."""
    if not output:
        return f"{name}-%05d.png"
    return str(Path(output) / "%05d.png") if Path(output).expanduser().is_dir() else output


@contextmanager
def _noting_stop() -> Iterator[None]:
    """Note what is left of a video that was interrupted."""
    from playground.capture.video import Stopped

    try:
        yield
    except Stopped as stopped:
        if stopped.path is None:
            note("stopped before the first picture; nothing was written")
        else:
            note(f"stopped; the first {counted(stopped.count, 'picture')}: {stopped.path}")
        raise

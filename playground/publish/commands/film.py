"""Videos, numbered pictures and sweeps, as ``render`` makes them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from playground.commands.arguments import Moment, Renderer, output_file, read_option, refuse
from playground.errors import ParameterError, counted
from playground.sketch.model import DEFAULT_PICTURE
from playground.terminal import note, progress

if TYPE_CHECKING:
    from playground.publish.series import Series, Sink

_FRAMES = re.compile(r"(\d{1,7})(?:\.\.(\d{1,7}))?")


@dataclass(frozen=True, kw_only=True)
class SeriesOptions:
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
        conflicts = {
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
        refuse(conflicts)


@dataclass(frozen=True, slots=True)
class SeriesJob:
    """A series of a moment of a sketch, where it is written, and by what it is drawn."""

    options: SeriesOptions
    moment: Moment
    output: str
    size: tuple[int, int] | None
    renderer: Renderer
    driver: str

    def make(self) -> None:
        """Make a video, numbered pictures or a sheet, and print the paths of what was written."""
        from playground.publish.series import write_series

        series, options = self._series(), self.options
        verb = "sweeping" if options.sweeps else "drawing" if options.frames else "filming"
        with (
            self._sink(series) as sink,
            self.renderer.open_engine(driver=self.driver) as engine,
            progress(f"{verb} {series.sketch.name}", len(options.frames or range(series.count))) as done,
            _noting_stop(),
        ):
            write_series(engine, series, sink, numbers=options.frames, done=done, notice=note)
        for path in sink.paths:
            print(path)

    def _series(self) -> Series:
        """Return what is drawn; raise ``ParameterError`` for what cannot be."""
        from playground.publish.series import FPS, SWEEP_FPS, SWEEP_SIZE, Series
        from playground.publish.sweep import DEFAULT_STEPS

        options, moment = self.options, self.moment
        if options.sweeps:
            if moment.steps:
                raise ParameterError("--steps is for one picture or a film by time, not for a sweep")
            return Series.of_values(
                moment.sketch,
                options.sweeps,
                steps=options.steps or DEFAULT_STEPS,
                fps=options.fps or Fraction(SWEEP_FPS),
                size=self.size or (DEFAULT_PICTURE if options.video else SWEEP_SIZE),
                time=moment.time,
            )
        size, fps = self.size or moment.size or DEFAULT_PICTURE, options.fps or Fraction(FPS)
        at: dict[str, Any] = {"fps": fps, "size": size, "start": moment.time, "steps": moment.steps}
        if options.frames is not None:
            return Series(sketch=moment.sketch, count=options.frames[-1] + 1, **at)
        return Series.at_times(moment.sketch, seconds=options.seconds, **at)

    @contextmanager
    def _sink(self, series: Series) -> Iterator[Sink]:
        """Return what the series is written into; refuse what could not be written."""
        from playground.publish.series import NumberedFiles, Sheet, check_pattern
        from playground.publish.video import QUALITY, VideoFile

        options, name = self.options, self.moment.sketch.name
        if options.video:
            video = VideoFile(options.video, options.quality or QUALITY)
            video.check(series)
            yield video
        elif options.frames is not None:
            pattern = _pattern(self.output, name)
            check_pattern(pattern)
            yield NumberedFiles(pattern, options.resume)
        else:
            with output_file(self.output, f"{name}-sweep.png", (".png",), "a sheet is") as path:
                yield Sheet(path)


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


def _pattern(output: str, name: str) -> str:
    """Return what names the files of a sequence: as it was given, or in the folder that was given."""
    if not output:
        return f"{name}-%05d.png"
    return str(Path(output) / "%05d.png") if Path(output).expanduser().is_dir() else output


@contextmanager
def _noting_stop() -> Iterator[None]:
    """Note what is left of a video that was interrupted."""
    from playground.publish.video import Stopped

    try:
        yield
    except Stopped as stopped:
        if stopped.path is None:
            note("stopped before the first picture; nothing was written")
        else:
            note(f"stopped; the first {counted(stopped.count, 'picture')}: {stopped.path}")
        raise

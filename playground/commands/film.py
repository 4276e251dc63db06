"""Videos, numbered pictures and sweeps, as ``render`` is asked for them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from playground.commands.arguments import Moment, Renderer
from playground.errors import DataError, ParameterError, counted
from playground.sketch.model import DEFAULT_PICTURE
from playground.terminal import note, progress

if TYPE_CHECKING:
    from playground.engine.engine import Engine

SWEEP_FPS = Fraction(4)
_FRAMES = re.compile(r"(\d{1,7})(?:\.\.(\d{1,7}))?")


@dataclass(frozen=True)
class Asked:
    """What ``render`` was asked for besides one picture; "" and None where it was not."""

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
        """Whether more than one picture is asked for."""
        return bool(self.video or self.frames is not None or self.sweeps)

    def check(self, output: str, texture: str, profile: bool) -> None:
        """Raise ``ParameterError`` for words that do not go together."""
        wrong = (
            (self.seconds is not None and not self.video, "--seconds needs --video FILE"),
            (bool(self.quality) and not self.video, "--quality needs --video FILE"),
            (
                self.fps is not None and not self.video and self.frames is None,
                "--fps needs --video or --frames",
            ),
            (self.resume and self.frames is None, "--resume needs --frames FIRST..LAST"),
            (self.steps is not None and not self.sweeps, "-n needs --sweep PATH=FROM..TO"),
            (
                bool(self.video) and self.frames is not None,
                "--video and --frames: a film is one file, or many",
            ),
            (bool(self.video and output), "--video says which file to write; -o is for another kind"),
            (
                bool(self.sweeps) and self.frames is not None,
                "--sweep and --frames: a sweep is a sheet, or with --video a film",
            ),
            (
                bool(self.sweeps) and self.seconds is not None,
                "--seconds is for a film by time; a sweep has as many pictures as values",
            ),
            (self.many and bool(texture), "--texture is for one pass's values, not for films and sweeps"),
            (self.many and profile, "--profile is for one picture"),
            (self.many and output == "-", "-o - is for one picture"),
        )
        for is_wrong, sentence in wrong:
            if is_wrong:
                raise ParameterError(sentence)


def read_number(text: str, option: str, example: str) -> float | None:
    """Return the positive number of an option, None where it is absent; raise ``ParameterError``."""
    if not text:
        return None
    try:
        found = float(text)
    except ValueError:
        found = 0.0
    if not 0.0 < found < 1e7:
        raise ParameterError(f"{option} {text}: expected a number above 0, as {example}")
    return found


def read_fps(text: str) -> Fraction | None:
    """Return the pictures a second of ``--fps``, as 30, 23.976 or 30000/1001; raise ``ParameterError``."""
    if not text:
        return None
    try:
        found = Fraction(text).limit_denominator(1001)
    except (ValueError, ZeroDivisionError):
        found = Fraction(0)
    if not Fraction(1, 60) <= found <= 1000:
        raise ParameterError(f"--fps {text}: expected pictures a second, 1/60 to 1000, as 30 or 30000/1001")
    return found


def read_frames(text: str) -> range | None:
    """Return the numbers of ``--frames``, as 0..299; raise ``ParameterError``."""
    if not text:
        return None
    match = _FRAMES.fullmatch(text.strip())
    if match is None or int(match.group(2) or match.group(1)) < int(match.group(1)):
        raise ParameterError(f"--frames {text}: expected FIRST..LAST, as 0..299")
    return range(int(match.group(1)), int(match.group(2) or match.group(1)) + 1)


def read_count(text: str) -> int | None:
    """Return the values of ``-n``; raise ``ParameterError``."""
    if not text:
        return None
    if not (text.isdecimal() and len(text) < 6 and int(text) >= 2):
        raise ParameterError(f"-n {text}: expected a whole number from 2, as 12")
    return int(text)


def make_many(
    asked: Asked,
    moment: Moment,
    output: str,
    size: tuple[int, int] | None,
    renderer: Renderer,
    driver: str,
) -> None:
    """Make a video, pictures or a sheet, and print the paths of what was written."""
    if asked.sweeps:
        _make_sweep(asked, moment, output, size, renderer, driver)
        return
    from playground.capture.film import FPS, Film, film_of, write_film

    sketch, fps, pixels = moment.sketch, asked.fps or Fraction(FPS), size or moment.size or DEFAULT_PICTURE
    if asked.frames is not None:
        from playground.capture.sequence import check_pattern, write_sequence

        pattern = _pattern(output, sketch.name)
        check_pattern(pattern)
        film = Film(
            sketch=sketch,
            count=asked.frames[-1] + 1,
            fps=fps,
            size=pixels,
            start=moment.time,
            steps=moment.steps,
        )
        with _drawing(f"drawing {sketch.name}", len(asked.frames), renderer, driver) as (engine, done):
            found = write_sequence(
                engine, film, pattern, numbers=asked.frames, resume=asked.resume, done=done
            )
        if found.kept:
            note(f"{counted(len(found.kept), 'picture')} kept, {len(found.drawn)} drawn")
        for path in sorted(found.drawn + found.kept):
            print(path)
        return
    from playground.capture.video import QUALITY, check_video

    film = film_of(sketch, seconds=asked.seconds, fps=fps, size=pixels, start=moment.time, steps=moment.steps)
    quality = asked.quality or QUALITY
    check_video(Path(asked.video).expanduser(), pixels, fps, quality)
    with _drawing(f"filming {sketch.name}", film.count, renderer, driver) as (engine, done), _stoppable():
        print(write_film(engine, film, asked.video, quality=quality, done=done, notice=note))


def _make_sweep(
    asked: Asked,
    moment: Moment,
    output: str,
    size: tuple[int, int] | None,
    renderer: Renderer,
    driver: str,
) -> None:
    from playground.capture import sheet, sweep
    from playground.capture.video import QUALITY, check_video

    sketch = moment.sketch.at(moment.time)
    if moment.steps:
        raise ParameterError("--steps is for one picture or a film by time, not for a sweep")
    found = [sweep.read_sweep(sketch, text, asked.steps or sweep.USUAL_STEPS) for text in asked.sweeps]
    rows = sweep.swept(sketch, found)
    count = sum(map(len, rows))
    if asked.video:
        pixels, fps, quality = size or DEFAULT_PICTURE, asked.fps or SWEEP_FPS, asked.quality or QUALITY
        check_video(Path(asked.video).expanduser(), pixels, fps, quality)
        with _drawing(f"sweeping {sketch.name}", count, renderer, driver) as (engine, done), _stoppable():
            print(
                sheet.write_sweep_film(
                    engine,
                    rows,
                    asked.video,
                    fps=fps,
                    size=pixels,
                    time=moment.time,
                    quality=quality,
                    done=done,
                    notice=note,
                )
            )
        return
    from playground.images.files import new_name

    pixels = size or sheet.USUAL_SIZE
    if output:
        path = _checked_png(output)
        with _drawing(f"sweeping {sketch.name}", count, renderer, driver) as (engine, done):
            print(
                sheet.write_sheet(engine, rows, path, size=pixels, time=moment.time, done=done, notice=note)
            )
        return
    with (
        new_name(f"{sketch.name}-sweep.png") as path,
        _drawing(f"sweeping {sketch.name}", count, renderer, driver) as (engine, done),
    ):
        print(sheet.write_sheet(engine, rows, path, size=pixels, time=moment.time, done=done, notice=note))


def _checked_png(output: str) -> Path:
    path = Path(output).expanduser()
    if path.suffix.lower() != ".png" or path.is_dir():
        raise DataError("a sheet is written to a name ending in .png", file=output)
    if not path.parent.is_dir():
        raise DataError(f"there is no folder '{path.parent}' to write into", file=output)
    return path


def _pattern(output: str, name: str) -> str:
    """Return what names the files of a sequence: as it was given, or in the folder that was given."""
    if not output:
        return f"{name}-%05d.png"
    return str(Path(output) / "%05d.png") if Path(output).expanduser().is_dir() else output


@contextmanager
def _drawing(
    text: str, total: int, renderer: Renderer, driver: str
) -> Iterator[tuple[Engine, Callable[[], None]]]:
    from playground.api import headless

    with (
        headless(software=renderer.software, device=renderer.device, driver=driver) as engine,
        progress(text, total) as done,
    ):
        yield engine, done


@contextmanager
def _stoppable() -> Iterator[None]:
    """Say what is left of a video that was interrupted."""
    from playground.capture.video import Stopped

    try:
        yield
    except Stopped as stopped:
        if stopped.path is None:
            note("stopped before the first picture; nothing was written")
        else:
            note(f"stopped; the first {counted(stopped.count, 'picture')}: {stopped.path}")
        raise

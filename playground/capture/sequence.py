"""Write pictures of a film as numbered PNG files; what is there already may stay.

Each file holds, as a text of its own, what its picture depends on. A sequence that goes on
where it was stopped keeps the files that are whole and of the same sketch, size, time and
renderer, and draws the others.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from contextlib import nullcontext
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from playground.api import headless
from playground.capture.film import DEFAULT_SIZE, FPS, MAX_FRAMES, Film, frame_uniforms
from playground.capture.large import is_large, write_large
from playground.data.image_files import read_png
from playground.engine.engine import Engine
from playground.errors import DataError, ParameterError
from playground.files import make_folder
from playground.sketch.load import opened
from playground.sketch.model import Sketch

MADE_OF = "Made of"
"""The text of a PNG that identifies all that its picture depends on."""

_NUMBER = re.compile(r"%(0\d+)?d")


@dataclass(frozen=True)
class Written:
    """The files of a sequence: those drawn now, and those that were there and stayed."""

    drawn: tuple[Path, ...]
    kept: tuple[Path, ...] = ()


def numbered(pattern: str | Path, number: int) -> Path:
    """Return the file of a picture: ``frames/%05d.png`` with its number in it."""
    path = Path(pattern).expanduser()
    return path.with_name(_NUMBER.sub(lambda match: f"{number:{match.group(1) or ''}d}", path.name))


def check_pattern(pattern: str | Path) -> None:
    """Raise ``DataError`` for what names no PNG files by number."""
    name = Path(pattern).name
    if len(_NUMBER.findall(name)) != 1 or name.count("%") != 1 or not name.lower().endswith(".png"):
        raise DataError("expected a name for numbered files, as frames/%05d.png", file=str(pattern))


def write_sequence(
    engine: Engine,
    film: Film,
    pattern: str | Path,
    *,
    numbers: Iterable[int] | None = None,
    resume: bool = False,
    done: Callable[[], None] = lambda: None,
) -> Written:
    """Write pictures of a film as PNG files, each whole or not at all.

    ``numbers`` are those of the pictures, all of the film's unless given; ``pattern`` names the
    files, as ``frames/%05d.png``; its folder is made. With ``resume`` a file that is there
    and good stays. ``done`` is called after each. Raises ``DataError`` in a message.
    """
    check_pattern(pattern)
    total = range(film.count) if numbers is None else list(numbers)
    make_folder(Path(pattern).expanduser().parent)
    drawn, kept = [], []
    for number in total:
        path = numbered(pattern, number)
        made_of = engine.fingerprint(
            film.sketch, size=film.size, time=film.time(number), steps=film.steps
        )  # before it is drawn, so that a mistake in the sketch is reported first
        if resume and _is_good(path, film.size, made_of):
            kept.append(path)
        else:
            _write(engine, film, number, path, made_of)
            drawn.append(path)
        done()
    return Written(tuple(drawn), tuple(kept))


def _write(engine: Engine, film: Film, number: int, path: Path, made_of: str) -> None:
    text, time = {MADE_OF: made_of}, film.time(number)
    with frame_uniforms(engine, film):
        if is_large(engine, film.sketch, film.size):
            write_large(engine, film.sketch, path, film.size, time=time, steps=film.steps, text=text)
        else:
            frame = engine.render(film.sketch, size=film.size, time=time, steps=film.steps)
            frame.save(path, text)
    engine.forget_unused()


def _is_good(path: Path, size: tuple[int, int], made_of: str) -> bool:
    """Return whether a file is there, whole to its last pixel, and the picture wanted."""
    if not path.is_file():
        return False
    try:
        pixels, texts = read_png(path)
    except DataError:
        return False
    return (pixels.shape[1], pixels.shape[0]) == size and texts.get(MADE_OF) == made_of


def render_sequence(
    sketch: Sketch | str | Path,
    pattern: str | Path,
    numbers: Iterable[int],
    *,
    fps: float | Fraction = FPS,
    size: tuple[int, int] = DEFAULT_SIZE,
    resume: bool = False,
    engine: Engine | None = None,
) -> Written:
    """Render pictures ``numbers`` of a sketch as PNG files named by ``pattern``, as ``frames/%05d.png``.

    Picture n is that of the time n / ``fps`` seconds; ``size`` in pixels. With ``resume``
    good files stay, whose sketch, size and time are the same. Without an ``engine`` one is
    opened. ``sketch`` is a loaded one, or what ``load`` takes. Returns the paths, those that were
    drawn and those that stayed.

        written = playground.render_sequence("l_dot_n", "frames/%05d.png", range(2), fps=10, size=(64, 36))

    Raises ``PlaygroundError`` in a message.
    """
    requested = list(numbers)
    if not requested or min(requested) < 0 or max(requested) >= MAX_FRAMES:
        raise ParameterError(f"pictures are numbered from 0 to {MAX_FRAMES - 1}; at least one was expected")
    rate = fps if isinstance(fps, Fraction) else Fraction(fps).limit_denominator(1001)
    film = Film(sketch=opened(sketch), count=max(requested) + 1, fps=rate, size=size)
    with nullcontext(engine) if engine is not None else headless() as used:
        return write_sequence(used, film, pattern, numbers=requested, resume=resume)

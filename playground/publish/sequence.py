"""Write pictures of a series as numbered PNG files; what is there already may stay.

Each file holds, as a text of its own, what its picture depends on. A sequence that goes on
where it was stopped keeps the files that are whole and of the same sketch, size, time and
renderer, and draws the others.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path

from playground.data.image_files import read_png
from playground.engine.engine import Engine
from playground.errors import DataError, ParameterError, counted
from playground.files import make_folder
from playground.publish.large import save_picture
from playground.publish.series import (
    DEFAULT_SIZE,
    FPS,
    MAX_FRAMES,
    Add,
    Picture,
    Series,
    engine_or_own,
    rate_of,
    write_series,
)
from playground.sketch.load import opened
from playground.sketch.model import Sketch

MADE_OF = "Made of"
"""The text of a PNG that identifies all that its picture depends on."""

_NUMBER = re.compile(r"%(0\d+)?d")


def numbered(pattern: str | Path, number: int) -> Path:
    """Return the file of a picture: ``frames/%05d.png`` with its number in it."""
    path = Path(pattern).expanduser()
    return path.with_name(_NUMBER.sub(lambda match: f"{number:{match.group(1) or ''}d}", path.name))


def check_pattern(pattern: str | Path) -> None:
    """Raise ``DataError`` for what names no PNG files by number."""
    name = Path(pattern).name
    if len(_NUMBER.findall(name)) != 1 or name.count("%") != 1 or not name.lower().endswith(".png"):
        raise DataError("expected a name for numbered files, as frames/%05d.png", file=str(pattern))


@dataclass
class NumberedFiles:
    """The sink of a series that is PNG files, each whole or not at all.

    ``pattern`` names the files, as ``frames/%05d.png``; its folder is made. With ``resume`` a file that is
    there and good stays.
    """

    pattern: str | Path
    resume: bool = False
    drawn: list[Path] = field(default_factory=list)  # now
    kept: list[Path] = field(default_factory=list)  # that were there

    @property
    def paths(self) -> list[Path]:
        """The files, those that stayed as well."""
        return sorted(self.drawn + self.kept)

    @contextmanager
    def open(self, series: Series, notice: Callable[[str], None]) -> Iterator[Add]:
        """Write the files; ``notice`` gets a message on those that stayed.

        Raises ``DataError`` for a name without a number.
        """
        check_pattern(self.pattern)
        make_folder(Path(self.pattern).expanduser().parent)
        yield self._add
        if self.kept:
            notice(f"{counted(len(self.kept), 'picture')} kept, {len(self.drawn)} drawn")

    def _add(self, picture: Picture) -> None:
        path = numbered(self.pattern, picture.number)
        made_of = picture.engine.fingerprint(picture.sketch, **picture.at)  # reports mistakes of the sketch
        if self.resume and _is_good(path, picture.at["size"], made_of):
            self.kept.append(path)
        else:
            save_picture(picture.engine, picture.sketch, path, **picture.at, text={MADE_OF: made_of})
            self.drawn.append(path)


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
) -> NumberedFiles:
    """Render pictures ``numbers`` of a sketch as PNG files named by ``pattern``, as ``frames/%05d.png``.

    Picture n is that of the time n / ``fps`` seconds; ``size`` in pixels. With ``resume``
    good files stay, whose sketch, size and time are the same. Without an ``engine`` one is
    opened. ``sketch`` is a loaded one, or what ``load`` takes. The result has
    the paths of those that were ``drawn`` and of those that were ``kept``.

        written = playground.render_sequence("l_dot_n", "frames/%05d.png", range(2), fps=10, size=(64, 36))

    Raises ``PlaygroundError`` in a message.
    """
    requested = list(numbers)
    if not requested or min(requested) < 0 or max(requested) >= MAX_FRAMES:
        raise ParameterError(f"pictures are numbered from 0 to {MAX_FRAMES - 1}; at least one was expected")
    series = Series(sketch=opened(sketch), count=max(requested) + 1, fps=rate_of(fps), size=size)
    sink = NumberedFiles(pattern, resume)
    with engine_or_own(engine) as used:
        write_series(used, series, sink, numbers=requested)
    return sink

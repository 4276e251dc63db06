"""A contact sheet: pictures of a sketch side by side, each with its values written below it.

The letters are Pillow's own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from playground.data.image_files import write_png
from playground.engine.engine import Engine
from playground.errors import ParameterError
from playground.publish.series import SWEEP_SIZE, Add, Picture, Series, engine_or_own, write_series
from playground.publish.sweep import DEFAULT_STEPS
from playground.publish.video import alpha_note, has_alpha
from playground.sketch.model import MAX_SIDE, Sketch

if TYPE_CHECKING:
    import PIL.ImageFont

_PAPER, _INK = (24, 25, 28), (232, 232, 228)
_MARGIN = 8  # [pixels] around a picture
_MIN_TEXT_HEIGHT = 9  # [pixels]


@dataclass(frozen=True)
class Sheet:
    """The sink of a series that is a contact sheet, a PNG that is whole or not there."""

    path: str | Path

    @property
    def paths(self) -> list[Path]:
        """The one file."""
        return [Path(self.path)]

    @contextmanager
    def open(self, series: Series, notice: Callable[[str], None]) -> Iterator[Add]:
        """Write the sheet; ``notice`` gets a message where alpha was dropped.

        Raises ``ParameterError`` for a sheet that is larger than a picture may be.
        """
        paper, dropped = Paper(series), 0

        def add(picture: Picture) -> None:
            nonlocal dropped
            array = picture.array
            dropped += has_alpha(array)
            paper.add(array)

        yield add
        write_png(self.path, paper.array)
        if note := alpha_note(dropped, series.count, "a sheet"):
            notice(note)


class Paper:
    """A sheet, onto which the pictures of a series are put one by one, each with its caption.

    A caption is as large as fits its picture's width. Raises ``ParameterError`` for too large a sheet.
    """

    def __init__(self, series: Series) -> None:
        import PIL.Image
        import PIL.ImageDraw

        self._columns, self._captions = series.columns, [case.caption for case in series.cases]
        width, height = series.size
        self._font, self._line = _font([text for caption in self._captions for text in caption], width)
        lines = len(self._captions[0])
        self._cell = width + _MARGIN, height + lines * self._line + _MARGIN + 4
        rows = -(-series.count // series.columns)
        size = series.columns * self._cell[0] + _MARGIN, rows * self._cell[1] + _MARGIN
        if max(size) > MAX_SIDE:
            raise ParameterError(
                f"a sheet of {size[0]} x {size[1]} pixels; at most {MAX_SIDE} a side: "
                "choose smaller pictures, or fewer"
            )
        self._image = PIL.Image.new("RGB", size, _PAPER)
        self._drawing = PIL.ImageDraw.Draw(self._image)
        self._count = 0

    @property
    def array(self) -> NDArray[np.uint8]:
        """The sheet, (height, width, 3) bytes, top row first."""
        return np.array(self._image, np.uint8)

    def add(self, picture: NDArray[np.uint8]) -> None:
        """Put the next picture, (height, width, 3 or 4) bytes, top row first, onto the sheet."""
        import PIL.Image

        down, along = divmod(self._count, self._columns)
        x, y = _MARGIN + along * self._cell[0], _MARGIN + down * self._cell[1]
        image = PIL.Image.fromarray(np.ascontiguousarray(picture[..., :3]))
        self._image.paste(image, (x, y))
        for number, text in enumerate(self._captions[self._count]):
            centre = (x + image.width / 2, y + image.height + 2 + (number + 0.5) * self._line)
            self._drawing.text(centre, text, _INK, font=self._font, anchor="mm")
        self._count += 1


def _font(captions: Sequence[str], width: int) -> tuple[PIL.ImageFont.FreeTypeFont, int]:
    """Return letters with which every caption is narrower than the picture, and the height of a line."""
    import PIL.ImageFont

    size = max(min(width // 16, 18), _MIN_TEXT_HEIGHT)
    while True:
        font = PIL.ImageFont.load_default(size)
        assert isinstance(font, PIL.ImageFont.FreeTypeFont)
        if size <= _MIN_TEXT_HEIGHT or max(font.getlength(text) for text in captions) <= width:
            return font, round(1.4 * size)
        size -= 1


def render_sweep(
    sketch: Sketch | str | Path,
    path: str | Path,
    *sweeps: str,
    steps: int = DEFAULT_STEPS,
    size: tuple[int, int] = SWEEP_SIZE,
    time: float = 0.0,
    engine: Engine | None = None,
) -> Path:
    """Render a contact sheet of one sweep, or of two that make a grid, as a PNG.

    A sweep is written ``"light.sun.elevation=5..60"``, ``"light.gain=1..3,5"`` for five steps,
    ``"light.gain=1,2,4"``; ``steps`` for a range that does not say. ``size`` in pixels is that
    of each picture, ``time`` in seconds. Without an ``engine`` one is opened. ``sketch`` is a loaded one,
    or what ``load`` takes; ``path`` is returned.

        playground.render_sweep("l_dot_n", "sheet.png", "product.sun.elevation=10,40,80", size=(64, 36))

    Raises ``ParameterError`` in a message for what ``sweeps`` do not say right.
    """
    series = Series.of_values(sketch, sweeps, steps=steps, size=size, time=time)
    with engine_or_own(engine) as used:
        write_series(used, series, Sheet(path))
    return Path(path)

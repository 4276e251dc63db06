"""A contact sheet: pictures of a sketch side by side, each with its values written below it.

Or a film of the same pictures, one after another. The letters are Pillow's own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import nullcontext
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from playground.api import headless
from playground.capture.sweep import DEFAULT_STEPS, Swept, read_sweep, swept
from playground.capture.video import QUALITY, Video, alpha_note, has_alpha
from playground.data.image_files import write_png
from playground.engine.engine import Engine
from playground.errors import ParameterError
from playground.sketch.load import opened
from playground.sketch.model import MAX_SIDE, Sketch

if TYPE_CHECKING:
    import PIL.ImageFont

DEFAULT_SIZE = (320, 180)
"""Width and height in pixels of a picture of a sheet."""

_PAPER, _INK = (24, 25, 28), (232, 232, 228)
_MARGIN = 8  # [pixels] around a picture
_MIN_TEXT_HEIGHT = 9  # [pixels]


def pictures(
    engine: Engine, rows: Sequence[Sequence[Swept]], size: tuple[int, int], time: float = 0.0
) -> Iterator[NDArray[np.uint8]]:
    """Yield the picture of each sketch, row by row, (height, width, 4) bytes, top row first."""
    for row in rows:
        for cell in row:
            yield engine.render(cell.sketch, size=size, time=time).array
            engine.forget_unused()


def sheet(rows: Sequence[Sequence[Swept]], arrays: Iterator[NDArray[np.uint8]]) -> NDArray[np.uint8]:
    """Return pictures on one sheet with their captions, (height, width, 3) bytes, top row first.

    ``arrays`` gives the picture of each of ``rows``. A caption is as large as fits its picture's width.
    """
    import PIL.Image
    import PIL.ImageDraw

    paper, drawn, font, line, whole = None, None, None, 0, (0, 0)
    for down, row in enumerate(rows):
        for along, cell in enumerate(row):
            picture = PIL.Image.fromarray(np.ascontiguousarray(next(arrays)[..., :3]))
            if paper is None:
                lines = len(cell.caption)
                captions = [text for each in rows for other in each for text in other.caption]
                font, line = _font(captions, picture.width)
                whole = (picture.width + _MARGIN, picture.height + lines * line + _MARGIN + 4)
                size = _sheet_size(rows, whole)
                paper = PIL.Image.new("RGB", size, _PAPER)
                drawn = PIL.ImageDraw.Draw(paper)
            assert drawn is not None and font is not None
            x, y = _MARGIN + along * whole[0], _MARGIN + down * whole[1]
            paper.paste(picture, (x, y))
            for number, text in enumerate(cell.caption):
                centre = (x + picture.width / 2, y + picture.height + 2 + (number + 0.5) * line)
                drawn.text(centre, text, _INK, font=font, anchor="mm")
    assert paper is not None, "a sweep has a value"
    return np.array(paper, np.uint8)


def _sheet_size(rows: Sequence[Sequence[Swept]], each: tuple[int, int]) -> tuple[int, int]:
    size = max(map(len, rows)) * each[0] + _MARGIN, len(rows) * each[1] + _MARGIN
    if max(size) > MAX_SIDE:
        raise ParameterError(
            f"a sheet of {size[0]} x {size[1]} pixels; at most {MAX_SIDE} a side: "
            "choose smaller pictures, or fewer"
        )
    return size


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


def write_sheet(
    engine: Engine,
    rows: Sequence[Sequence[Swept]],
    path: str | Path,
    *,
    size: tuple[int, int] = DEFAULT_SIZE,
    time: float = 0.0,
    done: Callable[[], None] = lambda: None,
    notice: Callable[[str], None] = lambda _: None,
) -> Path:
    """Write a contact sheet as a PNG, whole or not at all, and return its path.

    ``done`` is called after each picture, ``notice`` with a message where alpha was dropped.
    """
    dropped = 0

    def opaque() -> Iterator[NDArray[np.uint8]]:
        nonlocal dropped
        for picture in _counted(pictures(engine, rows, size, time), done):
            dropped += has_alpha(picture)
            yield picture

    write_png(path, sheet(rows, opaque()))
    if note := alpha_note(dropped, sum(map(len, rows)), "a sheet"):
        notice(note)
    return Path(path)


def write_sweep_film(
    engine: Engine,
    rows: Sequence[Sequence[Swept]],
    path: str | Path,
    *,
    fps: Fraction,
    size: tuple[int, int],
    time: float = 0.0,
    quality: str = QUALITY,
    done: Callable[[], None] = lambda: None,
    notice: Callable[[str], None] = lambda _: None,
) -> Path:
    """Write the pictures of a sweep as a video, one after another.

    Arguments as for ``Video`` and ``write_sheet``.
    """
    with Video(path, size, fps, sum(map(len, rows)), quality=quality) as video:
        for picture in _counted(pictures(engine, rows, size, time), done):
            video.add(picture)
    for note in (video.warning, alpha_note(video.dropped, video.count, "the video")):
        if note:
            notice(note)
    return Path(path)


def _counted(arrays: Iterator[NDArray[np.uint8]], done: Callable[[], None]) -> Iterator[NDArray[np.uint8]]:
    for picture in arrays:
        done()  # before it is handed on: the generator is not resumed after the last one
        yield picture


def render_sweep(
    sketch: Sketch | str | Path,
    path: str | Path,
    *sweeps: str,
    steps: int = DEFAULT_STEPS,
    size: tuple[int, int] = DEFAULT_SIZE,
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
    opened_sketch = opened(sketch)
    rows = swept(opened_sketch, [read_sweep(opened_sketch, text, steps) for text in sweeps])
    with nullcontext(engine) if engine is not None else headless() as used:
        return write_sheet(used, rows, path, size=size, time=time)

"""Draw a picture of any size part by part, and write it strip by strip.

What is drawn at a time is a tile, what is held a row of tiles; ``playground.engine.window``
says what makes the tiles one picture. Kernels and plain shaders give the same bytes however
they are parted. A mesh is rasterised again for each tile, and the driver rounds places and
what is interpolated between vertices to single precision, from another corner: on llvmpipe
one pixel in a thousand differs from the picture drawn whole, and by a few levels of 255.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from playground.data.image_files import PNG_START, chunk, text_chunks
from playground.engine.engine import Engine
from playground.engine.frame import reduced
from playground.engine.plan import Window, drawn_size
from playground.engine.textures import read_picture
from playground.errors import DataError, ParameterError, SketchError
from playground.files import replacing
from playground.sketch.load import opened
from playground.sketch.model import MAX_PICTURE_SIDE, Sketch

TILE = (2048, 512)
"""Width and height of a tile in pixels."""

MAX_UNTILED_PIXELS = 2**23
"""Pixels of a picture that is drawn whole: its samples and their depths take 12 bytes each."""


def max_side(engine: Engine) -> int:
    """Return how many pixels a side may have of a picture that is drawn whole."""
    limits = ("GL_MAX_TEXTURE_SIZE", "GL_MAX_RENDERBUFFER_SIZE")
    return min(int(engine.ctx.info[name]) for name in limits)


def check_large(engine: Engine, sketch: Sketch, size: tuple[int, int]) -> None:
    """Raise ``SketchError`` where a picture that is drawn in parts has a pass that cannot be."""
    whole = drawn_size(sketch, size, MAX_PICTURE_SIDE)
    engine.plan_for_window(sketch, tiles_of(whole, uncut(TILE, sketch.picture.supersample))[0][0])


def is_large(engine: Engine, sketch: Sketch, size: tuple[int, int]) -> bool:
    """Return whether a picture is drawn in parts.

    More than the driver's textures hold must be; more than 3840 x 2160 is, where the sketch's
    passes allow it.
    """
    size = drawn_size(sketch, size, MAX_PICTURE_SIDE)
    if max(size) > max_side(engine):
        return True
    if size[0] * size[1] <= MAX_UNTILED_PIXELS:
        return False
    try:
        engine.plan_for_window(sketch, tiles_of(size)[0][0])
    except SketchError:
        return False  # drawing it whole says what else may be wrong
    return True


def tiles_of(size: tuple[int, int], tile: tuple[int, int] = TILE) -> list[list[Window]]:
    """Return a picture's tiles, row by row from the top; all but the last of each row are alike.

    Raises ``ParameterError`` for odd sides: derivatives are worked out for squares of two
    pixels, which must be those of the whole picture.
    """
    if min(tile) < 2 or tile[0] % 2 or tile[1] % 2:
        raise ParameterError(f"tiles of {tile[0]} x {tile[1]} pixels: expected even numbers from 2")
    (width, height), (wide, tall) = size, tile
    return [
        [Window((x, y), (min(wide, width - x), min(tall, height - y)), size) for x in range(0, width, wide)]
        for y in reversed(range(0, height, tall))
    ]


def uncut(tile: tuple[int, int], times: int) -> tuple[int, int]:
    """Return a tile, hardly smaller, that cuts no square of so many pixels which become one."""
    unit = 2 * times
    wide, tall = (max(side // unit, 1) * unit if times > 1 else side for side in tile)
    return wide, tall


def count_tiles(size: tuple[int, int], tile: tuple[int, int] = TILE) -> int:
    """Return how many tiles a picture has."""
    return sum(len(row) for row in tiles_of(size, tile))


def count_parts(sketch: Sketch, size: tuple[int, int]) -> int:
    """Return how many tiles ``strips`` draws of a picture, its supersampling counted."""
    whole = drawn_size(sketch, size, MAX_PICTURE_SIDE)
    return count_tiles(whole, uncut(TILE, sketch.picture.supersample))


def strips(
    engine: Engine,
    sketch: Sketch | str | Path,
    size: tuple[int, int],
    *,
    time: float = 0.0,
    steps: Mapping[str, int] | None = None,
    tile: tuple[int, int] = TILE,
    done: Callable[[], None] = lambda: None,
) -> Iterator[NDArray[np.uint8]]:
    """Yield a picture's rows of tiles from the top, each (rows, width, 4), sRGB and alpha.

    ``size`` and ``tile`` in pixels, ``time`` in seconds, ``steps`` as in ``Engine.render``;
    ``done`` is called after each tile. Raises ``SketchError`` at a pass that cannot be drawn
    in parts, before anything of it is drawn.
    """
    opened_sketch = opened(sketch)
    times = opened_sketch.picture.supersample
    whole = drawn_size(opened_sketch, size, MAX_PICTURE_SIDE)
    for row in tiles_of(whole, uncut(tile, times)):
        strip = np.empty((row[0].size[1], whole[0], 4), np.uint8)
        for window in row:
            left = window.origin[0]
            texture = engine.draw_window(opened_sketch, window, time=time, steps=steps)
            strip[:, left : left + window.size[0]] = read_picture(texture)
            engine.forget_unused()
            done()
        yield reduced(strip, times)


def encode_strips(
    handle: BinaryIO,
    size: tuple[int, int],
    rows: Iterable[NDArray[np.uint8]],
    text: Mapping[str, str] | None = None,
) -> None:
    """Write a picture as a PNG to an open file, from what `strips` yields."""
    writer = PngStrips(handle, size, text=text)
    for strip in rows:
        writer.write(strip)
    writer.close()


def write_large(
    engine: Engine,
    sketch: Sketch | str | Path,
    path: str | Path,
    size: tuple[int, int],
    *,
    time: float = 0.0,
    steps: Mapping[str, int] | None = None,
    tile: tuple[int, int] = TILE,
    text: Mapping[str, str] | None = None,
    done: Callable[[], None] = lambda: None,
) -> Path:
    """Write a picture of up to 65,536 pixels a side as a PNG, whole or not at all, and return its path.

    ``size`` and ``tile`` in pixels; ``engine``, ``sketch``, ``time``, ``steps`` and ``done`` as for
    ``strips``; ``text`` as for ``Frame.save``. Of the picture, what is held is
    one strip, ``tile[1]`` rows, about five times over: 160 MiB at 16,384 pixels of width,
    independent of the height.

        with playground.headless() as engine:
            playground.write_large(engine, "l_dot_n", "land.png", (96, 64), tile=(64, 32))

    Raises ``DataError`` for a ``path`` with another ending, ``SketchError`` at a pass that cannot be drawn
    in parts.
    """
    if Path(path).suffix.lower() != ".png":
        raise DataError(
            "a picture that is drawn in parts is written to a name ending in .png", file=str(path)
        )
    rows = strips(engine, sketch, size, time=time, steps=steps, tile=tile, done=done)
    with replacing(path) as handle:
        encode_strips(handle, size, rows, text)
    return Path(path)


def save_picture(
    engine: Engine,
    sketch: Sketch,
    path: Path,
    size: tuple[int, int],
    *,
    time: float = 0.0,
    steps: Mapping[str, int] | None = None,
    text: Mapping[str, str] | None = None,
    begin: Callable[[int], None] = lambda _: None,
    done: Callable[[], None] = lambda: None,
) -> None:
    """Write a picture as a PNG, whole or not at all: in parts where it is large.

    ``begin`` is called with the number of parts, ``done`` after each; the rest as for ``write_large``.
    """
    if is_large(engine, sketch, size):
        begin(count_parts(sketch, size))
        write_large(engine, sketch, path, size, time=time, steps=steps, text=text, done=done)
        return
    begin(1)
    engine.render(sketch, size=size, time=time, steps=steps).save(path, dict(text or {}))
    done()


# ── PNG strip by strip ─────────────────────────────────────────────────────────


_LEVEL = 6
_MAX_INT32 = 2**31 - 1  # of a side, and of a chunk


class PngStrips:
    """A PNG of 8 bits being written to an open file: strips from the top, then ``close``.

    ``size`` is width and height in pixels, ``channels`` 3 (RGB) or 4 (RGBA).
    """

    def __init__(
        self,
        handle: BinaryIO,
        size: tuple[int, int],
        channels: int = 4,
        text: Mapping[str, str] | None = None,
    ) -> None:
        width, height = size
        if not (1 <= width <= _MAX_INT32 and 1 <= height <= _MAX_INT32) or channels not in (3, 4):
            raise DataError(f"a PNG of {width} x {height} pixels and {channels} channels cannot be written")
        self._handle = handle
        self._shape = (width, channels)
        self._left = height  # rows still to come
        self._above = np.zeros(width * channels, np.uint8)
        self._packer = zlib.compressobj(_LEVEL)
        kind = {3: 2, 4: 6}[channels]
        handle.write(PNG_START + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, kind, 0, 0, 0)))
        for texts in text_chunks(text or {}):
            handle.write(texts)

    def write(self, strip: NDArray[np.uint8]) -> None:
        """Write the rows that come next, (rows, width, channels)."""
        rows = len(strip)
        if strip.dtype != np.uint8 or strip.shape[1:] != self._shape or rows > self._left:
            raise DataError(
                f"a strip of {strip.dtype} {strip.shape} where at most {self._left} rows of {self._shape} fit"
            )
        flat = strip.reshape(rows, self._shape[0] * self._shape[1])
        self._packed(self._packer.compress(_filtered(flat, self._above, self._shape[1]).tobytes()))
        self._above = flat[-1].copy() if rows else self._above
        self._left -= rows

    def close(self) -> None:
        """Write the end; raise ``DataError`` where rows are missing."""
        if self._left:
            raise DataError(f"{self._left} rows of the picture are missing")
        self._packed(self._packer.flush())
        self._handle.write(chunk(b"IEND", b""))

    def _packed(self, data: bytes) -> None:
        if data:
            self._handle.write(chunk(b"IDAT", data))


def _filtered(rows: NDArray[np.uint8], above: NDArray[np.uint8], channels: int) -> NDArray[np.uint8]:
    """Return rows with the filter's number before each: that of 0, 1 (left) and 2 (above) that suits it."""
    count, length = rows.shape
    result = np.empty((count, length + 1), np.uint8)
    best = np.full(count, np.iinfo(np.int64).max)
    left = np.concatenate([np.zeros((count, channels), np.uint8), rows[:, :-channels]], axis=1)
    upper = np.concatenate([above[None], rows[:-1]])
    with np.errstate(over="ignore"):
        for number, guess in enumerate((np.zeros_like(rows), left, upper)):
            rest = rows - guess
            cost = np.minimum(rest, 0 - rest).sum(axis=1, dtype=np.int64)
            better = cost < best
            result[better, 0], best[better] = number, cost[better]
            result[better, 1:] = rest[better]
    return result

"""Write a PNG strip by strip, so that a picture need not fit in memory.

The picture goes through one compressor, a strip at a time: what is held is the strip, its
filtered rows and the compressor's window, independent of the picture's height.

Source: W3C PNG specification, third edition, 2025: clause 9.2 (filters) and 12.7 (each row
takes the filter whose bytes, counted as signed numbers, sum to the least).
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from playground.data.image_files import PNG_START, chunk, text_chunks
from playground.errors import DataError

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

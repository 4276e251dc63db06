"""What a grid of heights may be, how a format's reader hands one over, and which heights it means.

A grid's rows are gone through in bands, so that a large file is never in memory as a whole.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from playground.data.bounds import MAX_TEXELS
from playground.data.place import Crs, Georeference
from playground.errors import DataError
from playground.files import open_regular

Heights = NDArray[np.float32]
Packing = Literal["grey", "rgb"]

EIGHT_BIT = (0.0, 255.0)
SIXTEEN_BIT = (0.0, 65535.0)
PACKED = (0.0, 16777215.0)

MAX_TEXELS_IN_STRIPS = 2**34
"""Texels of a file that is never read as a whole."""


_SHORT_VOID = -32768  # "no data" in 16-bit elevations: SRTM's value, and the custom since


_BAND = 2**22  # [texels] of a band of an array

Band = tuple[int, NDArray[Any]]
"""The number of its first row, and the rows."""


class Rows(Protocol):
    """A grid of numbers whose rows can be read in turn, any number of times."""

    @property
    def shape(self) -> tuple[int, int]:
        """Return (rows, columns)."""
        ...

    @property
    def dtype(self) -> np.dtype[Any]:
        """Return the numbers' type."""
        ...

    def bands(self) -> Iterator[Band]:
        """Yield all rows in the file's order, some at a time."""
        ...


@dataclass(frozen=True, eq=False)
class ArrayRows:
    """The rows of an array."""

    values: NDArray[Any]  # (rows, cols)

    @property
    def shape(self) -> tuple[int, int]:
        """Return (rows, columns)."""
        rows, cols = self.values.shape
        return rows, cols

    @property
    def dtype(self) -> np.dtype[Any]:
        """Return the numbers' type."""
        return self.values.dtype

    def bands(self) -> Iterator[Band]:
        """Yield all rows, some at a time."""
        rows, cols = self.shape
        count = max(_BAND // cols, 1)
        for start in range(0, rows, count):
            yield start, self.values[start : start + count]


@dataclass(frozen=True, eq=False)
class FileRows:
    """Rows that are in a file as they are.

    They are read, not mapped: where a file shrinks under a map, the system ends the process.
    """

    path: Path
    shape: tuple[int, int]
    dtype: np.dtype[Any]  # as stored
    offset: int = 0  # [bytes] from the file's beginning to the first row

    def bands(self) -> Iterator[Band]:
        """Yield all rows, some at a time."""
        rows, cols = self.shape
        count = max(_BAND // cols, 1)
        with open_regular(self.path) as handle:
            handle.seek(self.offset)
            for start in range(0, rows, count):
                high = min(count, rows - start)
                raw = handle.read(high * cols * self.dtype.itemsize)
                if len(raw) < high * cols * self.dtype.itemsize:
                    row = start + len(raw) // (cols * self.dtype.itemsize)
                    raise DataError(f"is cut short: row {row} is missing", file=self.path)
                values = np.frombuffer(raw, self.dtype).reshape(high, cols)
                yield start, values.astype(self.dtype.newbyteorder("="), copy=False)


@dataclass(frozen=True, eq=False)
class RasterFile:
    """What a format's reader hands over; rows in the file's order."""

    rows: Rows  # of any real dtype
    spacing: tuple[float, float] | None = None
    in_metres: bool = True  # else heights are codes, as a picture's
    code_range: tuple[float, float] | None = None
    no_data: float | None = None  # what stands for no data
    assumed: str = ""  # of the unit of its heights; "" where the file or its format says it
    scale: float = 1.0  # [m] height of one step of the file's numbers
    offset: float = 0.0  # [m] height of the file's 0
    place: Georeference | None = None
    south_first: bool | None = None  # the file's first row is the south's; None: it does not say
    overviews: tuple[Rows, ...] = ()  # the same terrain in fewer texels, each the mean of several
    notes: tuple[str, ...] = ()

    @property
    def size(self) -> tuple[int, int]:
        """Return (nx, ny), in texels."""
        ny, nx = self.rows.shape
        return nx, ny

    def in_unit(self, crs: Crs, stated: str = "") -> RasterFile:
        """Return the same in metres, of scale and offset in a stated unit, else in that of ``crs``."""
        metres, assumed = crs.resolve_height_unit(stated)
        return replace(self, scale=self.scale * metres, offset=self.offset * metres, assumed=assumed)

    def heights(self, band: NDArray[Any]) -> NDArray[np.floating[Any]]:
        """Return the heights that some rows mean, NaN for no data."""
        void = void_of(band, self.no_data)
        if band.dtype.kind == "i" and band.dtype.itemsize == 2:
            short = band == _SHORT_VOID
            void = short if void is None else void | short
        with np.errstate(all="ignore"):
            plain = (self.scale, self.offset) == (1.0, 0.0)
            heights = np.array(
                band if plain else band.astype(np.float64) * self.scale + self.offset, dtype=np.float32
            )
        if void is not None:
            heights[void] = np.nan
        return heights


def in_memory(values: NDArray[Any], spacing: tuple[float, float] | None = None, **facts: Any) -> RasterFile:
    """Return what was found, of an array (rows, cols)."""
    return RasterFile(ArrayRows(values), spacing, **facts)


def void_of(values: NDArray[Any], no_data: float | None) -> NDArray[np.bool_] | None:
    """Return where numbers stand for no data; None where none could."""
    if no_data is None or math.isnan(no_data):
        return None
    if values.dtype.kind != "f":
        bounds = np.iinfo(values.dtype)
        exact = no_data.is_integer() and bounds.min <= no_data <= bounds.max
        return np.asarray(values == int(no_data)) if exact else None
    if abs(no_data) > 1e30:  # the lowest float, which programs round in several ways before printing
        return np.asarray(np.abs(values) > 1e30)
    return np.asarray(values == values.dtype.type(no_data))


def fitted(size: tuple[int, int], longest: int) -> tuple[int, int]:
    """Return a grid like one of ``size`` (nx, ny) with so many nodes at most on the longer side."""
    most = max(size)
    if longest >= most:
        return size
    ratio = (longest - 1) / (most - 1)
    return max(2, round((size[0] - 1) * ratio) + 1), max(2, round((size[1] - 1) * ratio) + 1)


def check_grid(shape: tuple[int, ...], dtype: np.dtype[Any], path: Path, *, in_turn: bool = False) -> None:
    """Raise ``DataError`` for what is no terrain; a header's claims are judged, before memory is taken.

    ``in_turn``: its rows can be read in turn, so that there may be more of them.
    """
    size = " x ".join(map(str, reversed(shape))) or "a single number"
    if dtype.kind not in "iuf":
        raise DataError(f"holds {dtype}, not heights; expected integers or real numbers", file=path)
    if len(shape) != 2:
        raise DataError(
            f"has {len(shape)} dimensions ({size}); expected two, rows from north to south", file=path
        )
    if min(shape) < 2:
        raise DataError(f"is {size} texels; expected at least 2 x 2", file=path)
    if math.prod(shape) > (MAX_TEXELS_IN_STRIPS if in_turn else MAX_TEXELS):
        most = "2**34, as 131072 x 131072" if in_turn else "2**28, as 16384 x 16384"
        raise DataError(f"is {size} texels; the most is {most}", file=path)


def from_channels(samples: NDArray[Any], packing: Packing, path: Path) -> RasterFile:
    """Return the heights in a picture's samples (rows, cols, channels): grey, grey + alpha, RGB or RGBA."""
    channels, bits = samples.shape[2], 8 * samples.dtype.itemsize
    values: NDArray[Any] = samples[..., 0]
    code_range = EIGHT_BIT if bits == 8 else SIXTEEN_BIT
    if packing == "rgb":
        if channels < 3 or bits != 8:
            what = f"packed heights need three channels of 8 bits; found {channels} of {bits}"
            raise DataError(what, file=path)
        values, code_range = unpacked(np.moveaxis(samples[..., :3], 2, 0)), PACKED
    elif channels >= 3:
        require_grey(np.moveaxis(samples[..., :3], 2, 0), path)
    if channels in (2, 4):
        values = np.where(samples[..., -1] == 0, np.float32(np.nan), values.astype(np.float32))
    return in_memory(values, in_metres=False, code_range=code_range)


def unpacked(channels: NDArray[Any]) -> NDArray[np.float32]:
    """Return the numbers R*65536 + G*256 + B of three channels (3, rows, cols) of bytes: exact in float32."""
    weights = np.array([65536.0, 256.0, 1.0], np.float32)
    return np.asarray(np.tensordot(weights, channels.astype(np.float32), 1))


def require_grey(channels: NDArray[Any], path: Path) -> None:
    """Raise ``DataError`` for a picture in colour, of channels (3, rows, cols)."""
    if not (channels[1:] == channels[0]).all():
        message = "is a picture in colour; expected grey, or packing 'rgb' for heights in three channels"
        raise DataError(message, file=path)

"""Read the rows of a TIFF's picture strip by strip or tile by tile, and never the whole of it.

Knows no compression, deflate and, from Python 3.14 on, zstd, with their predictors, of one channel;
``tiff_rows`` returns None for others. Sources: TIFF 6.0 (Adobe 1992), sections 3, 14 and 15; Adobe
Photoshop TIFF Technical Note 3 (2005) for predictor 3.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.data.rows import Band, FileRows, Rows
from playground.errors import DataError
from playground.regular_file import open_regular

if TYPE_CHECKING:
    import tifffile

_NONE, _DEFLATE, _ZSTD = 1, (8, 32946), 50000
_BAND = 2**22  # [texels] of a band, or of a row of tiles where that is more

Unpack = Callable[[bytes], bytes]


@dataclass(frozen=True, eq=False)
class _Blocks:
    """A picture in blocks: tiles, or strips as wide as the picture."""

    path: Path
    shape: tuple[int, int]
    dtype: np.dtype[Any]  # as stored
    block: tuple[int, int]  # rows and columns of one
    offsets: tuple[int, ...] = field(repr=False)
    lengths: tuple[int, ...] = field(repr=False)
    unpack: Unpack
    predictor: int
    absent: float  # what a block holds that is not stored

    def bands(self) -> Iterator[Band]:
        """Yield all rows, at least a row of blocks at a time."""
        rows, cols = self.shape
        high, wide = self.block
        across = -(-cols // wide)
        several = max(_BAND // (high * cols), 1)
        with open_regular(self.path) as handle:
            for start in range(0, rows, several * high):
                end = min(start + several * high, rows)
                values = np.empty((end - start, across * wide), self.dtype.newbyteorder("="))
                for row in range(start, end, high):
                    for column in range(across):
                        number = row // high * across + column
                        # The last strip is shorter; the last tiles are filled up.
                        count = min(high, rows - row) if wide == cols else high
                        block = self._block(handle, number, count)
                        place = values[row - start : row - start + high, column * wide : (column + 1) * wide]
                        place[:] = block[: len(place)]
                yield start, values[:, :cols]

    def _block(self, handle: Any, number: int, count: int) -> NDArray[Any]:
        shape = count, self.block[1]
        if not self.lengths[number]:
            return np.full(shape, self.absent, self.dtype)
        handle.seek(self.offsets[number])
        raw = self.unpack(handle.read(self.lengths[number]))
        need = count * self.block[1] * self.dtype.itemsize
        if len(raw) < need:
            raise DataError(
                f"is cut short: block {number} holds {len(raw)} bytes, {need} expected", file=self.path
            )
        if self.predictor == 3:
            return _floats_from_differences(raw[:need], shape, self.dtype)
        values = np.frombuffer(raw, self.dtype, shape[0] * shape[1]).reshape(shape)
        if self.predictor == 2:
            native = values.astype(self.dtype.newbyteorder("="))
            return np.cumsum(native, axis=1, dtype=native.dtype)  # modulo 2**bits, as is meant
        return values


def _floats_from_differences(raw: bytes, shape: tuple[int, int], dtype: np.dtype[Any]) -> NDArray[Any]:
    """Undo predictor 3: of each row the highest bytes, then the next, each less the byte before."""
    rows, cols = shape
    planes = np.frombuffer(raw, np.uint8).reshape(rows, dtype.itemsize * cols)
    summed = np.cumsum(planes, axis=1, dtype=np.uint8).reshape(rows, dtype.itemsize, cols)
    return np.ascontiguousarray(summed.transpose(0, 2, 1)).view(dtype.newbyteorder(">"))[..., 0]


def tiff_rows(page: tifffile.TiffPage, path: Path, absent: float = 0.0) -> Rows | None:
    """Return the rows of a picture of one channel; None where they cannot be read in turn here.

    ``absent`` is what a block holds that is left out of the file.
    """
    dtype = page.dtype
    if dtype is None or page.axes != "YX" or page.bitspersample != 8 * dtype.itemsize or page.fillorder != 1:
        return None
    unpack = _unpacker(int(page.compression), page)
    predictor = int(page.predictor)
    if unpack is None or predictor not in (1, 2, 3) or (predictor == 2 and dtype.kind == "f"):
        return None
    if predictor == 3 and dtype.kind != "f":
        return None
    rows, cols = page.shape
    stored = dtype.newbyteorder(page.parent.byteorder)
    if page.compression == _NONE and not page.is_tiled and predictor == 1 and page.is_contiguous:
        return FileRows(path, (rows, cols), stored, page.dataoffsets[0])
    block = (
        (page.tilelength, page.tilewidth) if page.is_tiled else (min(page.rowsperstrip or rows, rows), cols)
    )
    count = -(-rows // block[0]) * -(-cols // block[1])
    if min(len(page.dataoffsets), len(page.databytecounts)) < count:
        return None
    return _Blocks(
        path,
        (rows, cols),
        stored,
        block,
        tuple(page.dataoffsets),
        tuple(page.databytecounts),
        unpack,
        predictor,
        absent,
    )


def _unpacker(compression: int, page: tifffile.TiffPage) -> Unpack | None:
    """Return what undoes a compression, whose result is no longer than a block is."""
    if compression == _NONE:
        return bytes
    texels = page.tilelength * page.tilewidth if page.is_tiled else page.rowsperstrip * page.imagewidth
    most = max(texels, page.imagewidth) * page.bitspersample // 8
    if compression in _DEFLATE:
        return partial(_inflated, most)
    if compression == _ZSTD:
        with suppress(ImportError):
            from compression.zstd import ZstdDecompressor  # type: ignore[import-not-found,unused-ignore]

            return lambda packed: ZstdDecompressor().decompress(packed, most)
    return None


def _inflated(most: int, packed: bytes) -> bytes:
    return zlib.decompressobj().decompress(packed, most)

"""Numbers that are painted: one a texel, of either sign, in a TIFF of 32-bit floats.

What was written is read again bit by bit, at the size it was written in.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.images.files import replacing
from playground.terrain.elevation import read_elevation
from playground.terrain.resample import resample


def read_numbers(path: Path, size: tuple[int, int]) -> NDArray[np.float32]:
    """Return a file's numbers (ny, nx) at a size (nx, ny), row 0 south; any elevation file will do.

    Raises:
        DataError: missing, damaged, no grid of finite numbers.
    """
    found = read_elevation(path)
    if found.missing:
        raise DataError(f"{found.missing} texels have no data; expected a number in each", file=path)
    if found.size == size:
        return found.heights
    nx, ny = size
    return resample(found.heights, (max(nx, 2), max(ny, 2)))[:ny, :nx]


def write_numbers(path: Path, numbers: NDArray[np.float32]) -> None:
    """Write numbers (ny, nx), row 0 south, as a TIFF without compression, which takes a few milliseconds.

    Raises ``DataError`` where the file cannot be written.
    """
    import tifffile

    with replacing(path) as handle:
        tifffile.imwrite(
            handle, np.ascontiguousarray(numbers[::-1], "<f4"), photometric="minisblack", metadata=None
        )

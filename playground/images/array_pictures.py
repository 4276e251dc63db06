"""Read a picture that is NumPy's array in a file: its header first, and nothing is unpickled."""

from __future__ import annotations

from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.images.bounds import refuse_too_many

_PICTURED = (np.uint8, np.uint16, np.float32)
_START = b"\x93NUMPY"


def is_array(handle: BinaryIO) -> bool:
    """Return whether a file that is being read is NumPy's; leaves the handle at the start."""
    start = handle.read(6)
    handle.seek(0)
    return start == _START


def array_shape(handle: BinaryIO, path: Path) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """Return the shape, order and dtype of a picture in an `.npy`, judged before any memory is taken."""
    version = np.lib.format.read_magic(handle)
    read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, by_columns, dtype = read(handle)
    if len(shape) != 3 or shape[2] not in (1, 3, 4) or 0 in shape or dtype not in _PICTURED:
        raise DataError(
            f"holds {dtype} {shape}; a picture is uint8, uint16 or float32, (rows, cols, 1, 3 or 4)",
            file=path,
        )
    refuse_too_many(path, shape[1], shape[0])
    return shape, by_columns, dtype


def array_samples(handle: BinaryIO, path: Path) -> NDArray[Any]:
    """Return the numbers of a picture in an `.npy`, (rows, cols, 1, 3 or 4), top row first."""
    shape, by_columns, dtype = array_shape(handle, path)
    count = shape[0] * shape[1] * shape[2]
    flat = np.frombuffer(handle.read(count * dtype.itemsize), dtype)
    samples = flat.reshape(shape[::-1]).T if by_columns else flat.reshape(shape)
    if dtype.kind == "f" and not (samples.min() >= 0.0 and samples.max() <= 1.0):
        raise DataError(
            f"has numbers from {samples.min():g} to {samples.max():g}; expected 0 to 1", file=path
        )
    return samples

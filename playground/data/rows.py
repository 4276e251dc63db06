"""Go through a grid's rows in bands, so that a large file is never in memory as a whole."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.regular_file import open_regular

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
class StreamRows:
    """Rows that a function yields from the first to the last."""

    shape: tuple[int, int]
    dtype: np.dtype[Any]
    bands: Callable[[], Iterator[Band]] = field(repr=False)


@dataclass(frozen=True, eq=False)
class FileRows:
    """Rows that are in a file as they are.

    They are read, not mapped: where a file shrinks under a map, the system ends the process.
    """

    path: Path
    shape: tuple[int, int]
    dtype: np.dtype[Any]  # as stored
    offset: int = 0  # [bytes] from the file's beginning to the first row
    row_bytes: int = 0  # [bytes] from row to row; 0: of a row's numbers

    def bands(self) -> Iterator[Band]:
        """Yield all rows, some at a time."""
        rows, cols = self.shape
        count = max(_BAND // cols, 1)
        used = cols * self.dtype.itemsize
        wide = self.row_bytes or used
        with open_regular(self.path) as handle:
            handle.seek(self.offset)
            for start in range(0, rows, count):
                high = min(count, rows - start)
                raw = np.frombuffer(handle.read(high * wide), np.uint8)
                need = (high - 1) * wide + used  # the last row need not be filled up
                if len(raw) < need:
                    raise DataError(
                        f"is cut short: row {start + len(raw) // wide} is missing", file=self.path
                    )
                filled = raw if len(raw) == high * wide else np.pad(raw, (0, high * wide - len(raw)))
                values = np.ascontiguousarray(filled.reshape(high, wide)[:, :used]).view(self.dtype)
                yield start, values.astype(self.dtype.newbyteorder("="), copy=False)

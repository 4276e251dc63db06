"""The pictures of a series, as arrays."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from playground.engine.engine import Engine
from playground.publish.series import Add, Series, write_series


@dataclass
class Arrays:
    """A sink that holds the pictures."""

    arrays: list[np.ndarray] = field(default_factory=list)

    @property
    def paths(self) -> list[Path]:
        """No file."""
        return []

    @contextmanager
    def open(self, series: Series, notice: Callable[[str], None]) -> Iterator[Add]:
        """Take the pictures."""
        yield lambda picture: self.arrays.append(picture.array)


def pictures(engine: Engine, series: Series) -> list[np.ndarray]:
    """Return the pictures of a series, each (height, width, 4), top row first."""
    sink = Arrays()
    write_series(engine, series, sink)
    return sink.arrays

"""What each of the last pictures cost: milliseconds, texels, triangles. Recorded only while it is shown."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

LENGTH = 240
"""Pictures that are recorded."""


class Ring:
    """The last numbers of a row that goes on; a number that is missing is 0."""

    def __init__(self, length: int = LENGTH) -> None:
        self._numbers: NDArray[np.float64] = np.zeros(
            2 * length
        )  # each number twice, so that any stretch is one piece
        self._length = length
        self.count = 0

    def add(self, number: float) -> None:
        """Take in a number; the oldest goes."""
        at = self.count % self._length
        self._numbers[at] = self._numbers[at + self._length] = number
        self.count += 1

    @property
    def values(self) -> NDArray[np.float64]:
        """The numbers, oldest first; a view that the next number changes."""
        held = min(self.count, self._length)
        start = (self.count - held) % self._length
        return self._numbers[start : start + held]


class Record:
    """The costs of the pictures since they were first shown."""

    def __init__(self, length: int = LENGTH) -> None:
        self._length = length
        self.clear()

    def clear(self) -> None:
        """Forget all of it."""
        self.pictures = 0
        self.passes: dict[str, Ring] = {}  # [ms] by path
        self.whole = Ring(self._length)  # [ms] of all passes
        self.texels = Ring(self._length)
        self.triangles = Ring(self._length)

    def add(self, times: Mapping[str, float], texels: int, triangles: int) -> None:
        """Take in a picture; a pass that did not run for it cost nothing."""
        for path in times:
            if path not in self.passes:
                self.passes[path] = ring = Ring(self._length)
                for _ in range(min(self.pictures, self._length)):
                    ring.add(0.0)
        for path, ring in self.passes.items():
            ring.add(times.get(path, 0.0))
        self.whole.add(sum(times.values()))
        self.texels.add(texels)
        self.triangles.add(triangles)
        self.pictures += 1
        gone = [path for path, ring in self.passes.items() if path not in times and not ring.values.any()]
        for path in gone:
            del self.passes[path]

    def most_expensive(self, most: int) -> list[str]:
        """Return the passes that cost most, most_expensive first."""
        sums = {path: float(ring.values.sum()) for path, ring in self.passes.items()}
        return sorted(sums, key=lambda path: -sums[path])[:most]

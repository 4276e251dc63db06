"""What each of the last pictures cost: milliseconds, texels, triangles. Recorded only while it is shown."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping

LENGTH = 240
"""Pictures that are recorded."""
Numbers = deque[float]
"""The last numbers of a series, oldest first."""


class Record:
    """The costs of the pictures since they were first shown."""

    def __init__(self, length: int = LENGTH) -> None:
        self._length = length
        self.clear()

    def clear(self) -> None:
        """Forget all of it."""
        self.pictures = 0
        self.passes: dict[str, Numbers] = {}  # [ms] by path
        self.whole = self._numbers()  # [ms] of all passes
        self.texels = self._numbers()
        self.triangles = self._numbers()

    def add(self, times: Mapping[str, float], texels: int, triangles: int) -> None:
        """Take in a picture; a pass that did not run for it cost nothing."""
        for path in times:
            self.passes.setdefault(path, self._numbers(self.pictures))
        for path, spent in self.passes.items():
            spent.append(times.get(path, 0.0))
        self.whole.append(sum(times.values()))
        self.texels.append(texels)
        self.triangles.append(triangles)
        self.pictures += 1
        self.passes = {path: spent for path, spent in self.passes.items() if path in times or any(spent)}

    def most_expensive(self, most: int) -> list[str]:
        """Return the passes that cost most, the most expensive first."""
        return sorted(self.passes, key=lambda path: -sum(self.passes[path]))[:most]

    def _numbers(self, zeros: int = 0) -> Numbers:
        return deque([0.0] * min(zeros, self._length), self._length)

"""Estimate what a pass will take at another size, from what it took at sizes that were measured."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

_MAX_SIZES = 4  # sizes that are remembered of a pass: those of the latest measurements


class PassCosts:
    """What the passes of one sketch took [ms], by path and by their texels.

    The first measurement of a pass includes its compiler, so that the second takes its place. Of a size
    that was measured before, one below replaces it, and one above, when the machine may have been busy,
    is averaged with it.
    """

    def __init__(self) -> None:
        self._known: dict[str, dict[int, float]] = {}
        self._first: set[str] = set()  # paths that ran once so far

    def take(self, sizes: Mapping[str, int], times: Mapping[str, float]) -> None:
        """Take what passes took [ms] that ran with so many texels, both by path."""
        for path, spent in times.items():
            texels = sizes[path]
            if path not in self._known:
                self._known[path] = {texels: spent}
                self._first.add(path)
                continue
            costs = self._known[path]
            if path in self._first:
                self._first.remove(path)
                costs.clear()
            before = costs.pop(texels, spent)
            costs[texels] = min(spent, 0.5 * (before + spent))
            while len(costs) > _MAX_SIZES:
                del costs[next(iter(costs))]

    def expected(self, path: str, texels: int) -> float | None:
        """Return what a pass is expected to take with so many texels [ms]; None where it never ran.

        Between measured sizes, and beyond two of them, it is linear in texels; beyond one it is in
        proportion.
        """
        costs = self._known.get(path)
        if not costs:
            return None
        sizes = sorted(costs)
        if len(sizes) == 1 or texels <= sizes[0]:
            return costs[sizes[0]] * texels / sizes[0]
        low, high = next(((a, b) for a, b in pairwise(sizes) if texels <= b), (sizes[-2], sizes[-1]))
        # No smaller size takes longer, unless the machine was busy.
        least = min(costs[low], costs[high])
        return least + (costs[high] - least) * (texels - low) / (high - low)

    def clear(self) -> None:
        """Forget all: another sketch is opened, whose passes may have the same paths."""
        self._known.clear()
        self._first.clear()

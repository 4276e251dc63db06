"""Bring terrain that is too large for memory to another size, in one go through its rows.

The kernel is that of `resample`, and so are the results, but for the rounding of sums. Where texels
have no data, no kernel with negative weights will do: there the known ones around are averaged, each
counting less the further it is from the node, and a node with none around has no data.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.terrain.grid import Heights
from playground.terrain.resample import steps_away, taps
from playground.terrain.rows import Rows

_GROUP = 16  # results at a time: a dense product of these and the sources that they need

ToHeights = Callable[[int, NDArray[Any]], NDArray[np.floating[Any]]]
"""The number of a first row, and rows as the file has them → heights, NaN for no data."""


@dataclass(frozen=True, eq=False)
class Decimated:
    """A terrain at another size, and what all of it is like."""

    heights: Heights  # (ny, nx), rows in the file's order, NaN for no data
    lowest: float  # of all texels that were read; NaN where none has data
    highest: float


class _Gaps(Exception):
    """There are texels without data, for which nothing is prepared."""


def decimate(
    rows: Rows, size: tuple[int, int], to_heights: ToHeights, whole: tuple[int, int] | None = None
) -> Decimated:
    """Return the heights at a size (nx, ny), corners on corners.

    ``whole`` is the size (nx, ny) of the terrain that the rows are an overview of: then they are means
    of areas, and the terrain's outermost nodes lie outside of the outermost means.
    """
    here = rows.shape[::-1]
    leads = [0.5 * n / of - 0.5 for n, of in zip(here, whole or here, strict=True)]
    axes = [_smooth(*each) for each in zip(here, size, leads, strict=True)]
    try:
        return _through(rows, to_heights, axes[1], axes[0])
    except _Gaps:
        near, around = (
            [kind(*each) for each in zip(here, size, leads, strict=True)] for kind in (_hats, _boxes)
        )
        return _through(rows, to_heights, axes[1], axes[0], (near[1], near[0], around[1], around[0]))


@dataclass(frozen=True, eq=False)
class _Axis:
    """What each result along an axis is the sum of; sources rise from result to result."""

    sources: NDArray[np.intp]  # (count, taps)
    weights: NDArray[np.float64]  # (count, taps)

    def groups(self, start: int, end: int) -> list[tuple[slice, slice, NDArray[np.float64]]]:
        """Return which results take which of the sources from start to end, and their weights."""
        found = []
        for first in range(0, len(self.sources), _GROUP):
            results = slice(first, first + _GROUP)
            sources, weights = self.sources[results], self.weights[results]
            low, high = max(int(sources.min()), start), min(int(sources.max()) + 1, end)
            if low < high:
                dense = np.zeros((len(sources), high - low))
                inside = (sources >= low) & (sources < high)
                row = np.broadcast_to(np.arange(len(sources))[:, None], sources.shape)
                np.add.at(dense, (row[inside], sources[inside] - low), weights[inside])
                found.append((results, slice(low - start, high - start), dense))
        return found


def _smooth(n: int, count: int, lead: float) -> _Axis:
    weights, sources, first, last = taps(n, count, lead)
    # What the edges count besides is one more tap each; where it is nothing, it stays with the others.
    place = sources[:, :1]
    sources = np.hstack(
        [
            sources,
            *(
                np.where(extra != 0.0, edge, place[:, 0])[:, None]
                for extra, edge in ((first, 0), (last, n - 1))
            ),
        ]
    )
    return _Axis(sources, np.hstack([weights, first[:, None], last[:, None]]))


def _hats(n: int, count: int, lead: float) -> _Axis:
    ratio, away, index = steps_away(n, count, lead)
    weights = np.maximum(1.0 - np.abs(away) / max(ratio, 1.0), 0.0)
    return _inside(n, index, weights)


def _boxes(n: int, count: int, lead: float) -> _Axis:
    """Return what tells whether anything is where the smooth kernel reads."""
    _, away, index = steps_away(n, count, lead)
    return _inside(n, index, np.ones_like(away))


def _inside(n: int, index: NDArray[np.intp], weights: NDArray[np.float64]) -> _Axis:
    beyond = (index < 0) | (index >= n)
    return _Axis(np.clip(index, 0, n - 1), np.where(beyond, 0.0, weights))


class _Sum:
    """The sums over all rows that were added."""

    def __init__(self, down: _Axis, across: _Axis, columns: int) -> None:
        self.down = down
        self.across = across.groups(0, columns)
        self.total = np.zeros((len(down.sources), len(across.sources)))

    def add(self, start: int, values: NDArray[np.float64]) -> None:
        """Add rows, of which ``start`` is the first one's number."""
        narrow = np.empty((len(values), self.total.shape[1]))
        for results, sources, dense in self.across:
            np.matmul(values[:, sources], dense.T, out=narrow[:, results])
        for results, sources, dense in self.down.groups(start, start + len(values)):
            self.total[results] += dense @ narrow[sources]


class _Sums:
    """The sums over all rows of a file, and what all of it is like."""

    def __init__(
        self, columns: int, down: _Axis, across: _Axis, for_gaps: tuple[_Axis, _Axis, _Axis, _Axis] | None
    ) -> None:
        self.lowest, self.highest = np.inf, -np.inf
        self.reference = 0.0  # sums are of what is above it, in float64: a constant stays exact
        self.smooth = _Sum(down, across, columns)
        self.of_gaps: tuple[_Sum, _Sum, _Sum] | None = None  # what is near, what of it lacks, what they touch
        if for_gaps:
            near, lacking = (_Sum(for_gaps[0], for_gaps[1], columns) for _ in range(2))
            self.of_gaps = near, lacking, _Sum(for_gaps[2], for_gaps[3], columns)

    def read(self, rows: Rows, to_heights: ToHeights) -> None:
        """Add all rows; raise ``_Gaps`` for the first gap where nothing is prepared."""
        for start, band in rows.bands():
            heights = to_heights(start, band)
            gaps = np.isnan(heights)
            has_gaps = bool(gaps.any())
            if has_gaps and not self.of_gaps:
                raise _Gaps
            if not gaps.all():
                low, high = float(np.nanmin(heights)), float(np.nanmax(heights))
                self.reference = self.reference if np.isfinite(self.lowest) else low
                self.lowest, self.highest = min(self.lowest, low), max(self.highest, high)
            part = heights.astype(np.float64)
            part -= self.reference
            if self.of_gaps:
                near, lacking, touched = self.of_gaps
                if has_gaps:
                    part[gaps] = 0.0
                    there = gaps.astype(np.float64)
                    lacking.add(start, there)
                    touched.add(start, there)
                near.add(start, part)
            self.smooth.add(start, part)


def _through(
    rows: Rows,
    to_heights: ToHeights,
    down: _Axis,
    across: _Axis,
    for_gaps: tuple[_Axis, _Axis, _Axis, _Axis] | None = None,
) -> Decimated:
    sums = _Sums(rows.shape[1], down, across, for_gaps)
    sums.read(rows, to_heights)
    result, lowest, highest = sums.smooth.total, sums.lowest, sums.highest
    if not np.isfinite(lowest):
        return Decimated(np.full(result.shape, np.nan, np.float32), np.nan, np.nan)
    if for_gaps and sums.of_gaps:
        near, lacking, touched = sums.of_gaps
        full = np.outer(*(axis.weights.sum(axis=1) for axis in for_gaps[:2]))
        weights = full - lacking.total
        # What rounding leaves of no weight at all is no weight.
        around = np.divide(near.total, weights, out=np.full_like(full, np.nan), where=weights > 1e-9 * full)
        result = np.where(touched.total > 0.5, around, result)
    # In place: of the largest terrain it is 128 MiB.
    result += sums.reference
    np.clip(result, lowest, highest, out=result)  # a cubic overshoots next to a cliff
    return Decimated(result.astype(np.float32), lowest, highest)

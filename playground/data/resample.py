"""Bring terrain to another size, corners on corners: an array, or a large file in one pass over its rows.

Source: Keys 1981, "Cubic Convolution Interpolation for Digital Image Processing", IEEE
Transactions on Acoustics, Speech and Signal Processing 29, 6: the kernel with a = -1/2.

``decimate`` has the kernel of ``resample``, and its results, but for the rounding of sums. Where texels
have no data, no kernel with negative weights will do: there the texels with data around are averaged, each
counting less the further it is from the node, and a node with none around has no data.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.data.grid import Heights, Rows, check_grid
from playground.errors import DataError


def resample(
    heights: NDArray[np.floating[Any]], size: tuple[int, int], within: tuple[float, float] | None = None
) -> Heights:
    """Return the heights (ny, nx) on a grid of another size (nx, ny), corners on corners.

    One cubic kernel (Keys 1981, a = -1/2: "Catmull-Rom"), as wide as the coarser of
    the two grids, so that shrinking averages and does not alias. Beyond its edges the
    terrain goes on as its point reflection in the edge: the corners keep their
    heights, two tiles that share an edge still share it, a plane stays a plane, a
    constant stays exact. Next to a cliff a cubic overshoots by some 8 % of the cliff;
    `within` cuts that off at the lowest and highest height there may be. It is the caller's
    to say, for tiles of one terrain must all be cut alike to go on sharing their edges.

    Raises:
        DataError: not a grid of finite numbers, or a size below 2 x 2 or above 2**28.
    """
    array = np.asarray(heights)
    name = Path("heights to resample")
    check_grid(array.shape, array.dtype, name)
    nx, ny = (int(n) for n in size)
    check_grid((ny, nx), np.dtype(np.float32), Path("resampled heights"))
    bad = int(np.count_nonzero(~np.isfinite(array)))
    if bad:
        raise DataError(f"{bad} are not finite; expected gaps to be filled first", file=name)
    with np.errstate(all="ignore"):
        values = array.astype(np.float32, copy=False)
        middle = np.float64(values.min()) / 2 + np.float64(values.max()) / 2
        part = values - middle  # float64, and zero for a constant
        # The axis that shrinks most goes first: less to do for the other.
        if ny / array.shape[0] <= nx / array.shape[1]:
            part = _resized(_resized(part, ny).T, nx).T
        else:
            part = _resized(_resized(part.T, nx).T, ny)
        result = np.ascontiguousarray(part + middle, dtype=np.float32)
        return result if within is None else np.clip(result, np.float32(within[0]), np.float32(within[1]))


def _resized(values: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Return values resized along axis 0, to ``count`` rows."""
    values = np.ascontiguousarray(values)
    if count == len(values):
        return values
    result = np.empty((count, values.shape[1]))
    for results, sources, dense in _smooth(len(values), count, 0.0).groups(0, len(values)):
        np.matmul(dense, values[sources], out=result[results])
    return result


def _steps_away(n: int, count: int, lead: float = 0.0) -> tuple[float, NDArray[np.float64], NDArray[np.intp]]:
    """Return the values from one result to the next, and how far which values are from each result.

    Both arrays are (count, taps): the steps, and the values' numbers, which go on beyond the edges.
    """
    ratio = (n - 1 - 2.0 * lead) / (count - 1)
    places = np.linspace(lead, n - 1 - lead, count)
    scale = max(ratio, 1.0)
    start = np.floor(places - 2.0 * scale).astype(np.intp) + 1
    index = start[:, None] + np.arange(math.ceil(4.0 * scale) + 1)
    return ratio, index - places[:, None], index


def _catmull_rom(x: NDArray[np.float64]) -> NDArray[np.float64]:
    x = np.abs(x)
    near = 1.0 + x * x * (1.5 * x - 2.5)
    far = 2.0 + x * (x * (2.5 - 0.5 * x) - 4.0)
    return np.where(x < 1.0, near, np.where(x < 2.0, far, 0.0))


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
        groups = []
        for first in range(0, len(self.sources), _GROUP):
            results = slice(first, first + _GROUP)
            sources, weights = self.sources[results], self.weights[results]
            low, high = max(int(sources.min()), start), min(int(sources.max()) + 1, end)
            if low < high:
                dense = np.zeros((len(sources), high - low))
                inside = (sources >= low) & (sources < high)
                row = np.broadcast_to(np.arange(len(sources))[:, None], sources.shape)
                np.add.at(dense, (row[inside], sources[inside] - low), weights[inside])
                groups.append((results, slice(low - start, high - start), dense))
        return groups


def _smooth(n: int, count: int, lead: float) -> _Axis:
    """Return the cubic kernel of ``count`` results of n values.

    The first result is ``lead`` values after the first value, the last as far before the last.
    """
    ratio, away, index = _steps_away(n, count, lead)
    scale = max(ratio, 1.0)
    weights = _catmull_rom(away / scale)
    weights /= weights.sum(axis=1, keepdims=True)
    if scale > 1.0:
        # Sampled between its knots the wide kernel has its mean not quite on the place; tilting
        # the weights (by a term that adds up to zero) puts it there, so that a plane stays one.
        broad = np.maximum(2.0 - np.abs(away) / scale, 0.0)
        tilt = broad * (away - (broad * away).sum(axis=1, keepdims=True) / broad.sum(axis=1, keepdims=True))
        mean = (weights * away).sum(axis=1, keepdims=True)
        weights -= tilt * (mean / (tilt * away).sum(axis=1, keepdims=True))
    # Reflected in the points of its edges, the terrain repeats with period p, raised each time by twice
    # its rise: v[q p + r] = 2 q (v[n-1] - v[0]) + (v[r] if r < n else 2 v[n-1] - v[p - r]).
    period = 2 * (n - 1)
    periods, offset = np.divmod(index, period)
    inside = offset < n
    first = -2.0 * (weights * periods).sum(axis=1)
    last = 2.0 * (weights * (periods + ~inside)).sum(axis=1)
    weights, sources = np.where(inside, weights, -weights), np.where(inside, offset, period - offset)
    # What the edges count besides is one more tap each; where it is nothing, it stays with the others.
    edges = [np.where(extra != 0.0, edge, sources[:, 0]) for extra, edge in ((first, 0), (last, n - 1))]
    return _Axis(np.column_stack([sources, *edges]), np.column_stack([weights, first, last]))


def _hats(n: int, count: int, lead: float) -> _Axis:
    ratio, away, index = _steps_away(n, count, lead)
    weights = np.maximum(1.0 - np.abs(away) / max(ratio, 1.0), 0.0)
    return _inside(n, index, weights)


def _boxes(n: int, count: int, lead: float) -> _Axis:
    """Return what tells whether anything is where the smooth kernel reads."""
    _, away, index = _steps_away(n, count, lead)
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

"""Bring terrain to another size, corners on corners.

Source: Keys 1981, "Cubic Convolution Interpolation for Digital Image Processing", IEEE
Transactions on Acoustics, Speech and Signal Processing 29, 6: the kernel with a = -1/2.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.terrain.grid import Heights, check_grid


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
    given = np.asarray(heights)
    name = Path("heights to resample")
    check_grid(given.shape, given.dtype, name)
    nx, ny = (int(n) for n in size)
    check_grid((ny, nx), np.dtype(np.float32), Path("resampled heights"))
    bad = int(np.count_nonzero(~np.isfinite(given)))
    if bad:
        raise DataError(f"{bad} are not finite; expected gaps to be filled first", file=name)
    with np.errstate(all="ignore"):
        values = given.astype(np.float32, copy=False)
        middle = np.float64(values.min()) / 2 + np.float64(values.max()) / 2
        part = values - middle  # float64, and zero for a constant
        # The axis that shrinks most goes first: less to do for the other.
        if ny / given.shape[0] <= nx / given.shape[1]:
            part = _resized(_resized(part, ny).T, nx).T
        else:
            part = _resized(_resized(part.T, nx).T, ny)
        result = np.ascontiguousarray(part + middle, dtype=np.float32)
        return result if within is None else np.clip(result, np.float32(within[0]), np.float32(within[1]))


def _resized(values: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    # Along axis 0, to `count` rows.
    values = np.ascontiguousarray(values)
    if count == len(values):
        return values
    weights, sources, first, last = taps(len(values), count)
    result = first[:, None] * values[0] + last[:, None] * values[-1]
    for start in range(0, count, 64):
        # A band of results needs a band of sources: small dense products, which are fast.
        band = slice(start, start + 64)
        low = int(sources[band].min())
        dense = np.zeros((len(result[band]), int(sources[band].max()) + 1 - low))
        np.add.at(dense, (np.arange(len(dense))[:, None], sources[band] - low), weights[band])
        result[band] += dense @ values[low : low + dense.shape[1]]
    return np.asarray(result)


def taps(
    n: int, count: int, lead: float = 0.0
) -> tuple[NDArray[np.float64], NDArray[np.intp], NDArray[np.float64], NDArray[np.float64]]:
    """Return what each of ``count`` results is the sum of: n values, times weights.

    Weights and their sources are (count, taps); what the first and the last value count besides is
    (count,) each. The first result is ``lead`` values after the first value, the last as far before the last.
    """
    ratio, away, index = steps_away(n, count, lead)
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
    periods, place = np.divmod(index, period)
    inside = place < n
    first = -2.0 * (weights * periods).sum(axis=1)
    last = 2.0 * (weights * (periods + ~inside)).sum(axis=1)
    return np.where(inside, weights, -weights), np.where(inside, place, period - place), first, last


def steps_away(n: int, count: int, lead: float = 0.0) -> tuple[float, NDArray[np.float64], NDArray[np.intp]]:
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

"""A round brush: where it reaches, what it leaves on a mask of four weights, what its tools do to terrain.

The tools change what is added to terrain, in metres. Each stamp of the brush lasts some seconds, and what
it does is a rate, so a stroke does not depend on how many frames it was painted in. ``w`` is strength times
falloff, 0..1; h the terrain, ground and change:

    raise, lower   dh/dt = w rate, -w rate
    smooth         dh/dt = div(w D grad h), explicit, five points; fluxes are antisymmetric, so no rock
                   is gained or lost, and with steps of D dt (1/dx2 + 1/dy2) <= 1/2 no new extreme
    flatten        dh/dt = 10/s w (level - h)
    sharpen        dh/dt = 1/s w (h - mean), the mean by Gauss over a quarter of the radius
    erase          dc/dt = -10/s w c, of the change c alone

Flatten, sharpen and erase are integrated exactly over a stamp: their fractions are 1 - exp(-rate dt).
Erode runs a technique instead: see ``erode_tool``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

Part = tuple[slice, slice]
"""Rows and columns of an image."""

ERASER = -1
"""The channel that takes paint away: the rules below show again."""


Tool = Literal["raise", "lower", "smooth", "flatten", "sharpen", "erase", "erode"]
TOOLS: tuple[Tool, ...] = get_args(Tool)


@dataclass(frozen=True, slots=True)
class Brush:
    """What one stroke leaves."""

    channel: int = 3  # of a mask: 0 to 3, or ERASER
    radius: float = 60.0  # [m]
    strength: float = 0.6  # 0..1; on a mask what each step of a stroke covers, else a fraction of a rate
    softness: float = 0.7  # fraction of the radius over which it fades, 0..1
    tool: Tool = "raise"  # of what has one number a texel
    level: float | None = None  # that flatten goes to; None: where the stroke begins


@dataclass(frozen=True, slots=True)
class Dab:
    """A part of a stroke: from one place to another, in some seconds.

    Places are in fractions of the terrain's sides from the south-west.
    """

    start: tuple[float, float]
    end: tuple[float, float]
    extent: tuple[float, float]  # [m] of the terrain
    brush: Brush
    seconds: float = 0.0

    def reached(self, size: tuple[int, int], margin: float = 0.0) -> Part:
        """Return the rows and columns that it can touch of an image of (nx, ny) texels, and [m] around.

        There are none where it is off the terrain.
        """
        ends, radius = self._ends(), self.brush.radius + margin
        metres = spacing_of(size, self.extent)
        low = np.floor((ends.min(axis=0) - radius) / metres).astype(int)
        high = np.ceil((ends.max(axis=0) + radius) / metres).astype(int) + 1
        columns, rows = (
            slice(min(max(first, 0), count), max(min(last, count), 0))
            for first, last, count in zip(low.tolist(), high.tolist(), size, strict=True)
        )
        return rows, columns

    def covered(self, size: tuple[int, int]) -> tuple[Part, NDArray[np.float32]]:
        """Return which part of an image of (nx, ny) texels it touches, and the fraction of each texel."""
        rows, columns = self.reached(size)
        metres, (start, end) = spacing_of(size, self.extent), self._ends()
        x = np.arange(columns.start, columns.stop) * metres[0]
        y = np.arange(rows.start, rows.stop)[:, None] * metres[1]
        way = end - start
        length = float(way @ way)
        along = ((x - start[0]) * way[0] + (y - start[1]) * way[1]) / length if length > 0 else 0.0 * (x + y)
        along = np.clip(along, 0.0, 1.0)
        distance = np.hypot(x - start[0] - along * way[0], y - start[1] - along * way[1])
        fraction = falloff(distance, self.brush.radius, self.brush.softness)
        return (rows, columns), fraction.astype(np.float32)

    def _ends(self) -> NDArray[np.float64]:
        return np.array([self.start, self.end], np.float64) * self.extent


def spacing_of(size: tuple[int, int], extent: tuple[float, float]) -> NDArray[np.float64]:
    """Return the distance of two texels east and north [m]: the first and the last are on the edges."""
    return np.asarray(np.array(extent, np.float64) / np.maximum(np.array(size) - 1, 1))


def falloff(away: NDArray[np.float64], radius: float, softness: float) -> NDArray[np.float64]:
    """Return the fraction, 0..1, of a brush at distances [m] from its middle: a cubic over its softness."""
    fraction = np.clip((radius - away) / max(radius * softness, 1e-6), 0.0, 1.0)
    return np.asarray(fraction * fraction * (3 - 2 * fraction))


def cover(mask: NDArray[np.float32], dab: Dab) -> None:
    """Paint on a mask (ny, nx, 4), 0..1, in place.

    The brush's channel takes what it covers from the others: sums stay at most 1 where they were.
    """
    part, fraction = dab.covered((mask.shape[1], mask.shape[0]))
    weights, channel = mask[part], dab.brush.channel
    amount = (fraction * np.float32(dab.brush.strength))[..., None]
    weights *= 1 - amount
    if channel != ERASER:
        weights[..., channel] += amount[..., 0]


RISE = 0.5  # [1/s] radii that raise goes at full strength, where metres are painted
FACTOR = 1.0  # [1/s] how fast it goes where other numbers are
APPROACH = 10.0  # [1/s] flatten and erase, at full strength
SHARPEN = 1.0  # [1/s] likewise
_FINEST = 32  # texels that smooth looks at of a larger brush's radius: its steps grow with their square
_APART = 0.25  # stamps of a stroke, in radii


def rate_of(brush: Brush, *, metres: bool) -> float:
    """Return how fast raise goes at full strength: metres a second, or numbers."""
    return RISE * brush.radius if metres else FACTOR


def sculpt(
    change: NDArray[np.float32],
    ground: NDArray[np.float32] | None,
    dab: Dab,
    *,
    rate: float,
    level: float,
) -> None:
    """Change the terrain by a part of a stroke, in place.

    ``change`` (ny, nx) is what is painted, ``ground`` what it is added to, in the same unit; None: 0.
    ``rate`` is how fast raise goes at full strength [unit/s], ``level`` what flatten goes to.
    """
    size, radius = (change.shape[1], change.shape[0]), dab.brush.radius
    start, end = (np.array(position, np.float64) for position in (dab.start, dab.end))
    stamps = max(1, math.ceil(float(np.hypot(*((end - start) * dab.extent))) / (_APART * radius)))
    for n in range(stamps):
        x, y = start + (end - start) * (n + 0.5) / stamps
        position = float(x), float(y)
        stamp = Dab(position, position, dab.extent, dab.brush, dab.seconds / stamps)
        part, fraction = stamp.covered(size)
        if fraction.size:
            weight = dab.brush.strength * fraction.astype(np.float64)
            added = BRUSHES[dab.brush.tool](_Stamp(stamp, change, ground, part, weight, rate, level))
            change[part] += added.astype(np.float32)


@dataclass(frozen=True)
class _Stamp:
    """One stamp of a brush, at a place of the terrain."""

    dab: Dab
    change: NDArray[np.float32]
    ground: NDArray[np.float32] | None
    part: Part  # that it touches
    weight: NDArray[np.float64]  # of each texel of the part: strength times falloff, 0..1
    rate: float
    level: float

    @property
    def spacing(self) -> tuple[float, float]:
        """The distance of two texels east and north [m]."""
        dx, dy = spacing_of((self.change.shape[1], self.change.shape[0]), self.dab.extent)
        return float(dx), float(dy)

    def terrain(self, part: Part) -> NDArray[np.float64]:
        """Return the heights of a part."""
        heights = self.change[part].astype(np.float64)
        return heights if self.ground is None else heights + self.ground[part]

    def approached(self, rate: float) -> NDArray[np.float64]:
        """Return minus the fraction that is left behind on the way to a goal, at a rate [1/s]."""
        return np.asarray(np.expm1(rate * self.weight * self.dab.seconds))


def _smooth(stamp: _Stamp) -> NDArray[np.float64]:
    radius = min(stamp.dab.brush.radius, _FINEST * min(stamp.spacing))
    terrain = stamp.terrain(stamp.part)
    return _spread(terrain, stamp.weight, radius**2 / 16 * stamp.dab.seconds, stamp.spacing) - terrain


def _sharpen(stamp: _Stamp) -> NDArray[np.float64]:
    sigma = max(stamp.dab.brush.radius / 4, *stamp.spacing)
    around = stamp.dab.reached((stamp.change.shape[1], stamp.change.shape[0]), margin=3 * sigma)
    mean = _mean(stamp.terrain(around), around, stamp.part, sigma, stamp.spacing)
    return stamp.approached(SHARPEN) * (stamp.terrain(stamp.part) - mean)


BRUSHES: dict[Tool, Callable[[_Stamp], NDArray[np.float64]]] = {
    "raise": lambda stamp: stamp.weight * stamp.rate * stamp.dab.seconds,
    "lower": lambda stamp: -stamp.weight * stamp.rate * stamp.dab.seconds,
    "smooth": _smooth,
    "flatten": lambda stamp: stamp.approached(-APPROACH) * (stamp.terrain(stamp.part) - stamp.level),
    "sharpen": _sharpen,
    "erase": lambda stamp: stamp.approached(-APPROACH) * stamp.change[stamp.part],
}
"""What each tool adds to the part that a stamp touches; of all but erode, which a technique makes."""


def _spread(
    terrain: NDArray[np.float64], weight: NDArray[np.float64], most: float, spacing: tuple[float, float]
) -> NDArray[np.float64]:
    """Return the terrain after diffusion with conductivity times time ``weight * most`` [m2].

    Between two texels the lesser weight counts, so nothing passes to where the brush does not reach.
    """
    dx, dy = spacing
    steps = max(1, math.ceil(2 * most * float(weight.max(initial=0.0)) * (1 / dx**2 + 1 / dy**2)))
    east = np.minimum(weight[:, 1:], weight[:, :-1]) * (most / steps / dx**2)
    north = np.minimum(weight[1:], weight[:-1]) * (most / steps / dy**2)
    heights = terrain.copy()
    for _ in range(steps):
        along, across = east * np.diff(heights, axis=1), north * np.diff(heights, axis=0)
        heights[:, :-1] += along
        heights[:, 1:] -= along
        heights[:-1] += across
        heights[1:] -= across
    return heights


def _mean(
    terrain: NDArray[np.float64], around: Part, part: Part, sigma: float, spacing: tuple[float, float]
) -> NDArray[np.float64]:
    """Return the means of Gauss over ``around`` at the texels of ``part``; at the edges of what there is.

    A wide one looks at every n-th texel only, eight a deviation at least. ``einsum`` does without BLAS,
    whose threads spin on after small products and take longer than the products themselves.
    """
    every_y, every_x = (max(1, int(sigma / (8 * step))) for step in (spacing[1], spacing[0]))
    south_north = _weights(around[0], part[0], spacing[1] / sigma, every_y)
    west_east = _weights(around[1], part[1], spacing[0] / sigma, every_x)
    rows = np.einsum("ij,jk->ik", south_north, terrain[::every_y, ::every_x])
    return np.asarray(np.einsum("ik,lk->il", rows, west_east))


def _weights(there: slice, here: slice, step: float, every: int) -> NDArray[np.float64]:
    """Return the weights (here, there) of a Gaussian mean; ``step`` is a texel in standard deviations."""
    places = np.arange(there.start, there.stop, every)
    away = step * (np.arange(here.start, here.stop)[:, None] - places)
    weights = np.exp(-0.5 * np.minimum(away * away, 1000.0))
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))

"""What the tools of the sculptor do to a change that is added to terrain, in metres.

Each stamp of the brush lasts some seconds, and what it does is a rate, so a stroke does not depend on
how many frames it was painted in. ``w`` is strength times falloff, 0..1; h the terrain, ground and change:

    raise, lower   dh/dt = w rate, -w rate
    smooth         dh/dt = div(w D grad h), explicit, five points; fluxes are antisymmetric, so no rock
                   is gained or lost, and with steps of D dt (1/dx2 + 1/dy2) <= 1/2 no new extreme
    flatten        dh/dt = 10/s w (level - h)
    sharpen        dh/dt = 1/s w (h - mean), the mean by Gauss over a quarter of the radius
    erase          dc/dt = -10/s w c, of the change c alone

Flatten, sharpen and erase are integrated exactly over a stamp: their shares are 1 - exp(-rate dt).
Erode runs a technique instead: see ``erode_tool``.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from playground.workbench.brush import Brush, Part, covered, reached, spacing_of

APPROACH = 10.0  # [1/s] flatten and erase, at full strength
SHARPEN = 1.0  # [1/s] likewise
_FINEST = 32  # texels that smooth looks at of a larger brush's radius: its steps grow with their square
_APART = 0.25  # stamps of a stroke, in radii


def sculpt(
    change: NDArray[np.float32],
    ground: NDArray[np.float32] | None,
    ends: tuple[tuple[float, float], tuple[float, float]],
    extent: tuple[float, float],
    brush: Brush,
    *,
    seconds: float,
    rate: float,
    level: float,
) -> None:
    """Change the terrain from one place to another in some seconds, in place.

    ``change`` (ny, nx) is what is painted, ``ground`` what it is added to, in the same unit; None: 0.
    ``ends`` are shares of the terrain's sides, ``extent`` is in metres. ``rate`` is how fast raise goes
    at full strength [unit/s], ``level`` what flatten goes to.
    """
    start, end = (np.array(position, np.float64) for position in ends)
    stamps = max(1, math.ceil(float(np.hypot(*((end - start) * extent))) / (_APART * brush.radius)))
    for n in range(stamps):
        x, y = start + (end - start) * (n + 0.5) / stamps
        _stamp(change, ground, (float(x), float(y)), extent, brush, seconds / stamps, rate, level)


def _stamp(
    change: NDArray[np.float32],
    ground: NDArray[np.float32] | None,
    position: tuple[float, float],
    extent: tuple[float, float],
    brush: Brush,
    seconds: float,
    rate: float,
    level: float,
) -> None:
    shape = change.shape[0], change.shape[1]
    rows, columns, share = covered(shape, position, position, extent, brush)
    part = rows, columns
    if not share.size:
        return
    weight = brush.strength * share.astype(np.float64)
    dx, dy = spacing_of((shape[1], shape[0]), extent)
    match brush.tool:
        case "raise":
            added = weight * rate * seconds
        case "lower":
            added = -weight * rate * seconds
        case "erase":
            added = np.expm1(-APPROACH * weight * seconds) * change[part]
        case "flatten":
            added = np.expm1(-APPROACH * weight * seconds) * (_terrain(change, ground, part) - level)
        case "smooth":
            radius = min(brush.radius, _FINEST * min(dx, dy))
            terrain = _terrain(change, ground, part)
            added = _spread(terrain, weight, radius**2 / 16 * seconds, (dx, dy)) - terrain
        case "sharpen":
            sigma = max(brush.radius / 4, dx, dy)
            around = reached((shape[1], shape[0]), position, position, extent, brush.radius + 3 * sigma)
            away = _terrain(change, ground, part) - _mean(
                _terrain(change, ground, around), around, part, sigma, (dx, dy)
            )
            added = np.expm1(SHARPEN * weight * seconds) * away
    change[part] += added.astype(np.float32)


def _terrain(
    change: NDArray[np.float32], ground: NDArray[np.float32] | None, part: Part
) -> NDArray[np.float64]:
    heights = change[part].astype(np.float64)
    return heights if ground is None else heights + ground[part]


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

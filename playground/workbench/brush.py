"""A round brush on a mask of four weights."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

ERASER = -1
"""The layer that takes paint away: the rules below show again."""


@dataclass(frozen=True, slots=True)
class Brush:
    """What one stroke leaves."""

    layer: int = 3  # 0 to 3, or ERASER
    radius: float = 60.0  # [m]
    strength: float = 0.6  # of one pass over a place, 0..1
    softness: float = 0.7  # share of the radius over which it fades, 0..1


def covered(
    shape: tuple[int, int],
    start: tuple[float, float],
    end: tuple[float, float],
    extent: tuple[float, float],
    brush: Brush,
) -> tuple[slice, slice, NDArray[np.float32]]:
    """Return which rows and columns a stroke touches, and how much of each texel it covers, 0..1.

    ``shape``: (ny, nx) of the mask; ``start`` and ``end`` in shares of the terrain's sides from
    the south-west; ``extent`` of the terrain [m]. Texels are nodes, as everywhere: the first and
    the last are on the terrain's edges.
    """
    ny, nx = shape
    metres = np.array([extent[0] / max(nx - 1, 1), extent[1] / max(ny - 1, 1)])
    ends = np.array([start, end], np.float64) * extent
    low = np.floor((ends.min(axis=0) - brush.radius) / metres).astype(int)
    high = np.ceil((ends.max(axis=0) + brush.radius) / metres).astype(int) + 1
    columns = slice(max(low[0], 0), max(min(high[0], nx), 0))
    rows = slice(max(low[1], 0), max(min(high[1], ny), 0))
    x = np.arange(columns.start, columns.stop) * metres[0]
    y = np.arange(rows.start, rows.stop)[:, None] * metres[1]
    way = ends[1] - ends[0]
    length = float(way @ way)
    along = ((x - ends[0][0]) * way[0] + (y - ends[0][1]) * way[1]) / length if length > 0 else 0.0 * (x + y)
    along = np.clip(along, 0.0, 1.0)
    away = np.hypot(x - ends[0][0] - along * way[0], y - ends[0][1] - along * way[1])
    fade = max(brush.radius * brush.softness, 1e-6)
    share = np.clip((brush.radius - away) / fade, 0.0, 1.0)
    return rows, columns, (share * share * (3 - 2 * share)).astype(np.float32)


def stroke(
    mask: NDArray[np.float32],
    start: tuple[float, float],
    end: tuple[float, float],
    extent: tuple[float, float],
    brush: Brush,
) -> tuple[slice, slice]:
    """Paint from one place to another on a mask (ny, nx, 4), 0..1, in place; return its rows and columns.

    The layer takes what it covers from the others: sums stay at most 1 where they were.
    """
    rows, columns, share = covered((mask.shape[0], mask.shape[1]), start, end, extent, brush)
    part = mask[rows, columns]
    amount = (share * np.float32(brush.strength))[..., None]
    part *= 1 - amount
    if brush.layer != ERASER:
        part[..., brush.layer] += amount[..., 0]
    return rows, columns

"""A round brush: where it reaches, and what it leaves on a mask of four weights."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

Part = tuple[slice, slice]
"""Rows and columns of an image."""

ERASER = -1
"""The layer that takes paint away: the rules below show again."""


Tool = Literal["raise", "lower", "smooth", "flatten", "sharpen", "erase", "erode"]
TOOLS: tuple[Tool, ...] = get_args(Tool)


@dataclass(frozen=True, slots=True)
class Brush:
    """What one stroke leaves."""

    layer: int = 3  # of a mask: 0 to 3, or ERASER
    radius: float = 60.0  # [m]
    strength: float = 0.6  # 0..1; on a mask what each step of a stroke covers, else a fraction of a rate
    softness: float = 0.7  # share of the radius over which it fades, 0..1
    tool: Tool = "raise"  # of what has one number a texel
    level: float | None = None  # that flatten goes to; None: where the stroke begins


def reached(
    size: tuple[int, int],
    start: tuple[float, float],
    end: tuple[float, float],
    extent: tuple[float, float],
    radius: float,
) -> Part:
    """Return the rows and columns that a stroke can touch; no texel where it is off the terrain.

    ``size``: (nx, ny) of the image; ``start`` and ``end`` in fractions of the terrain's sides from
    the south-west; ``extent`` of the terrain and ``radius`` of the brush [m].
    """
    ends = np.array([start, end], np.float64) * extent
    metres = spacing_of(size, extent)
    low = np.floor((ends.min(axis=0) - radius) / metres).astype(int)
    high = np.ceil((ends.max(axis=0) + radius) / metres).astype(int) + 1
    columns, rows = (
        slice(min(max(first, 0), count), max(min(last, count), 0))
        for first, last, count in zip(low.tolist(), high.tolist(), size, strict=True)
    )
    return rows, columns


def spacing_of(size: tuple[int, int], extent: tuple[float, float]) -> NDArray[np.float64]:
    """Return the distance of two texels east and north [m]: the first and the last are on the edges."""
    return np.asarray(np.array(extent, np.float64) / np.maximum(np.array(size) - 1, 1))


def covered(
    shape: tuple[int, int],
    start: tuple[float, float],
    end: tuple[float, float],
    extent: tuple[float, float],
    brush: Brush,
) -> tuple[slice, slice, NDArray[np.float32]]:
    """Return which rows and columns a stroke touches, and how much of each texel it covers, 0..1.

    ``shape``: (ny, nx) of the image; the others as ``reached`` takes them.
    """
    size = shape[1], shape[0]
    rows, columns = reached(size, start, end, extent, brush.radius)
    metres, ends = spacing_of(size, extent), np.array([start, end], np.float64) * extent
    x = np.arange(columns.start, columns.stop) * metres[0]
    y = np.arange(rows.start, rows.stop)[:, None] * metres[1]
    way = ends[1] - ends[0]
    length = float(way @ way)
    along = ((x - ends[0][0]) * way[0] + (y - ends[0][1]) * way[1]) / length if length > 0 else 0.0 * (x + y)
    along = np.clip(along, 0.0, 1.0)
    away = np.hypot(x - ends[0][0] - along * way[0], y - ends[0][1] - along * way[1])
    return rows, columns, falloff(away, brush.radius, brush.softness).astype(np.float32)


def falloff(away: NDArray[np.float64], radius: float, softness: float) -> NDArray[np.float64]:
    """Return the share, 0..1, of a brush at distances [m] from its middle: a cubic over its softness."""
    share = np.clip((radius - away) / max(radius * softness, 1e-6), 0.0, 1.0)
    return np.asarray(share * share * (3 - 2 * share))


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

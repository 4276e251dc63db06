"""A round brush: where it reaches, and what it leaves on a mask of four weights."""

from __future__ import annotations

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
    softness: float = 0.7  # share of the radius over which it fades, 0..1
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
        share = falloff(distance, self.brush.radius, self.brush.softness)
        return (rows, columns), share.astype(np.float32)

    def _ends(self) -> NDArray[np.float64]:
        return np.array([self.start, self.end], np.float64) * self.extent


def spacing_of(size: tuple[int, int], extent: tuple[float, float]) -> NDArray[np.float64]:
    """Return the distance of two texels east and north [m]: the first and the last are on the edges."""
    return np.asarray(np.array(extent, np.float64) / np.maximum(np.array(size) - 1, 1))


def falloff(away: NDArray[np.float64], radius: float, softness: float) -> NDArray[np.float64]:
    """Return the share, 0..1, of a brush at distances [m] from its middle: a cubic over its softness."""
    share = np.clip((radius - away) / max(radius * softness, 1e-6), 0.0, 1.0)
    return np.asarray(share * share * (3 - 2 * share))


def cover(mask: NDArray[np.float32], dab: Dab) -> None:
    """Paint on a mask (ny, nx, 4), 0..1, in place.

    The brush's channel takes what it covers from the others: sums stay at most 1 where they were.
    """
    part, share = dab.covered((mask.shape[1], mask.shape[0]))
    weights, channel = mask[part], dab.brush.channel
    amount = (share * np.float32(dab.brush.strength))[..., None]
    weights *= 1 - amount
    if channel != ERASER:
        weights[..., channel] += amount[..., 0]

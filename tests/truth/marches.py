"""Slow marches over a heightfield in float64, and rays through ellipsoids: no early ends, leaps or lines."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from scipy.ndimage import map_coordinates

from .land import Array, towards

SIDE = 512
"""Texels a side of the square of ``shadows_of``."""


class Views:
    """Every place's way to the sun, step by step: how far off terrain is, and how high over the place [m].

    Places are texels, or ``finer`` times as many; a step goes from row to row or from column to column,
    whichever are met sooner, or by a share of that. Beyond the terrain's edge, by so many texels, its
    heights go on as at the edge.
    """

    def __init__(
        self,
        heights: Array,
        azimuth: float,
        spacing: tuple[float, float],
        step_length: float = 1.0,
        finer: int = 1,
        beyond: float = 1e-6,
    ) -> None:
        ny, nx = heights.shape
        places = np.mgrid[0 : (ny - 1) * finer + 1, 0 : (nx - 1) * finer + 1].astype(np.float64) / finer
        east, north, _ = towards(azimuth, 0.0)
        texels = np.array([north, east]) / np.array(spacing)[::-1]
        texels[np.abs(texels) < 1e-9] = 0
        self.run = step_length / np.abs(texels).max()  # [m] on the level in a step
        self.foot = map_coordinates(heights, places, order=1)
        self.steps: list[tuple[float, Array]] = []
        last = np.array([ny - 1, nx - 1])[:, None, None]
        for k in range(1, int(max(nx, ny) / step_length) + 2):
            at = places + (k * self.run * texels)[:, None, None]
            inside = ((at >= -beyond) & (at <= last + beyond)).all(axis=0)
            if not inside.any():
                break
            terrain = map_coordinates(heights, np.clip(at, 0, last), order=1)
            self.steps.append((k * self.run, np.where(inside, terrain - self.foot, -np.inf)))

    def tangents(self, steps: int | None = None) -> Array:
        """Return the tangent of the highest terrain on the way, 0 where none is higher."""
        rises = [np.maximum(over, 0) / far for far, over in self.steps[:steps]]
        return np.max([np.zeros(self.foot.shape), *rises], axis=0)

    def clearance(self, elevation: float) -> Array:
        """Return how far above the terrain each ray passes at its nearest step [m]."""
        rise = np.tan(np.radians(elevation))
        return np.min([np.full(self.foot.shape, np.inf), *(f * rise - o for f, o in self.steps)], axis=0)

    def free_of_beam(
        self, elevation: float, radius_at: Callable[[float], float], first: float = 1.0
    ) -> Array:
        """Return the least share of an upright stick, around the ray, over the terrain."""
        result = np.full(self.foot.shape, first)
        for far, over in self.steps:
            radius, middle = radius_at(far), far * np.tan(np.radians(elevation))
            free = np.clip(middle + radius - np.maximum(over, middle - radius), 0, 2 * radius)
            result = np.minimum(result, free / (2 * radius))
        return result


def shadows_of(
    eye: Array, wide: float, forms: Iterable[tuple[Array, Array]], azimuth: float, elevation: float
) -> Array:
    """Return which texels of a level square ``wide`` metres around the eye lie in shadow, row 0 south.

    ``forms``: of each ellipsoid its middle, east, north and over the ground there, and half its size [m].
    """
    to_sun = towards(azimuth, elevation)
    metres = ((np.arange(SIDE) + 0.5) / SIDE - 0.5) * wide
    x, y = np.meshgrid(eye[0] + metres, eye[1] + metres)
    hidden = np.zeros((SIDE, SIDE), bool)
    for middle, half in forms:
        start = (np.stack([x, y, np.zeros_like(x)]) - middle[:, None, None]) / half[:, None, None]
        along = to_sun / half
        nearest = np.maximum(-np.tensordot(along, start, 1) / (along @ along), 0.0)
        hidden |= ((start + nearest * along[:, None, None]) ** 2).sum(axis=0) < 1.0
    return hidden

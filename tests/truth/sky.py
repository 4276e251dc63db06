"""The sky's share of the light (thesis, eqs 3.4 and 3.12).

Over the azimuth the midpoint rule, over the elevation the exact integral above the
horizon, or Gauss's rule where the sky's radiance is a function of both. The sky is what
stands above the level: towards a valley the terrain's own slope may look below it, and sees
nothing there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from .horizon import NODE, Position, horizon
from .land import Array, Land

Radiance = Callable[[Array, Array], Array]


def azimuths(count: int) -> Array:
    """Return evenly spaced azimuths [degrees], on none of the eight chief directions."""
    return (np.arange(count) + 0.5) * 360 / count


def _slices(
    terrain: Land, count: int, part: Position, normals: Array
) -> Iterator[tuple[float, Array, Array, Array]]:
    """Yield each azimuth [degrees], N's components that way and up, the lowest elevation seen [radians]."""
    for azimuth in azimuths(count):
        a = np.radians(azimuth)
        across, up = normals[..., 0] * np.sin(a) + normals[..., 1] * np.cos(a), normals[..., 2]
        own = np.arctan2(-across, up)
        lowest = np.maximum(np.maximum(np.arctan(horizon(terrain, azimuth, part)), own), 0)
        yield float(azimuth), across, up, lowest


def sky_visibility(
    terrain: Land, *, count: int = 64, part: Position = NODE, normals: Array | None = None
) -> Array:
    """Return K (eq. 3.12): the light of an even sky of radiance 1, per texel; 1 on flat terrain."""
    normals = terrain.normals() if normals is None else normals
    total = np.zeros(terrain.heights.shape)
    for _, across, up, low in _slices(terrain, count, part, normals):
        total += across * (np.pi / 4 - low / 2 - np.sin(2 * low) / 4) + up * np.cos(low) ** 2 / 2
    return total * 2 / count


def sky_light(
    terrain: Land,
    radiance: Radiance,
    *,
    count: int = 64,
    heights: int = 24,
    part: Position = NODE,
    normals: Array | None = None,
) -> Array:
    """Return eq. 3.4 for a sky whose radiance is a function of azimuth and elevation [radians]."""
    normals = terrain.normals() if normals is None else normals
    places, weights = np.polynomial.legendre.leggauss(heights)
    total = np.zeros(terrain.heights.shape)
    for azimuth, across, up, low in _slices(terrain, count, part, normals):
        half = (np.pi / 2 - low) / 2
        for position, weight in zip(places, weights, strict=True):
            e = low + half * (1 + position)
            received = (across * np.cos(e) + up * np.sin(e)) * np.cos(e)
            total += weight * half * radiance(np.full_like(e, np.radians(azimuth)), e) * received
    return total * 2 / count

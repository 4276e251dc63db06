"""The sun's share of the light (thesis, eqs 3.2 and 3.3), the sun being a disc and not a point.

The disc is cut into upright strips, each in a plane through the vertical. Within a plane
what is above the horizon is seen, so each strip's integral over the elevation is exact;
the strips are summed with nodes that suit a disc's rounded ends.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .horizon import NODE, Position, horizon
from .land import Array, Land, towards

SUN = 0.53  # [degrees] the sun's mean angular diameter


def strips(azimuth: float, elevation: float, diameter: float, count: int) -> Iterator[tuple[float, ...]]:
    """Yield a disc's strips: azimuth, lowest and highest elevation [degrees], width [radians].

    A disc that holds the zenith is cut all round it.
    """
    rho, high = np.radians(diameter / 2), np.radians(elevation)
    around = elevation + diameter / 2 >= 90
    for k in range(count):
        if around:
            aside = 2 * np.pi * (k + 0.5) / count
            width = 2 * np.pi / count
        else:
            widest = np.arcsin(np.sin(rho) / np.cos(high))
            angle = np.pi * ((k + 0.5) / count - 0.5)
            aside, width = widest * np.sin(angle), widest * np.cos(angle) * np.pi / count
        # cos rho = sin e sin E + cos e cos E cos(aside), solved for e
        level = np.cos(high) * np.cos(aside)
        middle = np.arctan2(np.sin(high), level)
        apart = np.arccos(np.minimum(np.cos(rho) / np.hypot(np.sin(high), level), 1))
        low, top = np.degrees(middle - apart), 90.0 if around else np.degrees(middle + apart)
        yield float(azimuth + np.degrees(aside)), float(low), float(top), float(width)


def sunlight(
    terrain: Land,
    azimuth: float,
    elevation: float,
    *,
    diameter: float = SUN,
    count: int = 16,
    part: Position = NODE,
    normals: Array | None = None,
) -> tuple[Array, Array]:
    """Return the sun's visible share and its light, mean of visibility · max(0, N·v) over the disc.

    Both per texel. The visible share is that of the normal's hemisphere (figure 3.2): what is
    behind the surface itself is not seen. A disc of diameter 0 is a point. The part of the
    disc below the level is not seen.
    """
    normal = terrain.normals() if normals is None else normals
    if diameter == 0:
        return _point(terrain, azimuth, elevation, part, normal)
    share, light, whole = np.zeros(terrain.heights.shape), np.zeros(terrain.heights.shape), 0.0
    for towards_azimuth, low, high, width in strips(azimuth, elevation, diameter, count):
        a, lowest, top = np.radians((towards_azimuth, low, high))
        across, up = normal[..., 0] * np.sin(a) + normal[..., 1] * np.cos(a), normal[..., 2]
        # N·v > 0 above the slope of the surface itself; the vertical never is one.
        own = np.arctan2(-across, up)
        floor = np.maximum(
            np.arctan(horizon(terrain, towards_azimuth, part)), np.maximum(own, max(lowest, 0.0))
        )
        edge = np.minimum(floor, top)
        whole += width * (np.sin(top) - np.sin(lowest))
        share += width * np.maximum(np.sin(top) - np.sin(edge), 0)
        light += width * np.maximum(
            _received(across, up, np.maximum(top, edge)) - _received(across, up, edge), 0
        )
    return share / whole, light / whole


def _point(
    terrain: Land, azimuth: float, elevation: float, part: Position, normal: Array
) -> tuple[Array, Array]:
    received = normal @ towards(azimuth, elevation)
    high = np.tan(np.radians(elevation)) if elevation < 90 else np.inf
    seen = (received > 0) & (horizon(terrain, azimuth, part) <= high) & (elevation >= 0)
    return seen.astype(np.float64), np.where(seen, received, 0)


def _received(across: Array, up: Array, elevation: Array) -> Array:
    """Return the integral of N·v cos(e) over e from 0."""
    return across * (elevation / 2 + np.sin(2 * elevation) / 4) + up * np.sin(elevation) ** 2 / 2

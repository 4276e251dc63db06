"""Terrains in float64 metres, read as the shaders read them, and the terrains that methods are measured on.

Texels are nodes: texel k of n is at k · extent / (n - 1). Between them the terrain is
bilinear, and it ends at its border. Row 0 is in the south; x is east, y north.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from playground.data.elevation import read_elevation
from playground.paths import SKETCHES

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Land:
    """A heightfield."""

    heights: Array  # [m] (ny, nx)
    spacing: tuple[float, float]  # [m] from a node to the next, east and north
    name: str = ""

    @property
    def extent(self) -> tuple[float, float]:
        """Return the width and depth [m], from first node to last."""
        ny, nx = self.heights.shape
        return (nx - 1) * self.spacing[0], (ny - 1) * self.spacing[1]

    def at(self, x: object, y: object) -> Array:
        """Return the heights [m] at places in texels, which must lie on the terrain."""
        x, y = np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64))
        ny, nx = self.heights.shape
        i, j = np.clip(x.astype(int), 0, max(nx - 2, 0)), np.clip(y.astype(int), 0, max(ny - 2, 0))
        east, north = np.minimum(i + 1, nx - 1), np.minimum(j + 1, ny - 1)
        p, q, h = x - i, y - j, self.heights
        return (
            h[j, i] * (1 - p) * (1 - q)
            + h[j, east] * p * (1 - q)
            + h[north, i] * (1 - p) * q
            + h[north, east] * p * q
        )

    def slopes(self) -> tuple[Array, Array]:
        """Return the nodes' rise to the east and to the north: central differences, one-sided at an edge."""
        slopes = []
        for axis, step in ((1, self.spacing[0]), (0, self.spacing[1])):
            n = self.heights.shape[axis]
            after, before = np.minimum(np.arange(n) + 1, n - 1), np.maximum(np.arange(n) - 1, 0)
            rise = np.take(self.heights, after, axis) - np.take(self.heights, before, axis)
            run = np.maximum(after - before, 1) * step  # one texel wide: no rise either
            slopes.append(rise / (run if axis == 1 else run[:, None]))
        return slopes[0], slopes[1]

    def normals(self) -> Array:
        """Return the nodes' unit normals (ny, nx, 3)."""
        east, north = self.slopes()
        normal = np.stack([-east, -north, np.ones_like(east)], axis=-1)
        return normal / np.linalg.norm(normal, axis=-1, keepdims=True)


def towards(azimuth: object, elevation: object) -> Array:
    """Return the unit vector (…, 3) towards an azimuth from north, clockwise, and an elevation [degrees]."""
    a, e = np.radians(np.asarray(azimuth, np.float64)), np.radians(np.asarray(elevation, np.float64))
    return np.stack(np.broadcast_arrays(np.cos(e) * np.sin(a), np.cos(e) * np.cos(a), np.sin(e)), axis=-1)


def _grid(size: int, extent: float, middle: tuple[float, float] = (0.5, 0.5)) -> tuple[Array, Array]:
    """Return east and north [m] of a square terrain's nodes, from a place that is a fraction of its sides."""
    along = np.linspace(0, extent, size)
    return tuple(np.meshgrid(along - middle[0] * extent, along - middle[1] * extent))  # type: ignore[return-value]


def cone(size: int = 97, extent: float = 2400.0, slope: float = 30.0) -> Land:
    """Return one mountain on a plain, a cone that rises at an angle [degrees].

    It is where the shadow of a sun in the west-south-west, 5 degrees high, ends on the terrain.
    """
    east, north = _grid(size, extent, (0.25, 0.375))
    heights = np.maximum(extent / 9.6 - np.hypot(east, north), 0) * np.tan(np.radians(slope))
    return Land(heights, (extent / (size - 1),) * 2, "cone")


def valley(size: int = 97, extent: float = 2400.0, slope: float = 35.0) -> Land:
    """Return a straight valley from south to north, V in section, whose walls rise to the border."""
    east, _ = _grid(size, extent)
    return Land(np.abs(east) * np.tan(np.radians(slope)), (extent / (size - 1),) * 2, "valley")


def real(size: int = 97) -> Land:
    """Return a piece of the Jacksboro fault, where ridges are steep; not exaggerated."""
    elevation = read_elevation(SKETCHES / "data" / "jacksboro_fault_dem.npz")
    assert elevation.spacing is not None
    piece = elevation.heights[192 : 192 + size, :size].astype(np.float64)
    return Land(piece - piece.min(), elevation.spacing, "real")


def bowl(size: int = 33, radius: float = 100.0, rim: float = 60.0) -> Land:
    """Return a cap of a sphere sunk in a plain; its rim is as steep as said [degrees]."""
    wide = radius * np.sin(np.radians(rim))
    east, north = _grid(size, 2 * wide)
    depth = np.sqrt(np.maximum(radius**2 - east**2 - north**2, 0)) - radius * np.cos(np.radians(rim))
    return Land(-np.maximum(depth, 0), (2 * wide / (size - 1),) * 2, "bowl")


LANDS = {"cone": cone, "valley": valley, "real": real}
SUNS = ((250.0, 5.0), (250.0, 25.0), (250.0, 60.0))
"""Azimuth and elevation [degrees] of the suns that methods are measured under."""

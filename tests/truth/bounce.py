"""Interreflection (thesis, eqs 3.1 and 3.2): radiosity by a full matrix, on small terrains.

Row p of the matrix says how much of what texel p receives comes from each other texel, if
all were equally bright. Towards each azimuth the terrain comes into sight cell by cell, as
the steepest angle met so far grows: from the elevation it had to the one it has, a ray
first meets the terrain in that cell.
"""

from __future__ import annotations

import numpy as np

from .horizon import profile
from .land import Array, Land
from .sky import azimuths


def exchange(terrain: Land, *, count: int = 64) -> Array:
    """Return the matrix (texels, texels): the cosine-weighted share of a row's view that a column fills.

    A row and the texel's K add up to 1, less what looks out below the level beyond the border.
    """
    ny, nx = terrain.heights.shape
    normal, number = terrain.normals(), np.arange(nx * ny).reshape(ny, nx)
    matrix = np.zeros((nx * ny, nx * ny))
    for azimuth in azimuths(count):
        a = np.radians(azimuth)
        across, up = normal[..., 0] * np.sin(a) + normal[..., 1] * np.cos(a), normal[..., 2]
        highest = np.arctan2(-across, up)  # nothing is received from behind the surface
        for _, position, shown, tangent in profile(terrain, azimuth):
            angle = np.arctan(tangent)
            low = highest[shown]
            high = np.maximum(angle, low)
            share = _received(across[shown], up[shown], high) - _received(across[shown], up[shown], low)
            share = np.maximum(share, 0) * 2 / count
            highest[shown] = high
            rows = number[shown].ravel()
            x, y = int(np.floor(position[0])), int(np.floor(position[1]))
            px, py = position[0] - x, position[1] - y
            for dy, wy in ((0, 1 - py), (1, py)):
                for dx, wx in ((0, 1 - px), (1, px)):
                    if wx * wy:
                        matrix[rows, rows + (y + dy) * nx + x + dx] += wx * wy * share.ravel()
    return matrix


def _received(across: Array, up: Array, e: Array) -> Array:
    return across * (e / 2 + np.sin(2 * e) / 4) + up * np.sin(e) ** 2 / 2


def bounced(
    terrain: Land, direct: Array, colour: float, *, times: int | None = None, count: int = 64
) -> Array:
    """Return what each texel receives in all, of ground of one colour, from what it receives directly.

    ``times`` is how often light is thrown on; None: until nothing is left.
    """
    matrix = colour * exchange(terrain, count=count)
    first = direct.ravel()
    if times is None:
        return np.linalg.solve(np.eye(len(first)) - matrix, first).reshape(direct.shape)
    total = term = first
    for _ in range(times):
        term = matrix @ term
        total = total + term
    return total.reshape(direct.shape)

"""Convert the terrain to a mesh that other programs understand: y up, metres, counter-clockwise from above.

x is east, y up and z south, as in glTF 2.0 (Khronos Group 2021, section 3.4: right-handed, +Y
up); the middle of the terrain is at x = z = 0, sea level at y = 0. A regular grid, its
rows from the north: not reduced where the terrain is flat.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError


@dataclass(frozen=True, eq=False)
class TerrainMesh:
    """Vertices and how to join them."""

    positions: NDArray[np.float32]  # [m] (n, 3): x east, y up, z south
    normals: NDArray[np.float32]  # (n, 3), of length 1
    uv: NDArray[np.float32]  # (n, 2) 0..1: east and south, from the texture's north-western corner
    triangles: NDArray[np.uint32]  # (m, 3)


def sampled(values: NDArray[np.float32], size: tuple[int, int]) -> NDArray[np.float32]:
    """Return values on a grid of another size (nx, ny), corners on corners, between four texels.

    ``values`` is (rows, cols) or (rows, cols, channels). Where texels of both grids meet, and
    where nothing lies between, values are exact.
    """
    return _along(_along(values, 0, size[1]), 1, size[0])


def _along(values: NDArray[np.float32], axis: int, count: int) -> NDArray[np.float32]:
    here = values.shape[axis]
    if count == here:
        return values
    # Integers say exactly where texels of both grids meet.
    whole, rest = np.divmod(np.arange(count) * (here - 1), max(count - 1, 1))
    part = (rest / max(count - 1, 1)).astype(np.float32)
    part = part.reshape([-1 if k == axis else 1 for k in range(values.ndim)])
    low = np.take(values, whole, axis)
    high = np.take(values, np.minimum(whole + 1, here - 1), axis)
    with np.errstate(invalid="ignore"):  # what is not finite is its user's to refuse
        return np.asarray(low + (high - low) * part, dtype=np.float32)


def terrain_mesh(
    heights: NDArray[np.float32], extent: tuple[float, float], texels: tuple[int, int] = (2, 2)
) -> TerrainMesh:
    """Return the mesh with a vertex at each height.

    ``heights`` is (rows, cols) in metres, north row first; ``extent`` in metres, east and
    north; ``texels`` the size of the texture that is draped: its first and last texels'
    middles, not its edges, are on the terrain's edges. Normals are those of central differences.

    Raises:
        DataError: fewer than 2 x 2 heights, or some that are not finite.
    """
    rows, cols = heights.shape
    if min(rows, cols) < 2:
        raise DataError(f"terrain of {cols} x {rows} texels has no mesh; expected at least 2 x 2")
    bad = int(np.count_nonzero(~np.isfinite(heights)))
    if bad:
        raise DataError(f"{bad} of {heights.size} heights are not finite, and a mesh has no place for them")
    east, south = np.meshgrid(np.linspace(0.0, 1.0, cols), np.linspace(0.0, 1.0, rows))
    positions = np.empty((rows, cols, 3), np.float32)
    positions[..., 0] = (east - 0.5) * extent[0]
    positions[..., 1] = heights
    positions[..., 2] = (south - 0.5) * extent[1]

    metres = heights.astype(np.float64)
    normals = np.ones((rows, cols, 3))
    normals[..., 0] = -np.gradient(metres, extent[0] / (cols - 1), axis=1)
    normals[..., 2] = -np.gradient(metres, extent[1] / (rows - 1), axis=0)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)

    nx, ny = texels
    uv = np.stack([(east * (nx - 1) + 0.5) / nx, (south * (ny - 1) + 0.5) / ny], axis=-1)
    return TerrainMesh(
        positions.reshape(-1, 3),
        normals.reshape(-1, 3).astype(np.float32),
        uv.reshape(-1, 2).astype(np.float32),
        _triangles(rows, cols),
    )


def _triangles(rows: int, cols: int) -> NDArray[np.uint32]:
    """Return two triangles for each square, parted from south-west to north-east as in the playground."""
    index = np.arange(rows * cols, dtype=np.uint32).reshape(rows, cols)
    north_west, north_east = index[:-1, :-1], index[:-1, 1:]
    south_west, south_east = index[1:, :-1], index[1:, 1:]
    corners = [south_west, south_east, north_east, south_west, north_east, north_west]
    return np.stack(corners, axis=-1).reshape(-1, 3)

"""The cube map of OpenGL 4.6 core, table 8.19, in NumPy: which face a direction meets, and where."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def face_and_place(direction: NDArray[np.float64]) -> tuple[int, float, float]:
    """Return the face of a direction, +X -X +Y -Y +Z -Z from 0, and s and t there, 0..1."""
    x, y, z = direction
    axis = int(np.argmax(np.abs(direction)))
    face = 2 * axis + (direction[axis] < 0)
    across, down = [(-z, -y), (z, -y), (x, z), (x, -z), (x, -y), (-x, -y)][face]
    largest = np.abs(direction[axis])
    return face, 0.5 * (across / largest + 1), 0.5 * (down / largest + 1)


def directions(side: int) -> NDArray[np.float64]:
    """Return a direction that meets the middle of each texel of a cube, (6 * side, side, 3).

    Found by trying: those of a fine grid over the sphere whose place is nearest to the middle.
    """
    steps = np.linspace(-1, 1, 2 * side + 1)[1::2]
    array = np.full((6 * side, side, 3), np.nan)
    for axis in range(3):
        for way in (1.0, -1.0):
            for a in steps:
                for b in steps:
                    direction = np.insert([a, b], axis, way)
                    face, s, t = face_and_place(direction)
                    row, column = face * side + int(t * side), int(s * side)
                    array[row, column] = direction
    assert not np.isnan(array).any()
    return array

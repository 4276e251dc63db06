"""Build the meshes of a part: fewer triangles the farther, skirts around each to hide cracks.

Neighbouring parts have the same nodes on their border; where one is drawn with every
second node only, its edge cuts corners that the other's does not. A skirt hangs from each
edge, lower than what may be cut, in the colour of the edge.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

LEVELS = 4


def steps_of(intervals: int) -> tuple[int, ...]:
    """Return for each level how many intervals a triangle's side spans: 1, 2, 4 … as far as they fit."""
    found = [1]
    while len(found) < LEVELS and intervals % (2 * found[-1]) == 0 and intervals // (2 * found[-1]) >= 4:
        found.append(2 * found[-1])
    return tuple(found)


def part_mesh(intervals: int, step: int) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Return vertices (n, 3): node east, node north, 1 at the skirt's foot; and indices, three a triangle."""
    nodes = np.arange(0, intervals + 1, step, dtype=np.float32)
    n = len(nodes)
    east, north = np.meshgrid(nodes, nodes)
    top = np.stack([east.ravel(), north.ravel(), np.zeros(n * n, np.float32)], axis=1)
    index = np.arange(n * n, dtype=np.uint32).reshape(n, n)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    faces = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1)
    rim = np.concatenate([index[0, :-1], index[:-1, -1], index[-1, :0:-1], index[:0:-1, 0]])
    foot = top[rim].copy()
    foot[:, 2] = 1.0
    low = np.arange(len(rim), dtype=np.uint32) + np.uint32(n * n)
    after = np.roll(np.arange(len(rim)), -1)
    wall = np.stack([rim, low, low[after], rim, low[after], rim[after]], axis=-1).reshape(-1)
    return np.concatenate([top, foot]), np.concatenate([faces, wall]).astype(np.uint32)

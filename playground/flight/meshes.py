"""Build the meshes of a part: fewer triangles the farther, skirts around each to hide cracks.

Neighbouring parts have the same nodes on their border; where one is drawn with every
second node only, its edge cuts corners that the other's does not. A skirt hangs from each
edge, lower than what may be cut, in the colour of the edge.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from playground.terrain.meshes import skirted

LEVELS = 4


def steps_of(intervals: int) -> tuple[int, ...]:
    """Return for each level how many intervals a triangle's side spans: 1, 2, 4 … as far as they fit."""
    found = [1]
    while len(found) < LEVELS and intervals % (2 * found[-1]) == 0 and intervals // (2 * found[-1]) >= 4:
        found.append(2 * found[-1])
    return tuple(found)


def part_mesh(intervals: int, step: int) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Return vertices (n, 3): node east, node north, 1 at the skirt's foot; and indices, three a triangle."""
    return skirted(np.arange(0, intervals + 1, step, dtype=np.float32))

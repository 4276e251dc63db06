"""Build the meshes of a part: fewer triangles the farther, skirts around each to hide cracks.

Neighbouring parts have the same nodes on their border; where one is drawn with every
second node only, its edge cuts corners that the other's does not. A skirt hangs from each
edge, lower than what may be cut, in the colour of the edge.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from playground.engine.meshes import skirted

LEVELS = 4
BLOCKS = 4
"""Of the nearest parts, so many a side are drawn or not."""


class Block(NamedTuple):
    """Some of a part's triangles."""

    first: int  # index
    indices: int
    nodes: tuple[int, int, int, int]  # from east and north to east and north


def steps_of(intervals: int) -> tuple[int, ...]:
    """Return for each level how many intervals a triangle's side spans: 1, 2, 4 … as far as they fit."""
    steps = [1]
    while len(steps) < LEVELS and intervals % (2 * steps[-1]) == 0 and intervals // (2 * steps[-1]) >= 4:
        steps.append(2 * steps[-1])
    return tuple(steps)


def part_mesh(intervals: int, step: int) -> tuple[NDArray[np.float32], NDArray[np.uint32], list[Block]]:
    """Return vertices (n, 3): east node, north node, 1 at the skirt's foot; indices; and blocks.

    The indices of a block follow each other, so that it is drawn alone; the last has the skirt.
    """
    vertices, indices = skirted(np.arange(0, intervals + 1, step, dtype=np.float32))
    triangles = indices.reshape(-1, 3)
    low, foot = vertices[triangles].min(axis=1), vertices[triangles, 2].max(axis=1)
    side = max(intervals // BLOCKS, step)
    blocks = -(-intervals // side)
    number = (low[:, 1] // side * blocks + low[:, 0] // side).astype(int)
    number[foot > 0] = blocks * blocks
    order = np.argsort(number, kind="stable")
    ends = np.searchsorted(number[order], np.arange(blocks * blocks + 1), side="right") * 3
    starts = [0, *ends[:-1].tolist()]
    result = []
    for block, (start, end) in enumerate(zip(starts, ends.tolist(), strict=True)):
        if block == blocks * blocks:
            result.append(Block(start, end - start, (0, 0, intervals, intervals)))
        elif end > start:
            west, south = block % blocks * side, block // blocks * side
            reach = min(west + side, intervals), min(south + side, intervals)
            result.append(Block(start, end - start, (west, south, *reach)))
    return vertices, triangles[order].ravel(), result

"""Make the tile that all land in tiles is drawn with: its vertices, and how to join them.

A tile is 16 by 16 cells. One set of 17 by 17 vertices serves every tile at every level;
each level has a list of indices for each set of neighbours that are one level coarser,
whose edges it then shares vertex for vertex, so that no crack can open. A piece is drawn
once for all tiles that are to look so, each tile an instance.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

CELLS = 16
LEVELS = 5
SOUTH, EAST, NORTH, WEST = 1, 2, 4, 8
SIDES = (SOUTH, EAST, NORTH, WEST)

Piece = tuple[str, int, int]
"""A list: "fans", level, sides where the neighbour is coarser; "quarter" of the finest level, east or
not, north or not; "wall", level, side.

The last level has no coarser neighbours: there 0 is a tile cut from its south-west to its
north-east, 1 one cut the other way.
"""


@dataclass(frozen=True, slots=True)
class Chosen:
    """What to draw: instances of pieces, in order."""

    runs: tuple[tuple[Piece, int], ...]  # a piece, and how many of the places it takes, one after another
    places: NDArray[np.float32]  # (n, 4): node of the south-west corner, level, sides or reach [m]


def vertices() -> NDArray[np.float32]:
    """Return a tile's vertices, (n, 3): node east and north, 0..16, and 0, then its four sides' feet."""
    steps = np.arange(CELLS + 1)
    north, east = np.meshgrid(steps, steps, indexing="ij")
    top = np.stack([east.ravel(), north.ravel(), np.zeros(east.size)], axis=1)
    rim = [_node(*node) for side in SIDES for node in _side(side, 1)]
    foot = top[rim]
    foot[:, 2] = 1.0
    return np.concatenate([top, foot]).astype(np.float32)


@cache
def pieces() -> Mapping[Piece, NDArray[np.uint32]]:
    """Return every list of indices, three a triangle, counter-clockwise from above or outside."""
    found: dict[Piece, NDArray[np.uint32]] = {}
    for level in range(LEVELS - 1):
        for coarser in range(16):
            found["fans", level, coarser] = _fans(level, coarser)
    west, east, far, north = (_node(*n) for n in ((0, 0), (CELLS, 0), (CELLS, CELLS), (0, CELLS)))
    found["fans", LEVELS - 1, 0] = np.array([west, east, far, west, far, north], np.uint32)
    found["fans", LEVELS - 1, 1] = np.array([west, east, north, east, far, north], np.uint32)
    for east in (0, 1):
        for north in (0, 1):
            found["quarter", east, north] = _fans(0, 0, (east, north))
    for level in range(LEVELS):
        for side in SIDES:
            found["wall", level, side] = _wall(level, side)
    return found


@cache
def ranges() -> Mapping[Piece, tuple[int, int]]:
    """Return where each piece lies when all stand one after another: its first index, and how many."""
    found, first = {}, 0
    for piece, indices in pieces().items():
        found[piece] = first, len(indices)
        first += len(indices)
    return found


def _node(east: int, north: int) -> int:
    return north * (CELLS + 1) + east


def _side(side: int, step: int) -> list[tuple[int, int]]:
    """Return a side's nodes, with the tile to the left of who walks along it."""
    along = range(0, CELLS + 1, step)
    if side in (SOUTH, NORTH):
        nodes = [(k, 0 if side == SOUTH else CELLS) for k in along]
    else:
        nodes = [(0 if side == WEST else CELLS, k) for k in along]
    return nodes if side in (SOUTH, EAST) else nodes[::-1]


def _fans(level: int, coarser: int, quarter: tuple[int, int] | None = None) -> NDArray[np.uint32]:
    """Return a level's triangles: fans around the middles of blocks of two by two quads."""
    half = 1 << level
    blocks = [list(range(half, CELLS, 2 * half))] * 2
    if quarter is not None:
        blocks = [[at for at in blocks[0] if at * 2 // CELLS == part] for part in quarter]
    ring = [(-1, -1), (0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0)]
    found = []
    for north in blocks[1]:
        for east in blocks[0]:
            around = [(east + half * x, north + half * y) for x, y in ring]
            for side, middle in zip(SIDES, (1, 3, 5, 7), strict=True):
                axis = 1 if side in (SOUTH, NORTH) else 0
                rim = 0 if side in (SOUTH, WEST) else CELLS
                if coarser & side and around[middle][axis] == rim:
                    around[middle] = around[middle - 1]  # dropped below
            kept = [node for k, node in enumerate(around) if node != around[k - 1]]
            for k, node in enumerate(kept):
                found += [_node(east, north), _node(*node), _node(*kept[(k + 1) % len(kept)])]
    return np.array(found, np.uint32)


def _wall(level: int, side: int) -> NDArray[np.uint32]:
    """Return the wall from a side down to its feet."""
    step = 1 << level
    first = (CELLS + 1) ** 2 + SIDES.index(side) * (CELLS + 1)
    top = [_node(*node) for node in _side(side, step)]
    foot = list(range(first, first + CELLS + 1, step))
    found = []
    for k in range(len(top) - 1):
        found += [top[k], foot[k], foot[k + 1], top[k], foot[k + 1], top[k + 1]]
    return np.array(found, np.uint32)


def rims_of(ny: int, nx: int) -> dict[int, NDArray[np.bool_]]:
    """Return which tiles stand at each side of the land."""
    j, i = np.indices((ny, nx))
    return {SOUTH: j == 0, EAST: i == nx - 1, NORTH: j == ny - 1, WEST: i == 0}

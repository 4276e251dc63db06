"""Make the tile that all terrain in tiles is drawn with: its vertices, and how to join them.

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
_ROW = CELLS + 1  # nodes from one to the next in the north
_RING = np.array([(-1, -1), (0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0)])

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
    places: NDArray[np.float32]  # (n, 4): node of the south-west corner, level, sides or distance [m]


def vertices() -> NDArray[np.float32]:
    """Return a tile's vertices, (n, 3): node east and north, 0..16, and 0, then its four sides' feet."""
    steps = np.arange(CELLS + 1)
    north, east = np.meshgrid(steps, steps, indexing="ij")
    top = np.stack([east.ravel(), north.ravel(), np.zeros(east.size)], axis=1)
    foot = top[np.concatenate([_side(side, 1) for side in SIDES])]
    foot[:, 2] = 1.0
    return np.concatenate([top, foot]).astype(np.float32)


@cache
def pieces() -> Mapping[Piece, NDArray[np.uint32]]:
    """Return every list of indices, three a triangle, counter-clockwise from above or outside."""
    found: dict[Piece, NDArray[np.uint32]] = {}
    for level in range(LEVELS - 1):
        for coarser in range(16):
            found["fans", level, coarser] = _fans(level, coarser)
    south_west, south_east = _side(SOUTH, CELLS)
    north_east, north_west = _side(NORTH, CELLS)
    cut = [south_west, south_east, north_east, south_west, north_east, north_west]
    found["fans", LEVELS - 1, 0] = np.array(cut, np.uint32)
    cut = [south_west, south_east, north_west, south_east, north_east, north_west]
    found["fans", LEVELS - 1, 1] = np.array(cut, np.uint32)
    for east in (0, 1):
        for north in (0, 1):
            found["quarter", east, north] = _fans(0, 0, (east, north))
    for level in range(LEVELS):
        for side in SIDES:
            found["wall", level, side] = _wall(level, side)
    return found


@cache
def ranges() -> Mapping[Piece, tuple[int, int]]:
    """Return where each piece begins when all are one after another: its first index, and how many."""
    found, first = {}, 0
    for piece, indices in pieces().items():
        found[piece] = first, len(indices)
        first += len(indices)
    return found


def _side(side: int, step: int) -> NDArray[np.int64]:
    """Return every so many nodes of a side, in the order in which the tile is to their left."""
    along = np.arange(0, CELLS + 1, step)
    nodes = along if side in (SOUTH, NORTH) else along * _ROW
    far = {SOUTH: 0, EAST: CELLS, NORTH: CELLS * _ROW, WEST: 0}[side]
    return far + (nodes if side in (SOUTH, EAST) else nodes[::-1])


def _fans(level: int, coarser: int, quarter: tuple[int, int] | None = None) -> NDArray[np.uint32]:
    """Return a level's triangles: fans around the middles of blocks of two by two quads."""
    half = 1 << level
    middles = np.arange(half, CELLS, 2 * half)
    east, north = (
        middles if part is None else middles[middles * 2 // CELLS == part] for part in quarter or (None,) * 2
    )
    middle = np.stack([axis.ravel() for axis in np.meshgrid(east, north)], axis=1)  # (blocks, 2), east first
    around = middle[:, None] + half * _RING  # (blocks, 8, 2)
    for side, node in zip(SIDES, (1, 3, 5, 7), strict=True):
        if coarser & side:  # its edge has no node there
            axis, rim = int(side in (SOUTH, NORTH)), 0 if side in (SOUTH, WEST) else CELLS
            dropped = around[:, node, axis] == rim
            around[dropped, node] = around[dropped, node - 1]
    ring, centre = around @ (1, _ROW), middle @ (1, _ROW)
    after = np.roll(ring, -1, axis=1)
    fans = np.stack([np.broadcast_to(centre[:, None], ring.shape), ring, after], axis=2)
    found: NDArray[np.uint32] = fans[ring != after].astype(np.uint32).ravel()
    return found


def _wall(level: int, side: int) -> NDArray[np.uint32]:
    """Return the wall from a side down to its feet."""
    step = 1 << level
    top, foot = _side(side, step), _ROW**2 + SIDES.index(side) * _ROW + np.arange(0, CELLS + 1, step)
    quads = [top[:-1], foot[:-1], foot[1:], top[:-1], foot[1:], top[1:]]
    return np.stack(quads, axis=1).ravel().astype(np.uint32)


def rims_of(ny: int, nx: int) -> dict[int, NDArray[np.bool_]]:
    """Return which tiles are at each side of the terrain."""
    j, i = np.indices((ny, nx))
    return {SOUTH: j == 0, EAST: i == nx - 1, NORTH: j == ny - 1, WEST: i == 0}

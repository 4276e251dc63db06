"""Choose what to draw of a terrain in tiles: which tiles, at which level of detail, joined how.

``geomipmap`` gives each tile the coarsest level whose error, in pixels, is allowed.
Levels of neighbours then differ by one at most; a level made finer for that has a smaller
error. Tiles outside the view are left out.

The choice is made here and not in the vertex shader, though that would read nothing back:
there every vertex of the finest level goes through it, 45 ms a frame for 1025 x 1025
texels on llvmpipe with all triangles of a tile but two collapsed, where drawing those two
takes 3 ms, choosing them 1 ms, and downloading the tiles' errors 0.03 ms, once for each terrain.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from playground.terrain.morph import morph
from playground.terrain.tiles import CELLS, EAST, LEVELS, NORTH, SOUTH, WEST, Chosen, Piece, rims_of
from playground.terrain.visibility import Boxes, View, boxes_of

Levels = NDArray[np.int8]
Tables = Mapping[str, NDArray[np.float32]]


def levels_of(errors: NDArray[np.float32], boxes: Boxes, view: View, tolerance: float) -> Levels:
    """Return each tile's level: the coarsest of at most ``tolerance`` pixels, neighbours one apart at most.

    ``errors`` of levels 1 to 4 in heights, (ny, nx, 4), none less than that before it.
    """
    scale = abs(view.relief) * view.pixels / boxes.depths(view)
    levels: Levels = np.zeros(scale.shape, np.int8)
    for level in range(LEVELS - 1):
        levels += errors[..., level] * scale <= tolerance
    for _ in range(LEVELS - 1):
        finest = levels + 1
        finest[1:] = np.minimum(finest[1:], levels[:-1] + 1)
        finest[:-1] = np.minimum(finest[:-1], levels[1:] + 1)
        finest[:, 1:] = np.minimum(finest[:, 1:], levels[:, :-1] + 1)
        finest[:, :-1] = np.minimum(finest[:, :-1], levels[:, 1:] + 1)
        levels = np.minimum(levels, finest)
    return levels


def coarser_of(levels: Levels) -> Levels:
    """Return, for each tile, the sides whose neighbours are coarser."""
    found = np.zeros_like(levels)
    found[1:] |= SOUTH * (levels[:-1] > levels[1:])
    found[:-1] |= NORTH * (levels[1:] > levels[:-1])
    found[:, 1:] |= WEST * (levels[:, :-1] > levels[:, 1:])
    found[:, :-1] |= EAST * (levels[:, 1:] > levels[:, :-1])
    return found


def geomipmap(values: Mapping[str, object], tables: Tables, view: View) -> Chosen:
    """Choose tiles in the view, each at the coarsest level within ``tolerance`` pixels."""
    tolerance = values["tolerance"]
    assert isinstance(tolerance, float)
    boxes = boxes_of(tables["spans"], view)
    levels = levels_of(tables["errors"], boxes, view, tolerance)
    return tiles_at(levels, boxes, view)


def tiles_at(levels: Levels, boxes: Boxes, view: View) -> Chosen:
    """Return the tiles in the view at given levels, neighbours one apart at most, and walls at the rim."""
    ny, nx = levels.shape
    j, i = np.indices((ny, nx))
    # Of the last level, four tiles in a square make a fan.
    sides = np.where(levels == LEVELS - 1, (i + j) % 2, coarser_of(levels))
    places = [_gathered("fans", levels, sides, boxes.visible(view))]
    visible = boxes.with_walls(view).visible(view)
    for side, rim in rims_of(ny, nx).items():
        places.append(_gathered("wall", levels, np.full((ny, nx), side, np.int8), visible & rim))
    runs = tuple(run for found, _ in places for run in found)
    return Chosen(runs, np.concatenate([each for _, each in places]))


def _gathered(
    kind: str, levels: Levels, sides: Levels, wanted: NDArray[np.bool_]
) -> tuple[Sequence[tuple[Piece, int]], NDArray[np.float32]]:
    """Return the wanted tiles, those of one piece after another."""
    north, east = np.nonzero(wanted)
    level, side = levels[wanted], sides[wanted]
    code = level.astype(np.int64) * 16 + side
    order = np.argsort(code, kind="stable")
    places = np.stack([CELLS * east, CELLS * north, level, side], axis=1)[order].astype(np.float32)
    found, counts = np.unique(code, return_counts=True)
    runs = [((kind, int(c) // 16, int(c) % 16), int(n)) for c, n in zip(found, counts, strict=True)]
    return runs, places


# ── the registry ─────────────────────────────────────────────────────────────

WHOLE: Piece = ("whole", 0, 0)
DETAILS = ("full grid", "geomipmap", "morph")
"""What ``detail`` of mesh "terrain" may be, by number."""


def choose_terrain(values: Mapping[str, object], tables: Callable[[], Tables], view: View) -> Chosen:
    """Choose what to draw of mesh "terrain"; its full grid is drawn whole, once."""
    if values["detail"] == 0:
        return Chosen(((WHOLE, 1),), np.zeros((1, 4), np.float32))
    return (geomipmap if values["detail"] == 1 else morph)(values, tables(), view)


@dataclass(frozen=True, slots=True)
class Chooser:
    """How a mesh is chosen from for each picture."""

    choose: Callable[[Mapping[str, object], Callable[[], Tables], View], Chosen]
    parameters: tuple[str, ...]  # of the draw, that the choice reads besides those of the mesh
    inputs: tuple[str, ...]  # of the draw, whose texels the choice reads


CHOOSERS: dict[str, Chooser] = {
    "land": Chooser(choose_terrain, ("tolerance",), ("spans", "errors")),
}
"""Meshes of which only a part is drawn, by name; they have an attribute ``tile`` for each instance."""

"""Level of detail: the tiles of a terrain that a view needs, how they morph and join.

A tile is 16 by 16 cells. One set of 17 by 17 vertices serves every tile at every level;
each level has a list of indices for each set of neighbours that are one level coarser,
whose edges it then shares vertex for vertex, so that no crack can open. A piece is drawn
once for all tiles that are to look so, each tile an instance.

Like the camera's, these numbers are the same on every machine and in a browser (detail.js).

Every square is drawn by the same 512 triangles. Their vertices slide into those of the
next level as the distance grows (view/vertices.glsl), so that no level begins or ends in
one picture, and no edge needs stitching. The distance of each level is one number for the
whole terrain: its roughest place among those near enough to matter rules all of it.

``geomipmap`` gives each tile the coarsest level whose error, in pixels, is allowed.
Levels of neighbours then differ by one at most; a level made finer for that has a smaller
error. Tiles outside the view are left out.

The choice is made here and not in the vertex shader, though that would read nothing back:
there every vertex of the finest level goes through it, 45 ms a frame for 1025 x 1025
texels on llvmpipe with all triangles of a tile but two collapsed, where drawing those two
takes 3 ms, choosing them 1 ms, and downloading the tiles' errors 0.03 ms, once for each terrain.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
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
    foot = top[np.concatenate([edge_nodes(side, 1) for side in SIDES])]
    foot[:, 2] = 1.0
    return np.concatenate([top, foot]).astype(np.float32)


@cache
def pieces() -> Mapping[Piece, NDArray[np.uint32]]:
    """Return every list of indices, three a triangle, counter-clockwise from above or outside."""
    indices: dict[Piece, NDArray[np.uint32]] = {}
    for level in range(LEVELS - 1):
        for coarser in range(16):
            indices["fans", level, coarser] = _fans(level, coarser)
    south_west, south_east = edge_nodes(SOUTH, CELLS)
    north_east, north_west = edge_nodes(NORTH, CELLS)
    cut = [south_west, south_east, north_east, south_west, north_east, north_west]
    indices["fans", LEVELS - 1, 0] = np.array(cut, np.uint32)
    cut = [south_west, south_east, north_west, south_east, north_east, north_west]
    indices["fans", LEVELS - 1, 1] = np.array(cut, np.uint32)
    for east in (0, 1):
        for north in (0, 1):
            indices["quarter", east, north] = _fans(0, 0, (east, north))
    for level in range(LEVELS):
        for side in SIDES:
            indices["wall", level, side] = _wall(level, side)
    return indices


@cache
def ranges() -> Mapping[Piece, tuple[int, int]]:
    """Return where each piece begins when all are one after another: its first index, and how many."""
    ranges_by_piece, first = {}, 0
    for piece, indices in pieces().items():
        ranges_by_piece[piece] = first, len(indices)
        first += len(indices)
    return ranges_by_piece


def edge_nodes(side: int, step: int) -> NDArray[np.int64]:
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
    indices: NDArray[np.uint32] = fans[ring != after].astype(np.uint32).ravel()
    return indices


def _wall(level: int, side: int) -> NDArray[np.uint32]:
    """Return the wall from a side down to its feet."""
    step = 1 << level
    top, foot = edge_nodes(side, step), _ROW**2 + SIDES.index(side) * _ROW + np.arange(0, CELLS + 1, step)
    quads = [top[:-1], foot[:-1], foot[1:], top[:-1], foot[1:], top[1:]]
    return np.stack(quads, axis=1).ravel().astype(np.uint32)


def rims_of(ny: int, nx: int) -> dict[int, NDArray[np.bool_]]:
    """Return which tiles are at each side of the terrain."""
    j, i = np.indices((ny, nx))
    return {SOUTH: j == 0, EAST: i == nx - 1, NORTH: j == ny - 1, WEST: i == 0}


FAR = 1e30
Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class View:
    """From where, and how large, a terrain is looked at."""

    clip_from_world: Floats  # (4, 4), rows; acts on column vectors
    eye: tuple[float, float, float]  # [m]
    extent: tuple[float, float]  # [m]
    relief: float  # [m] of height 1
    size: tuple[int, int]  # [pixels]

    @property
    def forward(self) -> Floats:
        """What a place's depth [m] is worked out with: its first three times the place, plus the last."""
        row: Floats = self.clip_from_world[3]
        return row

    @property
    def near(self) -> float:
        """Depth [m] of the plane before which nothing is drawn."""
        ahead, depth = self._row(3), self._row(2)
        along = _dot(depth, ahead) / _dot(ahead, ahead)
        return -(_dot(depth, self.eye) + depth[3]) / (1.0 + along)

    @property
    def pixels(self) -> float:
        """The most pixels that a metre upwards is long, at depth 1 m, anywhere in the picture.

        A place at (x, y) of the view, over its depth, is x and y times a scale from the
        middle. Moved by a short way (a, b, c) at depth z it moves by (a - x c, b - y c) / z,
        whose length is greatest in a corner of the picture.
        """
        across, upright, ahead = (self._row(k) for k in (0, 1, 3))
        wide, tall = 1.0 / math.sqrt(_dot(across, across)), 1.0 / math.sqrt(_dot(upright, upright))
        lengths = []
        for x in (-wide, wide):
            for y in (-tall, tall):
                right = (self.size[0] / (2.0 * wide)) * (across[2] * wide - x * ahead[2])
                up = (self.size[1] / (2.0 * tall)) * (upright[2] * tall - y * ahead[2])
                lengths.append(math.sqrt(right * right + up * up))
        return max(lengths)

    @property
    def stretch(self) -> float:
        """How much further than it is deep a place in the picture may be."""
        across, upright = self._row(0), self._row(1)
        return math.sqrt(1.0 + 1.0 / _dot(across, across) + 1.0 / _dot(upright, upright))

    def _row(self, number: int) -> list[float]:
        row: list[float] = self.clip_from_world[number].tolist()
        return row


@dataclass(frozen=True, slots=True)
class Boxes:
    """The boxes around the tiles of a terrain [m]: columns and rows share their sides."""

    east: Floats  # (2, nx): west and east sides
    north: Floats  # (2, ny): south and north sides
    up: Floats  # (2, ny, nx): lowest and highest

    def support(self, plane: Floats) -> Floats:
        """Return the support of each box (ny, nx): the most of a plane's equation at a place of it."""
        east, north = (plane[0] * self.east).max(axis=0), (plane[1] * self.north).max(axis=0)
        supports: Floats = plane[2] * self.up[int(plane[2] > 0)]
        supports += east
        supports += north[:, None] + plane[3]
        return supports

    def depths(self, view: View) -> Floats:
        """Return the least depth [m] of each that can be visible."""
        least: Floats = np.maximum(-self.support(-view.forward), view.near)
        return least

    @property
    def longest(self) -> float:
        """The largest that a diagonal of any box can be [m]."""
        x, y, z = (float(np.ptp(side, axis=0).max()) for side in (self.east, self.north, self.up))
        return math.sqrt(x * x + y * y + z * z)

    def distances(self, eye: tuple[float, float, float]) -> tuple[Floats, Floats]:
        """Return how far [m] the eye is from each box's nearest place, and from its furthest."""
        nearest, furthest = [], []
        for (low, high), at in zip((self.east, self.north, self.up), eye, strict=True):
            nearest.append(np.maximum(np.maximum(low - at, at - high), 0.0) ** 2)
            furthest.append(np.maximum(np.abs(low - at), np.abs(high - at)) ** 2)
        return _length(*nearest), _length(*furthest)

    def visible(self, view: View) -> NDArray[np.bool_]:
        """Return which are not wholly outside one of the six planes of the view."""
        is_visible = np.ones(self.up.shape[1:], bool)
        for row in (0, 1, 2):
            for sign in (1.0, -1.0):
                is_visible &= self.support(view.clip_from_world[3] + sign * view.clip_from_world[row]) >= 0
        return is_visible

    def with_walls(self, view: View) -> Boxes:
        """Return boxes that hold the walls at the terrain's rim as well.

        How deep a wall goes is the draw's to say; none goes deeper than this, or than the terrain itself.
        """
        return replace(self, up=np.stack([np.minimum(self.up[0], -max(view.extent)), self.up[1]]))


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    """Return the product of the first three numbers of each."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _length(east: Floats, north: Floats, up: Floats) -> Floats:
    length_squared: Floats = np.sqrt(east + north[:, None] + up)
    return length_squared


def boxes_of(spans: NDArray[np.float32], view: View) -> Boxes:
    """Return the boxes of squares, (ny, nx): ``spans`` are their lowest and highest heights and their ends.

    Those are shares of the terrain's sides, east and north; each begins where the one before ends.
    """
    heights = np.moveaxis(np.clip(spans[..., :2].astype(np.float64), -FAR, FAR), -1, 0) * view.relief
    sides = []
    for ends, extent in zip((spans[0, :, 2], spans[:, 0, 3]), view.extent, strict=True):
        edges = np.concatenate([[0.0], ends.astype(np.float64)]) * extent
        sides.append(np.stack([edges[:-1], edges[1:]]))
    # A relief below 0 turns the terrain upside down.
    return Boxes(sides[0], sides[1], heights if view.relief >= 0 else heights[::-1])


START = 0.8
"""Where vertices begin to slide, over a level's distance: MORPH_START in view/vertices.glsl (tested)."""
NEARLY = 0.8
"""From where on a box counts, over the distance at which it needs a finer level."""


def pyramid(spans: NDArray[np.float32]) -> list[NDArray[np.float32]]:
    """Return the spans of squares of 1, 2, 4 ... tiles a side, up to one square: see ``boxes_of``."""
    levels = [spans]
    while max(levels[-1].shape[:2]) > 1:
        ny, nx = levels[-1].shape[:2]
        even = np.pad(levels[-1], ((0, ny % 2), (0, nx % 2), (0, 0)), mode="edge")
        four = np.stack([even[j::2, i::2] for j in (0, 1) for i in (0, 1)])
        levels.append(np.concatenate([four[..., :1].min(axis=0), four[..., 1:].max(axis=0)], axis=-1))
    return levels


def level_distances(
    tables: Mapping[str, NDArray[np.float32]],
    squares: Sequence[NDArray[np.float32]],
    view: View,
    tolerance: float,
) -> Floats:
    """Return the distance [m] up to which each level of morphing tiles is drawn; the last has no end.

    The next level shows through from ``START`` of it on, and must be within ``tolerance``
    pixels there. Of levels whose quads are larger than a tile, the error is taken to be all
    that heights differ in a quad. A level is also drawn so far that the next one lies wholly
    within its own unmorphed part wherever the two meet.
    """
    pixel = abs(view.relief) * view.pixels * view.stretch / max(tolerance, 1e-9)
    boxes = [boxes_of(each, view) for each in squares]
    distances: list[float] = []
    for level in range(1, len(squares)):
        size = max(level - LEVELS + 1, 0)  # of the squares whose errors are known
        heights = np.diff(squares[size].astype(np.float64), axis=-1)[..., 0]
        if level < LEVELS:
            errors = tables["errors"][..., level - 1].astype(np.float64)
            heights = np.where(errors < FAR / 2, errors, 0.0)  # holes may change their shape
        furthest = _furthest(boxes[size], heights * pixel, view)
        # The tile before was cut because its parent is near: its points may be a parent's size further.
        within = (distances[-1] + boxes[level - 1].longest) * 1.02 if distances else 0.0
        distances.append(min(max(furthest, within) / START, FAR))
    return np.array([*distances, FAR])


def _furthest(boxes: Boxes, fine: Floats, view: View) -> float:
    """Return the distance up to which some box needs a finer level, each for itself up to ``fine``.

    A box that lies wholly beyond that needs none. It comes in little by little as the eye
    comes near, so that nothing jumps.
    """
    near, far = boxes.distances(view.eye)
    share = np.clip((fine - NEARLY * near) / np.maximum((1.0 - NEARLY) * near, 1e-9), 0.0, 1.0)
    return float((np.minimum(fine, far) * share).max())


def morph(values: Mapping[str, object], tables: Mapping[str, NDArray[np.float32]], view: View) -> Chosen:
    """Choose tiles of a quadtree in the view, each cut in four where its children are drawn."""
    tolerance = values["tolerance"]
    assert isinstance(tolerance, float)
    squares = pyramid(tables["spans"])
    distances = level_distances(tables, squares, view, tolerance)
    places: list[tuple[Piece, NDArray[np.float32]]] = []
    inside = np.ones(squares[-1].shape[:2], bool)
    for level in range(len(squares) - 1, -1, -1):
        boxes = boxes_of(squares[level], view)
        cut = np.zeros_like(inside)
        if level:
            cut = inside & (boxes.distances(view.eye)[0] < distances[level - 1])
        drawn = inside & ~cut
        visible, beyond = drawn & boxes.visible(view), boxes.distances(view.eye)[0] >= distances[level]
        places.append((("fans", 0, 0), _placed(visible & ~beyond, level, level, distances)))
        # What has become its parent's quarter altogether, and is drawn as that.
        for quarter in ((0, 0), (0, 1), (1, 0), (1, 1)):
            here = np.zeros_like(visible)
            here[quarter[1] :: 2, quarter[0] :: 2] = True
            places.append(
                (("quarter", *quarter), _placed(visible & beyond & here, level, level + 1, distances))
            )
        walls = drawn & boxes.with_walls(view).visible(view)
        for side, rim in rims_of(*drawn.shape).items():
            places.append((("wall", 0, side), _placed(walls & rim, level, level, distances)))
        if level:
            ny, nx = squares[level - 1].shape[:2]
            inside = np.repeat(np.repeat(cut, 2, axis=0), 2, axis=1)[:ny, :nx]
    runs: list[tuple[Piece, int]] = []
    order = sorted(places, key=lambda each: each[0])
    for piece in dict.fromkeys(piece for piece, _ in order):
        runs.append((piece, sum(len(indices) for other, indices in order if other == piece)))
    return Chosen(tuple(runs), np.concatenate([indices for _, indices in order]))


def _placed(chosen: NDArray[np.bool_], level: int, shown: int, distances: Floats) -> NDArray[np.float32]:
    """Return the places of squares of a level, or of those of another that they lie in."""
    north, east = (CELLS * 2**shown * (at >> (shown - level)) for at in np.nonzero(chosen))
    last = min(shown, len(distances) - 1)
    each = np.broadcast_arrays(east, north, np.float32(shown), np.float32(distances[last]))
    return np.stack(each, axis=1).astype(np.float32)


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
    coarser = np.zeros_like(levels)
    coarser[1:] |= SOUTH * (levels[:-1] > levels[1:])
    coarser[:-1] |= NORTH * (levels[1:] > levels[:-1])
    coarser[:, 1:] |= WEST * (levels[:, :-1] > levels[:, 1:])
    coarser[:, :-1] |= EAST * (levels[:, 1:] > levels[:, :-1])
    return coarser


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
    runs = tuple(run for runs_found, _ in places for run in runs_found)
    return Chosen(runs, np.concatenate([each for _, each in places]))


def _gathered(
    kind: str, levels: Levels, sides: Levels, selected: NDArray[np.bool_]
) -> tuple[Sequence[tuple[Piece, int]], NDArray[np.float32]]:
    """Return the wanted tiles, those of one piece after another."""
    north, east = np.nonzero(selected)
    level, side = levels[selected], sides[selected]
    code = level.astype(np.int64) * 16 + side
    order = np.argsort(code, kind="stable")
    places = np.stack([CELLS * east, CELLS * north, level, side], axis=1)[order].astype(np.float32)
    codes, counts = np.unique(code, return_counts=True)
    runs = [((kind, int(c) // 16, int(c) % 16), int(n)) for c, n in zip(codes, counts, strict=True)]
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

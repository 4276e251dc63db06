"""Choose what to draw of a land in tiles: which tiles, at which level of detail, joined how.

A tile is 16 by 16 cells. One set of 17 by 17 vertices serves every tile at every level;
each level has a list of indices for each set of neighbours that are one level coarser,
whose edges it then shares vertex for vertex, so that no crack can open (``pieces``). A
piece is drawn once for all tiles that are to look so, each tile an instance.

``morph`` cuts squares of tiles in four where they are near, down to single tiles, and has each
drawn by the same 512 triangles, whose vertices slide with the distance.

``geomipmap`` gives each tile the coarsest level whose error, in pixels, is allowed.
Levels of neighbours then differ by one at most; a level made finer for that has a smaller
error. Tiles outside the view are left out.

The choice is made here and not in the vertex shader, though that would read nothing back:
there every vertex of the finest level goes through it, 45 ms a frame for 1025 x 1025
texels on llvmpipe with all triangles of a tile but two collapsed, where drawing those two
takes 3 ms, choosing them 1 ms, and reading the tiles' errors 0.03 ms, once for each land.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

CELLS = 16
LEVELS = 5
SOUTH, EAST, NORTH, WEST = 1, 2, 4, 8
SIDES = (SOUTH, EAST, NORTH, WEST)
_FAR = 1e30

Piece = tuple[str, int, int]
"""A list: "fans", level, sides where the neighbour is coarser; "wall", level, side.

The last level has no coarser neighbours: there 0 is a tile cut from its south-west to its
north-east, 1 one cut the other way.
"""

Floats = NDArray[np.float64]
Levels = NDArray[np.int8]
Tables = Mapping[str, NDArray[np.float32]]


@dataclass(frozen=True, slots=True)
class View:
    """From where, and how large, a land is looked at."""

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
        ahead = self.clip_from_world[3, :3]
        along = float(self.clip_from_world[2, :3] @ ahead / (ahead @ ahead))
        return float(-(self.clip_from_world[2] @ (*self.eye, 1.0)) / (1.0 + along))

    @property
    def pixels(self) -> float:
        """The most pixels that a metre upwards is long, at depth 1 m, anywhere in the picture.

        A place at (x, y) of the view, over its depth, is x and y times a scale from the
        middle. Moved by a short way (a, b, c) at depth z it moves by (a - x c, b - y c) / z,
        whose length is greatest in a corner of the picture.
        """
        across, upright, ahead = (self.clip_from_world[k, :3] for k in (0, 1, 3))
        wide, tall = 1.0 / np.linalg.norm(across), 1.0 / np.linalg.norm(upright)
        scale = self.size[0] / (2.0 * wide), self.size[1] / (2.0 * tall)
        moved = across[2] * wide, upright[2] * tall, ahead[2]
        corners = ((x, y) for x in (-wide, wide) for y in (-tall, tall))
        return float(
            max(
                np.hypot(scale[0] * (moved[0] - x * moved[2]), scale[1] * (moved[1] - y * moved[2]))
                for x, y in corners
            )
        )

    @property
    def stretch(self) -> float:
        """How much further than it is deep a place in the picture may be."""
        across, upright = (self.clip_from_world[k, :3] for k in (0, 1))
        return float(np.sqrt(1.0 + 1.0 / (across @ across) + 1.0 / (upright @ upright)))


@dataclass(frozen=True, slots=True)
class Chosen:
    """What to draw: instances of pieces, in order."""

    runs: tuple[tuple[Piece, int], ...]  # a piece, and how many of the places it takes, one after another
    places: NDArray[np.float32]  # (n, 4): node of the south-west corner, level, sides or reach [m]


@dataclass(frozen=True, slots=True)
class Boxes:
    """The boxes around the tiles of a land [m]: columns and rows share their sides."""

    east: Floats  # (2, nx): west and east sides
    north: Floats  # (2, ny): south and north sides
    up: Floats  # (2, ny, nx): lowest and highest

    def reach(self, plane: Floats) -> Floats:
        """Return, (ny, nx), the most of a plane's first three times a place of each box, plus its last."""
        east, north = (plane[0] * self.east).max(axis=0), (plane[1] * self.north).max(axis=0)
        found: Floats = plane[2] * self.up[int(plane[2] > 0)]
        found += east
        found += north[:, None] + plane[3]
        return found

    def depths(self, view: View) -> Floats:
        """Return the least depth [m] of each that can be seen."""
        least: Floats = np.maximum(-self.reach(-view.forward), view.near)
        return least

    def distances(self, eye: tuple[float, float, float]) -> Floats:
        """Return how far [m] the eye is from each."""
        east, north, up = (
            np.maximum(np.maximum(low - at, at - high), 0.0)
            for (low, high), at in zip((self.east, self.north, self.up), eye, strict=True)
        )
        found: Floats = np.sqrt(east**2 + north[:, None] ** 2 + up**2)
        return found

    def seen(self, view: View) -> NDArray[np.bool_]:
        """Say which are not wholly outside one of the six planes of the view."""
        found = np.ones(self.up.shape[1:], bool)
        for row in (0, 1, 2):
            for sign in (1.0, -1.0):
                found &= self.reach(view.clip_from_world[3] + sign * view.clip_from_world[row]) >= 0
        return found


# ── pieces ───────────────────────────────────────────────────────────────────


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


def _fans(level: int, coarser: int) -> NDArray[np.uint32]:
    """Return a level's triangles: fans around the middles of blocks of two by two quads."""
    half = 1 << level
    ring = [(-1, -1), (0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0)]
    found = []
    for north in range(half, CELLS, 2 * half):
        for east in range(half, CELLS, 2 * half):
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


# ── choosing ─────────────────────────────────────────────────────────────────


def boxes_of(
    spans: NDArray[np.float32], view: View, side: int = CELLS, tiles: tuple[int, int] | None = None
) -> Boxes:
    """Return the boxes of squares whose lowest and highest heights are ``spans``, (ny, nx, 2).

    ``side`` is theirs in cells; ``tiles`` says how many tiles, east and north, the land has,
    where that is not how many squares it has.
    """
    heights = np.moveaxis(np.clip(spans.astype(np.float64), -_FAR, _FAR), -1, 0) * view.relief
    sides = []
    for count, whole, extent in zip(
        spans.shape[1::-1], tiles or spans.shape[1::-1], view.extent, strict=True
    ):
        edges = np.minimum(np.arange(count + 1) * side, whole * CELLS) * (extent / (whole * CELLS))
        sides.append(np.stack([edges[:-1], edges[1:]]))
    # A relief below 0 turns the land upside down.
    return Boxes(sides[0], sides[1], heights if view.relief >= 0 else heights[::-1])


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
    places = [_gathered("fans", levels, sides, boxes.seen(view))]
    seen = _with_walls(boxes, view).seen(view)
    for side, rim in _rims(ny, nx).items():
        places.append(_gathered("wall", levels, np.full((ny, nx), side, np.int8), seen & rim))
    runs = tuple(run for found, _ in places for run in found)
    return Chosen(runs, np.concatenate([each for _, each in places]))


def _with_walls(boxes: Boxes, view: View) -> Boxes:
    """Return boxes that hold the walls at the rim as well.

    How deep a wall goes is the draw's to say; none goes deeper than this, or than the land itself.
    """
    return replace(boxes, up=np.stack([np.minimum(boxes.up[0], -max(view.extent)), boxes.up[1]]))


def _rims(ny: int, nx: int) -> dict[int, NDArray[np.bool_]]:
    """Return which tiles stand at each side of the land."""
    j, i = np.indices((ny, nx))
    return {SOUTH: j == 0, EAST: i == nx - 1, NORTH: j == ny - 1, WEST: i == 0}


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


# ── morphing ─────────────────────────────────────────────────────────────────

START = 0.8
"""Where vertices begin to slide, over the distance that a level reaches; as in view/vertices.glsl."""


def pyramid(spans: NDArray[np.float32]) -> list[NDArray[np.float32]]:
    """Return the lowest and highest heights of squares of 1, 2, 4 ... tiles a side, up to one square."""
    found = [spans]
    while max(found[-1].shape[:2]) > 1:
        ny, nx = found[-1].shape[:2]
        even = np.pad(found[-1], ((0, ny % 2), (0, nx % 2), (0, 0)), mode="edge")
        four = np.stack([even[j::2, i::2] for j in (0, 1) for i in (0, 1)])
        found.append(np.stack([four[..., 0].min(axis=0), four[..., 1].max(axis=0)], axis=-1))
    return found


def reaches(tables: Tables, squares: Sequence[NDArray[np.float32]], view: View, tolerance: float) -> Floats:
    """Return the distance [m] that each level of morphing tiles reaches; the last has no end.

    The next level shows through from ``START`` of it on, and must be within ``tolerance``
    pixels there. Of levels whose quads are larger than a tile, the error is taken to be all
    that heights differ in a quad. A level also reaches so far that the next one lies wholly
    within its own unmorphed part wherever the two meet.
    """
    errors = tables["errors"].reshape(-1, LEVELS - 1).astype(np.float64)
    known = errors[errors[:, -1] < _FAR / 2]  # holes may change their shape
    cells = [CELLS * count for count in squares[0].shape[1::-1]]
    cell = [extent / count for extent, count in zip(view.extent, cells, strict=True)]
    pixel = abs(view.relief) * view.pixels * view.stretch / max(tolerance, 1e-9)
    found: list[float] = []
    error = 0.0
    for level in range(1, len(squares)):
        if level < LEVELS:
            error = max(error, float(known[:, level - 1].max(initial=0.0)))
        else:
            error = max(error, _tallest(squares[level - LEVELS + 1]))
        tile = [CELLS * 2.0 ** (level - 1) * side for side in cell]
        tall = abs(view.relief) * _tallest(squares[level - 1])
        # The tile before it was cut because its parent is near: its points may be a parent's size further.
        within = (found[-1] + float(np.hypot(*tile)) + tall) * 1.02 if found else 0.0
        found.append(min(max(error * pixel, within) / START, _FAR))
    return np.array([*found, _FAR])


def _tallest(spans: NDArray[np.float32]) -> float:
    return float(np.max(spans[..., 1].astype(np.float64) - spans[..., 0]))


def morph(values: Mapping[str, object], tables: Tables, view: View) -> Chosen:
    """Choose tiles of a quadtree in the view, each cut in four where its children reach."""
    tolerance = values["tolerance"]
    assert isinstance(tolerance, float)
    squares = pyramid(tables["spans"])
    reach = reaches(tables, squares, view, tolerance)
    places: list[tuple[Piece, NDArray[np.float32]]] = []
    reached = np.ones(squares[-1].shape[:2], bool)
    for level in range(len(squares) - 1, -1, -1):
        boxes = boxes_of(squares[level], view, CELLS * 2**level, tables["spans"].shape[1::-1])
        cut = np.zeros_like(reached)
        if level:
            cut = reached & (boxes.distances(view.eye) < reach[level - 1])
        drawn = reached & ~cut
        wanted = [(("fans", 0, 0), drawn & boxes.seen(view))]
        walls = drawn & _with_walls(boxes, view).seen(view)
        wanted += [(("wall", 0, side), walls & rim) for side, rim in _rims(*drawn.shape).items()]
        for piece, tiles in wanted:
            north, east = (CELLS * 2**level * at for at in np.nonzero(tiles))
            each = np.broadcast_arrays(east, north, np.float32(level), np.float32(reach[level]))
            places.append((piece, np.stack(each, axis=1).astype(np.float32)))
        if level:
            ny, nx = squares[level - 1].shape[:2]
            reached = np.repeat(np.repeat(cut, 2, axis=0), 2, axis=1)[:ny, :nx]
    runs: list[tuple[Piece, int]] = []
    order = sorted(places, key=lambda each: each[0])
    for piece in dict.fromkeys(piece for piece, _ in order):
        runs.append((piece, sum(len(found) for other, found in order if other == piece)))
    return Chosen(tuple(runs), np.concatenate([found for _, found in order]))


# ── the registry ─────────────────────────────────────────────────────────────

WHOLE: Piece = ("whole", 0, 0)
DETAILS = ("full grid", "geomipmap", "morph")
"""What ``detail`` of mesh "land" may be, by number."""


def choose_land(values: Mapping[str, object], tables: Callable[[], Tables], view: View) -> Chosen:
    """Choose what to draw of mesh "land"; its full grid is drawn whole, once."""
    if values["detail"] == 0:
        return Chosen(((WHOLE, 1),), np.zeros((1, 4), np.float32))
    return (geomipmap if values["detail"] == 1 else morph)(values, tables(), view)


@dataclass(frozen=True, slots=True)
class Chooser:
    """How a mesh is chosen from for each picture."""

    choose: Callable[[Mapping[str, object], Callable[[], Tables], View], Chosen]
    parameters: tuple[str, ...]  # of the draw, that the choice reads beside those of the mesh
    inputs: tuple[str, ...]  # of the draw, whose texels the choice reads


CHOOSERS: dict[str, Chooser] = {
    "land": Chooser(choose_land, ("tolerance",), ("spans", "errors")),
}
"""Meshes of which only a part is drawn, by name; they have an attribute ``tile`` for each instance."""

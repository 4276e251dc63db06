"""Choose what to draw of a land in tiles that morph: squares of tiles, cut in four where they are near.

Every square is drawn by the same 512 triangles. Their vertices slide into those of the
next level as the distance grows (view/vertices.glsl), so that no level begins or ends in
one picture, and no edge needs stitching. How far a level reaches is one number for the
whole land, so its worst place rules all of it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from playground.terrain.sight import FAR, Floats, View, boxes_of
from playground.terrain.tiles import CELLS, LEVELS, Chosen, Piece, rims_of

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


def reaches(
    tables: Mapping[str, NDArray[np.float32]],
    squares: Sequence[NDArray[np.float32]],
    view: View,
    tolerance: float,
) -> Floats:
    """Return the distance [m] that each level of morphing tiles reaches; the last has no end.

    The next level shows through from ``START`` of it on, and must be within ``tolerance``
    pixels there. Of levels whose quads are larger than a tile, the error is taken to be all
    that heights differ in a quad. A level also reaches so far that the next one lies wholly
    within its own unmorphed part wherever the two meet.
    """
    errors = tables["errors"].reshape(-1, LEVELS - 1).astype(np.float64)
    known = errors[errors[:, -1] < FAR / 2]  # holes may change their shape
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
        found.append(min(max(error * pixel, within) / START, FAR))
    return np.array([*found, FAR])


def _tallest(spans: NDArray[np.float32]) -> float:
    return float(np.max(spans[..., 1].astype(np.float64) - spans[..., 0]))


def morph(values: Mapping[str, object], tables: Mapping[str, NDArray[np.float32]], view: View) -> Chosen:
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
        walls = drawn & boxes.with_walls(view).seen(view)
        wanted += [(("wall", 0, side), walls & rim) for side, rim in rims_of(*drawn.shape).items()]
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

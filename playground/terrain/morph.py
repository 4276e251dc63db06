"""Choose what to draw of a terrain in tiles that morph: squares of tiles, cut in four where they are near.

Every square is drawn by the same 512 triangles. Their vertices slide into those of the
next level as the distance grows (view/vertices.glsl), so that no level begins or ends in
one picture, and no edge needs stitching. The distance of each level is one number for the
whole terrain: its roughest place among those near enough to matter rules all of it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from playground.terrain.tiles import CELLS, LEVELS, Chosen, Piece, rims_of
from playground.terrain.visibility import FAR, Boxes, Floats, View, boxes_of

START = 0.8
"""Where vertices begin to slide, over a level's distance: MORPH_START in view/vertices.glsl (tested)."""
NEARLY = 0.8
"""From where on a box counts, over the distance at which it needs a finer level."""


def pyramid(spans: NDArray[np.float32]) -> list[NDArray[np.float32]]:
    """Return the spans of squares of 1, 2, 4 ... tiles a side, up to one square: see ``boxes_of``."""
    found = [spans]
    while max(found[-1].shape[:2]) > 1:
        ny, nx = found[-1].shape[:2]
        even = np.pad(found[-1], ((0, ny % 2), (0, nx % 2), (0, 0)), mode="edge")
        four = np.stack([even[j::2, i::2] for j in (0, 1) for i in (0, 1)])
        found.append(np.concatenate([four[..., :1].min(axis=0), four[..., 1:].max(axis=0)], axis=-1))
    return found


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
    found: list[float] = []
    for level in range(1, len(squares)):
        size = max(level - LEVELS + 1, 0)  # of the squares whose errors are known
        heights = np.diff(squares[size].astype(np.float64), axis=-1)[..., 0]
        if level < LEVELS:
            errors = tables["errors"][..., level - 1].astype(np.float64)
            heights = np.where(errors < FAR / 2, errors, 0.0)  # holes may change their shape
        wanted = _furthest(boxes[size], heights * pixel, view)
        # The tile before was cut because its parent is near: its points may be a parent's size further.
        within = (found[-1] + boxes[level - 1].longest) * 1.02 if found else 0.0
        found.append(min(max(wanted, within) / START, FAR))
    return np.array([*found, FAR])


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
        runs.append((piece, sum(len(found) for other, found in order if other == piece)))
    return Chosen(tuple(runs), np.concatenate([found for _, found in order]))


def _placed(chosen: NDArray[np.bool_], level: int, shown: int, distances: Floats) -> NDArray[np.float32]:
    """Return the places of squares of a level, or of those of another that they lie in."""
    north, east = (CELLS * 2**shown * (at >> (shown - level)) for at in np.nonzero(chosen))
    last = min(shown, len(distances) - 1)
    each = np.broadcast_arrays(east, north, np.float32(shown), np.float32(distances[last]))
    return np.stack(each, axis=1).astype(np.float32)

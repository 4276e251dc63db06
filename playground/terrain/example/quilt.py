"""Lay pieces of an example side by side, first along the features that are wanted, and join them by cuts.

After Zhou, Sun, Turk and Rehg 2007, "Terrain Synthesis from Digital Elevation Models" (IEEE TVCG 13, 4):
pieces follow the sketched features, from the strongest on, then what is between them is filled; and Efros
and Freeman 2001, "Image Quilting for Texture Synthesis and Transfer" (SIGGRAPH): where two pieces overlap
they are cut along the line on which they differ least.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from heapq import heappop, heappush

import numpy as np
from numpy.typing import NDArray

from playground.terrain.example.candidates import CELLS, Candidates, Fit, in_cells

Field = NDArray[np.float64]
_SIDES = ((0, -1), (0, 1), (-1, 0), (1, 0))  # west, east, south, north as rows and columns


@dataclass
class Quilt:
    """Terrain pieced together."""

    heights: Field  # (ny, nx)
    east: Field  # (ny, nx) the rise to the next texel east, of the piece that a texel is from
    north: Field  # likewise north


def quilted(
    candidates: Candidates,
    size: tuple[int, int],
    overlap: int,
    *,
    features: Field | None = None,
    weight: float = 1.0,
    report: Callable[[int, int], None] = lambda done, wanted: None,
) -> Quilt:
    """Return terrain of a size (nx, ny) laid of pieces that overlap by so many texels.

    ``features`` (ny, nx) are the ridges and valleys wanted, in deviations of the example's own; near 0 any
    will do. ``weight`` is theirs beside the overlaps'.
    """
    side, step = candidates.side, candidates.side - overlap
    nx, ny = size
    columns, rows = (max(-(-(n - overlap) // step), 1) for n in (nx, ny))
    shape = rows * step + overlap, columns * step + overlap
    quilt = Quilt(np.zeros(shape), np.zeros(shape), np.zeros(shape))
    known = np.zeros(shape, bool)
    wanted = np.zeros((rows, columns, CELLS * CELLS))
    if features is not None:
        whole = np.pad(features, ((0, max(shape[0] - ny, 0)), (0, max(shape[1] - nx, 0))), mode="edge")
        for j in range(rows):
            for i in range(columns):
                part = whole[j * step : j * step + side, i * step : i * step + side]
                wanted[j, i] = in_cells(part)
    strength = np.sqrt((wanted**2).mean(-1))
    placed = np.zeros((rows, columns), bool)
    for done, (j, i) in enumerate(_order(strength)):
        report(done, rows * columns)
        place = slice(j * step, j * step + side), slice(i * step, i * step + side)
        strong = min(strength[j, i], 1.0)
        fit = Fit(
            known[place],
            quilt.heights[place],
            wanted[j, i] if strong > _WEAK else None,
            weight * strong,
        )
        number = candidates.best(fit)
        beside = [_is_placed(placed, j + dj, i + di) for dj, di in _SIDES]
        _put(quilt, known, place, candidates.with_border(number), overlap, beside)
        placed[j, i] = True
    cut = slice(ny), slice(nx)
    return Quilt(quilt.heights[cut], quilt.east[cut], quilt.north[cut])


_WEAK = 0.25
"""Features of less than so many deviations are none."""


def _order(strength: Field) -> Iterator[tuple[int, int]]:
    """Yield all places: the strongest first, then always one beside those, the strongest of them.

    Of equally strong ones first that with the most beside it, then the southernmost, then the westernmost.
    Features that are strong but not beside any place begin another line before weak places are filled.
    """
    rows, columns = strength.shape
    strong = np.where(strength > _WEAK, strength, 0.0).tolist()
    waiting = {(j, i) for j in range(rows) for i in range(columns)}

    def rank(place: tuple[int, int]) -> tuple[float, int, int, int]:
        """Return what is least for the place that comes first; it falls as places beside it are filled."""
        j, i = place
        beside = sum((j + dj, i + di) not in waiting for dj, di in _SIDES)
        return -strong[j][i], -beside, j, i

    begins = sorted(map(rank, waiting), reverse=True)  # the first is the last
    border: list[tuple[float, int, int, int]] = []  # a heap; of a place that is in it twice the lesser counts
    while waiting:
        while begins and begins[-1][2:] not in waiting:
            begins.pop()
        while border and border[0][2:] not in waiting:
            heappop(border)
        follows = border and (border[0][0] < 0 or begins[-1][0] == 0)
        place = (heappop(border) if follows else begins.pop())[2:]
        waiting.remove(place)
        for dj, di in _SIDES:
            if (beside := (place[0] + dj, place[1] + di)) in waiting:
                heappush(border, rank(beside))
        yield place


def _is_placed(placed: NDArray[np.bool_], j: int, i: int) -> bool:
    return 0 <= j < placed.shape[0] and 0 <= i < placed.shape[1] and bool(placed[j, i])


def _put(
    quilt: Quilt,
    known: NDArray[np.bool_],
    place: tuple[slice, slice],
    piece: Field,
    overlap: int,
    beside: list[bool],
) -> None:
    """Put a piece (side + 1, side + 1) in its place, at the height of what is there, cut to its neighbours.

    ``beside`` says whether there is a piece to the west, east, south and north.
    """
    there, old, heights = known[place], quilt.heights[place], piece[:-1, :-1]
    if there.any():
        heights = heights + (old[there] - heights[there]).mean()
    else:
        heights = heights - heights.mean()
    taken = np.ones(there.shape, bool)
    error = (old - heights) ** 2
    for is_there, turns in zip(beside, (0, 2, 1, 3), strict=True):
        if is_there:
            # Turned so that the neighbour is to the left.
            line = cut(np.rot90(error, turns)[:, :overlap])
            keep = np.arange(len(line)) >= line[:, np.newaxis]
            taken &= np.rot90(keep, -turns)
    taken |= ~there
    quilt.heights[place][taken] = heights[taken]
    quilt.east[place][taken] = np.diff(piece, axis=1)[:-1][taken]
    quilt.north[place][taken] = np.diff(piece, axis=0)[:, :-1][taken]
    known[place] = True


def cut(error: Field) -> NDArray[np.intp]:
    """Return the column of the least-error way down an overlap (rows, columns), for each row.

    From row to row it moves by one column at the most.
    """
    cost = error.copy()
    for row in range(1, len(cost)):
        before = cost[row - 1]
        least = before.copy()
        np.minimum(least[1:], before[:-1], out=least[1:])
        np.minimum(least[:-1], before[1:], out=least[:-1])
        cost[row] += least
    way = np.empty(len(cost), np.intp)
    way[-1] = cost[-1].argmin()
    for row in range(len(cost) - 2, -1, -1):
        first = max(way[row + 1] - 1, 0)
        way[row] = first + cost[row, first : way[row + 1] + 2].argmin()
    return way

"""The horizon of every texel towards any azimuth, exact on bilinear terrain.

Over one cell the terrain along a ray is a parabola in the distance s, and the tangent of the
angle under which it is seen, (h(s) - h(0)) / s, has its greatest value at the ends of the
cell or where its derivative is 0. Rays from one place in every cell cross the grid's lines
at the same distances, so each crossing is a few sums of whole shifted arrays.

``marched`` finds the same by many small steps: slower and never quite there, for the test.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from .land import Array, Land

Position = tuple[float, float]
NODE: Position = (0.0, 0.0)


@dataclass(frozen=True)
class Crossing:
    """A ray's place where it meets a line of the grid."""

    distance: float  # [m] along the level
    place: Position  # from the start, in texels; whole along the axis that it crosses


def _ahead(azimuth: float) -> Array:
    ahead = np.array([np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))])
    return np.where(np.abs(ahead) < 1e-12, 0, ahead)  # along an axis, whatever the rounding of pi


def crossings(terrain: Land, azimuth: float, part: Position = NODE) -> list[Crossing]:
    """Return where rays towards an azimuth meet the grid's lines, from ``part`` [texels] of any cell."""
    way = _ahead(azimuth) / terrain.spacing  # texels a metre
    met = []
    for axis in (0, 1):
        for k in range(terrain.heights.shape[1 - axis] if way[axis] else 0):
            line = float(k + 1) if way[axis] > 0 else float(-k)
            if (line - part[axis]) * way[axis] > 0:
                met.append(((line - part[axis]) / way[axis], axis, line))
    result: list[Crossing] = []
    for s, axis, line in sorted(met):
        # Through a node, a ray meets two lines at once.
        twice = bool(result) and s - result[-1].distance <= 1e-9 * s
        position = list(result[-1].place if twice else part + s * way)
        position[axis] = line
        result[len(result) - twice :] = [Crossing(s, (float(position[0]), float(position[1])))]
    return result


def _sampled(terrain: Land, position: Position) -> tuple[Array, tuple[slice, slice]]:
    """Return the heights at a place as seen from each texel, and for which of them it is on the terrain."""
    ny, nx = terrain.heights.shape
    rows, row_part, row_from = _shift(position[1], ny)
    columns, column_part, column_from = _shift(position[0], nx)
    shown = (slice(rows[0], rows[1]), slice(columns[0], columns[1]))
    total = np.zeros((max(rows[1] - rows[0], 0), max(columns[1] - columns[0], 0)))
    for y, wy in ((0, 1 - row_part), (1, row_part)):
        for x, wx in ((0, 1 - column_part), (1, column_part)):
            if wx * wy:
                total = (
                    total
                    + wx
                    * wy
                    * terrain.heights[
                        rows[0] + row_from + y : rows[1] + row_from + y,
                        columns[0] + column_from + x : columns[1] + column_from + x,
                    ]
                )
    return total, shown


def _shift(offset: float, n: int) -> tuple[tuple[int, int], float, int]:
    """Return the texels (first, end) for which texel + offset is on the terrain, its part, its whole part."""
    whole = int(np.floor(offset))
    part = offset - whole
    first = max(0, -whole)
    end = min(n, n - whole - (1 if part else 0))
    return (first, max(end, first)), part, whole


def profile(
    terrain: Land, azimuth: float, part: Position = NODE
) -> Iterator[tuple[float, Position, tuple, Array]]:
    """Yield the greatest tangent within each cell that rays cross, cell by cell outwards.

    (distance [m] of the cell's middle, its place, the texels whose rays are still on the
    terrain, the tangent over the cell for those texels).
    """
    start, everywhere = _sampled(terrain, part)
    base = np.full(terrain.heights.shape, np.nan)
    base[everywhere] = start
    last = Crossing(0.0, part)
    before, seen = start, everywhere
    for crossing in crossings(terrain, azimuth, part):
        half = (crossing.distance - last.distance) / 2
        middle = (last.distance + crossing.distance) / 2
        position = ((last.place[0] + crossing.place[0]) / 2, (last.place[1] + crossing.place[1]) / 2)
        after, shown = _sampled(terrain, crossing.place)
        inner = _overlap(seen, shown)
        if after.size and inner[0].stop > inner[0].start and inner[1].stop > inner[1].start:
            origin = base[inner]
            h1 = before[_within(inner, seen)] - origin
            h2 = after[_within(inner, shown)] - origin
            between, around = _sampled(terrain, position)
            hm = between[_within(inner, around)] - origin
            yield middle, position, inner, _steepest(h1, hm, h2, last.distance, half)
        last, before, seen = crossing, after, shown


def _steepest(h1: Array, hm: Array, h2: Array, start: float, half: float) -> Array:
    """Return max (h(s) / s) over a cell from its heights over the eye at both ends and in the middle."""
    middle, end = start + half, start + 2 * half
    curve = (h1 + h2 - 2 * hm) / (2 * half**2)  # h = a + b s + c s²
    rise = (h2 - h1) / (2 * half) - 2 * curve * middle
    best = h2 / end
    if start == 0:
        return np.maximum(best, rise)  # as s tends to 0
    best = np.maximum(best, h1 / start)
    low = hm - rise * middle - curve * middle**2
    peaked = (low < 0) & (curve < 0)
    top = np.sqrt(np.divide(low, curve, out=np.zeros_like(low), where=peaked))
    inside = peaked & (top > start) & (top < end)
    return np.where(inside, np.maximum(best, rise + 2 * curve * top), best)


def _overlap(a: tuple[slice, slice], b: tuple[slice, slice]) -> tuple[slice, slice]:
    slices = [
        slice(max(p.start, q.start), max(min(p.stop, q.stop), max(p.start, q.start)))
        for p, q in zip(a, b, strict=True)
    ]
    return slices[0], slices[1]


def _within(inner: tuple[slice, slice], outer: tuple[slice, slice]) -> tuple[slice, slice]:
    slices = [slice(p.start - q.start, p.stop - q.start) for p, q in zip(inner, outer, strict=True)]
    return slices[0], slices[1]


def horizon(terrain: Land, azimuth: float, part: Position = NODE) -> Array:
    """Return the tangent of the horizon's elevation towards an azimuth [degrees], for every texel.

    -inf where no terrain lies that way, NaN where ``part`` of the texel's cell is off the terrain.
    What is above it is visible, what is below it hidden: the terrain has no overhangs.
    """
    result = np.full(terrain.heights.shape, np.nan)
    _, there = _sampled(terrain, part)
    result[there] = -np.inf
    for _, _, shown, tangent in profile(terrain, azimuth, part):
        result[shown] = np.maximum(result[shown], tangent)
    return result


def marched(terrain: Land, azimuth: float, x: Array, y: Array, step: float = 1 / 64) -> Array:
    """Return the same for places in texels by steps of so many texels: never above the exact one."""
    x, y = np.asarray(x, np.float64), np.asarray(y, np.float64)
    ny, nx = terrain.heights.shape
    way = _ahead(azimuth)
    length = step / np.abs(way / terrain.spacing).max()  # [m]
    foot, best = terrain.at(x, y), np.full(np.shape(x), -np.inf)
    for k in range(1, int((nx + ny) / step) + 1):
        px, py = x + k * length * way[0] / terrain.spacing[0], y + k * length * way[1] / terrain.spacing[1]
        on = (px >= 0) & (py >= 0) & (px <= nx - 1) & (py <= ny - 1)
        if not on.any():
            break
        best[on] = np.maximum(best[on], (terrain.at(px[on], py[on]) - foot[on]) / (k * length))
    return best

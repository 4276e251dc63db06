"""Triangulate points that come one by one, each into the triangle of greatest area.

After H. Belaiche 2010, section 1.3.8. Four corners make two triangles. Each further point
is at the barycentre of the greatest triangle, its corners weighted equally or at random,
and has a random height. What it makes illegal is fixed in one of two ways, which give the
same triangles: destruction and construction (Bowyer 1981, Watson 1981, both in The Computer
Journal 24) or flips of edges (Lawson 1977, "Software for C1 Surface Interpolation").

Fixed (slip 5 of the thesis's listing): the triangles that are destroyed are gathered in
one list and leave the triangulation; construction skips neighbours that are in that list
themselves, and takes the edges of the terrain's border, which have no neighbour.

Places are whole numbers on a lattice, so the orientation of three points and whether a circle
holds a point are exact: no case is degenerate but a tie. A circle does not hold the points
on it. That is what a lifted paraboloid gives when each new point is lifted by the least
amount more than all before it, so both ways leave the same edge of a tie, in any order.

No point falls on an edge. The greatest of 2 n + 2 triangles has at least the mean area, so
no altitude of it is shorter than 1 / (n + 1) / sqrt(2) of a square terrain's side, and a
point is over 1/11 of one away from each edge: for ``MAX_POINTS`` over 100 spacings of the
lattice, and over 18 on the longest terrain, where rounding moves it by less than one.
"""

from __future__ import annotations

import heapq
import zlib
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.memo import SOURCES, bytes_held

SIDE = 2**24
"""Lattice spacings along the longer side of the terrain: a float32 holds every whole number up to it."""

MAX_POINTS = 10_000
MAX_PROPORTION = 8.0
"""How many times longer one side of the terrain may be than the other."""

_CELLS = 4096  # sides are multiples of SIDE / _CELLS, so that GLSL can divide them by a terrain's texels
_MASK = 2**32 - 1
SALT = zlib.crc32(b"delaunay")
"""Added to the seed, as every kernel that draws adds one of its own (noise/hash.glsl)."""
_OUTSIDE = -1


@dataclass(frozen=True, slots=True)
class Rules:
    """What makes a triangulation: the same rules give the same one on every machine."""

    points: int = 60  # inserted after the four corners
    seed: int = 7
    random_weights: bool = False  # of the barycentre; else equal ones
    by_flips: bool = False  # else by destruction and construction
    flips: int = -1  # the last insertion stops after so many flips; -1: it makes all
    displaced: bool = False  # heights are the triangle's own, displaced; else random alone
    roughness: float = 1.0  # exponent of the displacement
    corners: tuple[float, float, float, float] = (0.5, 0.5, 0.5, 0.5)  # heights SW, SE, NW, NE
    proportion: float = 1.0  # the terrain's length north over its length east


@dataclass(frozen=True, slots=True)
class Triangulation:
    """Points, the triangles between them, and what the last insertion did."""

    sides: tuple[int, int]  # of the terrain, in lattice spacings
    places: NDArray[np.int32]  # (n, 2) lattice; the corners SW, SE, NW, NE come first
    heights: NDArray[np.float64]  # (n,)
    triangles: NDArray[np.int32]  # (t, 3) points, counter-clockwise, the least first; greatest area first
    neighbours: NDArray[np.int32]  # (t, 3) the triangle across from each corner; -1 outside
    destroyed: NDArray[np.int32]  # (k, 3) by the last insertion: the edge that led there, then its opposite
    replaced: int  # edges that the last insertion replaced: those of rows 1 to ``replaced`` of ``destroyed``


@SOURCES.cached(weight=bytes_held)
def triangulate(rules: Rules) -> Triangulation:
    """Return the triangulation that some rules make; raise ``DataError`` where it would not be exact."""
    if not 0 <= rules.points <= MAX_POINTS:
        raise DataError(f"{rules.points} points to triangulate; 0 to {MAX_POINTS} were expected")
    if not 1.0 / MAX_PROPORTION <= rules.proportion <= MAX_PROPORTION:
        raise DataError(f"sides 1 to {rules.proportion:g} to triangulate; 1 to {MAX_PROPORTION:g} at most")
    growing = Growing(rules)
    for _ in range(rules.points):
        growing.insert()
    return growing.finished()


def tables(made: Triangulation, size: tuple[int, int]) -> dict[str, NDArray[np.float32]]:
    """Return a triangulation as textures of one size, entry k at (k % width, k // width).

    ``places``: x, y, height, 0. ``triangles``: three points, 0. ``neighbours``: three
    triangles, 0. ``last``: first (point, entries that follow, edges replaced, all triangles),
    the point -1 where none was inserted, then the triangles destroyed. Raises ``DataError``
    where the size has too few texels.
    """
    width, height = size
    count = len(made.destroyed)
    newest = len(made.places) - 1 if count else _OUTSIDE
    header = np.array([[newest, count, made.replaced, len(made.triangles)]])
    rows = {
        "places": np.column_stack([made.places, made.heights, np.zeros(len(made.places))]),
        "triangles": np.pad(made.triangles, ((0, 0), (0, 1))),
        "neighbours": np.pad(made.neighbours, ((0, 0), (0, 1))),
        "last": np.concatenate([header, np.pad(made.destroyed, ((0, 0), (0, 1)))]),
    }
    most = max(map(len, rows.values()))
    if most > width * height:
        raise DataError(f"{most} entries do not fit into {width} x {height} texels; make the pass larger")
    arrays = {}
    for name, row in rows.items():
        table = np.zeros((height * width, 4), np.float32)
        table[: len(row)] = row
        arrays[name] = table.reshape(height, width, 4)
    return arrays


def hash3(x: int, y: int, z: int) -> tuple[int, int, int]:
    """Mix three whole numbers below 2^32 as pcg3d does (Jarzynski and Olano 2020; noise/hash.glsl)."""
    x, y, z = (n * 1664525 + 1013904223 & _MASK for n in (x, y, z))
    x = x + y * z & _MASK
    y = y + z * x & _MASK
    z = z + x * y & _MASK
    x, y, z = x ^ x >> 16, y ^ y >> 16, z ^ z >> 16
    x = x + y * z & _MASK
    y = y + z * x & _MASK
    z = z + x * y & _MASK
    return x, y, z


class Growing:
    """A triangulation that takes points. Triangle t has the corners and neighbours 3 t to 3 t + 2."""

    def __init__(self, rules: Rules) -> None:
        self.rules = rules
        self.sides = _sides(rules.proportion)
        east, north = self.sides
        self.x = [0, east, 0, east]
        self.y = [0, 0, north, north]
        self.heights = list(rules.corners)
        # The edge from south-east to north-west: what lifting the last corner most leaves of the tie.
        self.corners = [0, 1, 2, 1, 3, 2]
        self.across = [1, _OUTSIDE, _OUTSIDE, _OUTSIDE, 0, _OUTSIDE]
        self.greatest: list[tuple[int, tuple[int, int, int], int]] = []  # a heap
        self.destroyed: list[tuple[int, int, int]] = []
        self.replaced = 0
        self._rank((0, 1))

    def insert(self) -> None:
        """Insert the next point into the greatest triangle, and restore what it makes illegal."""
        rules = self.rules
        triangle, area = self._take_greatest()
        point = len(self.x)
        x, y = self.barycentre(triangle, point)
        self.heights.append(self._height(triangle, area, point, x, y))
        self.x.append(x)
        self.y.append(y)
        last = point == rules.points + 3
        if rules.by_flips:
            touched = self._split_and_flip(triangle, point, rules.flips if last else -1)
        else:
            touched = self._destroy_and_construct(triangle, point)
        self._rank(touched)

    def finished(self) -> Triangulation:
        """Return what has grown, its triangles from the greatest on."""
        triples = [self.triple(t) for t in range(len(self.corners) // 3)]
        order = sorted(range(len(triples)), key=lambda t: (-self._area(t), triples[t]))
        index_of = {t: k for k, t in enumerate(order)} | {_OUTSIDE: _OUTSIDE}
        neighbours = []
        for t in order:
            shift = self.corners[3 * t : 3 * t + 3].index(triples[t][0])
            neighbours.append([index_of[self.across[3 * t + (shift + i) % 3]] for i in range(3)])
        return Triangulation(
            self.sides,
            np.array([self.x, self.y], np.int32).T,
            np.array(self.heights, np.float64),
            np.array([triples[t] for t in order], np.int32),
            np.array(neighbours, np.int32),
            np.array(self.destroyed, np.int32).reshape(-1, 3),
            self.replaced,
        )

    # ── where the next point is ──────────────────────────────────────────

    def _take_greatest(self) -> tuple[int, int]:
        """Return the greatest triangle and twice its area, and take it from the heap.

        Entries of triangles that are no more stay in the heap until they come up.
        """
        while True:
            area, triple, triangle = heapq.heappop(self.greatest)
            if self.triple(triangle) == triple:
                return triangle, -area

    def _rank(self, triangles: Iterable[int]) -> None:
        """Put triangles into the heap: by area, then by their points, so that numbering does not count."""
        for t in triangles:
            heapq.heappush(self.greatest, (-self._area(t), self.triple(t), t))

    def barycentre(self, triangle: int, point: int) -> tuple[int, int]:
        """Return the lattice point nearest to a triangle's barycentre, its corners weighed."""
        weights = (1, 1, 1)
        if self.rules.random_weights:  # none below 64/702 of the whole
            a, b, c = self._drawn(point, 1)
            weights = (64 + (a >> 24), 64 + (b >> 24), 64 + (c >> 24))
        whole = sum(weights)
        # In the order that does not depend on how the triangle is stored.
        corners = self.triple(triangle)
        x = sum(w * self.x[c] for w, c in zip(weights, corners, strict=True))
        y = sum(w * self.y[c] for w, c in zip(weights, corners, strict=True))
        return (2 * x + whole) // (2 * whole), (2 * y + whole) // (2 * whole)

    def _drawn(self, point: int, which: int) -> tuple[int, int, int]:
        return hash3(point, which, self.rules.seed + SALT & _MASK)

    def _height(self, triangle: int, area: int, point: int, x: int, y: int) -> float:
        number = (self._drawn(point, 0)[0] >> 8) / 2**24
        if not self.rules.displaced:
            return number
        a, b, c = self.triple(triangle)
        height = 0.0
        for v, (p, q) in ((a, (b, c)), (b, (c, a)), (c, (a, b))):
            part = (self.x[p] - x) * (self.y[q] - y) - (self.x[q] - x) * (self.y[p] - y)
            height += part / area * self.heights[v]
        # As in section 1.3.1: within [-k^r, k^r], k the length of an edge over the side.
        share: float = (area / (2 * self.sides[0] * self.sides[1])) ** (0.5 * self.rules.roughness)
        return height + (2.0 * number - 1.0) * share

    # ── destruction and construction ─────────────────────────────────────────

    def _destroy_and_construct(self, triangle: int, point: int) -> list[int]:
        """Take out every triangle whose circle holds the point, and join the hole's edges to it."""
        corners, across = self.corners, self.across
        first = (corners[3 * triangle], corners[3 * triangle + 1], corners[3 * triangle + 2])
        self.destroyed = [first]
        doomed, stack = {triangle}, [triangle]
        rim: list[tuple[int, int, int]] = []  # an edge, counter-clockwise, and what lies behind it
        while stack:
            t = stack.pop()
            for i in range(3):
                neighbour = across[3 * t + i]
                if neighbour in doomed:
                    continue
                u, v = corners[3 * t + (i + 1) % 3], corners[3 * t + (i + 2) % 3]
                if neighbour == _OUTSIDE or not self._holds(neighbour, point):
                    rim.append((u, v, neighbour))
                    continue
                doomed.add(neighbour)
                stack.append(neighbour)
                self.destroyed.append((u, v, self._opposite(neighbour, u, v)))
        self.replaced = len(self.destroyed) - 1
        # A hole of k triangles has k + 2 edges: their places are taken again, and two more.
        count = len(corners) // 3
        places = [*doomed, count, count + 1]
        corners += [0] * 6
        across += [_OUTSIDE] * 6
        from_, to = {}, {}
        for t, (u, v, behind) in zip(places, rim, strict=True):
            corners[3 * t : 3 * t + 3] = [u, v, point]
            self._join(t, 2, behind, u, v)
            from_[u], to[v] = t, t
        for t, (u, v, _) in zip(places, rim, strict=True):
            across[3 * t], across[3 * t + 1] = from_[v], to[u]
        return places

    # ── flips ────────────────────────────────────────────────────────────────

    def _split_and_flip(self, triangle: int, point: int, limit: int) -> list[int]:
        """Split a triangle in three, then flip illegal edges, no more than ``limit`` unless that is -1.

        Every triangle here has the point last, so the edge to be tested lies across from place 2.
        """
        corners, across = self.corners, self.across
        a, b, c = corners[3 * triangle : 3 * triangle + 3]
        behind = across[3 * triangle : 3 * triangle + 3]
        count = len(corners) // 3
        parts = [triangle, count, count + 1]
        corners += [0] * 6
        across += [_OUTSIDE] * 6
        for i, (u, v) in enumerate(((b, c), (c, a), (a, b))):
            t = parts[i]
            corners[3 * t : 3 * t + 3] = [u, v, point]
            across[3 * t], across[3 * t + 1] = parts[(i + 1) % 3], parts[(i + 2) % 3]
            self._join(t, 2, behind[i], u, v)
        self.destroyed, self.replaced = [(a, b, c)], 0
        touched, stack = list(parts), list(parts)
        while stack:
            t = stack.pop()
            other = across[3 * t + 2]
            if other == _OUTSIDE or not self._holds(other, point):
                continue
            u, v = corners[3 * t], corners[3 * t + 1]
            w = self._opposite(other, u, v)
            self.destroyed.append((u, v, w))
            if self.replaced == limit:
                break
            self.replaced += 1
            self._flip(t, other, w)
            touched.append(other)
            stack += [t, other]
        return touched

    def _flip(self, t: int, other: int, w: int) -> None:
        """Turn the edge u v between t = (u, v, point) and ``other`` into the edge from the point to w."""
        corners, across = self.corners, self.across
        u, v, point = corners[3 * t : 3 * t + 3]
        at_w = corners.index(w, 3 * other, 3 * other + 3) - 3 * other
        # Counter-clockwise, ``other`` is w, v, u: its edges are w v, across from u, and u w, across from v.
        behind_vw = across[3 * other + (at_w + 2) % 3]
        behind_uw = across[3 * other + (at_w + 1) % 3]
        behind_vp, behind_pu = across[3 * t], across[3 * t + 1]
        corners[3 * t : 3 * t + 3] = [u, w, point]
        corners[3 * other : 3 * other + 3] = [w, v, point]
        self._join(t, 0, other, w, point)
        self._join(t, 1, behind_pu, point, u)
        self._join(t, 2, behind_uw, u, w)
        self._join(other, 0, behind_vp, v, point)
        self._join(other, 1, t, point, w)
        self._join(other, 2, behind_vw, w, v)

    # ── triangles ────────────────────────────────────────────────────────────

    def _join(self, t: int, index: int, behind: int, u: int, v: int) -> None:
        """Make two triangles neighbours along the edge u v, which lies across from ``index`` in t."""
        self.across[3 * t + index] = behind
        if behind != _OUTSIDE:
            self.across[3 * behind + self._place_of(behind, u, v)] = t

    def _place_of(self, t: int, u: int, v: int) -> int:
        """Return which of a triangle's corners is neither u nor v."""
        corners = self.corners
        for index in range(3):
            if corners[3 * t + index] not in (u, v):
                return index
        raise AssertionError("a triangle has three corners")

    def _opposite(self, t: int, u: int, v: int) -> int:
        return self.corners[3 * t + self._place_of(t, u, v)]

    def triple(self, t: int) -> tuple[int, int, int]:
        """Return a triangle's points, counter-clockwise, the one that came first in front."""
        a, b, c = self.corners[3 * t : 3 * t + 3]
        if b < a and b < c:
            return b, c, a
        return (c, a, b) if c < a else (a, b, c)

    def _area(self, t: int) -> int:
        """Return twice the area of a triangle, in squares of the lattice."""
        a, b, c = self.corners[3 * t : 3 * t + 3]
        x, y = self.x, self.y
        return (x[b] - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (y[b] - y[a])

    def _holds(self, t: int, point: int) -> bool:
        """Return whether the circle through a triangle's corners holds a point inside, not on it."""
        a, b, c = self.corners[3 * t : 3 * t + 3]
        x, y = self.x, self.y
        px, py = x[point], y[point]
        ax, ay = x[a] - px, y[a] - py
        bx, by = x[b] - px, y[b] - py
        cx, cy = x[c] - px, y[c] - py
        inside = (ax * ax + ay * ay) * (bx * cy - cx * by)
        inside += (bx * bx + by * by) * (cx * ay - ax * cy)
        inside += (cx * cx + cy * cy) * (ax * by - bx * ay)
        return inside > 0


def _sides(proportion: float) -> tuple[int, int]:
    """Return the terrain's sides on the lattice, the longer one ``SIDE``."""
    share = min(proportion, 1.0 / proportion)
    shorter = SIDE // _CELLS * max(round(share * _CELLS), 1)
    return (SIDE, shorter) if proportion <= 1.0 else (shorter, SIDE)

"""Draw points, lines and polygons as a mask: how much of each texel they cover.

A texel's share is worked out from its middle's distance to the nearest edge, as if that edge were straight:
exact where it runs along the texels, within 0.05 elsewhere, but at corners.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import compress

import numpy as np
from numpy.typing import NDArray

from playground.terrain.vectors import Line, Shape

_PIECE = 16.0  # [texels] of a line that are looked at together
_PAIRS = 2**21  # texels and pieces of lines that are compared at a time

Mask = NDArray[np.float32]
Segments = NDArray[np.float64]
"""(n, 2, 2): from and to, each x and y."""


@dataclass(frozen=True)
class Grid:
    """The texels of a mask."""

    size: tuple[int, int]  # east and north
    spacing: tuple[float, float]  # [m] a texel, east and north


def draw(shapes: Sequence[Shape], grid: Grid, width: float, *, filled: bool) -> Mask:
    """Return the shares 0..1 (ny, nx), row 0 in the south, of shapes whose places are in texels.

    Lines are ``width`` metres wide and points discs as wide as that; polygons are ``filled``, or lines.
    """
    mask = np.zeros(grid.size[::-1], np.float32)
    areas = [filled and shape.kind == "polygon" for shape in shapes]
    outlines = [shape for shape, area in zip(shapes, areas, strict=True) if not area]
    _stroke(mask, grid, _segments([line for shape in outlines for line in shape.lines]), 0.5 * width)
    for polygon in compress(shapes, areas):
        _fill(mask, grid, polygon)
    return mask


def _segments(lines: Sequence[Line]) -> Segments:
    """Return the segments of lines; of a single point one of no length."""
    pairs = [
        np.stack([line[:-1], line[1:]], 1) if len(line) > 1 else np.stack([line, line], 1) for line in lines
    ]
    return np.concatenate(pairs) if pairs else np.empty((0, 2, 2))


def _stroke(mask: Mask, grid: Grid, segments: Segments, radius: float) -> None:
    flat = mask.reshape(-1)
    for texels, away, side in _near(grid, segments, radius):
        inner = np.clip((radius - away) / side + 0.5, 0.0, 1.0)
        beyond = np.clip((-radius - away) / side + 0.5, 0.0, 1.0)  # of a line narrower than a texel
        np.maximum.at(flat, texels, (inner - beyond).astype(np.float32))


def _fill(mask: Mask, grid: Grid, polygon: Shape) -> None:
    rings = [np.concatenate([ring, ring[:1]]) for ring in polygon.lines]
    points = np.concatenate(rings)
    most = np.array(grid.size) - 1
    low = np.clip(np.floor(points.min(axis=0)) - 1.0, 0, most).astype(np.intp)
    high = np.clip(np.ceil(points.max(axis=0)) + 1.0, 0, most).astype(np.intp)
    share = _inside(_segments(rings), low, high).astype(np.float32)
    # Near the edge it is the share of the texel on the inner side.
    found = [(texels, away / side) for texels, away, side in _near(grid, _segments(rings), 0.0)]
    if found:
        texels, own = np.unique(np.concatenate([each[0] for each in found]), return_inverse=True)
        steps = np.full(len(texels), np.inf)
        np.minimum.at(steps, own, np.concatenate([each[1] for each in found]))
        y, x = texels // grid.size[0] - low[1], texels % grid.size[0] - low[0]
        share[y, x] = np.clip(0.5 + np.where(share[y, x] > 0.0, steps, -steps), 0.0, 1.0)
    part = mask[low[1] : high[1] + 1, low[0] : high[0] + 1]
    np.maximum(part, share, out=part)


def _inside(segments: Segments, low: NDArray[np.intp], high: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return which texels from low to high (x, y) are inside: west of each is an odd number of edges."""
    across, rows = high - low + 1
    crossings = np.zeros((rows, across + 1), np.int32)
    # An edge crosses the rows from its lower end on, and up to its upper end without that.
    lower, upper = segments[..., 1].min(axis=1), segments[..., 1].max(axis=1)
    first = np.clip(np.ceil(lower) - low[1], 0, rows).astype(np.intp)
    counts = np.clip(np.ceil(upper) - low[1], 0, rows).astype(np.intp) - first
    owner, number = _counted(counts)
    row = first[owner] + number
    (ax, ay), (bx, by) = segments[owner, 0].T, segments[owner, 1].T
    x = ax + (bx - ax) * (row + low[1] - ay) / (by - ay)
    column = np.clip(np.ceil(x) - low[0], 0, across).astype(np.intp)
    np.add.at(crossings, (row, column), 1)
    return np.asarray(np.cumsum(crossings[:, :-1], axis=1) % 2 == 1)


def _near(
    grid: Grid, segments: Segments, radius: float
) -> Iterator[tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.float64]]]:
    """Yield texels near segments: their numbers, the metres to the segment, those across a texel there."""
    spacing, most = np.array(grid.spacing), np.array(grid.size) - 1
    reach = radius / spacing + 1.0
    pieces = _pieces(_clipped(segments, -reach, most + reach))
    low = np.clip(np.ceil(pieces.min(axis=1) - reach), 0, most + 1).astype(np.intp)
    high = np.clip(np.floor(pieces.max(axis=1) + reach), -1, most).astype(np.intp)
    sides = np.maximum(high - low + 1, 0)
    counts = sides[:, 0] * sides[:, 1]
    ends = np.cumsum(counts)
    first = 0
    while first < len(pieces):
        before = ends[first - 1] if first else 0
        last = max(int(np.searchsorted(ends, before + _PAIRS, "right")), first + 1)
        owner, number = _counted(counts[first:last])
        owner += first
        x = low[owner, 0] + number % sides[owner, 0]
        y = low[owner, 1] + number // sides[owner, 0]
        away, side = _distance(np.stack([x, y], 1), pieces[owner], spacing)
        yield y * grid.size[0] + x, away, side
        first = last


def _distance(
    texels: NDArray[np.intp], segments: Segments, spacing: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the metres from each texel to its segment, and those across a texel in that direction."""
    begin, along = segments[:, 0] * spacing, (segments[:, 1] - segments[:, 0]) * spacing
    to = texels * spacing - begin
    square = (along**2).sum(axis=1)
    part = np.clip((to * along).sum(axis=1) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    off = to - part[:, None] * along
    away = np.hypot(off[:, 0], off[:, 1])
    # On the segment itself, at right angles to it.
    across = np.where(away[:, None] > 1e-9 * spacing.min(), off, along[:, ::-1] * (1.0, -1.0))
    length = np.hypot(across[:, 0], across[:, 1])
    unit = across / np.where(length > 0.0, length, 1.0)[:, None]
    side = np.hypot(unit[:, 0] * spacing[0], unit[:, 1] * spacing[1])
    return away, np.where(length > 0.0, side, spacing.min())


def _clipped(segments: Segments, low: NDArray[np.float64], high: NDArray[np.float64]) -> Segments:
    """Return the parts of segments inside a box: Liang and Barsky 1984, ACM Transactions on Graphics 3, 1."""
    begin, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        ways = np.stack([(low - begin) / along, (high - begin) / along])
    still = along == 0.0
    outside = (still & ((begin < low) | (begin > high))).any(axis=1)
    enters = np.where(still, 0.0, ways.min(axis=0)).max(axis=1).clip(0.0)
    leaves = np.where(still, 1.0, ways.max(axis=0)).min(axis=1).clip(None, 1.0)
    there = ~outside & (enters <= leaves)
    begin, along = begin[there], along[there]
    parts = [begin + along * share[there, None] for share in (enters, leaves)]
    return np.stack(parts, 1)


def _pieces(segments: Segments) -> Segments:
    """Return segments cut into pieces of a few texels: there is less to look at around them."""
    length = np.abs(segments[:, 1] - segments[:, 0]).max(axis=1, initial=0.0)
    counts = np.maximum(np.ceil(length / _PIECE), 1.0).astype(np.intp)
    owner, number = _counted(counts)
    step = ((segments[:, 1] - segments[:, 0]) / counts[:, None])[owner]
    begin = segments[owner, 0] + step * number[:, None]
    return np.stack([begin, begin + step], 1)


def _counted(counts: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return, of so many each, whose each is and its number: of 2, 0, 1 they are 0, 0, 2 and 0, 1, 0."""
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)

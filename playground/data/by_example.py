"""Terrain by example: pieces of real terrain quilted along a guide's features, or its ranked heights.

Pieces of the example are placed along the guide's features, from the strongest on, and then between them:
squares from random positions, in eight orientations, their heights about their mean, since a piece may be
placed higher or lower than it was (``quilted``). Where two overlap they are cut along the line on which they
differ least. Of the pieces their slopes are used: of all terrain that has these, as closely as it can, the
result has the guide's wide hills, by a screened Poisson equation (``integrated``). Mirrored in its edges a
field has no step there, and its transform is made of cosines: edges are free.

Sources: Zhou, Sun, Turk and Rehg 2007, "Terrain Synthesis from Digital Elevation Models" (IEEE TVCG 13, 4);
Efros and Freeman 2001, "Image Quilting for Texture Synthesis and Transfer" (SIGGRAPH).

``ranked``, after Heitz and Neyret 2018, "High-Performance By-Example Noise using a Histogram-Preserving
Blending Operator" (Proc. ACM CGIT 1, 2): blended as the numbers of a normal distribution that have their
ranks, and brought back by the sorted heights, heights keep their histogram.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from heapq import heappop, heappush
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.data.elevation import Elevation
from playground.data.resample import resample
from playground.errors import DataError
from playground.memo import SOURCES, bytes_held

Field = NDArray[np.float64]
_LEAST_EXPONENT = -200.0
"""The least exponent: products of two such powers, and of heights, are not too small for a float."""


def smoothed(field: Field, sigma: float) -> Field:
    """Return a field (ny, nx) convolved with a Gaussian of ``sigma`` texels."""
    ny, nx = field.shape
    across, along = (
        np.exp(np.maximum(-2 * (np.pi * sigma * frequency) ** 2, _LEAST_EXPONENT))
        for frequency in (np.fft.rfftfreq(2 * nx), np.fft.fftfreq(2 * ny))
    )
    return _filtered(field, along[:, None] * across)


def integrated(east: Field, north: Field, near: Field, nearness: float) -> Field:
    """Return the field whose gradients are closest to the given ones, and which is close to another.

    It minimises the sum of squares of (z[y, x + 1] - z[y, x] - ``east``), of the same to the north, and
    of (z - ``near``) times ``nearness``, over all texels: a screened Poisson equation (Bhat et al. 2008,
    "Fourier Analysis of the 2D Screened Poisson Equation for Gradient Domain Problems", ECCV). The last
    column of ``east`` and the last row of ``north`` are not read. All are (ny, nx).
    """
    ny, nx = near.shape
    right = -nearness * near
    right[:, :-1] += east[:, :-1]
    right[:, 1:] -= east[:, :-1]
    right[:-1] += north[:-1]
    right[1:] -= north[:-1]
    across = 2 * np.cos(2 * np.pi * np.fft.rfftfreq(2 * nx)) - 2
    along = 2 * np.cos(2 * np.pi * np.fft.fftfreq(2 * ny)) - 2
    return _filtered(right, 1 / (along[:, None] + across - nearness))


def _filtered(field: Field, factors: Field) -> Field:
    """Multiply the transform of the field, mirrored to (2 ny, 2 nx)."""
    ny, nx = field.shape
    mirrored = np.block([[field, field[:, ::-1]], [field[::-1], field[::-1, ::-1]]])
    result: Field = np.fft.irfft2(np.fft.rfft2(mirrored) * factors, s=mirrored.shape)[:ny, :nx]
    return result


Floats = NDArray[np.float32]
_SLIGHT = 0.02  # a difference that does not show
_USED = 0.5  # how much worse a piece counts for each time that it was used
CELLS = 8
"""Cells along a piece's side in which its features are compared."""


def features_of(heights: Field, width: float) -> Field:
    """Return how far each texel is above the terrain around it: ridges above 0, valleys below.

    ``width`` in texels is that of the ridges that count: wider and narrower ones are left out.
    """
    return smoothed(heights, width / 2) - smoothed(heights, 1.5 * width)


def features_both_ways(orientations: list[Field], side: int) -> list[Field]:
    """Return the features of an upright example and of a turned one, for pieces (side, side)."""
    return [features_of(orientation, side / 6) for orientation in (orientations[0], orientations[4])]


def in_cells(field: NDArray[np.floating[Any]]) -> NDArray[np.floating[Any]]:
    """Return the means of CELLS × CELLS parts of squares (…, side, side), as (…, CELLS²)."""
    side = field.shape[-1]
    edges = np.arange(CELLS) * side // CELLS
    sums = np.add.reduceat(np.add.reduceat(field, edges, -1), edges, -2)
    counts = np.diff([*edges, side])
    return np.asarray(sums / np.outer(counts, counts)).reshape(*field.shape[:-2], -1)


def oriented(
    example: Field, spacing: tuple[float, float], spacing_wanted: tuple[float, float]
) -> list[Field]:
    """Return an example in eight orientations, resampled from a spacing to the wanted one [m, m]."""

    def at(metres: tuple[float, float]) -> Field:
        ny, nx = example.shape
        size = [round((n - 1) * d / m) + 1 for n, d, m in zip((nx, ny), spacing, metres, strict=True)]
        if (size[0], size[1]) == (nx, ny):
            return example
        return resample(example, (max(size[0], 2), max(size[1], 2))).astype(np.float64)

    upright, turned = at(spacing_wanted), at((spacing_wanted[1], spacing_wanted[0])).T
    return [each[:: 1 - 2 * y, :: 1 - 2 * x] for each in (upright, turned) for y in (0, 1) for x in (0, 1)]


@dataclass(frozen=True)
class Fit:
    """What is compared of a place in the terrain with every piece."""

    filled: NDArray[np.bool_]  # (side, side) texels that have heights already
    heights: Field  # (side, side) theirs
    features: Field | None = None  # (CELLS²) those that are wanted, in the example's deviations; None: any
    weight: float = 0.0  # of the features, beside the known heights


class Candidates:
    """So many pieces of an example, each (side, side) texels.

    ``features`` is what `features_both_ways` gives, which takes longer than all the rest, where it is known.
    """

    def __init__(
        self,
        orientations: list[Field],
        side: int,
        count: int,
        rng: np.random.Generator,
        features: list[Field] | None = None,
    ) -> None:
        self.side = side
        self.orientations = orientations
        self.which = rng.integers(len(orientations), size=count)
        shapes = np.array([orientation.shape for orientation in orientations])[self.which] - side - 1
        self.corners = (rng.random((count, 2)) * (shapes + 1)).astype(np.intp)  # y, x in its orientation
        features = features or features_both_ways(orientations, side)
        self.deviation = float(features[0].std()) or 1.0
        turned = [*_mirrored(features[0]), *_mirrored(features[1])]
        pieces = np.empty((count, side, side), np.float32)
        cells = np.empty((count, CELLS * CELLS), np.float32)
        for k, (way, (y, x)) in enumerate(zip(self.which, self.corners, strict=True)):
            pieces[k] = orientations[way][y : y + side, x : x + side]
            cells[k] = in_cells(turned[way][y : y + side, x : x + side])
        pieces -= pieces.mean((1, 2), keepdims=True)
        self._heights = pieces.reshape(count, -1)
        self._squares = self._heights**2
        self._cells = cells / self.deviation
        self._uses = np.zeros(count)
        self._of_masks: dict[bytes, tuple[Floats, Floats]] = {}
        self._places = self._in_example()

    def with_border(self, number: int) -> Field:
        """Return the heights of a piece, and of one row and column more, (side + 1, side + 1)."""
        y, x = self.corners[number]
        side = self.side + 1
        whole: Field = self.orientations[self.which[number]]
        return whole[y : y + side, x : x + side]

    def best(self, fit: Fit) -> int:
        """Return the number of the piece that fits best, and note that it is used.

        The difference to the known heights counts relative to the variances of both, or flat pieces would
        always win; and pieces that were used already, in part too, count as worse.
        """
        errors = np.zeros(len(self._heights))
        count = int(fit.filled.sum())
        if count:
            mask = fit.filled.astype(np.float32).ravel()
            sums, squares = self._over(mask)
            heights = np.where(fit.filled, fit.heights, 0.0)
            heights -= heights.sum() / count * fit.filled
            products = self._heights @ heights.astype(np.float32).ravel()
            own = squares - sums**2 / count
            others = float((heights**2).sum())
            errors += (own + others - 2 * products) / (own + others + 1e-6)
        if fit.features is not None and fit.weight > 0:
            weights = abs(fit.features)
            away = (self._cells - fit.features.astype(np.float32)) ** 2
            whole = float((weights * fit.features**2).sum())
            errors += fit.weight * (away @ weights.astype(np.float32)) / whole
        errors = (errors + _SLIGHT) * (1 + _USED * self._uses)
        number = int(errors.argmin())
        away = abs(self._places - self._places[number]) / self.side
        self._uses += np.maximum(1 - away, 0).prod(1)
        return number

    def _over(self, mask: Floats) -> tuple[Floats, Floats]:
        """Return the sums of each piece's heights and of their squares, over a mask; few masks recur."""
        key = np.packbits(mask > 0).tobytes()
        if key not in self._of_masks:
            self._of_masks[key] = self._heights @ mask, self._squares @ mask
        return self._of_masks[key]

    def _in_example(self) -> Field:
        """Return the middles of the pieces in the upright example, (count, 2) in its texels."""
        positions = np.empty((len(self.which), 2))
        ny, nx = self.orientations[0].shape
        for k, (way, corner) in enumerate(zip(self.which, self.corners, strict=True)):
            shape = np.array(self.orientations[way].shape)
            middle = corner + self.side / 2
            south, west = way % 4 >= 2, way % 2 == 1
            middle = np.where([south, west], shape - middle, middle)
            if way >= 4:  # turned: its rows are the example's columns
                middle = (middle / shape)[::-1] * (ny, nx)
            positions[k] = middle
        return positions


def _mirrored(field: Field) -> list[Field]:
    return [field[:: 1 - 2 * y, :: 1 - 2 * x] for y in (0, 1) for x in (0, 1)]


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
    report: Callable[[int, int], None] = lambda done, total: None,
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
    filled = np.zeros(shape, bool)
    total = np.zeros((rows, columns, CELLS * CELLS))
    if features is not None:
        whole = np.pad(features, ((0, max(shape[0] - ny, 0)), (0, max(shape[1] - nx, 0))), mode="edge")
        for j in range(rows):
            for i in range(columns):
                part = whole[j * step : j * step + side, i * step : i * step + side]
                total[j, i] = in_cells(part)
    strength = np.sqrt((total**2).mean(-1))
    is_placed = np.zeros((rows, columns), bool)
    for done, (j, i) in enumerate(filling_order(strength)):
        report(done, rows * columns)
        slices = slice(j * step, j * step + side), slice(i * step, i * step + side)
        strong = min(strength[j, i], 1.0)
        fit = Fit(
            filled[slices],
            quilt.heights[slices],
            total[j, i] if strong > WEAK else None,
            weight * strong,
        )
        number = candidates.best(fit)
        beside = [_is_placed(is_placed, j + dj, i + di) for dj, di in _SIDES]
        _put(quilt, filled, slices, candidates.with_border(number), overlap, beside)
        is_placed[j, i] = True
    cut = slice(ny), slice(nx)
    return Quilt(quilt.heights[cut], quilt.east[cut], quilt.north[cut])


WEAK = 0.25
"""Features of less than so many deviations are none."""


def filling_order(strength: Field) -> Iterator[tuple[int, int]]:
    """Yield all places: the strongest first, then always one beside those, the strongest of them.

    Of equally strong ones first that with the most beside it, then the southernmost, then the westernmost.
    Features that are strong but not beside any place begin another line before weak places are filled.
    """
    rows, columns = strength.shape
    strong = np.where(strength > WEAK, strength, 0.0).tolist()
    waiting = {(j, i) for j in range(rows) for i in range(columns)}

    def rank(cell: tuple[int, int]) -> tuple[float, int, int, int]:
        """Return what is least for the place that comes first; it falls as places beside it are filled."""
        j, i = cell
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
        cell = (heappop(border) if follows else begins.pop())[2:]
        waiting.remove(cell)
        for dj, di in _SIDES:
            if (beside := (cell[0] + dj, cell[1] + di)) in waiting:
                heappush(border, rank(beside))
        yield cell


def _is_placed(array: NDArray[np.bool_], j: int, i: int) -> bool:
    return 0 <= j < array.shape[0] and 0 <= i < array.shape[1] and bool(array[j, i])


def _put(
    quilt: Quilt,
    filled: NDArray[np.bool_],
    slices: tuple[slice, slice],
    piece: Field,
    overlap: int,
    beside: list[bool],
) -> None:
    """Put a piece (side + 1, side + 1) in its place, at the height of what is there, cut to its neighbours.

    ``beside`` says whether there is a piece to the west, east, south and north.
    """
    there, old, heights = filled[slices], quilt.heights[slices], piece[:-1, :-1]
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
    quilt.heights[slices][taken] = heights[taken]
    quilt.east[slices][taken] = np.diff(piece, axis=1)[:-1][taken]
    quilt.north[slices][taken] = np.diff(piece, axis=0)[:, :-1][taken]
    filled[slices] = True


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


_MIN_PIECE, _MAX_PIECE = 12, 192  # texels of a piece's side
_BYTES = 2**26  # that the pieces may take
_OVERLAP = 3  # a piece overlaps the next by a third of it
_WEIGHT = 8.0  # of features that are followed wholly, beside the overlaps
_BEFORE, _STEPS = 3, 6  # resampling, cutting out, features; with what comes after the pieces are laid


@dataclass(frozen=True)
class SynthesisSettings:
    """What is made of an example."""

    piece: float = 3840.0  # [m] side of the pieces
    candidates: int = 2000  # pieces to choose from
    follow: float = 0.5  # 0..1, the guide's weight
    seed: int = 1


def made_like(
    example: Elevation,
    spacing_of_example: tuple[float, float],
    size: tuple[int, int],
    spacing: tuple[float, float],
    settings: SynthesisSettings,
    guide: Field | None = None,
    report: Callable[[int, int], None] = lambda done, total: None,
) -> Field:
    """Return heights (ny, nx), in the example's unit, about 0; row 0 is south.

    ``size`` is (nx, ny) and the spacings are in metres, east and north. ``guide`` is a picture of any size:
    what is lighter than around it is a ridge, what is darker a valley.
    Raises ``DataError`` for an example that is smaller than a piece.
    """
    report(0, _STEPS)
    rng = np.random.default_rng(settings.seed)
    ways = _ways(example, spacing_of_example, spacing)
    side = _side(settings, spacing, ways, example)
    report(1, _STEPS)
    of_example = _features(example, spacing_of_example, spacing, side)
    pieces = Candidates(ways, side, _count(settings, side), rng, of_example)
    report(2, _STEPS)
    hills = _guide(guide, size)
    features = features_of(hills, side / 6) if hills is not None and settings.follow > 0 else None
    if features is not None and (deviation := float(features.std())) > 0:
        features = features / deviation
    laid = 0

    def laying(done: int, total: int) -> None:
        nonlocal laid
        laid = total
        report(done + _BEFORE, total + _STEPS)

    quilt = quilted(
        pieces,
        size,
        max(side // _OVERLAP, 1),
        features=features,
        weight=_WEIGHT * settings.follow,
        report=laying,
    )
    report(laid + _BEFORE, laid + _STEPS)
    near, nearness = quilt.heights, (0.15 / side) ** 2
    if features is not None and hills is not None:
        wide = smoothed(hills, side / 6)
        deviation = float(smoothed(ways[0], side / 6).std()) / (float(wide.std()) or 1.0)
        near, nearness = (wide - wide.mean()) * deviation, 2 * settings.follow * (1.5 / side) ** 2
    report(laid + _BEFORE + 1, laid + _STEPS)
    field = integrated(quilt.east, quilt.north, near, nearness)
    report(laid + _BEFORE + 2, laid + _STEPS)
    return field


@SOURCES.cached(weight=bytes_held)
def _ways(
    example: Elevation, spacing_of_example: tuple[float, float], spacing: tuple[float, float]
) -> list[Field]:
    """Return the example's orientations; the same ones for another seed, size or guide."""
    return oriented(example.heights.astype(np.float64), spacing_of_example, spacing)


@SOURCES.cached(weight=bytes_held)
def _features(
    example: Elevation, spacing_of_example: tuple[float, float], spacing: tuple[float, float], side: int
) -> list[Field]:
    """Return the features of the example's orientations, likewise; another side of the pieces has others."""
    return features_both_ways(_ways(example, spacing_of_example, spacing), side)


def _side(
    settings: SynthesisSettings, spacing: tuple[float, float], ways: list[Field], example: Elevation
) -> int:
    """Return the texels of a piece's side."""
    side = int(np.clip(round(settings.piece / np.sqrt(spacing[0] * spacing[1])), _MIN_PIECE, _MAX_PIECE))
    least = min(min(way.shape) for way in ways)
    if least < side + 2:
        ny, nx = ways[0].shape
        message = (
            f"the example has {nx} x {ny} texels of this terrain's spacing, and pieces of {side} need"
            f" {side + 2} at least: smaller pieces, a larger example or more texels would do"
        )
        raise DataError(message, file=example.path or example.name)
    return side


def _count(settings: SynthesisSettings, side: int) -> int:
    return max(min(settings.candidates, _BYTES // (8 * side * side)), 1)


def _guide(guide: Field | None, size: tuple[int, int]) -> Field | None:
    """Return the guide in the terrain's size; None for none, and for one that is the same everywhere."""
    if guide is None or min(guide.shape) < 2 or not np.isfinite(guide).all() or np.ptp(guide) == 0:
        return None
    if guide.shape[::-1] == size:
        return guide.astype(np.float64)
    return resample(guide, size).astype(np.float64)


_RANKED_STEPS = 5  # resampling, smoothing, sorting, the deviates, and what is left


def ranked(
    example: Field | None,
    size: tuple[int, int],
    widest: float,
    report: Callable[[int, int], None] = lambda done, total: None,
) -> tuple[Field, Field]:
    """Return the normal deviate of each rank, and the heights sorted, of an example in a size (nx, ny).

    Both (ny, nx) in float64; the sorted heights begin with the lowest, row by row. Hills wider than the
    fraction ``widest`` of the width are taken out first; 0 leaves all. Without an example all is 0.
    """
    nx, ny = size
    report(0, _RANKED_STEPS)
    heights = np.zeros((ny, nx)) if example is None else example
    heights = np.nan_to_num(np.asarray(heights, np.float64), posinf=0.0, neginf=0.0)
    if heights.shape != (ny, nx):
        heights = resample(heights, size).astype(np.float64) if min(heights.shape) > 1 else np.zeros((ny, nx))
    report(1, _RANKED_STEPS)
    if widest > 0:
        heights = heights - smoothed(heights, widest * nx / 4)  # a hill is some four deviations wide
    report(2, _RANKED_STEPS)
    order = heights.ravel().argsort(kind="stable")
    report(3, _RANKED_STEPS)
    ranks = np.empty(order.size)
    ranks[order] = np.arange(order.size)
    normal = normal_deviate((ranks + 0.5) / order.size)
    report(4, _RANKED_STEPS)
    return normal.reshape(ny, nx), heights.ravel()[order].reshape(ny, nx)


def normal_deviate(share: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the number below which a fraction of a normal distribution lies, to 1e-8.

    Source: P. J. Acklam 2003, "An algorithm for computing the inverse normal cumulative distribution
    function": rational functions, near each end of the square root of -2 log.
    """
    a = (-39.6968302866538, 220.946098424521, -275.928510446969, 138.357751867269, -30.6647980661472)
    b = (-54.4760987982241, 161.585836858041, -155.698979859887, 66.8013118877197, -13.2806815528857)
    c = (-0.00778489400243029, -0.322396458041136, -2.40075827716184, -2.54973253934373, 4.37466414146497)
    d = (0.00778469570904146, 0.32246712907004, 2.445134137143, 3.75440866190742)
    tail = np.minimum(share, 1 - share)
    q = np.sqrt(-2 * np.log(tail))
    outer = np.polyval([*c, 2.938163982698783], q) / np.polyval([*d, 1.0], q)
    middle = share - 0.5
    r = middle**2
    inner = np.polyval([*a, 2.506628277459239], r) * middle / np.polyval([*b, 1.0], r)
    deviates: NDArray[np.float64] = np.where(tail < 0.02425, np.copysign(outer, middle), inner)
    return deviates

"""Pieces of an example that may be put into a terrain, and how well each would fit.

Squares of it at random places, turned and mirrored: eight orientations. The heights of each are about
their mean, since a piece may be put higher or lower than it was.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.terrain.example.mirrored import smoothed
from playground.terrain.resample import resample

Floats = NDArray[np.float32]
Field = NDArray[np.float64]
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
    return [features_of(one, side / 6) for one in (orientations[0], orientations[4])]


def in_cells(field: NDArray[np.floating[Any]]) -> NDArray[np.floating[Any]]:
    """Return the means of CELLS × CELLS parts of squares (…, side, side), as (…, CELLS²)."""
    side = field.shape[-1]
    edges = np.arange(CELLS) * side // CELLS
    sums = np.add.reduceat(np.add.reduceat(field, edges, -1), edges, -2)
    counts = np.diff([*edges, side])
    return np.asarray(sums / np.outer(counts, counts)).reshape(*field.shape[:-2], -1)


def oriented(example: Field, spacing: tuple[float, float], wanted: tuple[float, float]) -> list[Field]:
    """Return an example in eight orientations, resampled from a spacing to the wanted one [m, m]."""

    def at(metres: tuple[float, float]) -> Field:
        ny, nx = example.shape
        size = [round((n - 1) * d / m) + 1 for n, d, m in zip((nx, ny), spacing, metres, strict=True)]
        if (size[0], size[1]) == (nx, ny):
            return example
        return resample(example, (max(size[0], 2), max(size[1], 2))).astype(np.float64)

    upright, turned = at(wanted), at((wanted[1], wanted[0])).T
    return [each[:: 1 - 2 * y, :: 1 - 2 * x] for each in (upright, turned) for y in (0, 1) for x in (0, 1)]


@dataclass(frozen=True)
class Fit:
    """What is compared of a place in the terrain with every piece."""

    known: NDArray[np.bool_]  # (side, side) texels that have heights already
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
        shapes = np.array([one.shape for one in orientations])[self.which] - side - 1
        self.corners = (rng.random((count, 2)) * (shapes + 1)).astype(np.intp)  # y, x in its orientation
        features = features or features_both_ways(orientations, side)
        self.deviation = float(features[0].std()) or 1.0
        turned = [*_mirrored(features[0]), *_mirrored(features[1])]
        found = np.empty((count, side, side), np.float32)
        cells = np.empty((count, CELLS * CELLS), np.float32)
        for k, (way, (y, x)) in enumerate(zip(self.which, self.corners, strict=True)):
            found[k] = orientations[way][y : y + side, x : x + side]
            cells[k] = in_cells(turned[way][y : y + side, x : x + side])
        found -= found.mean((1, 2), keepdims=True)
        self._heights = found.reshape(count, -1)
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
        count = int(fit.known.sum())
        if count:
            mask = fit.known.astype(np.float32).ravel()
            sums, squares = self._over(mask)
            given = np.where(fit.known, fit.heights, 0.0)
            given -= given.sum() / count * fit.known
            products = self._heights @ given.astype(np.float32).ravel()
            own = squares - sums**2 / count
            others = float((given**2).sum())
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
        found = np.empty((len(self.which), 2))
        ny, nx = self.orientations[0].shape
        for k, (way, corner) in enumerate(zip(self.which, self.corners, strict=True)):
            shape = np.array(self.orientations[way].shape)
            middle = corner + self.side / 2
            south, west = way % 4 >= 2, way % 2 == 1
            middle = np.where([south, west], shape - middle, middle)
            if way >= 4:  # turned: its rows are the example's columns
                middle = (middle / shape)[::-1] * (ny, nx)
            found[k] = middle
        return found


def _mirrored(field: Field) -> list[Field]:
    return [field[:: 1 - 2 * y, :: 1 - 2 * x] for y in (0, 1) for x in (0, 1)]

"""Make terrain like an example, along the ridges and valleys of a guide.

Pieces of the example are laid along the guide's features and then between them (``quilt``). What is kept of
them are their slopes; of all terrain that has these, as closely as it can, the one is found whose wide hills
are the guide's: a screened Poisson equation (``mirrored.integrated``).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.terrain.elevation import Elevation
from playground.terrain.example.candidates import Candidates, features_both_ways, features_of, oriented
from playground.terrain.example.mirrored import integrated, smoothed
from playground.terrain.example.quilt import quilted
from playground.terrain.resample import resample

Field = NDArray[np.float64]
_LEAST, _MOST = 12, 192  # texels of a piece's side
_BYTES = 2**26  # that the pieces may take
_OVERLAP = 3  # a piece overlaps the next by a third of it
_WEIGHT = 8.0  # of features that are followed wholly, beside the overlaps
_BEFORE, _STEPS = 3, 6  # resampling, cutting out, features; with what comes after the pieces are laid


@dataclass(frozen=True)
class Wishes:
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
    wishes: Wishes,
    guide: Field | None = None,
    report: Callable[[int, int], None] = lambda done, wanted: None,
) -> Field:
    """Return heights (ny, nx), in the example's unit, about 0; row 0 is south.

    ``size`` is (nx, ny) and the spacings are in metres, east and north. ``guide`` is a picture of any size:
    what is lighter than around it is a ridge, what is darker a valley.
    Raises ``DataError`` for an example that is smaller than a piece.
    """
    report(0, _STEPS)
    rng = np.random.default_rng(wishes.seed)
    ways = _ways(example, spacing_of_example, spacing)
    side = _side(wishes, spacing, ways, example)
    report(1, _STEPS)
    known = _features(example, spacing_of_example, spacing, side)
    pieces = Candidates(ways, side, _count(wishes, side), rng, known)
    report(2, _STEPS)
    hills = _guide(guide, size)
    features = features_of(hills, side / 6) if hills is not None and wishes.follow > 0 else None
    if features is not None and (deviation := float(features.std())) > 0:
        features = features / deviation
    laid = 0

    def laying(done: int, wanted: int) -> None:
        nonlocal laid
        laid = wanted
        report(done + _BEFORE, wanted + _STEPS)

    quilt = quilted(
        pieces,
        size,
        max(side // _OVERLAP, 1),
        features=features,
        weight=_WEIGHT * wishes.follow,
        report=laying,
    )
    report(laid + _BEFORE, laid + _STEPS)
    near, nearness = quilt.heights, (0.15 / side) ** 2
    if features is not None and hills is not None:
        wide = smoothed(hills, side / 6)
        deviation = float(smoothed(ways[0], side / 6).std()) / (float(wide.std()) or 1.0)
        near, nearness = (wide - wide.mean()) * deviation, 2 * wishes.follow * (1.5 / side) ** 2
    report(laid + _BEFORE + 1, laid + _STEPS)
    found = integrated(quilt.east, quilt.north, near, nearness)
    report(laid + _BEFORE + 2, laid + _STEPS)
    return found


@lru_cache(maxsize=2)
def _ways(
    example: Elevation, spacing_of_example: tuple[float, float], spacing: tuple[float, float]
) -> list[Field]:
    """Return the example's orientations; the same ones for another seed, size or guide."""
    return oriented(example.heights.astype(np.float64), spacing_of_example, spacing)


@lru_cache(maxsize=1)
def _features(
    example: Elevation, spacing_of_example: tuple[float, float], spacing: tuple[float, float], side: int
) -> list[Field]:
    """Return the features of the example's orientations, likewise; another side of the pieces has others."""
    return features_both_ways(_ways(example, spacing_of_example, spacing), side)


def _side(wishes: Wishes, spacing: tuple[float, float], ways: list[Field], example: Elevation) -> int:
    """Return the texels of a piece's side."""
    side = int(np.clip(round(wishes.piece / np.sqrt(spacing[0] * spacing[1])), _LEAST, _MOST))
    least = min(min(way.shape) for way in ways)
    if least < side + 2:
        ny, nx = ways[0].shape
        message = (
            f"the example has {nx} x {ny} texels of this terrain's spacing, and pieces of {side} need"
            f" {side + 2} at least: smaller pieces, a larger example or more texels would do"
        )
        raise DataError(message, file=example.path or example.name)
    return side


def _count(wishes: Wishes, side: int) -> int:
    return max(min(wishes.candidates, _BYTES // (8 * side * side)), 1)


def _guide(guide: Field | None, size: tuple[int, int]) -> Field | None:
    """Return the guide in the terrain's size; None for none, and for one that is the same everywhere."""
    if guide is None or min(guide.shape) < 2 or not np.isfinite(guide).all() or np.ptp(guide) == 0:
        return None
    if guide.shape[::-1] == size:
        return guide.astype(np.float64)
    return resample(guide, size).astype(np.float64)

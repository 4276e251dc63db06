"""What came of judging a work: a result for each check, points, and how pictures differ."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from playground.course.model import Check
from playground.errors import Diagnostic

Picture = NDArray[np.uint8]
"""(h, w, 3), top row first."""


@dataclass(frozen=True, eq=False)
class CheckResult:
    """What came of one check."""

    check: Check
    passed: bool
    # Fraction of the pixels that differ, or the largest difference of a texel; of a measure its
    # value, NaN where it has none.
    difference: float = 0.0
    bias: float = 0.0  # mean of the work's minus the answer's: levels of 255, or the texture's unit
    region: str = ""  # where most of it differs, as "top-left" or "middle"; "": in no third of it
    not_finite: int = 0  # texels of the work that are no numbers
    sizes: tuple[tuple[int, ...], tuple[int, ...]] | None = None  # the work's and the answer's, if not equal
    mistake: str = ""  # why it could not be drawn at these values
    # The work and what is asked for, to compare; those of a check that is hidden are for the teacher.
    mine: Picture | None = None
    expected: Picture | None = None


@dataclass(frozen=True, eq=False)
class Verdict:
    """What came of a work."""

    results: tuple[CheckResult, ...]
    diagnostics: tuple[Diagnostic, ...]  # why nothing could be drawn: then there are no results
    points: float
    of: int  # points

    @property
    def passed(self) -> bool:
        """Whether it has all points."""
        return self.points == self.of

    @property
    def visible(self) -> tuple[CheckResult, ...]:
        """The results whose pictures a student may see."""
        return tuple(result for result in self.results if not result.check.hidden)


LEVELS = 3
"""Levels of 255 that no eye sees."""

SHARE = 0.002
"""Share of all pixels that may differ by more in pictures that are the same."""


def differing(first: NDArray[np.uint8], other: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Return which pixels of two pictures (h, w, 3 or 4) of one size differ in a colour; alpha aside."""
    apart = np.abs(first[..., :3].astype(np.int16) - other[..., :3])
    differs: NDArray[np.bool_] = apart.max(axis=-1) > LEVELS
    return differs


def share_differing(first: NDArray[np.uint8], other: NDArray[np.uint8]) -> float:
    """Return the fraction of the pixels that differ, 0..1; 1 for pictures of two sizes."""
    return float(differing(first, other).mean()) if first.shape[:2] == other.shape[:2] else 1.0


def mean_difference(first: NDArray[np.uint8], other: NDArray[np.uint8]) -> float:
    """Return the mean absolute difference of two pictures of one size in red, green and blue, in levels."""
    return float(np.abs(first[..., :3].astype(np.float64) - other[..., :3]).mean())


def difference_map(mine: Picture, expected: Picture) -> Picture:
    """Return the pixels that differ in white to red, by how much, over the dimmed picture asked for."""
    apart = np.abs(mine.astype(np.int16) - expected).max(axis=-1)
    picture: Picture = (expected.mean(axis=-1, keepdims=True) * 0.35).astype(np.uint8).repeat(3, axis=-1)
    where = differing(mine, expected)
    strong = np.clip(apart[where] * 2 + 80, 0, 255).astype(np.uint8)
    picture[where] = np.stack([np.full_like(strong, 255), 255 - strong, 255 - strong], axis=-1)
    return picture


def score(target: Picture, begin: Picture, mine: Picture) -> float:
    """Return 100 for the picture asked for, 0 for the one to begin from or one farther off, else between.

    Pictures are uint8 (h, w, 3 or 4) of one size; between them the score is linear in the mean absolute
    difference of the colours. Raises ``ValueError`` for pictures of several sizes.
    """
    if len({picture.shape[:2] for picture in (target, begin, mine)}) > 1:
        raise ValueError("pictures that are compared have one size")
    if share_differing(target, mine) <= SHARE:
        return 100.0
    whole = mean_difference(target, begin)
    return 100.0 * max(0.0, 1.0 - mean_difference(target, mine) / whole) if whole else 0.0

"""What came of judging a work: a result for each check, and points."""

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

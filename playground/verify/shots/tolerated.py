"""Apply the tolerance that a shot declares, which may let noise pass but no change of what is shown.

A tolerance bounds how much a pixel may differ, and how many pixels may. By these alone a picture
without its shadows could pass a wide one. So two bounds hold for every tolerance, whatever it says:

    scattered or unbiased   In each 32 × 32 pixels, either few differ by more than a level (one in
                            twenty), or what they differ by cancels: the sum of n differences is within
                            6 times the root of the sum of their squares. For independent noise
                            that is six standard deviations, of any distribution that is symmetric.
                            n equal differences reach √n times, more than 6 from 37 pixels on: so a
                            shadow that is lost, or a hue that shifts, fails however faint it is.
    not seen                FLIP is below the bounds between renderers: a pattern that is moved,
                            whose differences cancel too, shows there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from playground.sketch.model import Tolerance
from playground.verify.shots.compare import TOLERANCE, sums_of_windows
from playground.verify.shots.flip import flip

WINDOW = 32
"""[pixels] Side of the windows."""

OUTLIER_WINDOW = 20
"""One pixel of so many in a window may differ in any way."""

DEVIATIONS = 6.0
"""[standard deviations] By which the sum of the differences in a window may be off zero."""


@dataclass(frozen=True, slots=True)
class Tolerated:
    """Whether a tolerance lets a picture pass."""

    why_not: str  # "" where it does
    crowded: bool = False  # whether it is for differences that lie together


def tolerated(
    actual: NDArray[np.uint8],
    expected: NDArray[np.uint8],
    tolerance: Tolerance,
    bounds: tuple[float, float],
    hidden: int = 0,
) -> Tolerated:
    """Hold a picture to a tolerance, both uint8 (height, width, 4) and of one size.

    ``bounds`` are of FLIP, on average and in the worst tile; ``hidden`` is how many pixels are masked,
    which are the same in both.
    """
    signed = actual.astype(np.int16) - expected
    most = int(np.abs(signed).max())
    if most > tolerance.levels:
        return Tolerated(f"the tolerance allows {tolerance.levels}")
    over = (np.abs(signed) > TOLERANCE).any(axis=2)
    share = np.count_nonzero(over) / (over.size - hidden)
    if share > tolerance.share:
        return Tolerated(f"the tolerance allows {100 * tolerance.share:g} %")
    if corner := _biased(np.where(over[..., None], signed, 0), over):
        x, y = corner
        return Tolerated(
            f"it is no noise: in the {WINDOW} × {WINDOW} pixels at x = {x}, y = {y} from the top left many "
            "differ, and the same way, which no tolerance lets pass",
            crowded=True,
        )
    seen = flip(actual, expected)
    tile, (x, y) = seen.worst_tile()
    if seen.mean > bounds[0] or tile > bounds[1]:
        return Tolerated(
            f"an eye sees it: FLIP {seen.mean:.3f} on average, {tile:.3f} at x = {x}, y = {y} from the top "
            f"left; with any tolerance at most {bounds[0]:g} and {bounds[1]:g} may be"
        )
    return Tolerated("")


def _biased(signed: NDArray[np.int16], over: NDArray[np.bool_]) -> tuple[int, int] | None:
    """Return x and y of the window whose differences are the most biased, if that is too much."""
    counts = sums_of_windows(over, WINDOW)
    area = min(WINDOW, over.shape[0]) * min(WINDOW, over.shape[1])
    many = counts > area // OUTLIER_WINDOW
    if not many.any():
        return None
    worst, corner = 0.0, (0, 0)
    for channel in np.moveaxis(signed.astype(np.float64), 2, 0):
        sums, squares = sums_of_windows(channel, WINDOW), sums_of_windows(channel * channel, WINDOW)
        ratio = np.where(many, np.abs(sums) / np.sqrt(np.maximum(squares, 1.0)), 0.0)
        if float(ratio.max()) > worst:
            worst = float(ratio.max())
            y, x = divmod(int(ratio.argmax()), ratio.shape[1])
            corner = (x, y)
    return corner if worst > DEVIATIONS else None

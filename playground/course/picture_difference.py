"""How much two pictures differ, as an eye sees it.

The same formula may be written in another order, which moves a float's last digit and so a pixel
by a level, or an edge by a pixel. What is asked for is a picture that nobody could tell from the
right one. The page runtime has the same numbers (``picture_check.js``).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

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

"""Show where two pictures differ."""

from __future__ import annotations

import numpy as np

from playground.course.picture_difference import differing
from playground.course.tasks.verdict import Picture


def difference_map(mine: Picture, expected: Picture) -> Picture:
    """Return the pixels that differ in white to red, by how much, over the dimmed picture asked for."""
    apart = np.abs(mine.astype(np.int16) - expected).max(axis=-1)
    picture: Picture = (expected.mean(axis=-1, keepdims=True) * 0.35).astype(np.uint8).repeat(3, axis=-1)
    where = differing(mine, expected)
    strong = np.clip(apart[where] * 2 + 80, 0, 255).astype(np.uint8)
    picture[where] = np.stack([np.full_like(strong, 255), 255 - strong, 255 - strong], axis=-1)
    return picture

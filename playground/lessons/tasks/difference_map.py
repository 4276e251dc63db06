"""Show where two pictures differ."""

from __future__ import annotations

import numpy as np

from playground.lessons.picture_difference import differing
from playground.lessons.tasks.verdict import Picture


def difference_map(mine: Picture, wanted: Picture) -> Picture:
    """Return the pixels that differ in white to red, by how much, over the dimmed picture asked for."""
    apart = np.abs(mine.astype(np.int16) - wanted).max(axis=-1)
    found: Picture = (wanted.mean(axis=-1, keepdims=True) * 0.35).astype(np.uint8).repeat(3, axis=-1)
    where = differing(mine, wanted)
    strong = np.clip(apart[where] * 2 + 80, 0, 255).astype(np.uint8)
    found[where] = np.stack([np.full_like(strong, 255), 255 - strong, 255 - strong], axis=-1)
    return found

"""How near a picture is to that of a challenge: a score from 0 to 100."""

from __future__ import annotations

from playground.course.picture_difference import SHARE, mean_difference, share_differing
from playground.course.tasks.verdict import Picture


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

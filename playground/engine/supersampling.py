"""Say how large a picture is drawn that is reduced afterwards."""

from __future__ import annotations

from playground.engine.plan_request import checked_pixels
from playground.sketch.model import LARGEST_SIDE, Sketch


def drawn_size(sketch: Sketch, size: tuple[int, int], largest: int = LARGEST_SIDE) -> tuple[int, int]:
    """Return the pixels in which a picture of a size is drawn; raise ``ParameterError`` for too many.

    ``largest``: the most that a side may be drawn with.
    """
    times = sketch.supersample
    width, height = checked_pixels(size, largest // times)
    return width * times, height * times

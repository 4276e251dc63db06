"""Read the mask that a test in Python gives: rectangles, paths, textures of the sketch, arrays."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from playground.sketch.toml_sketch import MASK_ENDING
from playground.verify.shots.adapters import taken
from playground.verify.shots.masking import Light, Rectangle


class MaskOfTest:
    """What a test hides of a picture. Raises ``ValueError`` for what is no mask."""

    def __init__(self, mask: object) -> None:
        __tracebackhide__ = True
        self.named: tuple[Rectangle | str, ...] = ()  # rectangles, and paths from the test file's folder
        self.textures: tuple[str, ...] = ()  # of the sketch
        self.arrays: tuple[Light, ...] = ()
        if isinstance(mask, Sequence) and not isinstance(mask, str) and _rectangle(mask) is None:
            for item in mask:
                self._add(item)
        elif mask is not None:
            self._add(mask)

    def _add(self, item: object) -> None:
        __tracebackhide__ = True
        rectangle = _rectangle(item)
        if rectangle:
            self.named += (rectangle,)
        elif isinstance(item, Path) or (isinstance(item, str) and item.endswith(MASK_ENDING)):
            self.named += (str(item),)
        elif isinstance(item, str):
            self.textures += (item,)
        elif hasattr(item, "__array__") or hasattr(item, "__array_interface__"):
            self.arrays += (Light(taken(item).values),)
        else:
            raise ValueError(
                f"mask = {item!r}: expected a rectangle (x, y, width, height) in pixels, the path of a PNG, "
                "a texture of the sketch, an array, or a list of such"
            )


def _rectangle(item: object) -> Rectangle | None:
    if not isinstance(item, Sequence) or isinstance(item, str) or len(item) != 4:
        return None
    if not all(isinstance(value, int | np.integer) for value in item):
        return None
    __tracebackhide__ = True
    x, y, width, height = (int(value) for value in item)
    if width < 1 or height < 1:
        raise ValueError(f"mask = {item!r}: a rectangle is (x, y, width, height), of a pixel or more")
    return x, y, width, height

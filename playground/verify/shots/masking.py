"""Leave parts of a picture out of its comparison: rectangles, the light parts of an image, an array.

A mask hides pixels: they count as equal to the reference's. One that hides everything, or
nothing, is refused; what it hides is counted and shown.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.data.image_files import read_png
from playground.errors import DataError
from playground.paths import shown

Rectangle = tuple[int, int, int, int]
"""x, y, width and height, in pixels from the top left."""

Mask = NDArray[np.bool_]
"""(height, width), top row first; true where a pixel is hidden."""


@dataclass(frozen=True, eq=False)
class Light:
    """An array that hides where it is light."""

    values: NDArray[Any]  # (height, width), or with channels; top row first
    name: str = "an array"  # or the texture's


STRIPES = 8
"""[pixels] Width of the stripes that show what is hidden."""


def mask_of(items: Iterable[Sequence[int] | str | Light], size: tuple[int, int], folder: Path) -> Mask | None:
    """Return what rectangles, images and arrays hide of a picture of ``size``, width and height.

    A rectangle is x, y, width and height in pixels from the top left; an image, a path from ``folder``,
    and an array with its name hide where they are lighter than half, and have the picture's size. None for
    no items.
    Raises ``DataError``, also where everything or nothing is hidden.
    """
    mask = np.zeros((size[1], size[0]), np.bool_)
    none = True
    for item in items:
        none = False
        before = np.count_nonzero(mask)
        if isinstance(item, Light):
            mask |= _of_array(item.values, size, item.name)
        elif isinstance(item, str):
            path = folder / item
            mask |= _of_array(read_png(path)[0], size, shown(path))
        else:
            x, y, width, height = item
            mask[max(y, 0) : max(y + height, 0), max(x, 0) : max(x + width, 0)] = True
        if mask.all():
            raise DataError(f"mask: it hides all {size[0]} × {size[1]} pixels, so nothing would be compared")
        if np.count_nonzero(mask) == before:
            named = item.name if isinstance(item, Light) else item
            raise DataError(f"mask: {named} hides no pixel more of the {size[0]} × {size[1]}; leave it out")
    return None if none else mask


def _of_array(values: NDArray[np.generic], size: tuple[int, int], what: str) -> Mask:
    """Return where an array is lighter than half of what its kind of number holds."""
    if values.shape[:2] != (size[1], size[0]) or values.ndim not in (2, 3):
        there = " × ".join(map(str, values.shape[1::-1]))
        raise DataError(f"mask: {what} is {there}; the picture is {size[0]} × {size[1]} pixels")
    if values.ndim == 3:
        values = values[..., : min(values.shape[2], 3)].max(axis=2)
    if values.dtype == np.bool_:
        return values.astype(np.bool_)
    whole = values.dtype.itemsize if values.dtype.kind == "u" else 0
    half = (256**whole - 1) / 2 if whole else 0.5
    return np.asarray(values.astype(np.float64) > half)


def hidden(actual: NDArray[np.uint8], expected: NDArray[np.uint8], mask: Mask | None) -> NDArray[np.uint8]:
    """Return a picture with the reference's pixels where they are hidden; as it is if the sizes differ."""
    if mask is None or actual.shape != expected.shape:
        return actual
    return np.where(mask[..., None], expected, actual)


def describe_item(item: Sequence[int] | str | Light) -> str:
    """Describe what a part of a mask is."""
    if isinstance(item, str):
        return item
    if isinstance(item, Light):
        return item.name
    x, y, width, height = item
    return f"{width} × {height} pixels at x = {x}, y = {y}"


def shown_alone(actual: NDArray[np.uint8], mask: Mask | None) -> NDArray[np.uint8]:
    """Return a picture with the colour of its first visible pixel where pixels are hidden."""
    if mask is None:
        return actual
    y, x = divmod(int(np.argmin(mask)), mask.shape[1])
    return np.where(mask[..., None], actual[y, x], actual)


def striped(actual: NDArray[np.uint8], mask: Mask) -> NDArray[np.uint8]:
    """Return an opaque picture with magenta stripes over what is hidden."""
    y, x = np.indices(mask.shape)
    stripe = mask & ((x + y) // STRIPES % 2 == 0)
    picture = actual.copy()
    picture[..., 3] = 255
    picture[mask, :3] //= 2
    picture[stripe, :3] = (255, 0, 255)
    return picture

"""Compare a picture with the one expected: a verdict, how much, how many pixels, where; masks.

The one idea: the difference is the larger byte less the smaller one. So it never wraps
round, and darker counts as much as brighter. Alpha counts like a colour, and a picture of
one colour never passes: that is what most broken renders look like. Noise of one level, as
dithering leaves, is one colour still.

A mask hides pixels: they count as equal to the reference's. One that hides everything, or
nothing, is refused; what it hides is counted and shown.

It does not judge what an eye would see: a level is a level.
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
from playground.verify.shots.verdicts import VERDICTS

TOLERANCE = 1
"""[levels of 255] What may differ on the reference renderer: a rounding the other way."""

AMPLIFIED = 16
"""How many times brighter `difference_picture` shows a difference: two levels can then be seen."""

Colour = tuple[int, int, int, int]

_OUTSIDE = (255, 0, 255, 255)  # where one of the two pictures has no pixel


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """What came of comparing two pictures."""

    verdict: str  # same | differs | size | blank | missing (there is nothing to compare with)
    tolerance: int  # [levels of 255] that a channel may differ
    size: tuple[int, int]  # [pixels] width and height of the actual picture
    expected_size: tuple[int, int] | None = None  # [pixels] None: missing
    channels: Colour = (0, 0, 0, 0)  # [levels] largest difference in red, green, blue, alpha
    over: int = 0  # [pixels] with a channel beyond the tolerance
    position: tuple[int, int] | None = None  # [pixels] x and y, from the top left, of the first worst one
    actual: Colour | None = None  # what is at that place; of a blank picture, its colour
    expected: Colour | None = None  # what should be there
    hidden: int = 0  # [pixels] that are masked, and count as equal

    @property
    def ok(self) -> bool:
        """Whether the picture is the one expected."""
        return VERDICTS[self.verdict].passes

    @property
    def fraction(self) -> float:
        """Fraction of the pixels that are compared that differ beyond the tolerance."""
        return self.over / (self.size[0] * self.size[1] - self.hidden)

    @property
    def most(self) -> int:
        """Largest difference in any channel, in levels of 255."""
        return max(self.channels)

    def __str__(self) -> str:
        width, height = self.size
        if self.verdict == "missing":
            return "missing: there is no reference to compare with"
        if self.verdict == "blank":
            noise = " to within one level" if self.most else ""
            return f"blank: all {width} × {height} pixels are {self.actual}{noise}"
        if self.verdict == "size":
            assert self.expected_size is not None
            expected = " × ".join(map(str, self.expected_size))
            return f"size: {width} × {height} pixels where {expected} were expected"
        if self.position is None:
            return "same: every pixel"
        x, y = self.position
        most = f"max difference {self.most} of 255, at x = {x}, y = {y} from the top left"
        if self.ok:
            return f"same: {most}"
        compared = width * height - self.hidden
        counted = f"{self.over} of {compared} pixels ({100.0 * self.fraction:.3g} %) over {self.tolerance}"
        return f"differs: {most}, {self.actual} where {self.expected} was expected; {counted}"


def compare(
    actual: NDArray[np.uint8],
    expected: NDArray[np.uint8] | None,
    tolerance: int = TOLERANCE,
    *,
    allow_blank: bool = False,
    hidden: int = 0,
) -> Comparison:
    """Compare two pictures, uint8 (height, width, 4), top row first.

    With ``expected`` None the verdict is "missing"; "blank" goes before that and before "size",
    unless ``allow_blank``. ``hidden`` pixels are masked: the same in both, and no part of a fraction.
    Raises ``DataError`` for another dtype or shape.
    """
    actual = _picture(actual)
    expected = None if expected is None else _picture(expected)
    size, expected_size = _size(actual), None if expected is None else _size(expected)

    def result(verdict: str, **more: Any) -> Comparison:
        sizes: dict[str, Any] = {"size": size, "expected_size": expected_size}
        return Comparison(verdict=verdict, tolerance=tolerance, hidden=hidden, **sizes, **more)

    spread = None if allow_blank else _spread(actual)
    if spread is not None:
        return result("blank", channels=spread, actual=_colour(actual, 0, 0))
    if expected is None or size != expected_size:
        return result("missing" if expected is None else "size")
    if np.array_equal(actual.ravel().view(np.uint32), expected.ravel().view(np.uint32)):
        return result("same")  # as nearly all of one build are
    difference = _difference(actual, expected)
    # Down the columns first: long runs in memory, where axis 2 would be runs of four.
    channels = difference.reshape(size[1], -1).max(axis=0).reshape(-1, 4).max(axis=0)
    y, x = divmod(int(difference.argmax()) // 4, size[0])
    beyond = int(channels.max()) > tolerance
    over = int(np.count_nonzero((difference > tolerance).view(np.uint32))) if beyond else 0
    return result(
        "differs" if over else "same",
        channels=_four(channels),
        over=over,
        position=(x, y),
        actual=_colour(actual, x, y),
        expected=_colour(expected, x, y),
    )


def difference_picture(actual: NDArray[np.uint8], expected: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return a picture of the difference, 16 times as strong: opaque uint8 (height, width, 4).

    A difference in alpha shows as grey. Where sizes differ, the top left corners lie on each
    other and what only one of the two has is magenta. Raises ``DataError`` as `compare` does.
    """
    actual, expected = _picture(actual), _picture(expected)
    (width, height), (other_width, other_height) = _size(actual), _size(expected)
    picture = np.full((max(height, other_height), max(width, other_width), 4), _OUTSIDE, np.uint8)
    both = np.s_[: min(height, other_height), : min(width, other_width)]
    difference = _difference(actual[both], expected[both])
    seen = np.maximum(difference[..., :3], difference[..., 3:])
    picture[both][..., :3] = np.minimum(seen.astype(np.uint16) * AMPLIFIED, 255)
    picture[both][..., 3] = 255
    return picture


def _difference(actual: NDArray[np.uint8], expected: NDArray[np.uint8]) -> NDArray[np.uint8]:
    # Subtracting bytes the other way wraps round: 0 - 2 is 254, and as a signed byte 255 - 0 is -1.
    larger = np.maximum(actual, expected)
    return np.subtract(larger, np.minimum(actual, expected), out=larger)


def _spread(actual: NDArray[np.uint8]) -> Colour | None:
    """Return how far the channels of a picture of one colour range, 0 or 1 each; None for any other."""
    height, width = actual.shape[:2]
    some = actual[:: max(height // 16, 1), :: max(width // 16, 1)].reshape(-1, 4)
    if int(np.max(some.max(axis=0) - some.min(axis=0))) > 1:
        return None  # as good as every picture, and soon known
    rows = actual.reshape(height, -1)
    most, least = (bound.reshape(-1, 4) for bound in (rows.max(axis=0), rows.min(axis=0)))
    spread = most.max(axis=0) - least.min(axis=0)
    return _four(spread) if int(spread.max()) <= 1 else None


def _picture(array: NDArray[np.uint8]) -> NDArray[np.uint8]:
    if array.dtype != np.uint8 or array.ndim != 3 or array.shape[2] != 4 or 0 in array.shape:
        description = f"{array.dtype} {array.shape}"
        raise DataError(f"a picture to compare is uint8 (height, width, 4); found {description}")
    return np.ascontiguousarray(array)


def _size(array: NDArray[np.uint8]) -> tuple[int, int]:
    return array.shape[1], array.shape[0]


def _colour(array: NDArray[np.uint8], x: int, y: int) -> Colour:
    return _four(array[y, x])


def _four(values: NDArray[np.uint8]) -> Colour:
    red, green, blue, alpha = (int(v) for v in values)
    return red, green, blue, alpha


def worst_window(values: NDArray[Any], side: int) -> tuple[float, tuple[int, int], tuple[int, int]]:
    """Return the largest sum over any window of ``side`` × ``side`` pixels, by a summed-area table.

    With x and y of its top left corner, and its width and height, which are less in a small image.
    """
    windows = sums_of_windows(values, side)
    y, x = divmod(int(windows.argmax()), windows.shape[1])
    height, width = (min(side, length) for length in values.shape)
    return float(windows[y, x]), (x, y), (width, height)


def sums_of_windows(values: NDArray[Any], side: int) -> NDArray[np.float64]:
    """Return the sum over each window of ``side`` × ``side`` pixels, at its top left corner; exact to 2⁵³."""
    height, width = (min(side, length) for length in values.shape)
    sums = np.zeros([length + 1 for length in values.shape], np.float64)
    np.cumsum(values, axis=0, dtype=np.float64, out=sums[1:, 1:])
    np.cumsum(sums[1:, 1:], axis=1, out=sums[1:, 1:])
    windows = sums[height:, width:] - sums[:-height, width:] - sums[height:, :-width]
    windows += sums[:-height, :-width]
    return windows


# ── masks ────────────────────────────────────────────────────────────────────


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

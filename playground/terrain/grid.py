"""Report what a grid of heights may be, and how a format's reader hands one over."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.images.bounds import MAX_TEXELS

Heights = NDArray[np.float32]
Packing = Literal["grey", "rgb"]

EIGHT_BIT = (0.0, 255.0)
SIXTEEN_BIT = (0.0, 65535.0)
PACKED = (0.0, 16777215.0)


@dataclass(frozen=True)
class Found:
    """What a format's reader hands over; rows in the file's order."""

    values: NDArray[Any]  # (rows, cols), any real dtype
    spacing: tuple[float, float] | None = None
    in_metres: bool = False
    code_range: tuple[float, float] | None = None
    void: NDArray[np.bool_] | None = None  # where there is no data, NaN apart
    scale: float = 1.0  # metres in the file's unit of height
    offset: float = 0.0  # [m] height of the file's 0
    notes: tuple[str, ...] = ()


def check_grid(shape: tuple[int, ...], dtype: np.dtype[Any], path: Path) -> None:
    """Raise ``DataError`` for what is no terrain; a header's claims are judged, before memory is taken."""
    size = " x ".join(map(str, reversed(shape))) or "a single number"
    if dtype.kind not in "iuf":
        raise DataError(f"holds {dtype}, not heights; expected integers or real numbers", file=path)
    if len(shape) != 2:
        raise DataError(
            f"has {len(shape)} dimensions ({size}); expected two, rows from north to south", file=path
        )
    if min(shape) < 2:
        raise DataError(f"is {size} texels; expected at least 2 x 2", file=path)
    if math.prod(shape) > MAX_TEXELS:
        raise DataError(f"is {size} texels; the most is 2**28, as 16384 x 16384", file=path)


def from_channels(samples: NDArray[Any], packing: Packing, path: Path) -> Found:
    """Return the heights in a picture's samples (rows, cols, channels): grey, grey + alpha, RGB or RGBA."""
    channels = samples.shape[2]
    code_range = {"u1": EIGHT_BIT, "u2": SIXTEEN_BIT}.get(samples.dtype.str[1:])
    void = None
    pictured = samples.dtype.kind == "u"  # as greys and colours are, and bands of measured numbers are not
    if channels in (2, 4) and pictured:
        void = samples[..., -1] == 0
    if packing == "rgb":
        if channels < 3 or samples.dtype != np.uint8:
            bits = 8 * samples.dtype.itemsize
            raise DataError(
                f"packed heights need three channels of 8 bits; found {channels} of {bits}", file=path
            )
        red, green, blue = (samples[..., k].astype(np.float32) for k in range(3))  # exact: below 2**24
        return Found(red * 65536.0 + green * 256.0 + blue, code_range=PACKED, void=void)
    grey = samples[..., 0]
    if pictured and channels >= 3 and not all(np.array_equal(grey, samples[..., k]) for k in (1, 2)):
        raise DataError(
            "is a picture in colour; expected grey, or packing 'rgb' for heights in three channels", file=path
        )
    notes = () if pictured or channels == 1 else (f"the first of its {channels} bands was read",)
    return Found(grey, code_range=code_range, void=void, notes=notes)

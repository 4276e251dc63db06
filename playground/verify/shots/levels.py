"""Turn the numbers of a picture into the bytes that are compared, by rules that are stated.

    bool                 black and white
    uint8                as they are
    uint16               65535 is white, to the nearest of the 255 levels
    floats               0..1, display-encoded, to the nearest level; other numbers are refused

A ``tone`` says what else floats are, and what becomes of those outside 0..1:

    clip                 display-encoded; below 0 is black, above 1 white
    srgb                 linear light, encoded as sRGB; below 0 is black, above 1 white
    reinhard             linear light x of each channel, shown as x / (1 + x), encoded as sRGB

Grey has no third axis, or one of 1; two channels are grey and alpha; alpha has no tone.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError, nearest
from playground.shader.colours import linear_to_srgb

Numbers = NDArray[np.float64]

HALF = 0.5 / 255.0
"""How far outside 0..1 a number may be and still round to the first or the last level."""


def _clip(values: Numbers) -> Numbers:
    return np.clip(values, 0.0, 1.0)


def _srgb(values: Numbers) -> Numbers:
    return linear_to_srgb(np.clip(values, 0.0, 1.0))


def _reinhard(values: Numbers) -> Numbers:
    light = np.maximum(values, 0.0)
    return linear_to_srgb(light / (1.0 + light))


TONES: dict[str, Callable[[Numbers], Numbers]] = {"clip": _clip, "srgb": _srgb, "reinhard": _reinhard}
"""What ``tone`` may be: numbers → display-encoded ones, 0..1."""


def levels_of(values: NDArray[Any], tone: str = "") -> tuple[NDArray[np.uint8], str]:
    """Return a picture as uint8 (height, width, 4), and a message on numbers that are not finite, or "".

    Raises ``DataError`` for another shape or dtype, for numbers outside 0..1 without a tone, and
    for a tone that is not known or that has nothing to do.
    """
    if tone and tone not in TONES:
        raise DataError(f"tone = {tone!r}: expected one of {', '.join(TONES)}{nearest(tone, TONES)}")
    channels = {2: 1}.get(values.ndim, values.shape[-1] if values.ndim == 3 else 0)
    if channels not in (1, 2, 3, 4) or 0 in values.shape:
        raise DataError(f"a picture is an array (height, width, 3 or 4), or grey; found {values.shape}")
    values = values.reshape(*values.shape[:2], channels)
    wrong = ""
    if np.issubdtype(values.dtype, np.floating):
        values, wrong = _of_floats(values, tone)
    elif tone:
        raise DataError(f"tone = {tone!r} is for floats; this picture is of {values.dtype}")
    elif values.dtype == np.bool_:
        values = values.astype(np.uint8) * np.uint8(255)
    elif values.dtype == np.uint16:
        values = ((values.astype(np.uint32) * 255 + 32767) // 65535).astype(np.uint8)
    elif values.dtype != np.uint8:
        raise DataError(
            f"a picture is of uint8, or of floats from 0 to 1, of uint16 or bool; found {values.dtype}"
        )
    return _four_channels(values), wrong


def _of_floats(values: NDArray[Any], tone: str) -> tuple[NDArray[np.uint8], str]:
    wide = values.astype(np.float64)
    finite = np.isfinite(wide)
    wrong = ""
    if not finite.all():
        bad = int(np.count_nonzero(~finite.all(axis=2)))
        wrong = f"{bad} of {wide.shape[0] * wide.shape[1]} pixels are not finite numbers"
        wide = np.where(finite, wide, 0.0)
    if not tone:
        _refuse_beyond(wide)
        return np.rint(np.clip(wide, 0.0, 1.0) * 255.0).astype(np.uint8), wrong
    colours = wide.shape[2] - (wide.shape[2] in (2, 4))
    _refuse_beyond(wide[..., colours:], ": that is alpha")
    shown = np.concatenate([TONES[tone](wide[..., :colours]), np.clip(wide[..., colours:], 0, 1)], axis=2)
    return np.rint(shown * 255.0).astype(np.uint8), wrong


def _refuse_beyond(values: Numbers, what: str = "") -> None:
    if values.size == 0:
        return
    least, most = float(values.min()), float(values.max())
    if least < -HALF or most > 1.0 + HALF:
        advice = "" if what else f"; say what they mean with tone=, one of {', '.join(TONES)}"
        raise DataError(
            f"a picture of floats is from 0 to 1, and this one from {least:.4g} to {most:.4g}{what}{advice}"
        )


def _four_channels(values: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return grey, grey and alpha, or colours as red, green, blue and alpha."""
    channels = values.shape[2]
    colours = values[..., : channels - (channels in (2, 4))]
    alpha = values[..., -1:] if channels in (2, 4) else np.full((*values.shape[:2], 1), 255, np.uint8)
    if colours.shape[2] == 1:
        colours = np.repeat(colours, 3, axis=2)
    return np.ascontiguousarray(np.concatenate([colours, alpha], axis=2))

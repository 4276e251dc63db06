"""Pictures drawn larger than requested, and their reduction by the mean.

Antialiasing for whatever a picture is made by, passes that light pixels among them, which the samples of
draws do not reach. The mean is that of light, not of encoded numbers: half a pixel of white is 188 of 255.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from playground.shader.colours import linear_to_srgb, srgb_to_linear


@cache
def _light() -> NDArray[np.float64]:
    """Return the linear light of each byte."""
    return srgb_to_linear(np.arange(256) / 255)


def reduced(pixels: NDArray[np.uint8], times: int) -> NDArray[np.uint8]:
    """Return a picture (height, width, 4), sRGB and alpha, of one so many ``times`` as wide and high.

    Each pixel is the mean of a square of ``times`` by ``times``; colours count by their alpha.
    """
    if times == 1:
        return pixels
    height, width = pixels.shape[0] // times, pixels.shape[1] // times
    squares = pixels.reshape(height, times, width, times, 4)
    alpha = squares[..., 3].sum(axis=(1, 3), dtype=np.uint32)
    opaque = bool((alpha == 255 * times * times).all())
    reduced_picture = np.empty((height, width, 4), np.uint8)
    reduced_picture[..., 3] = np.rint(alpha / (times * times))
    for channel in range(3):
        light = _light()[squares[..., channel]]
        if opaque:
            mean = light.mean(axis=(1, 3))
        else:
            mean = (light * squares[..., 3]).sum(axis=(1, 3)) / np.maximum(alpha, 1)
        reduced_picture[..., channel] = np.rint(255 * linear_to_srgb(mean))
    return reduced_picture

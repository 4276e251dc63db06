"""A finished picture: an array that saves itself and shows itself in a notebook.

One that was drawn larger than requested is reduced by the mean: antialiasing for whatever a picture is made
by, passes that light pixels among them, which the samples of draws do not reach. The mean is that of light,
not of encoded numbers: half a pixel of white is 188 of 255.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.data.image_files import encode_png, write_picture
from playground.shader.colours import linear_to_srgb, srgb_to_linear


@dataclass(frozen=True, eq=False)
class Frame:
    """A picture, display-encoded: what ``Engine.render`` gives. A notebook shows it.

    ``array`` is uint8 (height, width, 4), top row first, sRGB and straight alpha; ``numpy.asarray(frame)``
    gives it, too. ``sketch`` is the sketch's name, ``time`` the moment in seconds.

        import numpy

        frame = playground.render("l_dot_n", size=(64, 36))
        assert numpy.asarray(frame).shape == (36, 64, 4)
    """

    array: NDArray[np.uint8]  # (height, width, 4), top row first, sRGB and alpha
    sketch: str = ""
    time: float = 0.0  # [s]

    @property
    def size(self) -> tuple[int, int]:
        """Return the width and height in pixels.

        For example:

            assert playground.render("l_dot_n", size=(64, 36)).size == (64, 36)
        """
        return self.array.shape[1], self.array.shape[0]

    def save(
        self,
        path: str | Path,
        text: dict[str, str] | None = None,
        *,
        say: Callable[[str], None] = lambda _: None,
    ) -> Path:
        """Write a picture by the path's ending, whole or not at all: .png, .jpg, .webp or .tif.

        ``text`` goes into a PNG; ``say`` is called with a message where a JPEG drops alpha.
        Returns the path.

            playground.render("l_dot_n", size=(64, 36)).save("land.webp")

        Raises ``DataError`` for another ending, with the list, and where it cannot be written.
        """
        if dropped := write_picture(path, self.array, text=text or {}):
            say(dropped)
        return Path(path)

    def __array__(self, dtype: np.dtype[Any] | None = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.array, dtype=dtype, copy=copy)

    def _repr_png_(self) -> bytes:
        return encode_png(self.array)


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

"""Encode linear colours as the bytes of a WebP or a JPEG: sRGB in 8 bits.

PNG is `playground.capture.values`, since its numbers may be anything.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from playground.capture.values import Encoded, colour_samples
from playground.images.image_formats import JPEG_QUALITY, encode_as


def encode_picture(colours: NDArray[np.float32], ending: str) -> Encoded:
    """Return the bytes of a picture; ``colours`` is (rows, cols) or (rows, cols, 3), linear, north on top.

    WebP loses nothing; JPEG keeps its colours at full resolution.

    Raises:
        DataError: a picture larger than the format takes, or colours that are not finite.
    """
    samples, warning = colour_samples(colours)
    data = encode_as(ending, samples.astype(np.uint8))
    lossless = "lossless" if ending == ".webp" else f"quality {JPEG_QUALITY}"
    return Encoded(data, (f"sRGB in 8 bits, {lossless}",), warning)

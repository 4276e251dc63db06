"""Turn linear colours into the bytes of a WebP or a JPEG: sRGB in 8 bits.

PNG is `playground.capture.values`, since its numbers may be anything.
"""

from __future__ import annotations

import io

import numpy as np
from numpy.typing import NDArray

from playground.capture.values import Encoded, colour_samples
from playground.errors import DataError

_FORMATS = {".webp": ("WEBP", 16383), ".jpg": ("JPEG", 65535), ".jpeg": ("JPEG", 65535)}
_QUALITY = 95  # of a JPEG, 0..100: above it files grow and nothing is seen


def encode_picture(colours: NDArray[np.float32], ending: str) -> Encoded:
    """Return the bytes of a picture; ``colours`` is (rows, cols) or (rows, cols, 3), linear, north on top.

    WebP loses nothing; JPEG keeps its colours at full resolution.

    Raises:
        DataError: a picture larger than the format takes, or colours that are not finite.
    """
    import PIL.Image

    name, limit = _FORMATS[ending]
    rows, cols = colours.shape[:2]
    if max(rows, cols) > limit:
        raise DataError(f"{cols} x {rows} texels are too many for {ending}, which takes {limit} a side")
    samples, warning = colour_samples(colours)
    stream = io.BytesIO()
    picture = PIL.Image.fromarray(np.ascontiguousarray(samples, dtype=np.uint8))
    try:
        if name == "WEBP":
            picture.convert("RGB").save(stream, name, lossless=True, quality=60)
        else:
            picture.save(stream, name, quality=_QUALITY, subsampling=0, optimize=True)
    except (KeyError, OSError) as error:
        raise DataError(f"this Pillow cannot write {ending}; .png can be written: {error}") from error
    lossless = "lossless" if name == "WEBP" else f"quality {_QUALITY}"
    return Encoded(stream.getvalue(), (f"sRGB in 8 bits, {lossless}",), warning)

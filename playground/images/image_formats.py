"""Write a picture in the format that its name's ending says: PNG, JPEG, WebP or TIFF, 8 bits, sRGB.

WebP and TIFF lose nothing. JPEG has no alpha and loses a little; its colours keep their full
resolution. Files of numbers are `playground.images.files` and `playground.capture.export`.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.images.extensions import PICTURE_ENDINGS
from playground.images.files import encode_png, replacing

_LONGEST = {".webp": 16383, ".jpg": 65500, ".jpeg": 65500}  # pixels a side that libwebp and libjpeg take
JPEG_QUALITY = 95  # of 100: above it files grow and nothing is seen
_NO_TEXT: Mapping[str, str] = MappingProxyType({})


@contextmanager
def naming(path: str | Path) -> Iterator[None]:
    """Raise a ``DataError`` of the block with the name of a file."""
    try:
        yield
    except DataError as error:
        raise DataError(error.diagnostics[0].message, file=path) from error


def picture_ending(path: str | Path) -> str:
    """Return the ending of a picture's name; raise ``DataError`` for one that no picture has."""
    ending = Path(path).suffix.lower()
    if ending not in PICTURE_ENDINGS:
        known = f"{', '.join(PICTURE_ENDINGS[:-1])} or {PICTURE_ENDINGS[-1]}"
        raise DataError(f"a picture is written to a name ending in {known}", file=str(path))
    return ending


def encode_as(ending: str, array: NDArray[np.uint8], text: Mapping[str, str] = _NO_TEXT) -> bytes:
    """Return the bytes of a picture, uint8 (rows, cols, 3 or 4), top row first, sRGB and straight alpha.

    JPEG and WebP take grey too, (rows, cols). ``text`` as in `encode_png`, which alone can hold it.

    Raises:
        DataError: a picture larger than the format takes, text for another than PNG.
    """
    if ending == ".png":
        return encode_png(array, text)
    if text:
        raise DataError(f"a picture ending in {ending} holds no text; .png does")
    rows, cols = array.shape[:2]
    if max(rows, cols) > (limit := _LONGEST.get(ending, 2**31)):
        raise DataError(f"{cols} x {rows} pixels are too many for {ending}, which takes {limit} a side")
    stream = io.BytesIO()
    if ending in (".tif", ".tiff"):
        import tifffile

        alpha = ["unassalpha"] if array.shape[2] == 4 else None
        tifffile.imwrite(stream, array, photometric="rgb", extrasamples=alpha, metadata=None, software=False)
        return stream.getvalue()
    import PIL.Image

    picture = PIL.Image.fromarray(np.ascontiguousarray(array))
    try:
        if ending == ".webp":
            colours = picture.convert("RGB") if picture.mode == "L" else picture
            colours.save(stream, "WEBP", lossless=True, quality=60, exact=True)
        else:
            opaque = picture.convert("RGB") if picture.mode == "RGBA" else picture
            opaque.save(stream, "JPEG", quality=JPEG_QUALITY, subsampling=0, optimize=True)
    except (KeyError, OSError) as error:
        raise DataError(f"this Pillow cannot write {ending}; .png can be written: {error}") from error
    return stream.getvalue()


def write_picture(path: str | Path, array: NDArray[np.uint8], *, text: Mapping[str, str] = _NO_TEXT) -> str:
    """Write a picture, whole or not at all; `array` and `text` as in `encode_as`.

    Returns a sentence on the alpha that a JPEG cannot hold, or `""`.

    Raises:
        DataError: what `picture_ending` and `encode_as` refuse, a missing folder, no permission, a full disk.
    """
    ending = picture_ending(path)
    with naming(path):
        data = encode_as(ending, array, text)
    with replacing(path) as handle:
        handle.write(data)
    lost = ending in (".jpg", ".jpeg") and array.shape[2] == 4 and bool((array[..., 3] < 255).any())
    return "a JPEG is opaque: the picture's alpha was dropped; .png, .webp and .tif keep it" if lost else ""

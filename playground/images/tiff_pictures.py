"""Read a picture of more than 8 bits that is a TIFF: whole numbers, and floats as they are.

Those of 8 bits and fewer, with palettes and other colour spaces, are Pillow's. Source: TIFF 6.0 (Adobe 1992),
sections 8 and 18 for photometry and alpha, tag 274 for the orientation.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.images.bounds import refuse_bomb, refuse_too_many

if TYPE_CHECKING:
    import tifffile

MAX_HALF = 65504.0
"""The largest number of a half float, as which a card holds a picture of floats."""

_STARTS = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
_WHITE_IS_ZERO, _ASSOCIATED = 0, 1
_ON_ITS_SIDE, _TURNED_X, _TURNED_Y = (5, 6, 7, 8), (2, 3, 6, 7), (3, 4, 7, 8)


def is_tiff(handle: BinaryIO) -> bool:
    """Return whether a file that is being read is a TIFF; leaves the handle at the start."""
    start = handle.read(4)
    handle.seek(0)
    return start in _STARTS


def is_deep_tiff(handle: BinaryIO) -> bool:
    """Return whether a file that is being read is a TIFF of more than 8 bits; leaves it at the start."""
    if not is_tiff(handle):
        return False
    with _first_page(handle) as page:
        return page.dtype is not None and page.dtype.itemsize > 1


def tiff_size(handle: BinaryIO) -> tuple[int, int]:
    """Return the width and height of a picture in a TIFF, as it is shown."""
    with _first_page(handle) as page:
        width, height = page.imagewidth, page.imagelength
        return (height, width) if _orientation(page) in _ON_ITS_SIDE else (width, height)


def tiff_samples(handle: BinaryIO, path: Path) -> NDArray[np.float32]:
    """Return the numbers of a picture in a TIFF, (rows, cols, 1 to 4), top row first, straight alpha.

    Whole numbers are of 1 at their most, floats as they are.
    """
    import tifffile

    with _first_page(handle) as page:
        axes, shape, dtype = page.axes, page.shape, page.dtype
        channels = shape[axes.index("S")] if "S" in axes else 1
        if axes not in ("YX", "YXS", "SYX") or channels > 4 or dtype is None or dtype.kind not in "uif":
            raise DataError(
                f"holds {dtype} {axes} {shape}; a picture is (rows, cols, 1 to 4) of numbers", file=path
            )
        refuse_too_many(path, page.imagewidth, page.imagelength)
        refuse_bomb(path, math.prod(shape) * dtype.itemsize, path.stat().st_size)
        try:
            samples = page.asarray()
        except ValueError as error:
            if "imagecodecs" not in str(error):
                raise
            name = tifffile.COMPRESSION(page.compression).name
            message = f"its compression, {name}, cannot be read; save it with Deflate or none"
            raise DataError(message, file=path) from None
        orientation, extra, photometric = _orientation(page), page.extrasamples, page.photometric
    samples = samples.transpose(1, 2, 0) if axes == "SYX" else samples.reshape(*samples.shape[:2], -1)
    pixels = samples.astype(np.float32)
    if dtype.kind != "f":
        pixels = np.clip(pixels / np.float32(np.iinfo(dtype).max), 0.0, 1.0)
    elif not np.abs(samples).max() <= MAX_HALF:  # not a number is not
        raise DataError(f"has numbers beyond {MAX_HALF:g}, the largest of a half float", file=path)
    if photometric == _WHITE_IS_ZERO:
        pixels = 1.0 - pixels
    if extra and int(extra[0]) == _ASSOCIATED:
        alpha = pixels[..., -1:]
        pixels[..., :-1] = np.divide(
            pixels[..., :-1], alpha, out=np.zeros_like(pixels[..., :-1]), where=alpha > 0
        )
    if orientation in _ON_ITS_SIDE:
        pixels = pixels.swapaxes(0, 1)
    if orientation in _TURNED_X:
        pixels = pixels[:, ::-1]
    if orientation in _TURNED_Y:
        pixels = pixels[::-1]
    return np.ascontiguousarray(pixels)


def _orientation(page: tifffile.TiffPage) -> int:
    tag: Any = page.tags.get("Orientation")
    return int(tag.value) if tag is not None else 1


@contextmanager
def _first_page(handle: BinaryIO) -> Iterator[tifffile.TiffPage]:
    """Open the first picture of a TIFF; leaves the handle at the start."""
    import tifffile

    log = logging.getLogger("tifffile")  # it logs each odd tag to the console
    was_disabled, log.disabled = log.disabled, True
    try:
        with tifffile.TiffFile(handle) as tif:
            page = tif.pages[0]
            assert isinstance(page, tifffile.TiffPage)
            yield page
    finally:
        log.disabled = was_disabled
        handle.seek(0)

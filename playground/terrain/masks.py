"""Masks for texture splatting: four weights a texel, as the channels of an image file.

An image's numbers are taken as they are, not as colours: nothing is decoded. Without an alpha
channel the fourth weight is 0.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.images.files import Image, read_image
from playground.terrain.resample import resample


def read_mask(path: Path, size: tuple[int, int], stated: tuple[int, int] = (0, 0)) -> NDArray[np.float32]:
    """Return an image's four channels, (ny, nx, 4) for a size (nx, ny), 0..1, row 0 south.

    The image may have more texels than that or fewer, but the same proportions, to within
    one texel; and where a size is ``stated``, that one.

    Raises:
        DataError: missing, not a picture, damaged, of another size than stated, or of
            other proportions.
    """
    image = read_image(path)
    width, height = image.size
    if any(stated) and (width, height) != stated:
        raise DataError(
            f"this alpha map has {width} x {height} texels; {stated[0]} x {stated[1]} were expected",
            file=path,
        )
    if abs(width * size[1] - height * size[0]) > max(width, height, *size):
        raise DataError(
            f"this alpha map has {width} x {height} texels, which the terrain's weights, "
            f"{size[0]} x {size[1]}, would stretch; the same proportions were expected",
            file=path,
        )
    return resized(weights_of(image), size)


def weights_of(image: Image) -> NDArray[np.float32]:
    """Return an image's channels as four weights (ny, nx, 4), 0..1, row 0 south."""
    pixels = image.pixels[::-1]
    weights = np.array(pixels / np.float32(255) if pixels.dtype == np.uint8 else pixels, np.float32)
    np.clip(weights, 0.0, 1.0, out=weights)
    if not image.has_alpha:
        weights[..., 3] = 0.0
    return weights


def resized(weights: NDArray[np.float32], size: tuple[int, int]) -> NDArray[np.float32]:
    """Return four weights a texel on a grid of another size (nx, ny), corners on corners."""
    if weights.shape[1::-1] == size:
        return weights
    channels = [resample(weights[..., k], size, within=(0.0, 1.0)) for k in range(4)]
    return np.stack(channels, axis=-1).astype(np.float32)

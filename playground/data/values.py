"""Write grids of values into files: arrays, 16-bit PNG, TIFF of floats.

Grids have row 0 in the south, as in the engine, and are flipped where a format is an image.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.data.image_files import PNG_KINDS, VALUE_ENDINGS, encode_samples
from playground.errors import DataError, nearest
from playground.files import replacing, write_file


def write_values(path: str | Path, array: NDArray[np.float32]) -> str:
    """Write a grid of values, whole or not at all, in the format the name's ending says.

    `array` is (ny, nx) or (ny, nx, 1 to 4), **row 0 in the south** as in the engine.

    * `.npy`: float32, exactly these values in this order, so row 0 stays in the south;
    * `.png`: 16 bits, 0..1 as 0..65535 rounded to nearest and clamped, north row on top;
      1, 3 or 4 channels (grey, RGB, RGBA), no transfer curve;
    * `.tif`, `.tiff`: float32, uncompressed, exactly these values, north row on top.

    Returns a message on what was clamped, or `""`.

    Raises:
        DataError: another ending or shape, a value that is not finite (PNG only),
            a missing folder, no permission, a full disk.
    """
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in VALUE_ENDINGS:
        raise DataError(f"values cannot be written as {ending!r}{nearest(ending, VALUE_ENDINGS)}", file=path)
    values = np.asarray(array)
    if values.dtype.kind not in "fiu" or values.ndim not in (2, 3) or 0 in values.shape:
        raise DataError(
            f"values are numbers (ny, nx) or (ny, nx, channels); found {values.dtype} {values.shape}",
            file=path,
        )
    if values.ndim == 3 and values.shape[2] > 4:
        raise DataError(f"{values.shape[2]} channels are too many; the most is 4", file=path)
    with np.errstate(all="ignore"):
        values = values.astype(np.float32)
    if ending == ".npy":
        with replacing(path) as handle:
            np.lib.format.write_array(handle, values, allow_pickle=False)
        return ""
    image = np.ascontiguousarray(values[::-1])  # north on top
    if image.ndim == 3 and image.shape[2] == 1:
        image = image[..., 0]
    if ending != ".png":
        import tifffile

        with replacing(path) as handle:
            tifffile.imwrite(handle, image, photometric="minisblack", metadata=None, software=False)
        return ""
    data, clamped = _values_as_png(image, path)
    write_file(path, data)
    return clamped


def _values_as_png(image: NDArray[np.float32], path: Path) -> tuple[bytes, str]:
    channels = 1 if image.ndim == 2 else image.shape[2]
    if channels not in PNG_KINDS:
        raise DataError(
            f"a PNG holds 1, 3 or 4 channels; found {channels}, which .npy and .tif can hold", file=path
        )
    unusable = int(np.count_nonzero(~np.isfinite(image)))
    if unusable:
        raise DataError(
            f"{unusable} of {image.size} values are not finite, which a PNG cannot hold; .npy and .tif can",
            file=path,
        )
    with np.errstate(all="ignore"):
        scaled = np.rint(np.clip(image, 0.0, 1.0).astype(np.float64) * 65535.0)
    return encode_samples(scaled.astype(np.uint16)), clamped_note(image)


def clamped_note(values: NDArray[np.float32], low: float = 0.0, high: float = 1.0, unit: str = "") -> str:
    """Return a message on how many values are clamped to a range; nothing where none are."""
    outside = int(np.count_nonzero((values < np.float32(low)) | (values > np.float32(high))))
    if not outside:
        return ""
    percent = 100.0 * outside / values.size
    amount = f"{percent:.1f} %" if percent >= 0.1 else "less than 0.1 %"
    return (
        f"{outside} of {values.size} values ({amount}) are outside {low:.7g} to {high:.7g}{unit} "
        f"(from {values.min():.7g} to {values.max():.7g}) and were clamped"
    )

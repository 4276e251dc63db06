"""Pictures in TIFF files are read to the bit, whatever numbers they hold and however these are laid out."""

from __future__ import annotations

import numpy as np
import pytest
import tifffile

from playground.data.image_files import picture_size, read_image
from playground.errors import DataError

RNG = np.random.default_rng(5)
SHAPE = (6, 9)
LAYOUTS = [
    {},
    {"byteorder": ">"},
    {"compression": "zlib", "predictor": True},
    {"tile": (16, 16)},
    {"rowsperstrip": 2},
    {"bigtiff": True},
]


def written(path, array, **how):
    is_colour = array.ndim == 3 and array.shape[-1] > 2
    how = {"photometric": "rgb" if is_colour else "minisblack", "metadata": None} | how
    if array.ndim == 3 and array.shape[-1] in (2, 4) and how.get("planarconfig") != "separate":
        how.setdefault("extrasamples", ["unassalpha"])
    tifffile.imwrite(path, array[..., 0] if array.shape[-1] == 1 else array, **how)
    return path


def four(array):
    """Return an array of 1 to 4 channels as red, green, blue and alpha of 1."""
    channels = array.shape[-1]
    colour = array if channels > 2 else array[..., [0, 0, 0, *range(1, channels)]]
    return colour if colour.shape[-1] == 4 else np.concatenate([colour, np.ones_like(colour[..., :1])], -1)


@pytest.mark.parametrize("kind", ["uint8", "uint16", "uint32", "float16", "float32", "float64"])
@pytest.mark.parametrize("channels", [1, 3, 4])
def test_numbers_are_those_of_the_file(tmp_path, kind, channels):
    numbers = RNG.random((*SHAPE, channels))
    dtype = np.dtype(kind)
    most = 1.0 if dtype.kind == "f" else float(np.iinfo(dtype).max)
    stored = (numbers * 3 - 1 if dtype.kind == "f" else np.rint(numbers * most)).astype(dtype)
    for how in LAYOUTS:
        if dtype.kind == "f" and "predictor" in how:
            how = {"compression": "zlib"}
        path = written(tmp_path / "a.tif", stored, **how)
        image = read_image(path)
        pixels = image.pixels / 255 if image.pixels.dtype == np.uint8 else image.pixels
        np.testing.assert_allclose(pixels, four(stored.astype(np.float64) / most), atol=6e-8, rtol=6e-8)
        assert image.has_alpha == (channels == 4)
        assert picture_size(path) == image.size == (9, 6)


@pytest.mark.parametrize("kind", ["uint8", "uint16", "float32"])
def test_every_orientation_is_obeyed(tmp_path, kind):
    stored = RNG.integers(0, 250, (*SHAPE, 3)).astype(kind)
    most = 1.0 if kind == "float32" else np.iinfo(kind).max
    turned = stored.swapaxes(0, 1)
    shown = [stored, stored[:, ::-1], stored[::-1, ::-1], stored[::-1]]
    shown += [turned, turned[:, ::-1], turned[::-1, ::-1], turned[::-1]]
    for number, expected in enumerate(shown, 1):
        path = written(tmp_path / "a.tif", stored, extratags=[(274, 3, 1, number, True)])
        image = read_image(path)
        pixels = image.pixels / 255 if kind == "uint8" else image.pixels
        np.testing.assert_allclose(pixels[..., :3] * most, expected, atol=1e-3, err_msg=str(number))
        assert picture_size(path) == image.size


def test_planes_inverse_grey_and_premultiplied_alpha(tmp_path):
    planes = RNG.random((3, *SHAPE)).astype(np.float32)
    path = written(tmp_path / "a.tif", planes, photometric="rgb", planarconfig="separate")
    np.testing.assert_array_equal(read_image(path).pixels[..., :3], planes.transpose(1, 2, 0))
    grey = RNG.integers(0, 65536, SHAPE).astype(np.uint16)
    pixels = read_image(written(tmp_path / "b.tif", grey, photometric="miniswhite")).pixels
    np.testing.assert_allclose(pixels[..., 0], 1 - grey / 65535, atol=1e-7)
    straight = RNG.random((*SHAPE, 4)).astype(np.float32)
    straight[0, 0, 3] = 0.0
    stored = np.concatenate([straight[..., :3] * straight[..., 3:], straight[..., 3:]], -1)
    pixels = read_image(written(tmp_path / "c.tif", stored, extrasamples=["assocalpha"])).pixels
    straight[0, 0, :3] = 0.0
    np.testing.assert_allclose(pixels, straight, rtol=1e-6)


@pytest.mark.parametrize(
    ("stored", "words"),
    [
        (np.full(SHAPE, np.nan, np.float32), "beyond 65504"),
        (np.full(SHAPE, 1e6, np.float32), "beyond 65504"),
        (np.zeros((5, *SHAPE), np.uint16), "a picture is"),
        (np.zeros(SHAPE, np.complex64), "a picture is"),
    ],
)
def test_what_is_no_picture_is_one_sentence(tmp_path, stored, words):
    path = tmp_path / "a.tif"
    how = {"planarconfig": "contig"} if stored.ndim == 3 else {}
    tifffile.imwrite(path, stored.transpose(1, 2, 0) if stored.ndim == 3 else stored, metadata=None, **how)
    with pytest.raises(DataError, match=words):
        read_image(path)
    path.write_bytes(path.read_bytes()[:60])
    with pytest.raises(DataError, match="damaged or cut short"):
        read_image(path)

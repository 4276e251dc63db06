"""EXR by the reader of those who made the format."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenEXR
import pytest

from playground.publish.values import encode_exr


@pytest.mark.parametrize("dtype", [np.float16, np.float32])
@pytest.mark.parametrize("shape", [(1, 1), (37, 21), (16, 5, 2), (33, 8, 3), (48, 3, 4)])
def test_every_number_comes_back(dtype: type, shape: tuple[int, ...], tmp_path: Path):
    image = np.random.default_rng(3).normal(scale=100.0, size=shape).astype(dtype)
    path = tmp_path / "a.exr"
    path.write_bytes(encode_exr(image, "a remark"))
    with OpenEXR.File(str(path), separate_channels=True) as file:
        assert file.header()["comments"] == "a remark"
        pixels = {name: channel.pixels.copy() for name, channel in file.channels().items()}
    names = "Y" if image.ndim == 2 else "RGBA"[: shape[2]]
    assert set(pixels) == set(names)
    for index, name in enumerate(names):
        expected = image if image.ndim == 2 else image[..., index]
        assert pixels[name].dtype == dtype
        np.testing.assert_array_equal(pixels[name], expected)


def test_smooth_terrain_is_packed_and_noise_is_not_blown_up():
    smooth = np.add.outer(np.arange(256.0), np.arange(256.0)).astype(np.float32)
    assert len(encode_exr(smooth)) < smooth.nbytes / 4
    noise = np.random.default_rng(1).integers(0, 2**31 - 2**24, (64, 64), dtype=np.uint32).view(np.float32)
    assert len(encode_exr(noise)) < noise.nbytes + 512


def test_what_is_no_number_stays_so(tmp_path: Path):
    image = np.array([[np.nan, np.inf], [-np.inf, 0.0]], np.float32)
    path = tmp_path / "a.exr"
    path.write_bytes(encode_exr(image))
    with OpenEXR.File(str(path), separate_channels=True) as file:
        np.testing.assert_array_equal(file.channels()["Y"].pixels, image)

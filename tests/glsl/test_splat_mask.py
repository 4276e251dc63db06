"""texturing/alpha_map_file: an image's channels as weights, and the sentences for images that do not fit."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from playground.engine.file_sources import read_mask
from playground.errors import DataError

ROOT = Path(__file__).resolve().parents[2]
PASS = '[[pass]]\nname = "weights"\nuse = "texturing/alpha_map_file"\nset = {{ image = "{}"{} }}\n{}'


@pytest.fixture
def paint(tmp_path):
    """Give a function that writes an image of bytes, top row first, and returns its name."""

    def write(pixels: np.ndarray, name: str = "mask.png") -> str:
        Image.fromarray(np.asarray(pixels, np.uint8)).save(tmp_path / name)
        return name

    return write


def random_bytes(rows, columns, channels=4, seed=1):
    return np.random.default_rng(seed).integers(0, 256, (rows, columns, channels), np.uint8)


def test_its_bytes_are_the_weights_in_proportion_south_first(any_engine, make_sketch, paint):
    pixels = random_bytes(21, 33)
    name = paint(pixels)
    result = (
        any_engine.read(make_sketch(PASS.format(name, "", ""), size=[33, 21]), "weights").astype(float) * 255
    )
    value = pixels[::-1].astype(float)
    total = value.sum(axis=-1, keepdims=True)
    free = np.maximum(255 - total, 0) * np.array([1.0, 0, 0, 0])
    np.testing.assert_allclose(result, (value + free) / np.maximum(total, 255) * 255, atol=2.0)
    assert (np.round(result).sum(axis=-1) == 255).all()


def test_no_number_is_decoded_as_if_it_were_a_colour(any_engine, make_sketch, paint):
    pixels = np.zeros((5, 5, 4))
    pixels[...] = (127, 128, 0, 0)
    result = any_engine.read(make_sketch(PASS.format(paint(pixels), "", ""), size=5), "weights") * 255
    np.testing.assert_allclose(result, np.broadcast_to([127, 128, 0, 0], (5, 5, 4)), atol=1e-3)


def test_an_image_without_alpha_has_no_fourth_layer(any_engine, make_sketch, paint):
    result = any_engine.read(
        make_sketch(PASS.format(paint(random_bytes(9, 9, 3)), "", ""), size=9), "weights"
    )
    assert (result[..., 3] == 0).all()
    assert result[..., :3].max(axis=(0, 1)).min() > 0.3


@pytest.mark.parametrize("size", [(65, 33), (9, 5), (32, 16)])
def test_an_image_of_another_resolution_is_brought_to_the_map_s(paint, tmp_path, size):
    ramp = np.linspace(0, 200, 33)
    pixels = np.stack(np.broadcast_arrays(ramp, 255 - ramp, np.zeros((17, 1)), 7.0), axis=-1)
    mask = read_mask(tmp_path / paint(pixels), size)
    assert mask.shape == (size[1], size[0], 4)
    np.testing.assert_allclose(mask[0, :, 0], np.linspace(0, 200, size[0]) / 255, atol=0.01)
    np.testing.assert_allclose(mask[..., 3], 7 / 255, atol=1e-6)
    assert mask.min() >= 0 and mask.max() <= 1


def test_proportions_hold_to_within_a_texel(paint, tmp_path):
    for width, height in ((128, 64), (129, 65), (32, 16), (100, 50), (17, 9)):
        read_mask(tmp_path / paint(random_bytes(height, width)), (129, 65))
    for width, height in ((64, 64), (65, 129), (129, 60), (64, 31)):
        with pytest.raises(DataError, match=f"{width} x {height} texels.*129 x 65.*same proportions"):
            read_mask(tmp_path / paint(random_bytes(height, width)), (129, 65))


def test_the_shipped_mask_uses_every_layer(any_engine, make_sketch):
    result = any_engine.read(
        make_sketch('[[pass]]\nname = "weights"\nuse = "texturing/alpha_map_file"\n', size=256), "weights"
    )
    assert (result.max(axis=(0, 1)) == 1).all()
    assert (np.round(result.astype(float) * 255).sum(axis=-1) == 255).all()


# ── what does not fit, as a user meets it ────────────────────────────────────


def refused(folder: Path, text: str) -> str:
    """Return the one message with which the command line refuses a sketch; its exit status is 2."""
    (folder / "sketch.toml").write_text(f"format = 1\nsize = 33\n{text}")
    done = subprocess.run(
        [sys.executable, "-m", "playground", "render", "sketch.toml", "-o", "out.png", "--size", "32x32"],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 2, done.stderr
    assert not (folder / "out.png").exists()
    sentence = " ".join(done.stderr.split())
    assert "Traceback" not in sentence
    return sentence


@pytest.mark.slow
def test_an_alpha_map_of_another_size_than_stated(paint, tmp_path):
    result = refused(tmp_path, PASS.format(paint(random_bytes(20, 20)), ", texels = [64, 64]", ""))
    assert "sketch.toml" in result and "mask.png" in result
    assert "has 20 x 20 texels; 64 x 64 were expected" in result


@pytest.mark.slow
def test_an_alpha_map_of_other_proportions(paint, tmp_path):
    result = refused(tmp_path, PASS.format(paint(random_bytes(20, 40)), "", "size = [64, 64]\n"))
    assert "mask.png" in result and "40 x 20" in result and "64 x 64" in result


@pytest.mark.slow
def test_a_missing_image(paint, tmp_path):
    paint(random_bytes(4, 4))
    result = refused(tmp_path, PASS.format("masks.png", "", ""))
    assert "no such file" in result and "did you mean 'mask.png'" in result


@pytest.mark.slow
def test_a_fifth_layer(tmp_path):
    text = '[[pass]]\nname = "weights"\nuse = "texturing/alpha_map_file"\nset = { layers = 5 }\n'
    result = refused(tmp_path, text)
    assert "layers" in result and "5" in result and "1 to 4" in result


# ── base images as files ─────────────────────────────────────────────────────

LAYERS = '[[pass]]\nname = "{}"\nuse = "texturing/image"\nsize = 8\nset = {{ image = "{}" }}\n'
SPLAT = '[[pass]]\nname = "weights"\nuse = "texturing/alpha_map_file"\nset = {{ image = "{}" }}\n'


def test_base_images_may_be_files_decoded_to_linear_light(any_engine, make_sketch, paint):
    """Half of one, half of another: the mean of their light, not of their bytes."""
    mask = paint(np.full((9, 9, 4), (0, 128, 0, 127)))
    grey = paint(np.full((8, 8, 3), 40), "grey.png")
    pale = paint(np.full((8, 8, 3), 220), "pale.png")
    text = SPLAT.format(mask) + "".join(
        LAYERS.format(name, file)
        for name, file in (("grass", grey), ("rock", grey), ("snow", grey), ("path", pale))
    )
    text += '[[pass]]\nname = "colour"\nuse = "texturing/splat"\n'
    result = any_engine.read(make_sketch(text, size=9), "colour")[..., :3]
    dark, light = (((byte / 255 + 0.055) / 1.055) ** 2.4 for byte in (40, 220))
    np.testing.assert_allclose(result, (128 * dark + 127 * light) / 255, atol=2e-3)


@pytest.mark.slow
def test_a_missing_base_image(paint, tmp_path):
    mask = paint(random_bytes(9, 9))
    text = SPLAT.format(mask) + "".join(LAYERS.format(n, "mask.png") for n in ("grass", "rock", "snow"))
    text += LAYERS.format("path", "gravel.png") + '[view]\nuse = "view/map"\ninputs = { shown = "path" }\n'
    result = refused(tmp_path, text)
    assert "gravel.png" in result and "no such file" in result

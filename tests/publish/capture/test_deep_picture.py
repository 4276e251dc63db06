"""Pictures of more than 8 bits: rounded to 255 levels they are the usual ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import playground
from playground import cli
from playground.data.image_files import encode_samples
from playground.engine.engine import Engine
from playground.errors import PlaygroundError
from playground.publish.deep_picture import check_deep, read_deep, save_deep

SIZE = (96, 54)


@pytest.mark.parametrize("name", ["jacksboro", "scene", "circles"])
def test_rounded_to_bytes_it_is_the_picture(any_engine: Engine, name: str) -> None:
    sketch = playground.load(name)
    if name == "scene":  # it follows edges from pixel to pixel, which are here not rounded before
        sketch = sketch.with_values({"view.antialias": False})
    deep = read_deep(any_engine, sketch, SIZE)
    usual = any_engine.render(sketch, size=SIZE).array
    assert np.array_equal(np.rint(np.clip(deep, 0, 1) * 255).astype(np.uint8), usual)
    assert len(np.unique(deep)) > 256


def test_supersampling_takes_the_mean_light(any_engine: Engine) -> None:
    sketch = playground.load("jacksboro").with_picture(supersample=3)
    deep = np.clip(read_deep(any_engine, sketch, SIZE), 0, 1)
    usual = any_engine.render(sketch, size=SIZE).array
    assert np.abs(deep * 255 - usual).max() < 1.0, "the usual one is the mean of rounded pixels"


def test_exr_holds_linear_light_and_png_its_16_bits(any_engine: Engine, tmp_path: Path) -> None:
    openexr = pytest.importorskip("OpenEXR")
    sketch = playground.load("jacksboro")
    deep = read_deep(any_engine, sketch, SIZE).astype(np.float64)
    for ending in ("exr", "png"):
        save_deep(any_engine, sketch, tmp_path / f"a.{ending}", SIZE)
    encoded = deep[..., :3]
    light = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    with openexr.File(str(tmp_path / "a.exr")) as file:
        np.testing.assert_allclose(file.channels()["RGBA"].pixels[..., :3], light, rtol=1e-5, atol=1e-7)
    expected = np.rint(np.clip(deep, 0, 1) * 65535).astype(np.uint16)
    assert (tmp_path / "a.png").read_bytes() == encode_samples(expected)


def test_the_command_writes_the_same_bytes(
    any_engine: Engine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["render", "jacksboro", "--size", "96x54"]
    assert cli.main([*words, "-o", "a.exr"]) == cli.main([*words, "--bits", "16", "-o", "a.png"]) == 0
    for ending in ("exr", "png"):
        save_deep(any_engine, playground.load("jacksboro"), tmp_path / f"b.{ending}", SIZE)
        assert (tmp_path / f"a.{ending}").read_bytes() == (tmp_path / f"b.{ending}").read_bytes()


def test_one_larger_than_a_texture_is_refused(any_engine: Engine) -> None:
    most = int(any_engine.ctx.info["GL_MAX_TEXTURE_SIZE"])
    with pytest.raises(PlaygroundError, match="can be a PNG of 8 bits"):
        check_deep(any_engine, playground.load("jacksboro"), (most + 1, 10))

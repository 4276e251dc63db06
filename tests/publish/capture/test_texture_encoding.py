"""Heights and textures as files: read back by the libraries of others, and as terrain by the playground."""

from __future__ import annotations

import io
import json
from pathlib import Path

import numpy as np
import OpenEXR
import PIL.Image
import pytest
import rasterio
import tifffile

import playground
from playground import Sketch
from playground.data.elevation import read_elevation
from playground.data.image_files import read_samples
from playground.engine.engine import Engine
from playground.publish.export import Exported
from playground.publish.texture_encoding import encode_exr, encode_picture

LOW, HIGH = 50.0 + 1000.0 * 0.125, 50.0 + 1000.0 * 0.875  # the south-western corner; the north-western
STEP = (HIGH - LOW) / 65535.0  # [m] of 16 bits


def exr(path: Path) -> dict[str, np.ndarray]:
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: channel.pixels.copy() for name, channel in file.channels().items()}


# ── heights ──────────────────────────────────────────────────────────────────


def test_floats_are_metres_from_the_north(
    any_engine: Engine, lop: Sketch, heightmap: np.ndarray, tmp_path: Path
):
    read = {
        "npy": np.load,
        "tif": tifffile.imread,
        "exr": lambda path: exr(path)["Y"],
        "r32": lambda path: np.fromfile(path, "<f4").reshape(5, 9),
    }
    for ending, reader in read.items():
        done = playground.export(lop, tmp_path / f"terrain.{ending}", engine=any_engine)
        result = reader(done.path)
        assert result.dtype == np.float32
        np.testing.assert_allclose(result, heightmap, rtol=1e-6)
        assert result.argmax() == 0, "the north-western corner is the highest"
        assert "metres above sea level" in done.summary


@pytest.mark.parametrize("ending", ["png", "r16", "raw", "tif"])
def test_sixteen_bits_say_what_they_stand_for(
    ending: str, any_engine: Engine, lop: Sketch, heightmap: np.ndarray, tmp_path: Path
):
    path = tmp_path / f"terrain.{ending}"
    done = playground.export(lop, path, bits=16, engine=any_engine)
    assert "0 is 175 m and 65535 is 925 m" in done.summary
    if ending == "png":
        with PIL.Image.open(path) as picture:
            stored, text = np.array(picture), picture.text  # type: ignore[attr-defined]
        scale, offset = float(text["scale_m"]), float(text["offset_m"])
        assert text["spacing_m"] == "100 75"
    elif ending == "tif":
        stored = tifffile.imread(path)
        with tifffile.TiffFile(path) as tif:
            items = tif.pages[0].tags.valueof(42112)
        scale, offset = (float(items.split(f'role="{r}">')[1].split("<")[0]) for r in ("scale", "offset"))
    else:
        stored = np.fromfile(path, "<u2").reshape(5, 9)
        assert done.sidecars == (tmp_path / f"terrain.{ending}.json",)
        described = json.loads(done.sidecars[0].read_text())
        assert (described["width"], described["height"], described["bits"]) == (9, 5, 16)
        assert (described["byte_order"], described["first_row"], described["spacing_m"]) == (
            "little",
            "north",
            [100.0, 75.0],
        )
        scale, offset = described["scale"], described["offset"]
    assert stored.dtype == np.uint16
    assert (stored.min(), stored.max()) == (0, 65535)
    np.testing.assert_allclose(offset + scale * stored.astype(np.float64), heightmap, atol=0.51 * STEP + 1e-4)


def test_a_range_is_used_and_values_outside_are_reported(any_engine: Engine, lop: Sketch, tmp_path: Path):
    done = playground.export(lop, tmp_path / "a.r16", span=(0.0, 6553.5), engine=any_engine)
    stored = np.fromfile(done.path, "<u2").reshape(5, 9)
    assert stored[0, 0] == 9250 and stored[-1, 0] == 1750 and not done.warnings
    done = playground.export(lop, tmp_path / "a.r16", span=(200.0, 900.0), engine=any_engine)
    stored = np.fromfile(done.path, "<u2").reshape(5, 9)
    assert stored[0, 0] == 65535 and stored[-1, 0] == 0
    assert "outside 200 to 900 m (from 175 to 925) and were clamped" in done.warnings[0]


def test_flat_terrain_has_a_scale(any_engine: Engine, lop: Sketch, tmp_path: Path):
    done = playground.export(lop.with_values({"relief": 0}), tmp_path / "a.r16", engine=any_engine)
    assert not np.fromfile(done.path, "<u2").any()
    assert "0 is 50 m and 65535 is 51 m" in done.summary


def test_the_terrain_comes_back_by_the_playground_s_own_reader(
    any_engine: Engine, lop: Sketch, heightmap: np.ndarray, tmp_path: Path
):
    for name, bits, spacing in (
        ("a.tif", 32, True),
        ("b.tif", 16, True),
        ("c.npy", 32, False),
        ("d.png", 16, True),
    ):
        playground.export(lop, tmp_path / name, bits=bits, engine=any_engine)
        elevation = read_elevation(tmp_path / name)
        np.testing.assert_allclose(
            elevation.heights[::-1], heightmap, atol=1e-4 if bits == 32 else 0.51 * STEP + 1e-4
        )
        assert (elevation.spacing == (100.0, 75.0)) if spacing else elevation.spacing is None


@pytest.mark.parametrize("ending", ["tif", "png", "r16", "npy"])
def test_an_exported_terrain_renders_like_the_one_it_came_from(
    ending: str, any_engine: Engine, lop: Sketch, tmp_path: Path
):
    """By `generation/heightmap`; what a format does not know is set as the README says."""
    path = tmp_path / f"terrain.{ending}"
    playground.export(lop, path, engine=any_engine)
    values: dict[str, object] = {"height.elevation": str(path)}
    if ending not in ("tif", "png"):
        values |= {"extent": "800x300", "height.metres": (LOW, HIGH)}
    if ending == "r16":
        values["height.raw_size"] = (9, 5)
    again = playground.load("generation/heightmap").with_values(values)
    plan = any_engine.plan(again, (64, 36))
    assert plan.terrain.size == (9, 5)
    assert plan.terrain.extent == pytest.approx((800.0, 300.0))
    assert (plan.terrain.base_elevation, plan.terrain.relief) == pytest.approx((LOW, HIGH - LOW))
    share = any_engine.read(again, "height").astype(np.float64)
    back = LOW + share * (HIGH - LOW)
    original = any_engine.read(lop, "height").astype(np.float64) * 1000.0 + 50.0
    np.testing.assert_allclose(back, original, atol=0.51 * STEP + 1e-3)


def test_given_metres_win_over_those_of_the_file(any_engine: Engine, lop: Sketch, tmp_path: Path):
    """Black and white of the file are 0 and 2000 m; if they are 1000 and 2000 m, terrain is half as high."""
    path = tmp_path / "terrain.png"
    playground.export(lop, path, span=(0.0, 2000.0), engine=any_engine)
    values = {"height.elevation": str(path), "height.metres": (1000.0, 2000.0)}
    plan = any_engine.plan(playground.load("generation/heightmap").with_values(values), (64, 36))
    assert plan.terrain.relief == pytest.approx((HIGH - LOW) / 2, abs=0.05)
    assert plan.terrain.base_elevation == pytest.approx(1000.0 + LOW / 2, abs=0.05)


def test_geotiff_has_metres_and_points(any_engine: Engine, lop: Sketch, tmp_path: Path):
    done = playground.export(lop, tmp_path / "a.tif", engine=any_engine)
    with rasterio.open(done.path) as raster:
        assert tuple(raster.transform)[:6] == (100.0, 0.0, -50.0, 0.0, -75.0, 337.5)
        assert raster.tags()["AREA_OR_POINT"] == "Point" and raster.units == ("m",)
        assert raster.crs.to_dict(projjson=True)["coordinate_system"]["axis"][0]["unit"] == "metre"
    assert read_elevation(done.path).spacing == (100.0, 75.0)


# ── colours and other numbers ────────────────────────────────────────────────


def srgb(linear: np.ndarray) -> np.ndarray:
    return np.array(
        [12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055 for c in linear.ravel()]
    ).reshape(linear.shape)


def tint() -> np.ndarray:
    """Return the colours of the sketch, north row first."""
    return np.array([[[x / 16, 1 - y / 12, 0.25] for x in range(17)] for y in range(13)])


@pytest.mark.parametrize(("ending", "bound"), [("png", 0), ("webp", 0), ("jpg", 10)])
def test_colours_are_srgb_pictures(ending: str, bound: int, any_engine: Engine, lop: Sketch, tmp_path: Path):
    done = playground.export(lop, tmp_path / f"a.{ending}", texture="colour", engine=any_engine)
    with PIL.Image.open(done.path) as picture:
        assert picture.mode == "RGB"
        result = np.array(picture).astype(int)
    assert np.abs(result - np.rint(255 * srgb(tint()))).max() <= bound
    assert "sRGB" in done.summary and not done.warnings


def test_colours_in_floats_stay_linear_and_whole(any_engine: Engine, lop: Sketch, tmp_path: Path):
    playground.export(lop, tmp_path / "a.exr", texture="colour", engine=any_engine)
    arrays = exr(tmp_path / "a.exr")
    assert set(arrays) == set("RGB")
    np.testing.assert_allclose(np.stack([arrays[c] for c in "RGB"], axis=-1), tint(), atol=1e-7)
    playground.export(lop, tmp_path / "b.exr", texture="light", bits=16, engine=any_engine)
    light = exr(tmp_path / "b.exr")["R"]
    assert light.dtype == np.float16
    np.testing.assert_allclose(light[:, 0], [1.25, 1.0625, 0.875, 0.6875, 0.5], rtol=1e-3)
    done = playground.export(lop, tmp_path / "c.png", texture="light", span=(0.0, 1.0), engine=any_engine)
    assert "(from 0.5 to 1.25) and were clamped" in done.warnings[0]


def test_other_numbers_stay_as_they_are(any_engine: Engine, lop: Sketch, tmp_path: Path):
    def write(name: str, texture: str, **options: object) -> Exported:
        return playground.export(lop, tmp_path / name, texture=texture, engine=any_engine, **options)

    north = 1.0 - np.arange(5) / 4
    weights = np.zeros((5, 9, 4))
    weights[...] = [0.0, 0.5, 0.0, 0.25]
    weights[..., 0], weights[..., 2] = np.arange(9) / 8, north[:, None]
    write("a.npy", "mix")
    np.testing.assert_array_equal(np.load(tmp_path / "a.npy"), weights.astype(np.float32))
    write("a.png", "mix:weights", bits=8)
    with PIL.Image.open(tmp_path / "a.png") as picture:
        assert picture.mode == "RGBA"
        np.testing.assert_array_equal(np.array(picture), np.rint(weights * 255))
    write("a.tif", "mix", bits=16)
    np.testing.assert_array_equal(tifffile.imread(tmp_path / "a.tif"), np.rint(weights * 65535))
    write("b.exr", "mix:flow")
    np.testing.assert_allclose(exr(tmp_path / "b.exr")["G"], 1e6 * np.tile(north[:, None], 9), rtol=1e-6)
    done = write("h.exr", "mix:flow", bits=16)
    assert "beyond 65504" in done.warnings[0] and exr(tmp_path / "h.exr")["G"].max() == 65504
    # Heights as the kernel gave them, and a texture of colours as numbers.
    write("h.npy", "height", kind="numbers")
    assert np.load(tmp_path / "h.npy")[0, 0] == 0.875
    write("c.npy", "colour", kind="numbers")
    assert np.load(tmp_path / "c.npy").shape == (13, 17, 4)
    write("w.npy", "mix:flow", kind="numbers")
    with pytest.raises(playground.DataError, match="a PNG holds 1, 3 or 4 channels; 'mix:flow' has 2"):
        write("w.png", "mix:flow")
    with pytest.raises(playground.DataError, match="a raw file holds one number a texel; 'mix' has 4"):
        write("w.r16", "mix")
    with pytest.raises(playground.SketchError, match="'mix' has 4 channels; heights have one"):
        write("w.r16", "mix", kind="height")


def test_what_is_no_number_is_for_floats(any_engine: Engine, lop: Sketch, tmp_path: Path):
    torn = lop.with_values({"height.gap": 1})
    for ending in ("png", "r16", "glb", "obj"):
        with pytest.raises(playground.DataError, match=rf"a\.{ending}: 1 of 45 .*not finite"):
            playground.export(torn, tmp_path / f"a.{ending}", engine=any_engine)
    assert [p.name for p in tmp_path.iterdir()] == ["lop"]
    playground.export(torn, tmp_path / "a.tif", engine=any_engine)
    result = tifffile.imread(tmp_path / "a.tif")
    assert np.argwhere(np.isnan(result)).tolist() == [[2, 4]]
    assert read_elevation(tmp_path / "a.tif").missing == 1


def test_colours_may_have_sixteen_bits(any_engine: Engine, lop: Sketch, tmp_path: Path):
    done = playground.export(lop, tmp_path / "a.png", texture="colour", bits=16, engine=any_engine)
    np.testing.assert_array_equal(read_samples(done.path), np.rint(65535 * srgb(tint())))


def test_a_picture_that_its_format_cannot_take_is_a_sentence(monkeypatch: pytest.MonkeyPatch):
    wide = np.zeros((1, 16384), np.float32)
    with pytest.raises(playground.DataError, match=r"16384 x 1 pixels are too many for \.webp"):
        encode_picture(wide, ".webp")
    with PIL.Image.open(io.BytesIO(encode_picture(wide, ".jpg").data)) as picture:
        assert (picture.mode, picture.size) == ("L", (16384, 1))
    PIL.Image.init()
    monkeypatch.delitem(PIL.Image.SAVE, "WEBP")
    with pytest.raises(playground.DataError, match=r"this Pillow cannot write \.webp; \.png can be written"):
        encode_picture(wide[:, :9], ".webp")


@pytest.mark.parametrize("name", ["light.png", "light.webp"])
def test_light_is_exported_from_black_to_the_brightest(any_engine: Engine, tmp_path: Path, name: str):
    """Nothing is clamped; decoded by IEC 61966-2-1 and times white, it is the light that floats hold."""
    text = 'format = 1\nsize = 33\nextent = 640.0\nrelief = 200.0\n[[pass]]\nname = "height"\n'
    text += 'use = "generation/diamond_square"\n[[pass]]\nname = "light"\nuse = "lighting/ray_cast"\n'
    (tmp_path / "hills.toml").write_text(text)
    hills = playground.load(tmp_path / "hills.toml")
    floats = playground.export(hills, tmp_path / "light.npy", texture="light", engine=any_engine)
    light = np.load(floats.path).astype(np.float64)
    assert (light > 1.0).mean() > 0.2
    done = playground.export(hills, tmp_path / name, texture="light", engine=any_engine)
    assert not done.warnings and f"black is 0 and white is {light.max():.7g}" in done.summary
    with PIL.Image.open(done.path) as picture:
        codes = np.asarray(picture.convert("RGB"), np.float64) / 255
        text = getattr(picture, "text", {})
    assert name != "light.png" or float(text["white"]) == light.max()
    low, high = (
        np.where(c <= 0.04045, c / 12.92, ((np.maximum(c, 0) + 0.055) / 1.055) ** 2.4) * light.max()
        for c in (codes - 0.501 / 255, codes + 0.501 / 255)
    )
    assert (low <= light + 1e-6).all() and (light - 1e-6 <= high).all()


def test_a_range_of_colours_says_how_much_is_clamped(any_engine: Engine, lop: Sketch, tmp_path: Path):
    whole = np.load(playground.export(lop, tmp_path / "a.npy", texture="colour", engine=any_engine).path)
    limit = float(np.median(whole))
    span = (0.0, limit)
    done = playground.export(lop, tmp_path / "a.png", texture="colour", span=span, engine=any_engine)
    outside = int((whole > np.float32(limit)).sum())
    assert f"{outside} of {whole.size} values ({100 * outside / whole.size:.1f} %)" in done.warnings[0]
    with PIL.Image.open(done.path) as picture:
        assert np.array_equal(np.asarray(picture) == 255, whole >= np.float32(limit * 0.996))


# ── EXR, by the reader of those who made the format ──────────────────────────


@pytest.mark.parametrize("dtype", [np.float16, np.float32])
@pytest.mark.parametrize("shape", [(1, 1), (37, 21), (16, 5, 2), (33, 8, 3), (48, 3, 4)])
def test_every_number_comes_back(dtype: type, shape: tuple[int, ...], tmp_path: Path):
    image = np.random.default_rng(3).normal(scale=100.0, size=shape).astype(dtype)
    path = tmp_path / "a.exr"
    path.write_bytes(encode_exr(image, "a remark"))
    with OpenEXR.File(str(path), separate_channels=True) as file:
        assert file.header()["comments"] == "a remark"
    pixels = exr(path)
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
    np.testing.assert_array_equal(exr(path)["Y"], image)

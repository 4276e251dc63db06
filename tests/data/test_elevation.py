"""Elevation files: every format against numbers made here, every refusal; gaps, and lengths of a degree."""

from __future__ import annotations

import io
import math
import shutil
import zipfile
from pathlib import Path

import numpy as np
import pytest
import tifffile
from PIL import Image as PillowImage

from playground.data.elevation import Elevation, fill_no_data, read_elevation
from playground.data.image_files import encode_samples
from playground.data.place import degree_lengths
from playground.data.values import write_values
from playground.errors import DataError
from playground.paths import GLSL

from ..elevations import geotiff

RNG = np.random.default_rng(11)
HEIGHTMAP = RNG.integers(200, 2000, (6, 9)).astype(np.int16)  # north row first, as files are


def refused(path: Path, words: str, **options: object) -> None:
    with pytest.raises(DataError, match=words) as caught:
        read_elevation(path, **options)  # type: ignore[arg-type]
    assert "\n" not in str(caught.value) and str(path) in str(caught.value)


def assert_heightmap(elevation: Elevation, north_first: np.ndarray) -> None:
    assert elevation.heights.dtype == np.float32 and elevation.heights.flags.c_contiguous
    np.testing.assert_array_equal(elevation.heights[::-1], north_first.astype(np.float32))


# PNG


@pytest.mark.parametrize("bits", [8, 16])
def test_grey_png(tmp_path, bits):
    heightmap = RNG.integers(0, 2**bits, (6, 9)).astype(f"u{bits // 8}")
    PillowImage.fromarray(heightmap).save(tmp_path / "a.png")
    elevation = read_elevation(tmp_path / "a.png")
    assert_heightmap(elevation, heightmap)
    assert (elevation.size, elevation.name, elevation.missing) == ((9, 6), "a.png", 0)
    assert elevation.code_range == (0, 2**bits - 1)
    assert elevation.spacing is None and elevation.extent is None and not elevation.in_metres
    assert (elevation.lowest, elevation.highest) == (heightmap.min(), heightmap.max())


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_a_png_that_says_what_its_numbers_stand_for_is_metres(tmp_path, dtype):
    path, heightmap = tmp_path / "a.png", (HEIGHTMAP % 200).astype(dtype)
    path.write_bytes(encode_samples(heightmap, {"scale_m": "0.5", "offset_m": "-40.0", "spacing_m": "30 20"}))
    elevation = read_elevation(path)
    assert_heightmap(elevation, heightmap * 0.5 - 40.0)
    assert elevation.in_metres and elevation.spacing == (30.0, 20.0)
    assert elevation.code_range == (-40.0, np.iinfo(dtype).max * 0.5 - 40.0)


@pytest.mark.parametrize(
    "texts", [("much", "0", "1 1"), ("0", "0", "1 1"), ("inf", "0", "1 1"), ("1", "", "1 1")]
)
def test_texts_of_a_png_that_are_not_understood_are_ignored(tmp_path, texts):
    path = tmp_path / "a.png"
    chunks = dict(zip(("scale_m", "offset_m", "spacing_m"), texts, strict=True))
    path.write_bytes(encode_samples(HEIGHTMAP.astype(np.uint16), chunks))
    elevation = read_elevation(path)
    assert_heightmap(elevation, HEIGHTMAP)
    assert not elevation.in_metres and elevation.spacing is None and elevation.code_range == (0, 65535)
    path.write_bytes(
        encode_samples(HEIGHTMAP.astype(np.uint16), {"scale_m": "2", "offset_m": "3", "spacing_m": "-1 5"})
    )
    assert read_elevation(path).in_metres and read_elevation(path).spacing is None


def test_what_write_values_wrote_comes_back(tmp_path):
    heightmap = RNG.random((6, 9)).astype(np.float32)  # south first
    write_values(tmp_path / "a.png", heightmap)
    np.testing.assert_allclose(
        read_elevation(tmp_path / "a.png").heights / 65535, heightmap, atol=0.51 / 65535
    )
    write_values(tmp_path / "a.tif", heightmap)
    np.testing.assert_array_equal(read_elevation(tmp_path / "a.tif").heights, heightmap)
    write_values(tmp_path / "a.npy", heightmap)
    np.testing.assert_array_equal(read_elevation(tmp_path / "a.npy", first_row="south").heights, heightmap)
    np.testing.assert_array_equal(read_elevation(tmp_path / "a.npy").heights, heightmap[::-1])


@pytest.mark.parametrize("ending", ["png", "tif"])
def test_heights_packed_in_three_channels(tmp_path, ending):
    heightmap = RNG.integers(0, 2**24, (6, 9))
    heightmap[0, 0], heightmap[0, 1] = 2**24 - 1, 2**24 - 2
    colour = np.stack([heightmap >> 16, (heightmap >> 8) & 255, heightmap & 255], axis=-1).astype(np.uint8)
    PillowImage.fromarray(colour).save(tmp_path / f"a.{ending}")
    elevation = read_elevation(tmp_path / f"a.{ending}", packing="rgb")
    assert_heightmap(elevation, heightmap)
    assert elevation.code_range == (0, 2**24 - 1)
    refused(tmp_path / f"a.{ending}", "in colour; expected grey, or packing 'rgb'")


def test_grey_in_three_channels_is_grey(tmp_path):
    heightmap = RNG.integers(0, 256, (6, 9), dtype=np.uint8)
    PillowImage.fromarray(np.stack([heightmap] * 3, axis=-1)).save(tmp_path / "a.png")
    assert_heightmap(read_elevation(tmp_path / "a.png"), heightmap)


def test_transparent_texels_have_no_data(tmp_path):
    heightmap = np.stack([HEIGHTMAP.astype(np.uint8), np.full(HEIGHTMAP.shape, 255, np.uint8)], axis=-1)
    heightmap[1, 2, 1] = 0
    PillowImage.fromarray(heightmap).save(tmp_path / "a.png")
    elevation = read_elevation(tmp_path / "a.png")
    assert elevation.missing == 1 and np.isnan(elevation.heights[6 - 1 - 1, 2])


def test_packing_must_fit_the_file(tmp_path):
    PillowImage.fromarray(HEIGHTMAP.astype(np.uint16)).save(tmp_path / "a.png")
    refused(tmp_path / "a.png", "three channels of 8 bits; found 1 of 16", packing="rgb")
    np.save(tmp_path / "a.npy", HEIGHTMAP)
    refused(tmp_path / "a.npy", "read from PNG and TIFF", packing="rgb")
    tifffile.imwrite(tmp_path / "a.tif", HEIGHTMAP)
    refused(tmp_path / "a.tif", "three channels of 8 bits; found 1 of 16", packing="rgb")
    refused(tmp_path / "a.png", "no such packing: 'gray'; did you mean 'grey'", packing="gray")
    refused(tmp_path / "a.png", "no such first row: 'North'", first_row="North")


# TIFF


@pytest.mark.parametrize("dtype", ["u1", "u2", "i2", "u4", "i4", "f2", "f4", "f8"])
@pytest.mark.parametrize("order", ["<", ">"])
def test_tiff_of_every_kind_of_number(tmp_path, dtype, order):
    heightmap = (HEIGHTMAP % 200).astype(dtype)
    tifffile.imwrite(tmp_path / "a.tif", heightmap, byteorder=order, photometric="minisblack")
    elevation = read_elevation(tmp_path / "a.tif")
    assert_heightmap(elevation, heightmap)
    assert elevation.code_range == {"u1": (0, 255), "u2": (0, 65535)}.get(dtype)


@pytest.mark.parametrize("bands", [2, 3, 5])
def test_of_several_bands_the_first_is_read_and_that_is_reported(tmp_path, bands):
    heightmap = np.stack([HEIGHTMAP.astype(np.float32) + 100 * k for k in range(bands)])
    tifffile.imwrite(tmp_path / "a.tif", heightmap, planarconfig="separate", photometric="minisblack")
    elevation = read_elevation(tmp_path / "a.tif")
    assert_heightmap(elevation, HEIGHTMAP)
    assert elevation.notes == (f"the first of its {bands} bands was read",)


def test_a_damaged_tag_is_one_sentence_and_no_log(tmp_path, capfd):
    tifffile.imwrite(tmp_path / "a.tif", HEIGHTMAP, metadata=None)
    content = bytearray((tmp_path / "a.tif").read_bytes())
    with tifffile.TiffFile(tmp_path / "a.tif") as tif:
        at = tif.pages[0].tags[273].valueoffset
    content[at : at + 3] = b"\xff\xff\xff"
    (tmp_path / "a.tif").write_bytes(content)
    refused(tmp_path / "a.tif", "damaged or cut short")
    assert capfd.readouterr() == ("", "")


def test_first_of_several_tiff_images_is_read_and_reported(tmp_path):
    with tifffile.TiffWriter(tmp_path / "a.tif") as tif:
        tif.write(HEIGHTMAP)
        tif.write(2 * HEIGHTMAP)
    elevation = read_elevation(tmp_path / "a.tif")
    assert_heightmap(elevation, HEIGHTMAP)
    assert elevation.notes == ("the first of 2 pictures was read",)


def test_a_projected_geotiff_gives_metres(tmp_path):
    elevation = read_elevation(
        geotiff(tmp_path / "a.tif", HEIGHTMAP, {1024: 1, 3072: 32633, 3076: 9001}, (30.0, 20.0))
    )
    assert_heightmap(elevation, HEIGHTMAP)
    assert elevation.spacing == (30.0, 20.0) and elevation.extent == (8 * 30.0, 5 * 20.0)
    assert elevation.in_metres and elevation.code_range is None and elevation.notes == ()


def test_16_bits_without_a_sign_are_metres_in_a_geotiff_only(tmp_path):
    elevation = read_elevation(
        geotiff(tmp_path / "a.tif", HEIGHTMAP.astype(np.uint16), {1024: 1, 3076: 9001})
    )
    assert elevation.in_metres and elevation.code_range is None


def test_whole_numbers_that_gdal_s_metadata_scale_become_metres(tmp_path):
    scale, offset = (
        f'<Item name="{r.upper()}" sample="0" role="{r}">{v}</Item>'
        for r, v in (("scale", 0.5), ("offset", -40))
    )
    other = '<Item name="SCALE" sample="1" role="scale">9</Item>'
    keys, heightmap = {1024: 1, 3076: 9001, 4099: 9002}, HEIGHTMAP % 200
    path = geotiff(tmp_path / "a.tif", heightmap, keys, metadata=offset + scale + other)
    elevation = read_elevation(path)
    assert elevation.in_metres and elevation.code_range is None
    np.testing.assert_allclose(elevation.heights[::-1], (heightmap * 0.5 - 40.0) * 0.3048, rtol=1e-6)
    # Heights and cells are two facts: scaled numbers are heights, whether cells have metres or not.
    elevation = read_elevation(geotiff(tmp_path / "b.tif", heightmap, {}, metadata=offset + scale))
    assert elevation.in_metres and "metres are assumed" in elevation.assumed
    np.testing.assert_allclose(elevation.heights[::-1], heightmap * 0.5 - 40.0, rtol=1e-6)
    refused(
        geotiff(tmp_path / "c.tif", heightmap, keys, metadata=scale.replace("0.5", "much")),
        "a scale or an offset that is no number",
    )


@pytest.mark.parametrize("raster", [1, 2])
def test_a_geographic_geotiff_has_its_middle_latitude(tmp_path, raster):
    tie = (0, 0, 0, 10.0, 61.0, 0)
    keys = {1024: 2, 1025: raster, 2048: 4326}
    elevation = read_elevation(geotiff(tmp_path / "a.tif", HEIGHTMAP, keys, (0.1, 0.1), tie))
    middle = 61.0 - (0.3 if raster == 1 else 0.25)  # six pixels, or five steps from node to node
    east, north = degree_lengths(middle)
    assert elevation.spacing == pytest.approx((0.1 * east, 0.1 * north), rel=1e-12)
    assert elevation.in_metres


def test_a_matrix_gives_the_same_as_scale_and_tie_point(tmp_path):
    matrix = (0.1, 0, 0, 10.0, 0, -0.1, 0, 61.0, 0, 0, 0, 0, 0, 0, 0, 1)
    keys = {1024: 2, 1025: 1}
    a = read_elevation(geotiff(tmp_path / "a.tif", HEIGHTMAP, keys, matrix=matrix))
    b = read_elevation(geotiff(tmp_path / "b.tif", HEIGHTMAP, keys, (0.1, 0.1), (0, 0, 0, 10.0, 61.0, 0)))
    assert a.spacing == pytest.approx(b.spacing)
    turned = (0.1, 0.05, 0, 10.0, 0.05, -0.1, 0, 61.0, 0, 0, 0, 0, 0, 0, 0, 1)
    path = geotiff(tmp_path / "c.tif", HEIGHTMAP, keys, matrix=turned)
    refused(path, "rows go 26.57 degrees off east; expected a grid that is not rotated")


def test_web_mercator_is_brought_back_to_true_metres(tmp_path):
    # At 60 degrees its unit is half a metre of the sphere it draws.
    y = 6378137.0 * math.log(math.tan(math.pi / 4 + math.radians(60) / 2))
    keys = {1024: 1, 1025: 1, 3072: 3857, 3076: 9001}
    elevation = read_elevation(geotiff(tmp_path / "a.tif", HEIGHTMAP, keys, (10.0, 10.0), (0, 3, 0, 0, y, 0)))
    assert elevation.spacing == pytest.approx((5.0, 5.0), rel=1e-6)


def test_a_texel_size_without_a_unit_is_not_believed(tmp_path):
    elevation = read_elevation(geotiff(tmp_path / "a.tif", HEIGHTMAP, {}, (10.0, 10.0)))
    assert elevation.spacing is None and "does not say" in elevation.notes[0]
    assert elevation.in_metres and "metres are assumed" in elevation.assumed
    at_the_pole = geotiff(tmp_path / "b.tif", HEIGHTMAP, {1024: 2}, (0.1, 0.1), (0, 0, 0, 0, 90.3, 0))
    assert read_elevation(at_the_pole).spacing is None


@pytest.mark.parametrize(
    ("dtype", "value", "text"),
    [
        ("i2", -9999, "-9999"),
        ("i2", -32768, ""),
        ("u2", 0, "0"),
        ("f4", -9999, "-9999.0 "),
        ("f4", -3.4028234663852886e38, "-3.40282346638529e+38"),
        ("f4", -3.4028230607370965e38, "-3.4028231e+38"),
        ("f8", -1.7976931348623157e308, "-1.7976931348623157e+308"),
        ("f4", np.nan, "nan"),
    ],
)
def test_no_data_becomes_nan(tmp_path, dtype, value, text):
    heightmap = HEIGHTMAP.astype(dtype)
    heightmap[1, 3] = value
    elevation = read_elevation(geotiff(tmp_path / "a.tif", heightmap, {1024: 1}, no_data=text))
    expected = HEIGHTMAP.astype(np.float32)
    expected[1, 3] = np.nan
    assert_heightmap(elevation, expected)
    assert elevation.missing == 1 and elevation.lowest == np.nanmin(expected)


@pytest.mark.parametrize("text", ["-9999", "0.5", "nonsense", "nan", "1e99"])
def test_a_no_data_value_that_the_numbers_cannot_have_is_ignored(tmp_path, text):
    elevation = read_elevation(geotiff(tmp_path / "a.tif", HEIGHTMAP.astype("u2"), {1024: 1}, no_data=text))
    assert elevation.missing == 0


# NumPy


@pytest.mark.parametrize("dtype", ["u1", "<i2", ">i2", ">f4", "<f8", "f2", "i8"])
@pytest.mark.parametrize("by_columns", [False, True])
def test_npy_of_every_kind_of_number(tmp_path, dtype, by_columns):
    heightmap = np.asarray((HEIGHTMAP % 200).astype(dtype), order="F" if by_columns else "C")
    np.save(tmp_path / "a.npy", heightmap)
    elevation = read_elevation(tmp_path / "a.npy")
    assert_heightmap(elevation, heightmap)
    assert elevation.spacing is None and elevation.in_metres and "metres are assumed" in elevation.assumed


def test_the_jacksboro_fault_has_its_true_size(on_ellipsoid):
    path = GLSL / "sketches" / "data" / "jacksboro_fault_dem.npz"
    elevation = read_elevation(path)
    assert elevation.size == (403, 344) and elevation.in_metres
    assert (elevation.lowest, elevation.highest, elevation.missing) == (236, 1076, 0)
    with np.load(path) as file:
        np.testing.assert_array_equal(elevation.heights, file["elevation"][::-1])  # row 0 in the south
    # From one edge to the other, by steps along the ellipsoid.
    latitudes = np.linspace(36.73291666666667 - 0.5 / 1200, 36.44625 + 0.5 / 1200, 344)
    points = np.array([on_ellipsoid(v, 0.0) for v in latitudes])
    depth = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    width = 402 * np.linalg.norm(on_ellipsoid(36.58958333, 1 / 1200) - on_ellipsoid(36.58958333, 0.0))
    assert elevation.extent == pytest.approx((width, depth), rel=1e-6)


def test_npz_in_metres_and_other_names(tmp_path):
    np.savez(tmp_path / "a.npz", dem=HEIGHTMAP, dx=25, dy=np.array([30.0]), title=np.array("x"))
    elevation = read_elevation(tmp_path / "a.npz")
    assert_heightmap(elevation, HEIGHTMAP)
    assert elevation.spacing == (25.0, 30.0) and elevation.in_metres and not elevation.assumed
    np.savez_compressed(tmp_path / "b.npz", other=2 * HEIGHTMAP, elevation=HEIGHTMAP)
    elevation = read_elevation(tmp_path / "b.npz")
    assert_heightmap(elevation, HEIGHTMAP)
    assert elevation.spacing is None and elevation.in_metres and "metres are assumed" in elevation.assumed


def test_npz_bounds_in_metres_are_not_degrees(tmp_path):
    bounds = dict(xmin=0.0, xmax=80.0, ymin=0.0, ymax=50.0)
    np.savez(tmp_path / "a.npz", elevation=HEIGHTMAP, dx=10.0, dy=10.0, **bounds)
    assert read_elevation(tmp_path / "a.npz").spacing == (10.0, 10.0)
    np.savez(tmp_path / "b.npz", elevation=HEIGHTMAP, dx=0.01, dy=0.01, units="m", **bounds)
    assert read_elevation(tmp_path / "b.npz").spacing == (0.01, 0.01)
    np.savez(tmp_path / "c.npz", elevation=HEIGHTMAP, dx=0.1, dy=0.1, units="degrees", ymin=0.0, ymax=0.5)
    assert read_elevation(tmp_path / "c.npz").spacing == pytest.approx((11131.9, 11057.4), rel=1e-4)


def test_npz_without_one_grid_is_refused(tmp_path):
    np.savez(tmp_path / "a.npz", first=HEIGHTMAP, second=HEIGHTMAP, line=np.zeros(3))
    refused(tmp_path / "a.npz", "no array 'elevation' and 2 of two dimensions; it holds first, line, second")
    np.savez(tmp_path / "b.npz", line=np.zeros(3))
    refused(tmp_path / "b.npz", "and 0 of two dimensions")
    for extra, words in (
        ({"dx": np.zeros(3)}, "expected one number"),
        ({"dx": np.nan}, "finite number"),
        ({"dx": 0.0}, "are zero"),
        ({"dx": 1.0, "units": "furlong"}, "'furlong'; expected 'm'"),
        ({"dx": 1.0, "units": 3}, "expected a word"),
    ):
        np.savez(tmp_path / "c.npz", elevation=HEIGHTMAP, **extra)
        refused(tmp_path / "c.npz", words)


# Raw numbers


@pytest.mark.parametrize("ending", ["r16", "raw"])
def test_raw_numbers_are_square_unless_told(tmp_path, ending):
    heightmap = RNG.integers(0, 65536, (7, 7)).astype("<u2")
    (tmp_path / f"a.{ending}").write_bytes(heightmap.tobytes())
    elevation = read_elevation(tmp_path / f"a.{ending}")
    assert_heightmap(elevation, heightmap)
    assert elevation.code_range == (0, 65535) and not elevation.in_metres
    (tmp_path / f"b.{ending}").write_bytes(HEIGHTMAP.astype("<u2").tobytes())
    assert_heightmap(read_elevation(tmp_path / f"b.{ending}", raw_size=(9, 6)), HEIGHTMAP)


def test_raw_numbers_that_do_not_fit_are_sentences(tmp_path):
    path = tmp_path / "a.r16"
    path.write_bytes(HEIGHTMAP.astype("<u2").tobytes())
    refused(path, r"54 heights .* no square \(7 x 7 would be 49, 8 x 8 64\); raw_size could be 9 x 6")
    refused(path, "6 x 6 heights of 16 bits need 72; raw_size could be 9 x 6", raw_size=(6, 6))
    refused(path, "expected at least 2 x 2", raw_size=(54, 1))
    refused(path, "expected at least 2 x 2", raw_size=(-9, -6))
    refused(path, r"the most is 2\*\*28", raw_size=(100_000, 100_000))
    path.write_bytes(bytes(99))
    refused(path, "an odd number")
    path.write_bytes(bytes(32 * 32))
    refused(path, "it is 32 x 32 of 8 bits, which is not read here")
    path.write_bytes(bytes(2 * 1009))  # a prime
    refused(path, "raw_size must give its width and height")


@pytest.mark.parametrize(
    ("name", "middle"), [("N36W085.hgt", 36.5), ("s07e110.HGT", -6.5), ("S01E006.hgt", -0.5)]
)
def test_srtm_tiles_cover_a_degree(tmp_path, name, middle):
    heightmap = RNG.integers(-100, 4000, (1201, 1201)).astype(">i2")
    heightmap[5, 7] = -32768
    (tmp_path / name).write_bytes(heightmap.tobytes())
    elevation = read_elevation(tmp_path / name)
    assert elevation.extent == pytest.approx(degree_lengths(middle), rel=1e-12)
    assert elevation.in_metres and elevation.missing == 1 and np.isnan(elevation.heights[1200 - 5, 7])
    assert elevation.heights[1200, 60] == heightmap[0, 60]


def test_a_tile_whose_name_says_no_corner_is_refused(tmp_path):
    (tmp_path / "hill.hgt").write_bytes(np.full((1201, 1201), 5, ">i2").tobytes())
    refused(tmp_path / "hill.hgt", "is no SRTM tile; .* a name that says its corner, as N36W085.hgt")


# Whatever the format


def test_no_file_no_heights(tmp_path):
    np.save(tmp_path / "hill.npy", HEIGHTMAP)
    refused(tmp_path / "hil.npy", "no such file; did you mean 'hill.npy'")
    refused(tmp_path / "none" / "hill.npy", "no folder")
    refused(tmp_path, "is a folder")
    (tmp_path / "folder.tif").mkdir()
    refused(tmp_path / "folder.tif", "is a folder")
    for ending in ("png", "tif", "npy", "npz", "r16", "hgt"):
        (tmp_path / f"empty.{ending}").touch()
        refused(tmp_path / f"empty.{ending}", "the file is empty")
    (tmp_path / "land.jpg").write_bytes(b"x")
    refused(tmp_path / "land.jpg", r"'\.jpg' is no elevation format; readable are \.png, \.tif,")
    (tmp_path / "land").write_bytes(b"x")
    refused(tmp_path / "land", "without an ending")


def test_permission_denied_is_a_sentence(tmp_path, monkeypatch):
    for ending in ("png", "npy", "npz", "tif", "r16"):
        (tmp_path / f"a.{ending}").write_bytes(bytes(18))

    def denied(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    for name in ("pathlib.Path.open", "io.open", "builtins.open", "os.open", "numpy.fromfile"):
        monkeypatch.setattr(name, denied)
    for ending in ("png", "npy", "npz", "r16"):
        refused(tmp_path / f"a.{ending}", "cannot be read: Permission denied", raw_size=(3, 3))


@pytest.mark.parametrize("ending", ["png", "tif", "npy", "npz", "hgt"])
def test_rubbish_is_refused(tmp_path, ending):
    for content in (
        b"\0" * 300,
        b"II*\0" + b"\xff" * 300,
        b"PK\x03\x04" + bytes(40),
        b"\x93NUMPY\x01\0\x08\0rubbish!",
    ):
        (tmp_path / f"a.{ending}").write_bytes(content + b"x")
        refused(tmp_path / f"a.{ending}", "damaged or cut short|not a|is no SRTM tile")


def damage(path: Path) -> None:
    whole = path.read_bytes()
    for part in (0.3, 0.6, 0.9):
        path.write_bytes(whole[: int(part * len(whole)) // 2 * 2])
        refused(path, "cut short|no square|not a|damaged")


def test_files_cut_short_are_refused(tmp_path):
    heightmap = RNG.integers(0, 60000, (64, 64)).astype(np.uint16)
    PillowImage.fromarray(heightmap).save(tmp_path / "a.png")
    tifffile.imwrite(tmp_path / "a.tif", heightmap)
    tifffile.imwrite(tmp_path / "b.tif", heightmap, compression="zlib", rowsperstrip=8)
    np.save(tmp_path / "a.npy", heightmap)
    np.savez(tmp_path / "a.npz", heightmap)
    np.savez_compressed(tmp_path / "b.npz", heightmap)
    heightmap[:45].tofile(tmp_path / "a.r16")
    for path in sorted(tmp_path.iterdir()):
        damage(path)


def test_a_damaged_archive_is_refused(tmp_path):
    np.savez_compressed(tmp_path / "a.npz", RNG.integers(0, 60000, (64, 64)))
    content = bytearray((tmp_path / "a.npz").read_bytes())
    content[200:400] = bytes(200)
    (tmp_path / "a.npz").write_bytes(content)
    refused(tmp_path / "a.npz", "damaged or cut short")


@pytest.mark.parametrize(
    ("array", "words"),
    [
        (np.array([[1, "a"], [None, 2]], object), "Python objects, which are never loaded"),
        (np.array([["a", "b"], ["c", "d"]]), "holds <U1, not heights"),
        (np.zeros((4, 4), complex), "holds complex128, not heights"),
        (np.zeros((4, 4), bool), "holds bool, not heights"),
        (np.zeros((4, 4), "M8[s]"), "not heights"),
        (np.zeros((4, 4), [("ä", "f4")]), "not heights"),
        (np.zeros(16), "has 1 dimensions"),
        (np.zeros((4, 4, 3)), "has 3 dimensions"),
        (np.float32(1.0), "has 0 dimensions"),
        (np.zeros((1, 1)), "is 1 x 1 texels; expected at least 2 x 2"),
        (np.zeros((1, 9)), "is 9 x 1 texels"),
        (np.zeros((0, 4)), "is 4 x 0 texels"),
        (np.full((4, 4), np.nan), "no texel has any data"),
        (np.array([[0, np.inf], [0, 0]]), r"infinite, at texel \(1, 1\)"),
        (np.array([[0, 0], [1e300, 0]]), r"infinite, at texel \(0, 0\)"),
        (np.full((4, 4), -32768, np.int16), "no texel has any data"),
    ],
)
@pytest.mark.filterwarnings("ignore:Stored array in format 3.0")
def test_arrays_that_are_no_terrain_are_refused(tmp_path, array, words):
    np.save(tmp_path / "a.npy", array, allow_pickle=True)
    refused(tmp_path / "a.npy", words)
    if "objects" not in words and "ä" not in (array.dtype.names or ()):
        np.savez(tmp_path / "a.npz", elevation=array)
        refused(tmp_path / "a.npz", words)


def test_an_object_inside_an_archive_is_never_loaded(tmp_path):
    with (tmp_path / "a.npz").open("wb") as handle:
        np.savez(handle, elevation=np.array([[print]], object))
    refused(tmp_path / "a.npz", "Python objects")


def monstrous_header(shape: tuple[int, ...]) -> bytes:
    stream = io.BytesIO()
    header = {"descr": "<f8", "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(stream, header)
    return stream.getvalue() + bytes(1000)


def test_monsters_are_refused_by_their_header(tmp_path):
    (tmp_path / "a.npy").write_bytes(monstrous_header((10**6, 10**6)))
    refused(tmp_path / "a.npy", r"1000000 x 1000000 texels; the most is 2\*\*34")
    (tmp_path / "b.npy").write_bytes(monstrous_header((10_000, 10_000)))
    refused(tmp_path / "b.npy", "promises 800000000 bytes, 1000 are there")
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        archive.writestr("elevation.npy", monstrous_header((10**6, 10**6)))
    refused(tmp_path / "a.npz", r"the most is 2\*\*28")
    tifffile.imwrite(tmp_path / "a.tif", HEIGHTMAP, metadata=None)
    content = (tmp_path / "a.tif").read_bytes()
    with tifffile.TiffFile(tmp_path / "a.tif") as tif:
        places = [tif.pages[0].tags[code].valueoffset for code in (256, 257)]
        kinds = [tif.pages[0].tags[code].dtype for code in (256, 257)]
    for position, kind in zip(places, kinds, strict=True):
        huge = (60_000).to_bytes(2 if kind == 3 else 4, "little")
        content = content[:position] + huge + content[position + len(huge) :]
    (tmp_path / "a.tif").write_bytes(content)
    refused(tmp_path / "a.tif", r"60000 x 60000 texels; the most is 2\*\*28")


def test_large_offsets_that_float32_cannot_hold_are_reported(tmp_path):
    heightmap = 5e6 + RNG.random((6, 9))
    np.save(tmp_path / "a.npy", heightmap)
    assert read_elevation(tmp_path / "a.npy").notes == (
        "float64 heights up to 5e+06 are kept as float32, to 0.5 only",
    )
    np.save(tmp_path / "b.npy", heightmap - 5e6)
    assert read_elevation(tmp_path / "b.npy").notes == ()


def test_reading_twice_gives_the_same_and_cannot_be_changed(tmp_path):
    np.save(tmp_path / "a.npy", HEIGHTMAP)
    a, b = read_elevation(tmp_path / "a.npy"), read_elevation(str(tmp_path / "a.npy"))
    np.testing.assert_array_equal(a.heights, b.heights)
    with pytest.raises(ValueError, match="read-only"):
        a.heights[0, 0] = 1.0


def test_the_name_s_case_does_not_matter(tmp_path):
    np.save(tmp_path / "a.npy", HEIGHTMAP)
    shutil.move(tmp_path / "a.npy", tmp_path / "A.NPY")
    assert_heightmap(read_elevation(tmp_path / "A.NPY"), HEIGHTMAP)


# ── Gaps: a plane is its own smooth sheet ────────────────────────────────────


def plane(n: int) -> np.ndarray:
    y, x = np.mgrid[:n, :n] / (n - 1)
    return (1000.0 + 300.0 * x + 200.0 * y).astype(np.float32)


def test_gaps_are_refused_with_their_number_and_place():
    heights = plane(9)
    heights[3, 4] = heights[5, 1] = np.nan
    with pytest.raises(DataError, match=r"hill: 2 of 81 texels have no data, the first at \(4, 3\)"):
        fill_no_data(Elevation(heights, "hill"), "refuse")
    with pytest.raises(DataError, match="no such way with gaps: 'fil'; did you mean 'fill'"):
        fill_no_data(Elevation(heights, "hill"), "fil")  # type: ignore[arg-type]


@pytest.mark.parametrize("mode", ["refuse", "fill"])
def test_terrain_without_gaps_is_left_alone(mode):
    whole = Elevation(plane(9), "hill")
    assert fill_no_data(whole, mode) is whole


@pytest.mark.parametrize("n", [33, 100, 257])
def test_a_hole_in_a_plane_is_filled_by_the_plane(n):
    y, x = np.mgrid[:n, :n] / (n - 1)
    heights = plane(n)
    heights[(x - 0.5) ** 2 + (y - 0.45) ** 2 < 0.09] = np.nan
    elevation = fill_no_data(Elevation(heights, "hill", spacing=(2.0, 2.0), in_metres=True), "fill")
    assert np.abs(elevation.heights - plane(n)).max() < 0.005 * 500.0
    existing = ~np.isnan(heights)
    np.testing.assert_array_equal(elevation.heights[existing], heights[existing])
    assert elevation.missing == 0 and elevation.spacing == (2.0, 2.0) and elevation.in_metres
    assert "were filled" in elevation.notes[0]


def test_a_fill_is_smooth_within_range_and_the_same_each_time():
    y, x = np.mgrid[:129, :200] / 60.0
    heights = (100 * np.sin(3 * x) * np.cos(2 * y)).astype(np.float32)
    heightmap = heights.copy()
    heightmap[:40, :50] = heightmap[60:90, 100:160] = np.nan
    heightmap[RNG.random(heightmap.shape) < 0.2] = np.nan
    item, two = (fill_no_data(Elevation(heightmap, "hill"), "fill").heights for _ in range(2))
    np.testing.assert_array_equal(item, two)
    assert np.nanmin(heightmap) <= item.min() and item.max() <= np.nanmax(heightmap)
    steepest = np.abs(np.diff(heights, axis=1)).max()
    assert np.abs(np.diff(item, axis=1)).max() < 3 * steepest


def test_one_known_texel_fills_the_terrain():
    heights = np.full((37, 21), np.nan, np.float32)
    heights[30, 2] = 7.25
    assert (fill_no_data(Elevation(heights, "hill"), "fill").heights == np.float32(7.25)).all()


def test_a_fill_keeps_the_symmetry_of_the_terrain():
    heights = plane(65)
    heights[20:45, 20:45] = np.nan
    a = fill_no_data(Elevation(heights, "a"), "fill").heights
    b = fill_no_data(Elevation(np.ascontiguousarray(heights[:, ::-1]), "b"), "fill").heights
    np.testing.assert_allclose(a, b[:, ::-1], atol=1.0)


# ── Lengths of a degree: published tables, and distances along the ellipsoid ─


# National Geospatial-Intelligence Agency, "Length of a degree of latitude and longitude", WGS 84, km.
@pytest.mark.parametrize(
    ("latitude", "north", "east"),
    [
        (0, 110.574, 111.320),
        (15, 110.649, 107.550),
        (30, 110.852, 96.486),
        (45, 111.132, 78.847),
        (60, 111.412, 55.800),
        (75, 111.618, 28.902),
        (90, 111.694, 0.000),
    ],
)
def test_a_degree_is_as_long_as_the_tables_say(latitude, north, east):
    assert degree_lengths(latitude) == pytest.approx((1000 * east, 1000 * north), abs=0.6)
    assert degree_lengths(-latitude) == degree_lengths(latitude)


@pytest.mark.parametrize("latitude", [-63.2, 0.0, 12.5, 36.59, 80.0])
def test_short_steps_in_space_are_as_long_as_their_degrees(on_ellipsoid, latitude):
    step = 1 / 1200
    east, north = degree_lengths(latitude)
    over = np.linalg.norm(on_ellipsoid(latitude, step) - on_ellipsoid(latitude, 0.0))
    up = np.linalg.norm(on_ellipsoid(latitude + step / 2, 0.0) - on_ellipsoid(latitude - step / 2, 0.0))
    np.testing.assert_allclose([east * step, north * step], [over, up], rtol=1e-7)

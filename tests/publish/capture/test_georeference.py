"""What is exported lies where the file of its terrain does, as GDAL sees it."""

from __future__ import annotations

import json

import numpy as np
import pytest
import rasterio
from rasterio.crs import CRS
from rasterio.transform import Affine

from playground.data.elevation import read_elevation
from playground.publish.export import export

HEIGHTS = np.random.default_rng(4).normal(700.0, 200.0, (19, 31)).astype(np.float32)  # north row first
METRES = Affine(12.5, 0.0, 400_123.5, 0.0, -7.0, 5_300_000.25)
DEGREES = Affine(1 / 1200, 0.0, 10.1, 0.0, -1 / 900, 46.7)
SOUTH_UP = Affine(12.5, 0.0, 400_123.5, 0.0, 7.0, 5_300_000.25)
LAEA = "+proj=laea +lat_0=52 +lon_0=10 +x_0=4321000 +y_0=3210000 +ellps=GRS80 +units=m"


def dem(path, crs, transform, point=False, heights=HEIGHTS, **options):
    rows, cols = heights.shape
    facts = {"driver": "GTiff", "width": cols, "height": rows, "count": 1, "dtype": heights.dtype}
    with rasterio.open(path, "w", **facts, crs=crs, transform=transform, **options) as file:
        file.write(heights, 1)
        if point:
            file.update_tags(AREA_OR_POINT="Point")
    return path


def of_terrain(folder, engine, file, ending=".tif", values=None, **options):
    out = folder / f"out{ending}"
    toml = folder / "sketch.toml"
    toml.write_text(
        f'format = 1\n[[pass]]\nname = "height"\nuse = "generation/heightmap"\n'
        f'set = {{ elevation = "{file.name}", no_data = "fill" }}\n'
    )
    from playground.sketch.load import load

    sketch = load(toml)
    return export(sketch.with_values(values or {}), out, engine=engine, **options)


@pytest.mark.parametrize("point", [False, True])
@pytest.mark.parametrize(
    ("crs", "transform"),
    [
        ("EPSG:32633", METRES),
        ("EPSG:2056", METRES),
        ("EPSG:3857", METRES),
        ("EPSG:32633+5773", METRES),  # with heights of their own
        (LAEA, METRES),  # with no code
        ("EPSG:4326", DEGREES),
        ("EPSG:4269", DEGREES),
    ],
)
def test_export_at_native_size_preserves_georeference(tmp_path, any_engine, crs, transform, point):
    path = dem(tmp_path / "dem.tif", crs, transform, point)
    made = of_terrain(tmp_path, any_engine, path)
    assert "in its place" in made.summary and not made.warnings
    with rasterio.open(path) as before, rasterio.open(made.path) as after:
        assert after.crs == before.crs and after.shape == before.shape
        # To the last bit but one: the half texel is taken off and put on again.
        np.testing.assert_allclose(after.transform, before.transform, rtol=4e-16, atol=0)
        assert after.tags()["AREA_OR_POINT"] == before.tags()["AREA_OR_POINT"]
        # Heights go through 0 to 1 in float32: two roundings, of a span of some 1300 m.
        np.testing.assert_allclose(after.read(1), before.read(1), rtol=0, atol=4e-4)


def test_south_up_file_exports_north_up_with_same_bounds(tmp_path, any_engine):
    path = dem(tmp_path / "dem.tif", "EPSG:32633", SOUTH_UP)
    with rasterio.open(path) as before, rasterio.open(of_terrain(tmp_path, any_engine, path).path) as after:
        assert (after.bounds.left, after.bounds.right) == (before.bounds.left, before.bounds.right)
        assert {after.bounds.bottom, after.bounds.top} == {before.bounds.bottom, before.bounds.top}
        assert after.transform.e < 0
        np.testing.assert_allclose(after.read(1)[::-1], before.read(1), rtol=0, atol=4e-4)


@pytest.mark.parametrize("size", [(61, 37), (16, 10), (7, 19)])
def test_at_another_size_the_outermost_nodes_stay_where_they_are(tmp_path, any_engine, size):
    path = dem(tmp_path / "dem.tif", "EPSG:32633", METRES)
    made = of_terrain(tmp_path, any_engine, path, values={"size": size})
    with rasterio.open(path) as before, rasterio.open(made.path) as after:
        assert (after.width, after.height) == size
        for corner in ((0, 0), (-1, -1)):
            there = before.transform @ (
                0.5 if corner[0] == 0 else before.width - 0.5,
                0.5 if corner[1] == 0 else before.height - 0.5,
            )
            here = after.transform @ (
                0.5 if corner[0] == 0 else after.width - 0.5,
                0.5 if corner[1] == 0 else after.height - 0.5,
            )
            np.testing.assert_allclose(here, there, rtol=1e-14)
            np.testing.assert_allclose(after.read(1)[corner], before.read(1)[corner], atol=4e-4)


def test_feet_are_written_as_the_metres_that_they_are_read_as(tmp_path, any_engine):
    import tifffile

    path = tmp_path / "dem.tif"
    keys = (1, 1, 1, 5, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 2264, 4096, 0, 1, 6360, 4099, 0, 1, 9003)
    tags = [
        (33550, "d", 3, (30.0, 30.0, 0.0), True),
        (33922, "d", 6, (0, 0, 0, 1e6, 6e5, 0), True),
        (34735, "H", len(keys), keys, True),
    ]
    tifffile.imwrite(path, HEIGHTS, extratags=tags, metadata=None, photometric="minisblack")
    made = of_terrain(tmp_path, any_engine, path)
    with rasterio.open(made.path) as after:
        np.testing.assert_allclose(after.read(1), HEIGHTS * (1200 / 3937), rtol=1e-6)
        assert CRS.from_epsg(2264).to_epsg() == 2264 and after.crs.to_epsg() == 2264, (
            "no height system in feet"
        )


@pytest.mark.parametrize("bits", [16, 32])
@pytest.mark.parametrize(
    ("crs", "unit", "factor"),
    [
        ("EPSG:2264+6360", None, 1200 / 3937),
        ("EPSG:2264+5703", None, 1.0),
        ("EPSG:2264", None, 1200 / 3937),  # as of its cells
        ("EPSG:32633", "ft", 0.3048),
        ("EPSG:32633+5773", None, 1.0),
    ],
)
def test_exported_heights_state_that_they_are_metres(tmp_path, any_engine, crs, unit, factor, bits):
    path = dem(tmp_path / "dem.tif", crs, METRES)
    if unit:
        with rasterio.open(path, "r+") as file:
            file.set_band_unit(1, unit)
    made = of_terrain(tmp_path, any_engine, path, bits=bits)
    with rasterio.open(made.path) as after:
        metres = after.read(1) * after.scales[0] + after.offsets[0]
        # Whole numbers are off by half a step, and float32 by two roundings of some 1300 m.
        np.testing.assert_allclose(
            metres, HEIGHTS * factor, rtol=0, atol=(0.51 * after.scales[0] if bits == 16 else 0) + 4e-4
        )
        assert after.units == ("m",)
        vertical = after.crs.to_wkt().partition("VERT_CS")[2]
        assert "foot" not in vertical and bool(vertical) is ("+57" in crs)
    np.testing.assert_allclose(read_elevation(made.path).heights[::-1], metres, rtol=1e-6)


def test_a_prj_without_a_code_keeps_its_system(tmp_path, any_engine):
    path = tmp_path / "dem.asc"
    lines = ["ncols 3", "nrows 2", "xllcorner 1000", "yllcorner 2000", "cellsize 25"]
    path.write_text("\n".join([*lines, "1 2 3", "4 5 6"]))
    path.with_suffix(".prj").write_text(CRS.from_epsg(2154).to_wkt(version="WKT1_ESRI"))
    made = of_terrain(tmp_path, any_engine, path)
    with rasterio.open(made.path) as after:
        assert tuple(after.bounds) == (1000.0, 2000.0, 1075.0, 2050.0) and after.crs.to_epsg() == 2154
    assert not made.warnings


def test_colours_and_whole_numbers_lie_there_too(tmp_path, any_engine):
    path = dem(tmp_path / "dem.tif", "EPSG:32633", METRES)
    made = of_terrain(tmp_path, any_engine, path, bits=16)
    with rasterio.open(path) as before, rasterio.open(made.path) as after:
        assert after.crs == before.crs and after.transform == before.transform
        metres = after.read(1) * after.scales[0] + after.offsets[0]
        np.testing.assert_allclose(metres, HEIGHTS, atol=0.51 * after.scales[0] + 4e-4)


def test_a_raw_file_s_json_says_where_it_lies(tmp_path, any_engine):
    path = dem(tmp_path / "dem.tif", "EPSG:4326", DEGREES)
    made = of_terrain(tmp_path, any_engine, path, ".r32")
    said = json.loads(made.sidecars[0].read_text())
    assert said["crs"] == "EPSG:4326"
    west, south, east, north = said["bounds"]
    assert (west, north) == pytest.approx((10.1 + 1 / 2400, 46.7 - 1 / 1800), rel=1e-15)
    assert (east - west, north - south) == pytest.approx((30 / 1200, 18 / 900), rel=1e-12)


def test_exported_line_matches_its_geographic_coordinates(tmp_path, any_engine):
    """From a file of elevations and one of lines to a GeoTIFF: opened, drawn, written, opened again."""
    from rasterio.warp import transform

    utm = Affine(20.0, 0.0, 376_000.0, 0.0, -30.0, 5_229_500.0)
    south, east = np.mgrid[:81, :91]
    hills = (600 + 50 * np.sin(south / 9) * np.cos(east / 11)).astype(np.float32)
    path = dem(tmp_path / "dem.tif", "EPSG:32633", utm, heights=hills)
    line = {"type": "LineString", "coordinates": [[13.362, 47.19], [13.385, 47.214]]}
    (tmp_path / "line.geojson").write_text(json.dumps(line))
    (tmp_path / "sketch.toml").write_text(
        f'format = 1\n[[pass]]\nname = "height"\nuse = "generation/heightmap"\n'
        f'set = {{ elevation = "{path.name}" }}\n'
        f'[[pass]]\nname = "line"\nuse = "texturing/vectors/drawn"\n'
        f'set = {{ vectors = "line.geojson", elevation = "{path.name}", width = 60.0 }}\n'
        f'[view]\nuse = "view/terrain"\n'
    )
    made = export(tmp_path / "sketch.toml", tmp_path / "line.tif", texture="line", engine=any_engine)
    with rasterio.open(made.path) as after, rasterio.open(path) as before:
        assert after.crs == before.crs and after.transform == before.transform
        rows, cols = np.nonzero(after.read(1) > 0.9)
        x, y = after.transform @ (cols + 0.5, rows + 0.5)
        longitude, latitude = map(np.array, transform(after.crs, "EPSG:4326", x, y))
    assert len(rows) > 80
    share = (latitude - 47.19) / 0.024
    off = (longitude - (13.362 + 0.023 * share)) * np.cos(np.radians(47.2)) * 111_320
    # Texels that are covered nearly whole lie within the line's half width of its middle, and none outside.
    assert np.abs(off).max() < 60.0 and abs(off.mean()) < 5.0
    assert share.min() > -0.02 and share.max() < 1.02


def test_what_has_no_number_is_no_data_to_gdal(tmp_path, any_engine):
    (tmp_path / "holes.glsl").write_text(
        '#pragma kernel(output = "height:r32f")\n'
        "float kernel(ivec2 texel) { return texel.x == 2 ? uintBitsToFloat(0x7fc00000u) : 0.5; }\n"
    )
    (tmp_path / "sketch.toml").write_text(
        'format = 1\nsize = 9\n[[pass]]\nname = "height"\nuse = "./holes"\n[view]\nuse = "view/map"\n'
        'inputs = { shown = "height" }\n'
    )
    made = export(tmp_path / "sketch.toml", tmp_path / "a.tif", texture="height", engine=any_engine)
    with rasterio.open(made.path) as after:
        assert np.isnan(after.nodata) and after.read(1, masked=True).mask[:, 2].all()


ERODED = """format = 1
[[pass]]
name = "raw"
use  = "generation/heightmap"
set  = { elevation = "dem.tif" }
[[pass]]
name   = "height"
use    = "erosion/hydraulic"
inputs = { height = "raw" }
set    = { hours = 100, rain = 0.02 }
[[pass]]
name   = "streams"
use    = "texturing/mask"
inputs = { amount = "height:flow" }
set    = { from = 20.0, to = 1000.0, by_factors = true }
[[pass]]
name = "ground"
use  = "texturing/height_colour"
[[pass]]
name   = "colour"
use    = "texturing/waters"
inputs = { colour = "ground", river = "streams", wetness = "height:wetness" }
[[pass]]
name = "light"
use  = "lighting/ray_cast"
[view]
use = "view/terrain"
"""


@pytest.mark.slow
def test_eroded_textured_dem_exports_at_its_original_location(tmp_path, any_engine):
    """A file is opened, eroded, textured by its streams, exported, and opened again by GDAL."""
    from playground.paths import SKETCHES
    from playground.sketch.load import load

    real = np.load(SKETCHES / "data" / "jacksboro_fault_dem.npz")
    texel = float(real["dx"])
    affine = Affine(texel, 0.0, float(real["xmin"]), 0.0, -texel, float(real["ymin"]))
    path = dem(tmp_path / "dem.tif", "EPSG:4269", affine, heights=real["elevation"].astype(np.float32))
    (tmp_path / "sketch.toml").write_text(ERODED)
    sketch = load(tmp_path / "sketch.toml")
    heights = export(sketch, tmp_path / "worn.tif", engine=any_engine).path
    colours = export(sketch, tmp_path / "colours.tif", engine=any_engine, texture="colour").path
    wear, deposit, streams = (
        any_engine.read(sketch, name)[::-1].astype(float).copy()
        for name in ("height:wear", "height:deposit", "streams")
    )
    with rasterio.open(path) as before, rasterio.open(heights) as after, rasterio.open(colours) as shown:
        for file in (after, shown):
            assert file.crs == before.crs and file.shape == before.shape
            np.testing.assert_allclose(file.transform, before.transform, rtol=4e-16, atol=0)
        # What is higher or lower than it was is what the water took and laid down: to float32 of 1 km.
        change = after.read(1).astype(float) - before.read(1)
        np.testing.assert_allclose(change, deposit - wear, rtol=0, atol=1e-3)
        # That something happened, no more: the water took rock, and not the mountains.
        assert 0.1 < wear.mean() < 50 and after.read(1).dtype == np.float32
        assert shown.dtypes[0] == "float32"
        red, _, blue = (band.astype(float) for band in shown.read()[:3])
        # Likewise: streams are seen at all, in linear light.
        bluer = (blue - red)[streams > 0.9].mean() - (blue - red)[streams < 0.1].mean()
        assert bluer > 0.1, "streams are seen"

"""Heights in metres whatever unit their file has, and kept where cells have no metres; against GDAL."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
import rasterio
import tifffile
from PIL import Image
from rasterio.crs import CRS
from rasterio.transform import Affine

import playground
from playground.data.elevation import read_elevation
from playground.data.place import metres_in

from ..elevations import geotiff

FOOT, SURVEY_FOOT = 0.3048, 1200 / 3937
NUMBERS = np.add.outer(np.arange(9.0), np.arange(9.0)).astype(np.float32) * 100  # 0 .. 1600
PLACE = Affine(30.0, 0.0, 500_000.0, 0.0, -30.0, 5_000_000.0)
DEGREES = Affine(1e-3, 0.0, 10.0, 0.0, -1e-3, 46.0)


def raster(path, crs="EPSG:32633", unit="", driver="GTiff", values=NUMBERS, scale=1.0, offset=0.0, **options):
    rows, cols = values.shape
    facts = {"driver": driver, "width": cols, "height": rows, "count": 1, "dtype": values.dtype}
    degrees = DEGREES if crs and CRS.from_user_input(crs).is_geographic else PLACE
    with rasterio.open(path, "w", **facts, crs=crs, transform=degrees, **options) as file:
        file.write(values, 1)
        if unit:
            file.set_band_unit(1, unit)
        if (scale, offset) != (1.0, 0.0):
            file.scales, file.offsets = (scale,), (offset,)
    return path


def keyed(path, keys, metadata="", aux=""):
    if aux:
        band = f'<PAMRasterBand band="1">{aux}</PAMRasterBand>'
        Path(f"{path}.aux.xml").write_text(f"<PAMDataset>{band}</PAMDataset>")
    return geotiff(path, NUMBERS, keys, (30.0, 30.0), (0, 0, 0, 1e6, 6e5, 0), metadata=metadata)


def assert_metres(path, factor, numbers=NUMBERS):
    elevation = read_elevation(path)
    assert elevation.in_metres
    np.testing.assert_allclose(elevation.heights[::-1], numbers * factor, rtol=1e-6)
    return elevation


def rows_of_proj(query):
    database = Path(rasterio.__file__).parent / "proj_data" / "proj.db"
    if not database.exists():
        pytest.skip("rasterio has no database of PROJ beside it")
    with closing(sqlite3.connect(database)) as opened:
        return dict(opened.execute(query).fetchall())


@pytest.mark.parametrize(
    ("metres", "names"),
    [
        (FOOT, "ft, foot, feet, Foot, FT, international foot, feet (international), foot_intl"),
        (SURVEY_FOOT, "us-ft, ftUS, ft (US), US survey foot, us_survey_feet, Foot_US, US-Foot, survey foot"),
        (1.0, "m, metre, metres, Meter, meters"),
        (0.01, "cm, centimetre, centimeters"),
        (0.001, "mm, millimetres"),
        (1000.0, "km, kilometre, kilometers"),
        (0.9144, "yd, yard, yards"),
        (1.8288, "fathom, fathoms, fath"),
        (None, "K, degrees, furlong, 0.1 m, m2, s, "),
    ],
)
def test_names_of_units(metres, names):
    for name in names.split(", "):
        assert metres_in(name) == metres, name


FEET = {
    "band in ft": ("EPSG:32633", "ft", FOOT),
    "band in us-ft": ("EPSG:32633", "us-ft", SURVEY_FOOT),
    "band in US survey foot": ("EPSG:4326", "US survey foot", SURVEY_FOOT),
    "band in cm": ("EPSG:32633", "cm", 0.01),
    "band in metres, system in feet": ("EPSG:2264+6360", "m", 1.0),
    "vertical in US survey feet": ("EPSG:32633+6360", "", SURVEY_FOOT),
    "vertical in feet": ("EPSG:32633+8228", "", FOOT),
    "vertical in metres, map in feet": ("EPSG:2264+5703", "", 1.0),
    "geographic, vertical in feet": ("EPSG:6318+6360", "", SURVEY_FOOT),
    "compound with a code": ("EPSG:8768", "", SURVEY_FOOT),
    "no system, band in ft": (None, "ft", FOOT),
}


@pytest.mark.parametrize("compress", [None, "zstd"])
@pytest.mark.parametrize("form", FEET)
def test_a_geotiff_s_heights_are_in_metres(tmp_path, form, compress):
    crs, unit, factor = FEET[form]
    path = raster(tmp_path / "a.tif", crs, unit, compress=compress)
    assert not assert_metres(path, factor).assumed


@pytest.mark.parametrize(
    ("crs", "unit", "factor"),
    [
        ("EPSG:32633", 1.0, 1.0),
        ("EPSG:2264", SURVEY_FOOT, SURVEY_FOOT),
        ("EPSG:2264+5703", SURVEY_FOOT, 1.0),
        ("EPSG:26918+8052", 1.0, SURVEY_FOOT),
    ],
)
def test_a_citation_of_esri_s_says_both_units(tmp_path, crs, unit, factor):
    path = raster(tmp_path / "a.tif", crs, GEOTIFF_KEYS_FLAVOR="ESRI_PE")
    assert assert_metres(path, factor).spacing == pytest.approx((30 * unit,) * 2)


@pytest.mark.parametrize("dtype", ["f4", "i2", "u2", "u1"])
def test_scale_and_offset_are_in_the_unit(tmp_path, dtype):
    values = (NUMBERS / 10).astype(dtype)
    path = raster(tmp_path / "a.tif", unit="ft", values=values, scale=0.5, offset=-40.0)
    assert_metres(path, FOOT, values.astype(float) * 0.5 - 40.0)


@pytest.mark.parametrize(("driver", "ending"), [("AAIGrid", "asc"), ("EHdr", "bil"), ("EHdr", "flt")])
def test_grids_have_their_unit_next_to_them(tmp_path, driver, ending):
    path = raster(tmp_path / f"a.{ending}", unit="ft", driver=driver, scale=2.0)
    assert not assert_metres(path, 2 * FOOT).assumed
    path = raster(tmp_path / f"b.{ending}", crs="EPSG:32633+6360", driver=driver)
    assert not assert_metres(path, SURVEY_FOOT).assumed
    path = raster(tmp_path / f"c.{ending}", driver=driver)
    assert "metres are assumed" in assert_metres(path, 1.0).assumed


@pytest.mark.parametrize(
    ("lines", "factor", "cell"),
    [
        ("Projection UTM\nZone 33\nUnits METERS\nParameters\n", 1.0, 30.0),
        ("Projection UTM\nZone 33\nUnits FEET\nParameters\n", SURVEY_FOOT, 30.0 * SURVEY_FOOT),
    ],
)
def test_a_prj_of_lines_says_the_unit_of_its_cells(tmp_path, lines, factor, cell):
    path = raster(tmp_path / "a.asc", driver="AAIGrid")
    path.with_suffix(".prj").write_text(lines)
    result = assert_metres(path, factor)
    assert result.spacing == pytest.approx((cell, cell), rel=1e-5) and result.assumed


UTM = {1024: 1, 1025: 1, 3072: 32633}
UNIT_FT = '<Item name="UNITTYPE" sample="0" role="unittype">ft</Item>'


@pytest.mark.parametrize(
    ("keys", "metadata", "aux", "factor"),
    [
        (UTM | {4099: 9003}, "", "", SURVEY_FOOT),
        (UTM | {4096: 32767, 4099: 9002}, "", "", FOOT),
        (UTM | {4096: 6360}, "", "", SURVEY_FOOT),
        (UTM | {4096: 6360}, UNIT_FT, "", FOOT),  # what is said of the band counts more
        (UTM | {4096: 6360}, "", "<UnitType>m</UnitType>", 1.0),
        (UTM, UNIT_FT, "<UnitType>m</UnitType><Scale>2</Scale>", 2.0),
        (UTM | {4099: 9036}, "", "", 1000.0),
        (UTM | {4099: 9014}, "", "", 1.8288),
    ],
)
def test_keys_and_metadata_count_as_in_gdal(tmp_path, keys, metadata, aux, factor):
    path = keyed(tmp_path / "a.tif", keys, metadata, aux)
    names = rows_of_proj("select name, conv_factor from unit_of_measure where auth_name = 'EPSG'")
    with rasterio.open(path) as file:
        gdal = (names | {"m": 1.0, "ft": FOOT})[file.units[0]] * file.scales[0]
    assert gdal == pytest.approx(factor)
    assert not assert_metres(path, factor).assumed


@pytest.mark.parametrize(("code", "metres"), [(2264, SURVEY_FOOT), (2222, FOOT)])
def test_a_code_in_feet_scales_cells_without_a_unit(tmp_path, code, metres):
    elevation = read_elevation(keyed(tmp_path / "a.tif", {1024: 1, 1025: 1, 3072: code}))
    assert elevation.spacing == pytest.approx((30 * metres,) * 2)


@pytest.mark.parametrize(("driver", "ending"), [("GTiff", "tif"), ("EHdr", "bil")])
def test_a_system_stated_beside_a_file_counts(tmp_path, driver, ending):
    path = raster(tmp_path / f"a.{ending}", None, driver=driver)
    wkt = CRS.from_user_input("EPSG:2264+8228").to_wkt().replace('"', "&quot;")
    Path(f"{path}.aux.xml").write_text(f"<PAMDataset>\n  <SRS>{wkt}</SRS>\n</PAMDataset>")
    result = assert_metres(path, FOOT)
    assert result.spacing == pytest.approx((30 * SURVEY_FOOT,) * 2) and not result.assumed


@pytest.mark.parametrize("crs", ["EPSG:4807", "EPSG:4901"])
def test_cells_in_grads_are_nine_tenths_of_degrees(tmp_path, crs):
    tif = read_elevation(raster(tmp_path / "a.tif", crs=crs))
    north = 1e-3 * np.radians(0.9) * 6_367_500  # [m] on a sphere
    assert tif.spacing[1] == pytest.approx(north, rel=0.005)
    asc = read_elevation(raster(tmp_path / "a.asc", crs=crs, driver="AAIGrid"))
    assert asc.spacing == pytest.approx(tif.spacing)


@pytest.mark.parametrize(("crs", "factor"), [("EPSG:2264", SURVEY_FOOT), ("EPSG:2222", FOOT)])
def test_a_map_in_feet_has_heights_in_feet(tmp_path, crs, factor):
    result = assert_metres(raster(tmp_path / "a.tif", crs=crs), factor)
    assert result.assumed == "nothing says the unit of its heights; feet, as of its cells, are assumed"
    assert result.spacing == pytest.approx((30 * factor,) * 2)


@pytest.mark.parametrize("crs", ["EPSG:32633", "EPSG:4326", None])
def test_heights_without_a_unit_are_taken_for_metres(tmp_path, crs):
    result = assert_metres(raster(tmp_path / "a.tif", crs=crs), 1.0)
    assert result.assumed == "nothing says the unit of its heights; metres are assumed"


def test_an_unknown_unit_is_named(tmp_path):
    result = assert_metres(raster(tmp_path / "a.tif", unit="furlong"), 1.0)
    assert result.assumed == "its heights are in 'furlong', no unit of length here; metres are assumed"


@pytest.mark.parametrize(
    ("version", "crs", "factor"),
    [
        ("WKT1_GDAL", "EPSG:32633+6360", SURVEY_FOOT),
        ("WKT1_ESRI", "EPSG:2264+8228", FOOT),
        ("WKT2_2019", "EPSG:32633+6360", SURVEY_FOOT),
        ("WKT2_2019", "EPSG:4979", 1.0),
        ("WKT1_ESRI", "EPSG:4979", 1.0),
        ("WKT2_2019", "EPSG:2264+5703", 1.0),
    ],
)
def test_an_npz_s_text_of_its_system_says_the_unit(tmp_path, version, crs, factor):
    wkt = CRS.from_user_input(crs).to_wkt(version=version)
    step = 1e-3 if CRS.from_user_input(crs).is_geographic else 30.0
    bounds = {"xmin": 10.0, "xmax": 10.0 + 8 * step, "ymin": 20.0, "ymax": 20.0 + 8 * step}
    np.savez(tmp_path / "a.npz", elevation=NUMBERS, dx=step, dy=step, crs=wkt, **bounds)
    assert not assert_metres(tmp_path / "a.npz", factor).assumed
    np.savez(tmp_path / "b.npz", elevation=NUMBERS, dx=step, dy=step, crs=wkt, height_units="cm")
    assert not assert_metres(tmp_path / "b.npz", 0.01).assumed


def plain(path, values):
    tifffile.imwrite(path, values, photometric="minisblack", metadata=None)


def grid_of_text(path, values):
    header = f"ncols {values.shape[1]}\nnrows {values.shape[0]}\nxllcorner 0\nyllcorner 0\ncellsize 30\n"
    path.write_text(header + "\n".join(" ".join(map(str, row)) for row in values))


HEIGHTS = np.array([[100, 110, 120], [100, 110, 120], [100, 110, 130]], np.uint8)
WITHOUT_METRES = {
    "no system.tif": lambda path: raster(path, None, values=HEIGHTS.astype("f4")),
    "8 bits in a place.tif": lambda path: raster(path, values=HEIGHTS),
    "8 bits without a system.tif": lambda path: raster(path, None, values=HEIGHTS),
    "16 bits without a system.tif": lambda path: raster(path, None, values=HEIGHTS.astype("u2")),
    "floats.tif": lambda path: plain(path, HEIGHTS.astype("f4")),
    "signed.tif": lambda path: plain(path, HEIGHTS.astype("i2")),
    "bytes in ft.tif": lambda path: raster(path, None, "m", values=HEIGHTS),
    "no prj.asc": lambda path: grid_of_text(path, HEIGHTS),
    "floats.npy": lambda path: np.save(path, HEIGHTS.astype("f8")),
    "bytes.npy": lambda path: np.save(path, HEIGHTS),
    "archive.npz": lambda path: np.savez(path, elevation=HEIGHTS.astype("f4")),
}


@pytest.mark.parametrize("name", WITHOUT_METRES)
def test_numbers_keep_their_heights_without_cells(tmp_path, any_engine, name):
    """Heights and cells are two facts: what has heights in numbers keeps them."""
    WITHOUT_METRES[name](tmp_path / name)
    metres = any_engine.metres(playground.load(tmp_path / name), "height")
    np.testing.assert_allclose(metres[::-1], HEIGHTS, atol=1e-4)


PICTURES = {
    "8.png": lambda path: Image.fromarray(HEIGHTS).save(path),
    "16.png": lambda path: Image.fromarray(HEIGHTS.astype("u2")).save(path),
    "8.tif": lambda path: plain(path, HEIGHTS),
    "16.r16": lambda path: path.write_bytes(HEIGHTS.astype("<u2").tobytes()),
}


@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_is_stretched_and_that_is_reported_once(tmp_path, any_engine, name):
    PICTURES[name](tmp_path / name)
    reports: list[str] = []
    any_engine.warnings.report = lambda result: reports.append(result.message)
    sketch = playground.load(tmp_path / name)
    for size in ((16, 9), (9, 16)):
        any_engine.render(sketch, size=size)
    assert np.ptp(any_engine.metres(sketch, "height")) == pytest.approx(1800.0)
    assert sorted(reports) == [
        "its heights have no unit and are stretched to 0..1800 m",
        "nothing says how large it is; a width of 10240 m is assumed",
    ]
    reports.clear()
    any_engine.render(sketch.with_values({"relief": 300.0, "extent": (900.0, 900.0)}), size=(16, 9))
    assert not reports, "the sketch says it"


def test_what_is_assumed_of_a_unit_is_reported_once(tmp_path, any_engine):
    reports: list[str] = []
    any_engine.warnings.report = lambda result: reports.append(result.message)
    sketch = playground.load(raster(tmp_path / "a.tif"))
    for size in ((16, 9), (9, 16)):
        any_engine.render(sketch, size=size)
    assert reports == ["nothing says the unit of its heights; metres are assumed"]
    any_engine.render(playground.load(raster(tmp_path / "b.tif", unit="m")), size=(16, 9))
    assert len(reports) == 1

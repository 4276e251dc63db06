"""ESRI's grids, against numbers made here and against GDAL."""

from __future__ import annotations

import numpy as np
import pytest
import rasterio

from playground.data.elevation import read_elevation
from playground.data.place import degree_lengths
from playground.errors import DataError

RNG = np.random.default_rng(2)
HEIGHTS = RNG.integers(-40, 3000, (7, 5)).astype(np.float32)  # north row first
UTM = (
    'PROJCS["WGS_1984_UTM_Zone_33N",GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,'
    '298.257223563]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],'
    'PROJECTION["Transverse_Mercator"],PARAMETER["False_Easting",500000.0],PARAMETER["False_Northing",0.0],'
    'PARAMETER["Central_Meridian",15.0],PARAMETER["Scale_Factor",0.9996],'
    'PARAMETER["Latitude_Of_Origin",0.0],UNIT["Meter",1.0]]'
)
DEGREES = (
    'GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],'
    'PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]]'
)
FEET = UTM.replace('UNIT["Meter",1.0]', 'UNIT["Foot_US",0.3048006096012192]').replace("Zone_33N", "Zone_X")


def asc(path, heights=HEIGHTS, header="xllcorner 1000\nyllcorner 2000\ncellsize 25", prj=UTM, per_line=0):
    rows, cols = heights.shape
    lines = [f"ncols {cols}", f"NROWS {rows}", header, "NODATA_value -9999"]
    words = [f"{v:.9g}" for v in heights.ravel()]
    per_line = per_line or cols
    lines += [" ".join(words[k : k + per_line]) for k in range(0, len(words), per_line)]
    path.write_text("\n".join(lines) + "\n")
    if prj:
        path.with_suffix(".prj").write_text(prj)
    return path


def refused(path, words):
    with pytest.raises(DataError, match=words) as caught:
        read_elevation(path)
    assert caught.value.diagnostics[0].file


@pytest.mark.parametrize("per_line", [0, 1, 3, 35])
def test_a_grid_of_text_however_its_lines_part_it(tmp_path, per_line):
    elevation = read_elevation(asc(tmp_path / "a.asc", per_line=per_line))
    np.testing.assert_array_equal(elevation.heights[::-1], HEIGHTS)
    assert elevation.spacing == (25.0, 25.0) and elevation.in_metres and elevation.notes == ()
    # The corner is the cell's: its middle, the node, lies half a cell inside.
    assert elevation.place.bounds == (1012.5, 2012.5, 1112.5, 2162.5)
    assert elevation.place.crs.facts.epsg == 32633


def test_cell_registration_and_non_square_cells_set_bounds(tmp_path):
    header = "xllcenter 1000\nyllcenter 2000\ndx 10\ndy 20"
    elevation = read_elevation(asc(tmp_path / "a.asc", header=header))
    assert elevation.spacing == (10.0, 20.0) and elevation.place.bounds == (1000.0, 2000.0, 1040.0, 2120.0)


def test_cells_in_degrees_and_in_feet(tmp_path):
    header = "xllcenter 7\nyllcenter 46\ncellsize 0.01"
    elevation = read_elevation(asc(tmp_path / "a.asc", header=header, prj=DEGREES))
    east, north = degree_lengths(46.03)
    assert elevation.spacing == pytest.approx((0.01 * east, 0.01 * north), rel=1e-9)
    elevation = read_elevation(asc(tmp_path / "b.asc", prj=FEET))
    assert elevation.spacing == pytest.approx((25 * 1200 / 3937,) * 2, rel=1e-9)


def test_grid_without_prj_has_no_spacing_and_reports_it(tmp_path):
    elevation = read_elevation(asc(tmp_path / "a.asc", prj=""))
    assert elevation.spacing is None and elevation.in_metres
    assert "there is no a.prj next to it" in elevation.notes[0]


def test_no_data_of_text_becomes_nan(tmp_path):
    heights = HEIGHTS.copy()
    heights[2, 3] = -9999
    elevation = read_elevation(asc(tmp_path / "a.asc", heights))
    assert np.isnan(elevation.heights[::-1][2, 3]) and elevation.missing == 1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("ncols 5", "columns 5"), "is no ESRI grid; expected a header of ncols"),
        (("NROWS 7", "NROWS 9"), "damaged or cut short: .*File short"),
        (("cellsize 25", "cellsize -25"), "expected a grid that is not rotated"),
    ],
)
def test_a_header_that_is_wrong_is_a_sentence(tmp_path, change, words):
    path = asc(tmp_path / "a.asc", np.full_like(HEIGHTS, -9), per_line=1)
    path.write_text(path.read_text().replace(*change, 1))
    refused(path, words)


def flt(path, heights=HEIGHTS, order="LSBFIRST", prj=UTM):
    rows, cols = heights.shape
    heights.astype("<f4" if order == "LSBFIRST" else ">f4").tofile(path)
    lines = [f"ncols {cols}", f"nrows {rows}", "xllcorner 1000", "yllcorner 2000", "cellsize 25"]
    path.with_suffix(".hdr").write_text("\n".join([*lines, "NODATA_value -9999", f"byteorder {order}"]))
    path.with_suffix(".prj").write_text(prj)
    return path


@pytest.mark.parametrize("order", ["LSBFIRST", "MSBFIRST"])
def test_floats_with_a_header(tmp_path, order):
    elevation = read_elevation(flt(tmp_path / "a.flt", order=order))
    np.testing.assert_array_equal(elevation.heights[::-1], HEIGHTS)
    assert elevation.place.bounds == (1012.5, 2012.5, 1112.5, 2162.5)


def test_floats_without_their_header_or_cut_short(tmp_path):
    path = flt(tmp_path / "a.flt")
    path.write_bytes(path.read_bytes()[:-1])
    refused(path, "is cut short: it holds 139 bytes; 5 x 7 numbers of 32 bits need 140")
    path = flt(tmp_path / "a.flt")
    with path.with_suffix(".hdr").open("a") as header:
        header.write("\nTOTALROWBYTES 24")
    refused(path, "says that a row takes 24 bytes; 5 x 7 numbers of 32 bits take 20 each")
    path.with_suffix(".hdr").unlink()
    refused(path, "needs a.hdr next to it")


@pytest.mark.parametrize("name", ["a.asc", "a.flt"])
def test_gdal_reads_the_same_in_the_same_place(tmp_path, name):
    path = (asc if name == "a.asc" else flt)(tmp_path / name)
    elevation = read_elevation(path)
    with rasterio.open(path) as raster:
        np.testing.assert_array_equal(raster.read(1), elevation.heights[::-1])
        west, south, east, north = elevation.place.bounds
        assert tuple(raster.bounds) == (west - 12.5, south - 12.5, east + 12.5, north + 12.5)
        assert raster.crs.to_epsg() == elevation.place.crs.facts.epsg

"""Vector data: what files hold, where it lies on the terrain, how much of each texel it covers."""

from __future__ import annotations

import json
import math
import re

import numpy as np
import pytest

from playground.allowed_files import VECTORS
from playground.data import vectors
from playground.data.vectors import Grid, VectorShape, draw, read_vectors
from playground.engine.sources import source_kind
from playground.errors import DataError
from playground.extras import install_command
from playground.paths import GLSL
from playground.sketch.techniques import read_technique

from ..cases import each
from ..elevations import geotiff
from ..refusals import rows

RNG = np.random.default_rng(6)
FINE = 16  # texels of the truth in one, along each side


def shape(kind, *lines):
    return VectorShape(kind, tuple(np.array(line, np.float64) for line in lines))


# What covers a texel, counted on a fine grid.


def fine_places(size):
    nx, ny = size
    x, y = ((np.arange(n * FINE) + 0.5) / FINE - 0.5 for n in (nx, ny))
    return np.meshgrid(x, y)


def in_texels(fine):
    rows, cols = fine.shape
    return fine.reshape(rows // FINE, FINE, cols // FINE, FINE).mean(axis=(1, 3))


def within(places, lines, radius, spacing):
    """Return which places are so near to lines, each piece by itself."""
    x, y = places[0] * spacing[0], places[1] * spacing[1]
    result = np.zeros(x.shape, bool)
    for line in lines:
        line = line * np.array(spacing)
        for a, b in zip(line, line[1:] if len(line) > 1 else line, strict=False):
            along = b - a
            part = ((x - a[0]) * along[0] + (y - a[1]) * along[1]) / (along @ along or 1.0)
            part = np.clip(part, 0.0, 1.0)
            result |= np.hypot(x - a[0] - part * along[0], y - a[1] - part * along[1]) <= radius
    return result


def inside(places, rings):
    """Return which places have an odd number of edges in the west, one edge at a time."""
    x, y = places
    odd = np.zeros(x.shape, bool)
    for ring in rings:
        for (ax, ay), (bx, by) in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            if ay != by:
                crosses = (y >= min(ay, by)) & (y < max(ay, by))
                odd ^= crosses & (ax + (bx - ax) * (y - ay) / (by - ay) < x)
    return odd


@pytest.mark.parametrize("spacing", [(10.0, 10.0), (10.0, 25.0), (30.0, 7.0)])
@pytest.mark.parametrize("texels", [0.4, 1.0, 3.7])
def test_a_line_covers_as_much_of_each_texel_as_it_does(spacing, texels):
    size, width = (41, 29), texels * math.sqrt(spacing[0] * spacing[1])
    lines = [np.array([(-9.0, 3.3), (18.2, 11.7), (22.0, 40.0)]), np.array([(3.0, 26.0), (37.5, 20.25)])]
    made = draw([VectorShape("line", (line,)) for line in lines], Grid(size, spacing), width, filled=True)
    truth = in_texels(within(fine_places(size), lines, width / 2, spacing))
    # Straight edges to 0.05; at ends, bends and crossings two of them share a texel.
    assert np.abs(made - truth).max() < 0.35
    assert np.sqrt(np.mean((made - truth) ** 2)) < 0.02
    assert made.sum() == pytest.approx(truth.sum(), rel=0.03)


def test_points_are_discs_of_that_width():
    places = [(5.2, 7.9), (20.0, 3.0), (31.5, 20.5)]
    made = draw([shape("point", [p]) for p in places], Grid((41, 29), (10.0, 20.0)), 90.0, filled=True)
    # Of 4.5 by 9 texels: their edge is no straight line within one.
    assert made.sum() * 200.0 == pytest.approx(3 * math.pi * 45.0**2, rel=0.02)
    north, east = np.mgrid[:29, :41]
    for x, y in places:
        near = made * (np.hypot((east - x) * 10, (north - y) * 20) < 70)
        assert (near * east).sum() / near.sum() == pytest.approx(x, abs=0.05)
        assert (near * north).sum() / near.sum() == pytest.approx(y, abs=0.05)


HOLED = [
    [(4.3, 3.1), (36.2, 8.4), (30.7, 25.6), (9.9, 22.2)],
    [(14.5, 9.5), (14.5, 16.5), (24.5, 16.5), (24.5, 9.5)],
]


def test_polygon_with_hole_has_correct_texel_coverage():
    polygon = shape("polygon", *HOLED)
    made = draw([polygon], Grid((41, 29), (10.0, 10.0)), 1.0, filled=True)
    truth = in_texels(inside(fine_places((41, 29)), polygon.lines))
    assert np.abs(made - truth).max() < 0.3, "at the corners"
    assert np.sqrt(np.mean((made - truth) ** 2)) < 0.015
    # The hole's edges run between texels: exact.
    np.testing.assert_allclose(made[11:15, 16:23], 0.0, atol=1e-6)
    assert made[8, 20] == 1.0 and made[12, 8] == 1.0


def test_overlapping_polygons_merge_and_outlines_are_lines():
    a = shape("polygon", [(2.5, 2.5), (12.5, 2.5), (12.5, 12.5), (2.5, 12.5), (2.5, 2.5)])
    b = shape("polygon", [(8.5, 8.5), (18.5, 8.5), (18.5, 18.5), (8.5, 18.5)])
    grid = Grid((21, 21), (1.0, 1.0))
    made = draw([a, b], grid, 1.0, filled=True)
    assert made.sum() == pytest.approx(100 + 100 - 16, abs=1e-3) and made[10, 10] == 1.0
    outlined = draw([a], grid, 1.0, filled=False)
    assert outlined[7, 7] == 0.0 and outlined.sum() == pytest.approx(40.0, rel=0.05)


def test_shapes_far_beyond_bounds_are_clipped_to_terrain():
    around = shape("polygon", [(-1e7, -1e7), (1e7, -1e7), (1e7, 1e7), (-1e7, 1e7)])
    across = shape("line", [(-1e9, 10.0), (1e9, 10.0)])
    grid = Grid((31, 21), (5.0, 5.0))
    assert (draw([around], grid, 1.0, filled=True) == 1.0).all()
    made = draw([across, shape("point", [(1e8, 3.0)])], grid, 5.0, filled=True)
    np.testing.assert_allclose(made[10], 1.0, atol=1e-6)
    assert made[[0, 8, 12, 20]].max() == 0.0
    assert draw([], grid, 5.0, filled=True).max() == 0.0


@pytest.mark.slow
def test_a_long_and_winding_line_is_drawn_in_a_moment():
    walk = 300 + RNG.standard_normal((50_000, 2)).cumsum(0)
    made = draw([VectorShape("line", (walk,))], Grid((601, 601), (10.0, 10.0)), 15.0, filled=True)
    on = np.rint(walk[(walk > 1).all(axis=1) & (walk < 599).all(axis=1)]).astype(int)
    assert made[on[:, 1], on[:, 0]].min() > 0.5


def test_shapes_are_not_compared_with_one_another():
    compared = []

    class Compared(VectorShape):
        def __eq__(self, other):
            compared.append(other)
            return self is other

        __hash__ = VectorShape.__hash__

    ring = np.array([(2.5, 2.5), (12.5, 2.5), (12.5, 12.5)])
    shapes = [Compared(kind, (ring,)) for kind in ("polygon", "line") for _ in range(50)]
    draw(shapes, Grid((21, 21), (1.0, 1.0)), 1.0, filled=True)
    assert len(compared) <= len(shapes), "50 000 buildings would be compared a milliard times"


# Files


def geojson(path, *geometries, **further):
    features = [{"type": "Feature", "properties": None, "geometry": g} for g in geometries]
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features} | further))
    return path


def geometry(kind, coordinates):
    return {"type": kind, "coordinates": coordinates}


def test_every_kind_of_geometry_is_read_with_and_without_heights(tmp_path):
    ring = [[0, 0], [1, 0], [1, 1], [0, 0]]
    path = geojson(
        tmp_path / "a.geojson",
        geometry("Point", [1, 2, 99]),
        geometry("MultiPoint", [[1, 2], [3, 4, 5]]),
        geometry("LineString", [[1, 2], [3, 4]]),
        geometry("MultiLineString", [[[1, 2], [3, 4]], [[5, 6, 7], [7, 8, 9], [0, 0, 0]]]),
        geometry("Polygon", [ring, ring]),
        geometry("MultiPolygon", [[ring], [ring, ring]]),
        {"type": "GeometryCollection", "geometries": [geometry("Point", [7, 8])]},
        None,
    )
    result = read_vectors(path)
    kinds = ["point"] * 3 + ["line"] * 3 + ["polygon"] * 3 + ["point"]
    assert [s.kind for s in result.shapes] == kinds
    assert [len(s.lines) for s in result.shapes] == [1, 1, 1, 1, 1, 1, 2, 1, 2, 1]
    np.testing.assert_array_equal(result.shapes[5].lines[0], [[5, 6], [7, 8], [0, 0]])
    assert result.crs == "EPSG:4326"


HUGE = {
    "text": f'{{"type": "Point", "coordinates": [1{"0" * 400}, 1]}}',
    "names": "coordinates are no numbers",
}


@each("row", [*rows("geojson"), HUGE])
def test_what_is_wrong_with_a_file_is_a_sentence(tmp_path, row):
    (tmp_path / "a.json").write_text(row["text"])
    with pytest.raises(DataError, match=re.escape(row["names"])):
        read_vectors(tmp_path / "a.json")


def test_too_big_or_of_another_kind_is_a_sentence(tmp_path, monkeypatch):
    path = geojson(tmp_path / "a.geojson", geometry("Point", [1, 2]))
    monkeypatch.setattr(vectors, "MAX_BYTES", 20)
    with pytest.raises(DataError, match="of GeoJSON 0 are read at most"):
        read_vectors(path)
    with pytest.raises(DataError, match=r"'\.dxf' is no format of vector data; readable are \.geojson"):
        read_vectors(path.rename(tmp_path / "a.dxf"))


@pytest.mark.parametrize("ending", [e for e in VECTORS if "json" not in e])
def test_other_formats_are_read_by_ogr_or_name_the_extra(tmp_path, monkeypatch, ending):
    pyogrio = pytest.importorskip("pyogrio")  # of the extra gis
    path = tmp_path / f"a{ending}"
    lines = np.array([[7.0, 46.0], [7.25, 46.5], [7.5, 46.25]])
    blob = b"\x01" + np.array([2, 3], "<u4").tobytes() + lines.astype("<f8").tobytes()
    pyogrio.raw.write(
        path,
        np.array([blob], object),
        field_data=[],
        fields=[],
        geometry_type="LineString",
        crs="EPSG:4326",
        layer="routes" if ending == ".gpx" else None,
        driver="KML" if ending == ".kml" else None,
    )
    result = read_vectors(path)
    assert result.crs == "EPSG:4326" and [s.kind for s in result.shapes] == ["line"]
    np.testing.assert_allclose(result.shapes[0].lines[0], lines, atol=1e-9)
    path.write_bytes(b"<OGRVRTDataSource></OGRVRTDataSource>")
    with pytest.raises(DataError, match=f"is no {ending[1:]} file, although its name ends like one"):
        read_vectors(path)
    monkeypatch.setattr(vectors, "find_spec", lambda _: None)
    with pytest.raises(
        DataError, match=f"is read by OGR, which needs pyogrio: {re.escape(install_command('gis'))}"
    ):
        read_vectors(path)


_VRT = (
    "<OGRVRTDataSource>{0}<OGRVRTLayer name='secret'><SrcDataSource>{1}</SrcDataSource></OGRVRTLayer>"
    "</OGRVRTDataSource>"
)


@pytest.mark.parametrize("ending", [".kml", ".gpx", ".fgb"])
@pytest.mark.parametrize(
    "text",
    [
        _VRT.format("<!-- <{2} -->", "{1}"),
        "<?xml version='1.0'?><!-- <{2}> -->" + _VRT,
        "<!-- <{2}>" + "-" * 400 + "-->" + _VRT,
        "<{2}></{2}>" + _VRT,
        "<{2}><!--" + "-" * 2000 + "-->" + _VRT + "</{2}>",
        "fgb\x03fgb\x01" + _VRT,
        "<!-- <{2}> --><OGRWFSDataSource><URL>http://127.0.0.1:9/</URL></OGRWFSDataSource>",
        "<!DOCTYPE {2} [<!ENTITY a SYSTEM '{1}'>]><{2}>&a;</{2}>",
        "<{2} xmlns:gml='http://www.opengis.net/gml' xsi:schemaLocation='a http://127.0.0.1:9/'></{2}>",
    ],
    ids=["inside", "before", "long", "second", "deep", "marked", "network", "entity", "schema"],
)
def test_list_of_other_sources_is_refused_as_vector_file(tmp_path, ending, text):
    pytest.importorskip("pyogrio")  # of the extra gis
    private = geojson(tmp_path / "private.geojson", geometry("Point", [1, 2]))
    path = tmp_path / f"a{ending}"
    path.write_text(text.format("", private, ending[1:]))
    with pytest.raises(DataError, match=f"is no {ending[1:]} file, although its name ends like one"):
        read_vectors(path)


def test_what_ogr_takes_for_another_format_is_not_read(tmp_path, monkeypatch):
    pytest.importorskip("pyogrio")
    monkeypatch.setattr(vectors, "matches_ending", lambda *_: True)
    private = geojson(tmp_path / "private.geojson", geometry("Point", [1, 2]))
    path = tmp_path / "a.kml"
    path.write_text(_VRT.format("", private).replace("secret", "private"))
    with pytest.raises(DataError, match="is no kml file to OGR, but one of OGR_VRT"):
        read_vectors(path)


@pytest.mark.parametrize(
    "begin", ["", "\ufeff", "<?xml version='1.0'?>\n<!-- <a> --> <!--b-->\n", "<!--" + "a" * 5000 + "-->"]
)
def test_what_may_come_before_the_first_element_does(tmp_path, begin):
    pytest.importorskip("pyogrio")
    path = tmp_path / "a.kml"
    path.write_text(
        begin
        + '<kml xmlns="http://www.opengis.net/kml/2.2"><Document><Folder><name>a</name><Placemark><Point>'
        "<coordinates>7,46</coordinates></Point></Placemark></Folder></Document></kml>",
        "utf-8",
    )
    assert [s.kind for s in read_vectors(path).shapes] == ["point"]


# On the terrain

KIND = source_kind("vector_file")


def terrain(path, epsg, west, north, step, size=(61, 41), model=1):
    keys = {1024: model, 1025: 2, 3072 if model == 1 else 2048: epsg}
    return geotiff(path, np.zeros(size[::-1], np.float32), keys, step, (0.0, 0.0, 0.0, west, north, 0.0))


@pytest.fixture
def values(tmp_path):
    def values_(vector, elevation, **changes):
        defaults = {
            p.name: p.default for p in read_technique("texturing/vectors/drawn", GLSL, GLSL).parameters
        }
        return defaults | {"vectors": str(vector), "elevation": str(elevation)} | changes

    return values_


def centre(mask):
    rows, cols = np.mgrid[: mask.shape[0], : mask.shape[1]]
    return (mask * cols).sum() / mask.sum(), (mask * rows).sum() / mask.sum()


def test_the_kernel_declares_what_the_source_reads():
    parameters = read_technique("texturing/vectors/drawn", GLSL, GLSL).parameters
    assert set(KIND.parameters) == {p.name for p in parameters}
    menus = {p.name: p.widget.choices for p in parameters if p.widget.kind == "menu"}
    assert menus == {"polygons": ("filled", "outlined")}
    assert all(name in KIND.parameters for name in KIND.files)


@pytest.mark.parametrize("size", [(61, 41), (121, 81), (200, 33)])
def test_geographic_point_lands_at_its_texel_on_geographic_dem(tmp_path, values, size):
    dem = terrain(tmp_path / "a.tif", 4269, 10.0, 47.0, (0.001, 0.002), model=2)
    path = geojson(tmp_path / "a.json", geometry("Point", [10.0423, 46.9577]))
    made = KIND.make(values(path, dem, width=900.0), size)["mask"]
    assert made.shape == size[::-1] and made.dtype == np.float32
    share = (10.0423 - 10.0) / 0.06, (46.9577 - 46.92) / 0.08
    assert centre(made) == pytest.approx([s * (n - 1) for s, n in zip(share, size, strict=True)], abs=0.05)
    assert KIND.notes(values(path, dem)) == ()


@pytest.mark.parametrize("size", [(1, 5), (5, 1), (1, 1)])
def test_a_pass_of_one_texel_is_a_sentence(tmp_path, values, size):
    dem = terrain(tmp_path / "a.tif", 4326, 10.0, 47.0, (0.001, 0.002), model=2)
    path = geojson(tmp_path / "a.json", geometry("Point", [10.0423, 46.9577]))
    with pytest.raises(DataError, match=rf"is {size[0]} x {size[1]} texels; expected at least 2 x 2"):
        KIND.make(values(path, dem), size)


def utm(longitude, latitude, middle):
    """Return metres in UTM, north of the equator: Snyder 1987, p. 61, eqs. (8-9) to (8-15)."""
    a, f, k0 = 6378137.0, 1 / 298.257223563, 0.9996
    e2 = f * (2 - f)
    p = math.radians(latitude)
    second = e2 / (1 - e2)
    n = a / math.sqrt(1 - e2 * math.sin(p) ** 2)
    t, c = math.tan(p) ** 2, second * math.cos(p) ** 2
    q = math.radians(longitude - middle) * math.cos(p)
    m = a * (
        (1 - e2 / 4 - 3 * e2**2 / 64 - 5 * e2**3 / 256) * p
        - (3 * e2 / 8 + 3 * e2**2 / 32 + 45 * e2**3 / 1024) * math.sin(2 * p)
        + (15 * e2**2 / 256 + 45 * e2**3 / 1024) * math.sin(4 * p)
        - (35 * e2**3 / 3072) * math.sin(6 * p)
    )
    x = k0 * n * (q + (1 - t + c) * q**3 / 6 + (5 - 18 * t + t**2 + 72 * c - 58 * second) * q**5 / 120)
    more = (61 - 58 * t + t**2 + 600 * c - 330 * second) * q**6 / 720
    y = k0 * (m + n * math.tan(p) * (q**2 / 2 + (5 - t + 9 * c + 4 * c**2) * q**4 / 24 + more))
    return 500_000 + x, y


def test_a_place_in_degrees_is_at_its_place_on_terrain_in_utm(tmp_path, values):
    x, y = utm(13.37, 47.21, 15.0)
    dem = terrain(tmp_path / "a.tif", 32633, x - 300.0, y + 250.0, (10.0, 12.5))
    path = geojson(tmp_path / "a.json", geometry("Point", [13.37, 47.21]))
    made = KIND.make(values(path, dem, width=100.0), (61, 41))["mask"]
    assert centre(made) == pytest.approx((30.0, 20.0), abs=0.02)


def test_a_parallel_is_bent_on_terrain_in_utm(tmp_path, values):
    (west, _), (east, _) = utm(12.0, 47.5, 15.0), utm(13.0, 47.5, 15.0)
    middle = utm(12.5, 47.5, 15.0)
    step = (east - west) / 60, 50.0
    dem = terrain(tmp_path / "a.tif", 32633, west, middle[1] + 1000.0, step)
    path = geojson(tmp_path / "a.json", geometry("LineString", [[12.0, 47.5], [13.0, 47.5]]))
    made = KIND.make(values(path, dem, width=200.0), (61, 41))["mask"]
    for column, longitude in ((15, 12.25), (30, 12.5), (45, 12.75)):
        x, y = utm(longitude, 47.5, 15.0)
        position = (x - west) / step[0], 20 + (y - middle[1]) / step[1]
        assert abs(position[0] - column) < 0.3
        rows = made[:, column]
        assert (rows * np.arange(41)).sum() / rows.sum() == pytest.approx(position[1], abs=0.6)
    straight = utm(12.0, 47.5, 15.0)[1] / 2 + utm(13.0, 47.5, 15.0)[1] / 2
    assert abs(straight - middle[1]) > 2 * step[1], "a straight line would miss the middle by two texels"


@pytest.mark.parametrize("name", ["urn:ogc:def:crs:EPSG::32633", "EPSG:32633"])
def test_an_older_geojson_may_name_the_terrain_s_system(tmp_path, values, name):
    dem = terrain(tmp_path / "a.tif", 32633, 5000.0, 9000.0, (10.0, 10.0))
    crs = {"type": "name", "properties": {"name": name}}
    path = geojson(tmp_path / "a.json", geometry("Point", [5100, 8800]), crs=crs)
    made = KIND.make(values(path, dem, width=80.0), (61, 41))["mask"]
    assert centre(made) == pytest.approx((10.0, 20.0), abs=0.02)


def test_what_cannot_be_transformed_is_a_sentence(tmp_path, values):
    dem = terrain(tmp_path / "a.tif", 32633, 5000.0, 9000.0, (10.0, 10.0))
    crs = {"type": "name", "properties": {"name": "EPSG:99999"}}
    path = geojson(tmp_path / "b.json", geometry("Point", [13, 47]), crs=crs)
    with pytest.raises(DataError, match="GDAL does not know a reference system"):
        KIND.make(values(path, dem), (61, 41))


def test_terrain_without_a_place_is_a_sentence(tmp_path, values):
    np.save(tmp_path / "a.npy", np.zeros((9, 9)))
    path = geojson(tmp_path / "a.json", geometry("Point", [13, 47]))
    with pytest.raises(DataError, match="does not say where its terrain lies"):
        KIND.make(values(path, tmp_path / "a.npy"), (9, 9))


def test_shapes_beside_the_terrain_are_reported(tmp_path, values):
    dem = terrain(tmp_path / "a.tif", 4326, 10.0, 47.0, (0.001, 0.001), model=2)
    path = geojson(tmp_path / "a.json", geometry("Point", [11, 46.99]))
    assert KIND.make(values(path, dem), (61, 41))["mask"].max() == 0.0
    assert KIND.notes(values(path, dem)) == ("a.json: none of its shapes lies on the terrain",)

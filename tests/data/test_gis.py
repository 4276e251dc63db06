"""Rasters as GDAL writes them, and what it reads of them: numbers, places, masks, overviews."""

from __future__ import annotations

import socket

import numpy as np
import pytest
import rasterio
import rasterio.shutil
from rasterio.crs import CRS
from rasterio.enums import Resampling
from rasterio.transform import Affine
from rasterio.vrt import WarpedVRT
from scipy.io import netcdf_file

from playground.allowed_files import leads_outside, sidecars
from playground.data import content_hash as hashes
from playground.data import gis
from playground.data.elevation import open_elevation, read_elevation
from playground.data.grid import ArrayRows
from playground.data.place import Crs, CrsFacts, degree_lengths
from playground.data.resample import decimate
from playground.engine import file_sources
from playground.engine.sources import source_kind
from playground.errors import DataError
from playground.sketch.files import find_file

RNG = np.random.default_rng(8)
HEIGHTS = RNG.normal(900.0, 300.0, (77, 131)).astype(np.float32)  # north row first
NORTH_UP = Affine(10.0, 0.0, 400_000.0, 0.0, -12.5, 5_300_000.0)


def raster(path, values=HEIGHTS, transform=NORTH_UP, crs="EPSG:32633", scale=1.0, offset=0.0, **options):
    rows, cols = values.shape
    facts = {"driver": "GTiff", "width": cols, "height": rows, "count": 1, "dtype": values.dtype}
    with rasterio.open(path, "w", **facts, crs=crs, transform=transform, **options) as file:
        file.write(values, 1)
        if (scale, offset) != (1.0, 0.0):
            file.scales, file.offsets = (scale,), (offset,)
    return path


TILES = {"tiled": True, "blockxsize": 32, "blockysize": 16}
FORMS = {
    "strips": {},
    "strips of several rows": {"blockysize": 10},
    "tiles": TILES,
    "deflate": {"compress": "deflate", **TILES},
    "deflate and predictor 2": {"compress": "deflate", "predictor": 2, **TILES},
    "deflate and predictor 3": {"compress": "deflate", "predictor": 3, **TILES},
    "big-endian deflate": {"compress": "deflate", "predictor": 3, "ENDIANNESS": "BIG"},
    "BigTIFF": {"BIGTIFF": "YES", **TILES},
    "zstd": {"compress": "zstd", **TILES},
    "zstd and predictor 3": {"compress": "zstd", "predictor": 3, **TILES},
    "lerc": {"compress": "lerc", "max_z_error": 0.0, **TILES},
    "lerc and zstd": {"compress": "lerc_zstd", "max_z_error": 0.0, **TILES},
    "lzw and predictor 3": {"compress": "lzw", "predictor": 3, **TILES},
    "packbits": {"compress": "packbits"},
}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("dtype", ["f4", "f8", "i2", "u1", "i4"])
def test_every_form_of_geotiff_has_its_numbers_and_its_place(tmp_path, form, dtype):
    options = FORMS[form]
    if dtype[0] != "f" and options.get("predictor") == 3:
        options = options | {"predictor": 2}
    if dtype[0] == "f" and options.get("predictor") == 2:
        options = options | {"predictor": 3}
    values = (HEIGHTS if dtype[0] == "f" else HEIGHTS % 120).astype(dtype)
    file = open_elevation(raster(tmp_path / "a.tif", values, **options))
    np.testing.assert_array_equal(file.read().heights[::-1], values.astype(np.float32))
    west, south, east, north = file.grid.place.bounds
    assert (west, north) == (400_005.0, 5_299_993.75), "the corner's node is half a texel inside"
    assert (east, south) == (400_005.0 + 1300.0, 5_299_993.75 - 950.0)
    assert file.extent == (1300.0, 950.0)


def test_a_sparse_file_has_no_data_where_nothing_is_stored(tmp_path):
    facts = {
        "driver": "GTiff",
        "width": 70,
        "height": 50,
        "count": 1,
        "dtype": "float32",
        "crs": "EPSG:32633",
    }
    with rasterio.open(
        tmp_path / "a.tif", "w", **facts, transform=NORTH_UP, nodata=-9999, SPARSE_OK=True, **TILES
    ) as file:
        file.write(HEIGHTS[:16, :32], 1, window=rasterio.windows.Window(0, 16, 32, 16))
    heights = read_elevation(tmp_path / "a.tif").heights[::-1]
    np.testing.assert_array_equal(heights[16:32, :32], HEIGHTS[:16, :32])
    assert np.isnan(heights).sum() == 50 * 70 - 16 * 32


def test_scale_offset_and_no_data(tmp_path):
    values = HEIGHTS.astype("i2")
    values[3, 5] = -1
    path = raster(tmp_path / "a.tif", values, nodata=-1, scale=0.25, offset=-10.0)
    heights = read_elevation(path).heights[::-1]
    expected = values * 0.25 - 10.0
    expected[values == -1] = np.nan
    np.testing.assert_allclose(heights, expected, rtol=1e-6)


def test_a_raster_from_the_south_is_turned(tmp_path):
    south_up = Affine(10.0, 0.0, 400_000.0, 0.0, 12.5, 5_300_000.0)
    elevation = read_elevation(raster(tmp_path / "a.tif", transform=south_up))
    np.testing.assert_array_equal(elevation.heights, HEIGHTS)  # the first row is the south's
    west, south, _, north = elevation.place.bounds
    assert (west, south, north) == (400_005.0, 5_300_006.25, 5_300_006.25 + 76 * 12.5)


@pytest.mark.parametrize(
    ("transform", "angle"),
    [
        (Affine(10.0, 5.0, 0.0, 5.0, -10.0, 0.0), "26.57"),
        (Affine(8.660254037844387, 5.0, 0.0, -5.0, 8.660254037844387, 0.0), "30"),
        (Affine(-10.0, 0.0, 9e5, 0.0, -10.0, 0.0), "180"),
    ],
)
def test_a_rotated_raster_is_refused(tmp_path, transform, angle):
    with pytest.raises(DataError, match=rf"go {angle} degrees off east; expected a grid that is not rotated"):
        read_elevation(raster(tmp_path / "a.tif", transform=transform))


def test_a_raster_without_a_reference_system_says_so(tmp_path):
    elevation = read_elevation(raster(tmp_path / "a.tif", crs=None))
    assert elevation.spacing is None and "does not say whether that is metres" in elevation.notes[0]


# Large files, which a bound of a few texels makes of small ones.


@pytest.fixture
def values(monkeypatch):
    monkeypatch.setattr(file_sources, "LARGE", 1000)
    monkeypatch.setattr(file_sources, "DEFAULT_SIDE", 61)
    monkeypatch.setattr(gis, "BAND", 400)

    def values_(path, **changes):
        result = {"raw_size": (0, 0), "packing": 0, "no_data": 0, "first_row": 0, "metres": (0.0, 0.0)}
        return result | {"elevation": str(path), "longest": 0} | changes

    return values_


KIND = source_kind("elevation_file")


def smooth(rows=300, cols=420):
    south, east = np.mgrid[:rows, :cols]
    return (700 + 300 * np.sin(south / 31) * np.cos(east / 47)).astype(np.float32)


@pytest.mark.parametrize("form", ["strips", "tiles", "deflate and predictor 3", "zstd"])
def test_a_large_file_is_read_at_the_size_of_the_terrain(tmp_path, values, monkeypatch, form):
    heights = smooth()
    path = raster(tmp_path / "a.tif", heights, **FORMS[form])
    asked = values(path, longest=57)
    terrain = KIND.describe(asked)
    assert terrain.size == (57, 41) and terrain.extent == (4190.0, 3737.5)
    assert (terrain.base_elevation, terrain.relief) == (heights.min(), np.ptp(heights))
    made = KIND.make(asked, (57, 41))["height"]
    monkeypatch.setattr(file_sources, "LARGE", 2**24)
    expected = KIND.make(asked, (57, 41))["height"]
    np.testing.assert_allclose(made, expected, rtol=0, atol=1e-6)
    assert KIND.notes(asked) == ()


def test_large_raster_without_size_reads_at_default_and_reports(tmp_path, values):
    path = raster(tmp_path / "a.tif", smooth())
    assert KIND.describe(values(path)).size == (61, 44)
    assert KIND.notes(values(path)) == (
        "a.tif: has 420 x 300 texels; unless a size or `longest` says how many, 61 x 44 are read",
    )


def test_a_large_file_at_its_own_size_has_its_own_numbers(tmp_path, values):
    heights = smooth()
    asked = values(raster(tmp_path / "a.tif", heights, **TILES), longest=420)
    made = KIND.make(asked, (420, 300))["height"]
    low, high = heights.min(), heights.max()
    np.testing.assert_array_equal(made[::-1], (heights - low) / (high - low))


def test_gaps_of_a_large_file_are_refused_or_filled(tmp_path, values):
    heights = smooth()
    heights[100:180, 50:200] = -9999
    path = raster(tmp_path / "a.tif", heights, nodata=-9999)
    with pytest.raises(DataError, match=r'have no data, .* or no_data = "fill"'):
        KIND.describe(values(path))
    made = KIND.make(values(path, no_data=1), (61, 44))["height"]
    assert np.isfinite(made).all() and made.min() >= 0 and made.max() <= 1
    assert "were filled from their surroundings" in KIND.notes(values(path, no_data=1))[0]
    nothing = raster(tmp_path / "b.tif", np.full_like(heights, -9999), nodata=-9999)
    with pytest.raises(DataError, match="no texel has any data"):
        KIND.describe(values(nothing, no_data=1))


def test_an_infinite_height_of_a_large_file_is_named(tmp_path, values):
    heights = smooth()
    heights[290, 7] = np.inf
    with pytest.raises(DataError, match=r"at texel \(7, 9\) from the south-west corner"):
        KIND.describe(values(raster(tmp_path / "a.tif", heights)))


@pytest.mark.parametrize("compress", ["deflate", "zstd"])
def test_an_overview_is_read_where_it_is_fine_enough(tmp_path, values, monkeypatch, compress):
    heights = smooth(640, 800)
    path = raster(tmp_path / "a.tif", heights, **TILES, compress=compress)
    with rasterio.open(path, "r+") as file:
        file.build_overviews([2, 4, 8], Resampling.average)
    file = open_elevation(path)
    assert [rows.shape for rows in file.grid.overviews] == [(320, 400), (160, 200), (80, 100)]
    read = []
    monkeypatch.setattr(
        "playground.data.elevation.decimate",
        lambda rows, *rest: (read.append(rows.shape), decimate(rows, *rest))[1],
    )
    made = file.read_at((90, 70)).heights
    assert read == [(160, 200)], "twice as fine as what is wanted"
    expected = decimate(ArrayRows(heights), (90, 70), lambda _, band: band).heights[::-1]
    # Waves of 195 texels: means of 4 are 1 - sinc(4 / 195) lower, 0.07 % of 300 m each way.
    assert np.abs(made - expected)[2:-2, 2:-2].max() < 0.5
    file.read_at((600, 500))
    assert read[1] == (640, 800)


# NetCDF


def netcdf(path, names=("elevation",), up=1, unit="m"):
    heights = np.arange(35, dtype="i2").reshape(5, 7)
    with netcdf_file(path, "w") as file:
        for name, count, first, degrees in (("lat", 5, 46.0, "north"), ("lon", 7, 7.0, "east")):
            file.createDimension(name, count)
            axis = file.createVariable(name, "f8", (name,))
            axis[:] = (first + 0.1 * np.arange(count))[:: up if name == "lat" else 1]
            axis.units, axis.standard_name = (
                f"degrees_{degrees}",
                {"lat": "latitude", "lon": "longitude"}[name],
            )
        for name in names:
            grid = file.createVariable(name, "i2", ("lat", "lon"))
            grid[:] = heights
            if unit:
                grid.units = unit
    return path, heights


@pytest.mark.parametrize("up", [1, -1])
def test_netcdf_from_the_south_or_the_north(tmp_path, up):
    path, heights = netcdf(tmp_path / "a.nc", up=up)
    elevation = read_elevation(path)
    np.testing.assert_array_equal(elevation.heights, heights[::up])
    assert elevation.place.bounds == pytest.approx((7.0, 46.0, 7.6, 46.4))
    assert elevation.place.crs.facts.epsg == 4326 and elevation.in_metres
    assert elevation.notes == ("its degrees are of no named system; WGS 84 is assumed",)


def test_netcdf_of_several_grids_needs_one_of_a_usual_name(tmp_path):
    assert read_elevation(netcdf(tmp_path / "a.nc", names=("tid", "elevation"))[0]).size == (7, 5)
    with pytest.raises(DataError, match="holds tid, sid; expected one grid, or one called elevation or z"):
        read_elevation(netcdf(tmp_path / "b.nc", names=("tid", "sid"))[0])
    assert "metres are assumed" in read_elevation(netcdf(tmp_path / "c.nc", unit="")[0]).assumed


def test_netcdf_that_is_none_is_a_sentence(tmp_path):
    (tmp_path / "a.nc").write_bytes(RNG.bytes(300))
    with pytest.raises(DataError, match=r"is no \.nc file to GDAL.s driver netCDF, although"):
        read_elevation(tmp_path / "a.nc")


def test_more_texels_than_any_picture_may_have_are_read_in_turn(tmp_path, values):
    """A terrain of 2**29 texels of which one tile is stored; the others have no data."""
    path = tmp_path / "a.tif"
    facts = {"driver": "GTiff", "width": 2**15, "height": 2**14, "count": 1, "dtype": "uint8"}
    tiles = {"tiled": True, "blockxsize": 2048, "blockysize": 2048, "compress": "deflate"}
    with rasterio.open(path, "w", **facts, transform=NORTH_UP, nodata=0, SPARSE_OK=True, **tiles) as file:
        window = rasterio.windows.Window(4096, 2048, 2048, 2048)
        file.write(np.full((2048, 2048), 7, np.uint8), 1, window=window)
    file = open_elevation(path)
    assert file.size == (2**15, 2**14)
    with pytest.raises(DataError, match=r"32768 x 16384 texels; the most is 2\*\*28"):
        file.read()


# What else GDAL opens


def copied(source, path, driver, **options):
    rasterio.shutil.copy(source, path, driver=driver, **options)
    return path


FORMATS = {
    "a.img": ("HFA", "f4", {}),
    "a.gpkg": ("GPKG", "f4", {}),
    "a.jp2": ("JP2OpenJPEG", "u2", {"REVERSIBLE": "YES", "QUALITY": "100"}),
    "a.nc": ("netCDF", "f4", {}),
    "a.asc": ("AAIGrid", "f4", {"SIGNIFICANT_DIGITS": "9", "FORCE_CELLSIZE": "NO"}),
    "a.flt": ("EHdr", "f4", {}),
    "a.vrt": ("VRT", "f4", {}),
}


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_has_what_rasterio_reads_of_it(tmp_path, name):
    driver, dtype, options = FORMATS[name]
    values = np.abs(HEIGHTS).astype(dtype)
    source = raster(tmp_path / "source.tif", values, Affine(10.0, 0.0, 4e5, 0.0, -10.0, 5.3e6))
    path = copied(source, tmp_path / name, driver, **options)
    beside = sorted(tmp_path.iterdir())
    elevation = read_elevation(path)
    with rasterio.open(path) as same:
        np.testing.assert_array_equal(elevation.heights[::-1], same.read(1).astype(np.float32))
        west, south, east, north = elevation.place.bounds
        np.testing.assert_allclose(same.bounds, (west - 5, south - 5, east + 5, north + 5), rtol=1e-15)
    assert (
        elevation.spacing == (10.0, 10.0) and elevation.in_metres and elevation.place.crs.name == "EPSG:32633"
    )
    assert sorted(tmp_path.iterdir()) == beside, "nothing is written next to it"


@pytest.mark.parametrize("internal", ["YES", "NO"])
def test_what_a_mask_leaves_out_has_no_data(tmp_path, internal):
    path = raster(tmp_path / "a.tif", HEIGHTS.astype("i2"))
    kept = HEIGHTS > 700.0
    with rasterio.Env(GDAL_TIFF_INTERNAL_MASK=internal), rasterio.open(path, "r+") as file:
        file.write_mask(kept)
    heights = read_elevation(path).heights[::-1]
    np.testing.assert_array_equal(np.isnan(heights), ~kept)
    np.testing.assert_array_equal(heights[kept], HEIGHTS.astype("i2")[kept])
    assert (tmp_path / "a.tif.msk").exists() is (internal == "NO")


def test_overviews_next_to_a_file_are_read(tmp_path):
    path = raster(tmp_path / "a.tif", smooth(640, 800), **TILES)
    with rasterio.Env(TIFF_USE_OVR=True), rasterio.open(path, "r+") as file:
        file.build_overviews([2, 4], Resampling.average)
    assert (tmp_path / "a.tif.ovr").exists()
    assert [rows.shape for rows in open_elevation(path).grid.overviews] == [(320, 400), (160, 200)]


def test_a_mosaic_is_read_as_one(tmp_path, monkeypatch):
    (tmp_path / "tiles").mkdir()
    heights = smooth(60, 100)
    west = raster(tmp_path / "tiles" / "w.tif", heights[:, :40])
    east = raster(tmp_path / "tiles" / "e.tif", heights[:, 40:], NORTH_UP @ Affine.translation(40, 0))
    (tmp_path / "a.vrt").write_text(mosaic((west, 0, 40), (east, 40, 60), size=(100, 60)))
    elevation = read_elevation(tmp_path / "a.vrt")
    np.testing.assert_array_equal(elevation.heights[::-1], heights)
    assert set(sidecars(tmp_path / "a.vrt")) == {west, east}, "they go where it goes"
    for large in (2**26, 1):  # judged by contents, or by times and sizes
        monkeypatch.setattr(hashes, "LARGE", large)
        before = hashes.content_key(tmp_path / "a.vrt")
        raster(west, heights[:, :40] + large)
        assert hashes.content_key(tmp_path / "a.vrt") != before, "a source's contents are its own"


def mosaic(*parts, size):
    sources = "".join(
        f'<SimpleSource><SourceFilename relativeToVRT="1">tiles/{path.name}</SourceFilename>'
        f'<SourceBand>1</SourceBand><SrcRect xOff="0" yOff="0" xSize="{width}" ySize="{size[1]}"/>'
        f'<DstRect xOff="{left}" yOff="0" xSize="{width}" ySize="{size[1]}"/></SimpleSource>'
        for path, left, width in parts
    )
    band = f'<VRTRasterBand dataType="Float32" band="1">{sources}</VRTRasterBand>'
    position = "<GeoTransform>400000, 10, 0, 5300000, 0, -12.5</GeoTransform><SRS>EPSG:32633</SRS>"
    return f'<VRTDataset rasterXSize="{size[0]}" rasterYSize="{size[1]}">{position}{band}</VRTDataset>'


def test_a_warp_is_read(tmp_path):
    path = raster(tmp_path / "a.tif", smooth(60, 100), Affine(10.0, 5.0, 4e5, 5.0, -10.0, 5.3e6))
    with rasterio.open(path) as turned, WarpedVRT(turned, crs="EPSG:32633", nodata=-1) as straight:
        rasterio.shutil.copy(straight, tmp_path / "a.vrt", driver="VRT")
        expected = straight.read(1)
    heights = read_elevation(tmp_path / "a.vrt").heights[::-1]
    np.testing.assert_array_equal(np.where(np.isnan(heights), -1, heights), expected)


# What a stranger's file may name

VRT = (
    '<VRTDataset rasterXSize="131" rasterYSize="77"><VRTRasterBand dataType="Float32" band="1"><SimpleSource>'
    '<SourceFilename relativeToVRT="{relative}">{source}</SourceFilename></SimpleSource></VRTRasterBand>'
    "</VRTDataset>"
)


@pytest.fixture
def listener():
    """Give the address of a server that notes who asks it."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(0.2)
        yield f"http://127.0.0.1:{server.getsockname()[1]}/a.tif"
        with pytest.raises(TimeoutError):
            server.accept()


@pytest.mark.parametrize(
    ("source", "relative", "words"),
    [
        ("{url}", 1, "names the source 'http://.*', which is no file"),
        ("{url}", 0, "names the source 'http://.*', which is no file"),
        ("/vsicurl/{url}", 0, "names the source '/vsicurl/.*', which is no file"),
        ("/vsicurl/{url}", 1, "names the source '/vsicurl/.*', which is no file"),
        ('NETCDF:"b.tif":z', 1, "which is no file"),
        ("b.tif", 0, "names a source that is not relative to itself"),
        ("none.tif", 1, "names the source 'none.tif', which is no file"),
        ("service.xml", 1, "is a source of a VRT; expected GeoTIFF, ERDAS Imagine or JPEG 2000"),
        ("b.tif ", 1, "names the source 'b.tif ', which is no file"),
        ("b.tif<!-- -->", 1, "is no VRT; expected <VRTDataset> in plain XML"),
        ("&#98;.tif", 1, "is no VRT; expected <VRTDataset> in plain XML"),
        ("b.tif<Size/>", 1, "names the source 'b.tif' with more than its name"),
        ("far.vrt", 1, "far.vrt: names the source 'http"),
        ("text.tif", 1, "is a source of a VRT; expected GeoTIFF"),
    ],
)
def test_a_vrt_leads_to_files_alone(tmp_path, listener, source, relative, words, capfd):
    raster(tmp_path / "b.tif")
    service = f"<GDAL_WMS><Service name='TMS'><ServerUrl>{listener}</ServerUrl></Service></GDAL_WMS>"
    for name in ("service.xml", "text.tif"):
        (tmp_path / name).write_text(service)
    (tmp_path / "far.vrt").write_text(VRT.format(relative=1, source=listener))
    (tmp_path / "a.vrt").write_text(VRT.format(relative=relative, source=source.format(url=listener)))
    with pytest.raises(DataError, match=words) as caught:
        read_elevation(tmp_path / "a.vrt")
    assert "\n" not in str(caught.value) and capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("part", "words"),
    [
        ("<OpenOptions/>", "has a part 'OpenOptions', which is not read here"),
        ('<Metadata domain="GEOLOCATION"/>', "has a part 'GEOLOCATION'"),
        ('<VRTRasterBand subClass="VRTRawRasterBand"/>', "has a part 'VRTRasterBand VRTRawRasterBand'"),
        ('<VRTRasterBand subClass="VRTDerivedRasterBand"/>', "has a part 'VRTRasterBand VRTDerived"),
        ('<SimpleSource SourceFilename="/vsicurl/a"/>', "has a part 'SourceFilename'"),
        ("<sourcefilename/>", "has a part 'sourcefilename'"),
        ("<SRS>http://127.0.0.1:9/a.prj</SRS>", "has a part 'http://127.0.0.1:9/a.prj'"),
        ("<TargetSRS>/etc/a.prj</TargetSRS>", "has a part '/etc/a.prj'"),
    ],
)
def test_a_vrt_of_other_parts_is_refused(tmp_path, part, words):
    raster(tmp_path / "b.tif")
    text = VRT.format(relative=1, source="b.tif").replace("</VRTDataset>", f"{part}</VRTDataset>")
    (tmp_path / "a.vrt").write_text(text)
    with pytest.raises(DataError, match=words):
        read_elevation(tmp_path / "a.vrt")


def test_a_vrt_has_no_more_sources_than_are_looked_at(tmp_path, monkeypatch):
    raster(tmp_path / "b.tif")
    (tmp_path / "a.vrt").write_text(VRT.format(relative=1, source="b.tif"))
    monkeypatch.setattr(gis, "MAX_SOURCES", 1)
    with pytest.raises(DataError, match="is made of 1 files or more; 0 is the most"):
        read_elevation(tmp_path / "a.vrt")


def test_a_system_next_to_a_raster_is_no_address(tmp_path, listener, capfd):
    path = raster(tmp_path / "a.tif", crs=None)
    (tmp_path / "a.tif.aux.xml").write_text(f"<PAMDataset><SRS>{listener}</SRS></PAMDataset>")
    assert read_elevation(path).spacing is None and capfd.readouterr() == ("", "")


def test_a_vrt_s_sources_are_those_a_sketch_may_read(tmp_path):
    own = tmp_path / "own"
    own.mkdir()
    raster(tmp_path / "b.tif")
    (own / "a.vrt").write_text(VRT.format(relative=1, source="../b.tif"))
    assert read_elevation(own / "a.vrt").size == (131, 77), "a user's own file"
    assert leads_outside("a.vrt", own) and not leads_outside("own/a.vrt", tmp_path)
    with pytest.raises(DataError, match=r"elevation: b\.tif next to it leads out of the sketch's folder"):
        find_file("a.vrt", str(own), str(own / "k.glsl"), "elevation")


@pytest.mark.parametrize("beside", ["a.tif.ovr", "a.tif.msk", "a.tif.aux.xml"])
def test_a_file_next_to_a_raster_leads_nowhere(tmp_path, listener, beside, capfd):
    path = raster(tmp_path / "a.tif")
    item = f'<Metadata domain="OVERVIEWS"><MDI key="OVERVIEW_FILE">/vsicurl/{listener}</MDI></Metadata>'
    text = VRT.format(relative=0, source=f"/vsicurl/{listener}")
    (tmp_path / beside).write_text(f"<PAMDataset>{item}</PAMDataset>" if "aux" in beside else text)
    with pytest.raises(DataError, match=r"names further files|is no TIFF file, as an overview"):
        read_elevation(path)
    assert capfd.readouterr() == ("", "")


def test_a_text_of_a_system_is_no_address(tmp_path, listener, capfd):
    np.savez(tmp_path / "a.npz", elevation=HEIGHTS, dx=1.0, dy=1.0, crs=np.array(listener))
    assert read_elevation(tmp_path / "a.npz").spacing is None
    with pytest.raises(DataError, match="GDAL does not know a reference system"):
        gis.transformed(np.zeros((1, 2)), listener, "EPSG:4326")
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    "text",
    ['PROJCS["x"]', 'GEOGCS["x"]', "EPSG:99999", "FOO:BAR", "EPSG:4978", '{"type": "x"}', "PROJCS[" * 5000],
)
def test_of_an_odd_system_nothing_is_known(text, capfd):
    assert Crs(text).facts == CrsFacts() and capfd.readouterr() == ("", "")


def test_what_becomes_too_much_of_too_little_is_refused(tmp_path):
    facts = {"driver": "GTiff", "width": 2**15, "height": 2**14, "count": 1, "dtype": "uint16"}
    tiles = {"tiled": True, "blockxsize": 4096, "blockysize": 4096, "compress": "deflate"}
    with rasterio.open(tmp_path / "a.tif", "w", **facts, transform=NORTH_UP, **tiles) as file:
        file.write(np.ones((4096, 4096), np.uint16), 1, window=rasterio.windows.Window(0, 0, 4096, 4096))
    with pytest.raises(DataError, match="would become 1024 MiB from"):
        read_elevation(tmp_path / "a.tif")


# ── ESRI's grids ─────────────────────────────────────────────────────────────


GRID = RNG.integers(-40, 3000, (7, 5)).astype(np.float32)  # north row first


def asc(path, header="xllcorner 1000\nyllcorner 2000\ncellsize 25"):
    rows = "\n".join(" ".join(map(str, row)) for row in GRID)
    path.write_text(f"ncols 5\nNROWS 7\n{header}\nNODATA_value -9999\n{rows}\n")
    return path


def flt(path):
    GRID.astype("<f4").tofile(path)
    place = "xllcorner 1000\nyllcorner 2000\ncellsize 25"
    path.with_suffix(".hdr").write_text(f"ncols 5\nnrows 7\n{place}\nbyteorder LSBFIRST")
    return path


def test_a_grid_of_text_has_its_cells_and_their_system(tmp_path):
    path = asc(tmp_path / "a.asc", "xllcenter 1000\nyllcenter 2000\ndx 10\ndy 20")
    elevation = read_elevation(path)
    np.testing.assert_array_equal(elevation.heights[::-1], GRID)
    assert elevation.spacing is None and elevation.in_metres
    assert "there is no a.prj next to it" in elevation.notes[0]
    assert "there is no b.prj next to it" in read_elevation(flt(tmp_path / "b.flt")).notes[0]
    for system, metres in (("EPSG:32633", 1.0), ("EPSG:2264", 1200 / 3937)):
        path.with_suffix(".prj").write_text(CRS.from_user_input(system).to_wkt(version="WKT1_ESRI"))
        elevation = read_elevation(path)
        assert elevation.spacing == pytest.approx((10.0 * metres, 20.0 * metres), rel=1e-9)
        assert elevation.place.bounds == (1000.0, 2000.0, 1040.0, 2120.0)
    path = asc(path, "xllcenter 7\nyllcenter 46\ncellsize 0.01")
    path.with_suffix(".prj").write_text(CRS.from_user_input("EPSG:4326").to_wkt(version="WKT1_ESRI"))
    east, north = degree_lengths(46.03)
    assert read_elevation(path).spacing == pytest.approx((0.01 * east, 0.01 * north), rel=1e-9)


@pytest.mark.parametrize(
    ("write", "name", "old", "new", "words"),
    [
        (asc, "a.asc", "ncols 5", "columns 5", "is no ESRI grid; expected a header of ncols"),
        (asc, "a.asc", "NROWS 7", "NROWS 9", "damaged or cut short: .*File short"),
        (asc, "a.asc", "cellsize 25", "cellsize -25", "expected a grid that is not rotated"),
        (flt, "a.hdr", "nrows 7", "nrows 8", "holds 140 bytes; 5 x 8 numbers of 32 bits need 160"),
        (flt, "a.hdr", "byteorder", "TOTALROWBYTES 24\nbyteorder", "a row takes 24 bytes; .* take 20 each"),
        (flt, "a.hdr", None, None, "needs a.hdr next to it"),
    ],
)
def test_a_wrong_grid_is_one_sentence(tmp_path, write, name, old, new, words):
    path, header = write(tmp_path / f"a.{write.__name__}"), tmp_path / name
    text = header.read_text()
    header.write_text(text.replace(old, new, 1)) if old else header.unlink()
    with pytest.raises(DataError, match=words) as caught:
        read_elevation(path)
    assert caught.value.diagnostics[0].file

"""Read rasters by GDAL (rasterio), with its units, no data, masks, scale and offset, and overviews.

Each ending has one driver: others may take the same file for a list of further files, or of addresses. What
a raster names by itself is looked at first: the files next to it, and the sources of a VRT. GDAL reads rows
in turn, so that a large raster is never in memory as a whole; it reprojects nothing.

Source: GDAL's raster driver documentation; USGS (2015), "SRTM data format" for the name of a tile.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.allowed_files import (
    AUXILIARY,
    MASK,
    MAX_SOURCES,
    OVERVIEWS,
    all_sources,
    sidecar_places,
    sidecars,
    vrt_document,
)
from playground.data.bounds import ALWAYS_FINE, refuse_bomb
from playground.data.grid import (
    EIGHT_BIT,
    PACKED,
    SIXTEEN_BIT,
    Band,
    Packing,
    RasterFile,
    check_grid,
    require_grey,
    unpacked,
)
from playground.data.place import WGS_84, Crs, Georeference, gdal, gdal_crs
from playground.errors import DataError
from playground.files import irregularity, read_regular, reason

if TYPE_CHECKING:
    import rasterio.io

_DRIVERS = {
    ".tif": "GTiff",
    ".tiff": "GTiff",
    ".asc": "AAIGrid",
    ".bil": "EHdr",
    ".flt": "EHdr",
    ".gpkg": "GPKG",
    ".hgt": "SRTMHGT",
    ".img": "HFA",
    ".jp2": "JP2OpenJPEG",
    ".nc": "netCDF",
    ".vrt": "VRT",
}
_EXPECTED = {
    ".tif": "not a TIFF file, although its name ends like one",
    ".tiff": "not a TIFF file, although its name ends like one",
    ".asc": "is no ESRI grid; expected a header of ncols, nrows, xllcorner, yllcorner and cellsize",
    ".gpkg": "holds no raster; vector data go to a pass that lays them on terrain",
    ".hgt": "is no SRTM tile; expected 1201 x 1201 or 3601 x 3601 heights of 16 bits, and a name that says "
    "its corner, as N36W085.hgt",
}
_HEIGHTS = ("elevation", "z", "height", "altitude", "topo", "dem", "band1", "band_data")  # names of variables
BAND = 2**22  # [texels] that are read at a time
_ESRI_NO_DATA = -9999.0  # where an .asc or .flt does not say
_SOURCES = re.compile(rb"II[*+]\0|MM\0[*+]|EHFA_HEADER_TAG\0|\0\0\0\x0cjP  \r\n\x87\n")
_VRT_TAGS = frozenset(
    "VRTDataset SRS GeoTransform Metadata MDI VRTRasterBand ColorInterp ColorTable Entry CategoryNames "
    "Category Description NoDataValue HideNoDataValue UnitType Offset Scale Histograms HistItem HistMin "
    "HistMax BucketCount IncludeOutOfRange Approximate HistCounts SimpleSource ComplexSource AveragedSource "
    "NoDataFromMaskSource KernelFilteredSource Kernel Size Coefs SourceFilename SourceBand SourceProperties "
    "SrcRect DstRect NODATA UseMaskBand ScaleOffset ScaleRatio LUT Exponent SrcMin SrcMax DstMin DstMax "
    "ColorTableComponent OverviewList MaskBand BlockXSize BlockYSize GDALWarpOptions WarpMemoryLimit "
    "ResampleAlg WorkingDataType Option SourceDataset Transformer ApproxTransformer MaxError BaseTransformer "
    "GenImgProjTransformer SrcGeoTransform SrcInvGeoTransform DstGeoTransform DstInvGeoTransform "
    "ReprojectTransformer ReprojectionTransformer SourceSRS TargetSRS SourceCRS TargetCRS Options BandList "
    "BandMapping SrcNoDataReal SrcNoDataImag DstNoDataReal DstNoDataImag SrcAlphaBand DstAlphaBand".split()
)
_VRT_KEYS = frozenset(
    "rasterXSize rasterYSize dataType band subClass blockXSize blockYSize domain key name relativeToVRT "
    "shared RasterXSize RasterYSize DataType BlockXSize BlockYSize xOff yOff xSize ySize "
    "dataAxisToSRSAxisMapping coordinateEpoch resampling resample normalized src dst c1 c2 c3 c4".split()
)
_VRT_CLASSES = frozenset(f"{tag} VRTSourcedRasterBand" for tag in _VRT_TAGS) | {
    "VRTDataset VRTWarpedDataset",
    "VRTRasterBand VRTWarpedRasterBand",
}
_SYSTEM = re.compile(r"\s*(\w+\[|EPSG:\d+(\+\d+)?\s*$|\+proj=|$)")  # no address, and no file


@dataclass(frozen=True, eq=False)
class GdalRows:
    """The rows of a raster's first band, or of one of its overviews; NaN where its mask leaves out."""

    path: Path  # of the file, for messages
    name: str  # GDAL's, of the file or of a part of it
    driver: str
    shape: tuple[int, int]
    dtype: np.dtype[Any]
    block_rows: int
    packed: bool = False  # heights in three bands
    coloured: bool = False  # whether bands may differ, which is no picture of heights
    masked: bool = False
    overview: int | None = None

    def bands(self) -> Iterator[Band]:
        """Yield all rows, at least a row of blocks at a time."""
        from rasterio.windows import Window

        rows, cols = self.shape
        count = max(BAND // (cols * self.block_rows), 1) * self.block_rows
        with _explained(self.path):
            raster = _open(self.name, self.driver, self.overview)
        with raster:
            for start in range(0, rows, count):
                window = Window(0, start, cols, min(count, rows - start))
                with _explained(self.path):
                    values = self._values(raster, window)
                yield start, values

    def _values(self, raster: rasterio.io.DatasetReader, window: Any) -> NDArray[Any]:
        samples = raster.read((1, 2, 3) if self.packed or self.coloured else (1,), window=window)
        values: NDArray[Any] = unpacked(samples) if self.packed else samples[0]
        if self.coloured:
            require_grey(samples, self.path)
        if self.masked:
            values = values.astype(self.dtype)
            values[raster.read_masks(1, window=window) == 0] = np.nan
        return values


def read_raster(path: Path, packing: Packing = "grey") -> RasterFile:
    """Read a raster's header: its rows, their meaning and their place.

    Raises:
        DataError: what GDAL does not take for the format that its ending says, a rotated grid, a raster that
            is made of files which may not be read, or of no heights.
    """
    driver = _DRIVERS[path.suffix.lower()]
    _check_neighbours(path)
    name = _grid_in(path)
    with _explained(path), _open(name, driver) as raster:
        shape, dtype, bands = raster.shape, np.dtype(raster.dtypes[0]), raster.count
        check_grid(shape, dtype, path, in_turn=True)
        _check_size(raster, path)
        crs = Crs(raster.crs.to_wkt(version="WKT2_2019") if raster.crs else "")
        unit, scale, offset = raster.units[0] or "", raster.scales[0], raster.offsets[0]
        no_data, overviews = raster.nodata, len(raster.overviews(1))
        pictures = len(raster.subdatasets) if driver == "GTiff" else 0
        masked = any(flag.name == "per_dataset" for flag in raster.mask_flag_enums[0])
        georeference, south_first, notes = _place(raster, crs, path)
        block_rows = raster.block_shapes[0][0]
    if not (math.isfinite(scale) and math.isfinite(offset) and scale):
        raise DataError("says that its numbers have a scale or an offset that is no number", file=path)
    packed = packing == "rgb"
    if packed and (bands < 3 or dtype != np.uint8):
        what = f"packed heights need three channels of 8 bits; found {bands} of {8 * dtype.itemsize}"
        raise DataError(what, file=path)
    code_range = {"u1": EIGHT_BIT, "u2": SIXTEEN_BIT}.get(dtype.str[1:])
    coloured = not packed and code_range is not None and bands >= 3
    has_meaning = georeference is not None or crs.facts.kind or unit or (scale, offset) != (1.0, 0.0)
    in_metres = code_range is None or bool(not packed and has_meaning)
    if masked or packed:
        dtype = np.promote_types(dtype, np.float32)
    if pictures > 1:
        notes += (f"the first of {pictures} pictures was read",)
    elif bands > 1 and code_range is None:
        notes += (f"the first of its {bands} bands was read",)
    if no_data is None and path.suffix.lower() in (".asc", ".flt"):
        no_data = _ESRI_NO_DATA
    rows = GdalRows(path, name, driver, shape, dtype, block_rows, packed, coloured, masked)
    result = RasterFile(
        rows,
        None if georeference is None else georeference.spacing[0],
        in_metres=in_metres,
        code_range=None if in_metres else PACKED if packed else code_range,
        no_data=no_data,
        place=georeference,
        south_first=south_first,
        overviews=tuple(_overview(rows, number) for number in range(overviews)),
        notes=notes,
    )
    if not in_metres:
        return result
    return replace(result, scale=scale, offset=offset).in_unit(
        georeference.crs if georeference else crs, unit
    )


def _open(name: str, driver: str, overview: int | None = None) -> rasterio.io.DatasetReader:
    import rasterio

    options: dict[str, Any] = {} if overview is None else {"OVERVIEW_LEVEL": overview}
    if driver == "GPKG":
        options |= {"IMMUTABLE": "YES"}  # SQLite puts nothing next to it
    return rasterio.open(name, driver=driver, **options)


@contextmanager
def _explained(path: Path) -> Iterator[None]:
    """Let GDAL work; raise what rasterio raises as a ``DataError``."""
    from rasterio.errors import RasterioError

    try:
        with gdal():
            yield
    except RasterioError as error:
        why = reason(Exception(str(error.__cause__ or error)))
        ending = path.suffix.lower()
        if "not recognized" in why:
            usual = f"is no {ending} file to GDAL's driver {_DRIVERS[ending]}, although its name says so"
            why = _EXPECTED.get(ending, usual)
        else:
            why = f"the file is damaged or cut short: {why}"
        raise DataError(why, file=path) from error


def _overview(rows: GdalRows, number: int) -> GdalRows:
    """Return the rows of an overview, by its number from 0."""
    with _explained(rows.path), _open(rows.name, rows.driver, number) as raster:
        return replace(rows, shape=raster.shape, block_rows=raster.block_shapes[0][0], overview=number)


def _grid_in(path: Path) -> str:
    """Return what GDAL calls the raster of heights: of several the one of a usual name, or the only one."""
    ending = path.suffix.lower()
    name = str(path.resolve() if ending == ".vrt" else path.absolute())  # GDAL follows the link of a VRT
    if ending not in (".nc", ".gpkg"):
        return name
    with _explained(path), _open(name, _DRIVERS[ending]) as raster:
        if raster.count:
            return name
        names: dict[str, str] = {part.rpartition(":")[2].lower(): part for part in raster.subdatasets}
    usual = [names[name] for name in _HEIGHTS if name in names]
    if usual or len(names) == 1:
        return [*usual, *names.values()][0]
    listed = ", ".join(names) or "nothing"
    names_of_heights = " or ".join(_HEIGHTS[:2])
    raise DataError(f"holds {listed}; expected one grid, or one called {names_of_heights}", file=path)


def _place(
    raster: rasterio.io.DatasetReader, crs: Crs, path: Path
) -> tuple[Georeference | None, bool | None, tuple[str, ...]]:
    """Return where the nodes lie, whether the first row is the south's, both None if unknown, and notes."""
    at = raster.transform
    if at.is_identity:
        return None, None, ("it does not say where its texels lie",) if raster.driver == "netCDF" else ()
    if at.b or at.d or at.a < 0.0:
        raise turned(path, at.a, at.d)
    if not (0.0 < at.a < math.inf and 0.0 < abs(at.e) < math.inf):
        raise DataError(f"says that a texel is {at.a} x {abs(at.e)}; expected lengths above zero", file=path)
    notes: tuple[str, ...] = ()
    units = [str(text) for name, text in raster.tags().items() if name.endswith("#units")]
    if not crs.text and any(text.startswith("degree") for text in units):
        crs, notes = WGS_84, ("its degrees are of no named system; WGS 84 is assumed",)
    size, south_first = (raster.width, raster.height), at.e > 0.0
    north = at.f + (size[1] - 0.5 if south_first else 0.5) * at.e
    is_point = raster.tags().get("AREA_OR_POINT") == "Point"
    georeference = Georeference(at.c + 0.5 * at.a, north, (at.a, abs(at.e)), size, crs, is_point)
    if raster.driver in ("AAIGrid", "EHdr") and not crs.text:
        prj = path.with_suffix(".prj").name
        more: tuple[str, ...] = (f"there is no {prj} next to it, so its cells may be degrees or metres",)
    else:
        more = georeference.spacing[1]
    return georeference, south_first, (*more, *notes)


def turned(path: Path, east: float, north: float) -> DataError:
    """Return the error of a grid whose rows do not go east, but so far east and north a texel."""
    angle = abs(math.degrees(math.atan2(north, east)))
    message = f"its rows go {angle:.4g} degrees off east; expected a grid that is not rotated"
    return DataError(f"{message}, as gdalwarp makes of it", file=path)


# ── what a stranger's file may ask for ───────────────────────────────────────


def _check_size(raster: rasterio.io.DatasetReader, path: Path) -> None:
    """Raise ``DataError`` for a raster that has more texels than its files can hold."""
    itemsize = np.dtype(raster.dtypes[0]).itemsize
    unpacked = math.prod(raster.shape) * itemsize
    if raster.driver == "EHdr":  # GDAL takes what is missing for zeros, and rows for packed
        have, size = path.stat().st_size, f"{raster.width} x {raster.height} numbers of {8 * itemsize} bits"
        if unpacked > have:
            raise DataError(f"is cut short: it holds {have} bytes; {size} need {unpacked}", file=path)
        header = next(file for file in sidecars(path) if file.suffix.lower() == ".hdr")
        row = re.search(rb"(?im)^\s*totalrowbytes\s+(\d+)", read_regular(header, 2**16))
        if row is not None and int(row[1]) != raster.width * itemsize:
            message = f"says that a row takes {int(row[1])} bytes; {size} take {raster.width * itemsize} each"
            raise DataError(message, file=header)
    if unpacked > ALWAYS_FINE and not _is_sparse(raster):
        refuse_bomb(path, unpacked, sum(file.stat().st_size for file in (path, *sidecars(path))))


def _is_sparse(raster: rasterio.io.DatasetReader) -> bool:
    """Return whether blocks of a TIFF are not stored: they have no data."""
    (high, wide), (rows, cols) = raster.block_shapes[0], raster.shape
    blocks = product(range(-(-cols // wide)), range(-(-rows // high)))
    return raster.driver == "GTiff" and any(
        raster.get_tag_item(f"BLOCK_OFFSET_{x}_{y}", "TIFF", bidx=1) is None for x, y in blocks
    )


def _check_neighbours(path: Path) -> None:
    """Raise ``DataError`` where GDAL would be led to what is no file of this raster."""
    ending = path.suffix.lower()
    for sidecar in sidecar_places(path):
        if what := irregularity(sidecar):
            raise DataError(what, file=sidecar)
    beside = sidecars(path)
    if ending in (".bil", ".flt") and not any(file.suffix.lower() == ".hdr" for file in beside):
        raise DataError(f"needs {path.with_suffix('.hdr').name} next to it, which says its size", file=path)
    sources = all_sources(path) if ending == ".vrt" else ()
    if len(sources) >= MAX_SOURCES:
        raise DataError(f"is made of {len(sources)} files or more; {MAX_SOURCES - 1} is the most", file=path)
    for file in (path, *sources) if ending == ".vrt" else ():
        if file.suffix.lower() == ".vrt":
            _check_vrt(file)
        elif _SOURCES.match(read_regular(file, 16)) is None:
            raise DataError("is a source of a VRT; expected GeoTIFF, ERDAS Imagine or JPEG 2000", file=file)
    for file in beside:
        if file.name.lower().endswith(AUXILIARY) and re.search(
            rb"OVERVIEW_FILE|<Subdataset", read_regular(file)
        ):
            raise DataError("names further files, which are not read; gdaladdo makes overviews", file=file)
        if file.suffix.lower() in (OVERVIEWS, MASK) and _SOURCES.match(read_regular(file, 16)) is None:
            raise DataError("is no TIFF file, as an overview or a mask is", file=file)


def _check_vrt(path: Path) -> None:
    """Raise ``DataError`` for a VRT of other parts than GDAL's mosaics and warps of files have."""
    root = vrt_document(path.resolve())
    if root is None or root.tag != "VRTDataset":
        raise DataError("is no VRT; expected <VRTDataset> in plain XML of 4 MiB at most", file=path)
    for element in root.iter():
        text, kind = element.text or "", element.get("subClass", "VRTSourcedRasterBand")
        parts = [element.tag, *element.keys(), f"{element.tag} {kind}", element.get("domain", "")]
        allowed = (_VRT_TAGS, *[_VRT_KEYS] * len(element.keys()), _VRT_CLASSES, ("", "IMAGE_STRUCTURE"))
        odd = [part for part, names in zip(parts, allowed, strict=True) if part not in names]
        if element.tag.endswith(("SRS", "CRS")) and not _SYSTEM.match(text):
            odd.append(text)
        if odd:
            message = f"has a part {odd[0][:40]!r}, which is not read here; expected what gdalbuildvrt, "
            raise DataError(f"{message}gdal_translate and gdalwarp write", file=path)
        if element.tag in ("SourceFilename", "SourceDataset"):
            source = path.resolve().parent / text
            if ":" in text[2:] or text.startswith(("/vsi", "\\\\", "//")) or not source.is_file():
                raise DataError(f"names the source {text[:80]!r}, which is no file", file=path)
            if text != text.strip() or len(element):
                raise DataError(f"names the source {text[:80]!r} with more than its name", file=path)
            if element.get("relativeToVRT", "0") != "1" and not Path(text).is_absolute():
                raise DataError("names a source that is not relative to itself (relativeToVRT)", file=path)


# ── transformations ──────────────────────────────────────────────────────────


def transformed(points: NDArray[np.float64], from_crs: str, to_crs: str) -> NDArray[np.float64]:
    """Return points (n, 2) in another reference system; what has no place there is not finite.

    Both are a code or a text. Raises ``DataError`` where GDAL knows one of them not.
    """
    from rasterio.errors import RasterioError
    from rasterio.warp import transform

    systems = [gdal_crs(crs) for crs in (from_crs, to_crs)]
    try:
        with gdal():
            x, y = transform(*systems, points[:, 0].tolist(), points[:, 1].tolist())
    except RasterioError as error:
        raise DataError(f"cannot be brought into another system: {reason(Exception(str(error)))}") from None
    return np.stack([np.array(x, np.float64), np.array(y, np.float64)], 1)

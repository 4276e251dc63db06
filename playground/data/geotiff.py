"""Read elevations from TIFF files, with what GeoTIFF's tags say of metres and gaps.

Reads the first picture only, strip by strip or tile by tile where that can be done, and does not
reproject. Sources: OGC GeoTIFF 1.1 (OGC 19-008r4, 2019) for tags and keys; GDAL's raster driver
documentation for tags 42112 and 42113 and for overviews.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.data import gis
from playground.data.band import band_facts, system_beside
from playground.data.bounds import MAX_TEXELS, refuse_bomb
from playground.data.geokeys import DIRECTORY, DOUBLES, IS_POINT, RASTER, WORDS, code, read_keys
from playground.data.grid import EIGHT_BIT, SIXTEEN_BIT, Found, Packing, check_grid, from_channels, void_of
from playground.data.image_files import reason
from playground.data.place import Crs, Place, turned
from playground.data.rows import ArrayRows, Rows
from playground.data.tiff_rows import tiff_rows
from playground.data.wkt import CrsFacts
from playground.errors import DataError

if TYPE_CHECKING:
    import tifffile


def read_tiff(path: Path, packing: Packing) -> Found:
    """Read the first picture of a TIFF, with its spacing, unit and no-data value where tags tell them."""
    import tifffile

    try:
        with _without_log("tifffile"):
            tif = tifffile.TiffFile(path)
    except tifffile.TiffFileError as error:
        why = reason(error).removeprefix("not a TIFF file: ")
        raise DataError(f"not a TIFF file, although its name says so: {why}", file=path) from error
    with _without_log("tifffile"), tif:
        pages = tif.pages
        page = pages[0]
        if not isinstance(page, tifffile.TiffPage) or page.dtype is None:
            raise DataError("its kind of numbers is not readable; expected 8 to 64 bits", file=path)
        axes, shape = page.axes, page.shape
        if axes not in ("YX", "YXS", "SYX"):
            raise DataError(f"has axes {axes} {shape}; expected one picture", file=path)
        rows_cols = tuple(n for n, axis in zip(shape, axes, strict=True) if axis != "S")
        samples = math.prod(shape) // max(1, math.prod(rows_cols))
        check_grid(rows_cols, page.dtype, path, in_turn=axes == "YX")
        if samples > 4:
            raise DataError(f"has {samples} channels; expected one, or three with packing 'rgb'", file=path)
        end = max((o + n for o, n in zip(page.dataoffsets, page.databytecounts, strict=False)), default=0)
        if end > path.stat().st_size:
            raise DataError(f"is cut short: its data ends at byte {end}, the file before", file=path)
        sparse = 0 in page.databytecounts
        if not sparse:
            refuse_bomb(path, math.prod(shape) * page.dtype.itemsize, sum(page.databytecounts))
        no_data = _no_data(page)
        rows = _rows(page, path, no_data)
        keys = read_keys(*(page.tags.valueof(number) for number in (DIRECTORY, DOUBLES, WORDS)))
        crs = Crs(keys, "" if keys else system_beside(path))
        place, south_first = _place(page, (rows_cols[1], rows_cols[0]), crs, path)
        band = band_facts(path, str(page.tags.valueof(42112) or ""))
        overviews, notes = _further(tif, page, path, no_data)
    if isinstance(rows, gis.GdalRows):
        overviews = gis.overview_rows(path, "GTiff")
    spacing = None
    is_map = place is not None or crs.facts != CrsFacts()
    if place is not None:
        spacing, more = place.spacing
        notes = (*more, *notes)
    if place is not None and not math.isfinite(place.west + place.north):
        place = None  # it has steps, but no point that they go from
    void = None
    if isinstance(rows, np.ndarray) and rows.ndim == 3:
        found = from_channels(rows, packing, path)
        void = void_of(rows, no_data)
        void = None if void is None else void[..., 0]
        if found.void is not None:
            void = found.void if void is None else void | found.void
        rows, code_range, notes = found.rows, found.code_range, notes + found.notes
        no_data, overviews = None, ()
    elif packing == "rgb":
        raise DataError("packed heights need three channels of 8 bits; found one", file=path)
    else:
        rows = ArrayRows(rows) if isinstance(rows, np.ndarray) else rows
        code_range = {"u1": EIGHT_BIT, "u2": SIXTEEN_BIT}.get(rows.dtype.str[1:])
    in_metres = code_range is None or (packing == "grey" and (is_map or not band.is_default))
    found = Found(
        rows,
        spacing,
        in_metres=in_metres,
        code_range=None if in_metres else code_range,
        void=void,
        no_data=no_data,
        scale=band.scale if in_metres else 1.0,
        offset=band.offset if in_metres else 0.0,
        place=place,
        south_first=south_first,
        overviews=overviews,
        notes=notes,
    )
    return found.in_unit(crs, band.unit) if in_metres else found


@contextmanager
def _without_log(name: str) -> Iterator[None]:
    # tifffile logs each odd tag to the console; the one sentence about the file is enough.
    log = logging.getLogger(name)

    def nothing(_: logging.LogRecord) -> bool:
        return False

    log.addFilter(nothing)
    try:
        yield
    finally:
        log.removeFilter(nothing)


def _rows(page: tifffile.TiffPage, path: Path, no_data: float | None) -> Rows | NDArray[Any]:
    """Return the rows of the picture, to be read in turn; else all its samples (rows, cols[, channels])."""
    rows = tiff_rows(page, path, no_data or 0.0)
    if rows is not None:
        return rows
    if page.axes == "YX" and math.prod(page.shape) > MAX_TEXELS and gis.has_rasters():
        return gis.raster_rows(path, "GTiff")
    assert page.dtype is not None
    check_grid(page.shape[:2] if page.axes != "SYX" else page.shape[1:], page.dtype, path)
    try:
        values = np.asarray(page.asarray())
        return np.moveaxis(values, 0, -1) if page.axes == "SYX" else values
    except ImportError:  # zstd, of which Python knows from 3.14 on
        pass
    except (ValueError, KeyError) as error:
        if "imagecodecs" not in str(error):
            raise
    if page.axes == "YX" and gis.has_rasters():
        return gis.raster_rows(path, "GTiff")
    # tifffile alone lacks LZW and the floating-point predictor too; Pillow's libtiff has them.
    import PIL.Image

    modes = {"u1": ("L", "RGB", "RGBA", "LA"), "u2": ("I;16",), "i2": ("I",), "i4": ("I",), "f4": ("F",)}
    compression = getattr(page.compression, "name", page.compression)
    try:
        with PIL.Image.open(path, formats=("TIFF",)) as picture:
            if picture.mode in modes.get(page.dtype.str[1:], ()):
                values = np.array(picture)
                if values.shape == page.shape:
                    return values.astype(page.dtype.newbyteorder("="))
    except PIL.UnidentifiedImageError:
        pass
    except OSError as error:
        message = (
            f"its compression {compression} cannot be undone ({error}): it is damaged, or {gis.advice()}"
        )
        raise DataError(message, file=path) from error
    raise DataError(
        f"its {page.dtype} numbers under compression {compression} cannot be read here; "
        f"expected no compression or deflate; {gis.advice()}",
        file=path,
    )


def _further(
    tif: tifffile.TiffFile, page: tifffile.TiffPage, path: Path, no_data: float | None
) -> tuple[tuple[Rows, ...], tuple[str, ...]]:
    """Return the overviews of the first picture, finest first, and what is to be said of other pictures."""
    import tifffile

    found: list[Rows] = []
    notes: list[str] = []
    for other in tif.pages[1:]:
        if isinstance(other, tifffile.TiffFrame):
            other = other.aspage()
        if other.is_mask:
            notes.append("its mask of texels that count is not read")
        elif other.is_reduced and other.dtype == page.dtype:
            rows = tiff_rows(other, path, no_data or 0.0)
            if rows is not None:
                found.append(rows)
        elif not other.is_reduced:
            notes.append(f"the first of {len(tif.pages)} pictures was read")
            break
    found.sort(key=lambda rows: -rows.shape[0])
    return tuple(found), tuple(dict.fromkeys(notes))


def _no_data(page: tifffile.TiffPage) -> float | None:
    text = page.tags.valueof(42113)  # GDAL_NODATA: a number in ASCII
    try:
        return float(str(text).strip(" \0"))
    except ValueError:
        return None


def _place(
    page: tifffile.TiffPage, size: tuple[int, int], crs: Crs, path: Path
) -> tuple[Place | None, bool | None]:
    """Return where the nodes lie, and whether the first row is the south's; None for what is not said."""
    tags = page.tags
    scale, tie, matrix = (tags.valueof(number) for number in (33550, 33922, 34264))
    middle = 0.0 if code(dict(crs.keys), RASTER) == IS_POINT else 0.5  # of a texel, from its place
    if scale is not None and len(scale) >= 2:
        dx, dy = float(scale[0]), -abs(float(scale[1]))  # as GDAL takes their signs
        column, row, west, north = 0.0, 0.0, math.nan, math.nan
        if tie is not None and len(tie) >= 6:
            column, row, west, north = (float(tie[k]) for k in (0, 1, 3, 4))
        west, north = west + (middle - column) * dx, north + (middle - row) * dy
    elif matrix is not None and len(matrix) == 16:
        if matrix[1] or matrix[4]:
            raise turned(path, float(matrix[0]), float(matrix[4]))
        dx, dy = float(matrix[0]), float(matrix[5])
        west, north = float(matrix[3]) + middle * dx, float(matrix[7]) + middle * dy
    else:
        return None, None
    if not (0.0 < abs(dx) < math.inf and 0.0 < abs(dy) < math.inf):
        raise DataError(f"says that a texel is {dx} x {abs(dy)}; expected lengths above zero", file=path)
    if dx < 0.0:
        raise turned(path, dx, 0.0)
    if dy > 0.0:
        north += (size[1] - 1) * dy
    return Place(west, north, (dx, abs(dy)), size, crs), dy > 0.0

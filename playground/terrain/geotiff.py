"""Read elevations from TIFF files, with what GeoTIFF's tags say of metres and gaps.

Reads the first picture only, and does not reproject. Sources: OGC GeoTIFF 1.1 (OGC
19-008r4, 2019) for tags and keys; GDAL's raster driver documentation for tags 42112 and 42113.
"""

from __future__ import annotations

import logging
import math
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.images.bounds import refuse_bomb
from playground.images.files import reason
from playground.terrain.geodesy import spacing_from_degrees
from playground.terrain.grid import EIGHT_BIT, SIXTEEN_BIT, Found, Packing, check_grid, from_channels

if TYPE_CHECKING:
    import tifffile


def read_tiff(path: Path, packing: Packing) -> Found:
    """Read the first picture of a TIFF, with its spacing, unit and no-data value where tags tell them."""
    import tifffile

    try:
        with _without_log("tifffile"):
            tif = tifffile.TiffFile(path)
    except tifffile.TiffFileError as error:
        raise DataError(f"not a TIFF file, although its name says so: {reason(error)}", file=path) from error
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
        check_grid(rows_cols, page.dtype, path)
        if samples > 4:
            raise DataError(f"has {samples} channels; expected one, or three with packing 'rgb'", file=path)
        end = max((o + n for o, n in zip(page.dataoffsets, page.databytecounts, strict=False)), default=0)
        if end > path.stat().st_size:
            raise DataError(f"is cut short: its data ends at byte {end}, the file before", file=path)
        refuse_bomb(path, math.prod(shape) * page.dtype.itemsize, sum(page.databytecounts))
        values = _tiff_values(page, path)
        if axes == "SYX":
            values = np.moveaxis(values, 0, -1)
        geo = _geography(page, rows_cols, path)
        void = _tiff_void(page, values)
        packed = _packing(page, path)
        notes = geo.notes
        if len(pages) > 1 and not getattr(pages[1], "is_reduced", True):
            notes += (f"the first of {len(pages)} pictures was read",)
    if values.ndim == 3:
        found = from_channels(values, packing, path)
        void = None if void is None else void[..., 0]
        if found.void is not None:
            void = found.void if void is None else void | found.void
        values, code_range, notes = found.values, found.code_range, notes + found.notes
    elif packing == "rgb":
        raise DataError("packed heights need three channels of 8 bits; found one", file=path)
    else:
        code_range = {"u1": EIGHT_BIT, "u2": SIXTEEN_BIT}.get(values.dtype.str[1:])
    in_metres = geo.in_metres and (packed is not None or code_range in (None, SIXTEEN_BIT))
    scale, offset = packed if packed is not None and in_metres else (1.0, 0.0)
    unit = geo.height_unit if in_metres else 1.0
    return Found(
        values,
        geo.spacing,
        in_metres=in_metres,
        code_range=None if in_metres else code_range,
        void=void,
        scale=scale * unit,
        offset=offset * unit,
        notes=notes,
    )


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


def _tiff_values(page: tifffile.TiffPage, path: Path) -> NDArray[Any]:
    try:
        return np.asarray(page.asarray())
    except ImportError:  # zstd, of which Python knows from 3.14 on
        pass
    except (ValueError, KeyError) as error:
        if "imagecodecs" not in str(error):
            raise
    # tifffile alone lacks LZW and the floating-point predictor too; Pillow's libtiff has them.
    import PIL.Image

    assert page.dtype is not None
    modes = {"u1": ("L", "RGB", "RGBA", "LA"), "u2": ("I;16",), "i2": ("I",), "i4": ("I",), "f4": ("F",)}
    compression = getattr(page.compression, "name", page.compression)
    install = "the package imagecodecs reads it: python -m pip install imagecodecs"
    try:
        with PIL.Image.open(path, formats=("TIFF",)) as picture:
            if picture.mode in modes.get(page.dtype.str[1:], ()):
                values = np.array(picture)
                if values.shape == page.shape:
                    return values.astype(page.dtype.newbyteorder("="))
    except PIL.UnidentifiedImageError:
        pass
    except OSError as error:
        message = f"its compression {compression} cannot be undone ({error}): it is damaged, or {install}"
        raise DataError(message, file=path) from error
    raise DataError(
        f"its {page.dtype} numbers under compression {compression} cannot be read here; "
        f"expected no compression or deflate; {install}",
        file=path,
    )


def _tiff_void(page: tifffile.TiffPage, values: NDArray[Any]) -> NDArray[np.bool_] | None:
    text = page.tags.valueof(42113)  # GDAL_NODATA: a number in ASCII
    try:
        value = float(str(text).strip(" \0"))
    except ValueError:
        return None
    if values.dtype.kind != "f":
        bounds = np.iinfo(values.dtype)
        exact = value.is_integer() and bounds.min <= value <= bounds.max
        return np.asarray(values == int(value)) if exact else None
    if abs(value) > 1e30:  # the lowest float, which programs round in several ways before printing
        return np.asarray(np.abs(values) > 1e30)
    return np.asarray(values == values.dtype.type(value))


def _packing(page: tifffile.TiffPage, path: Path) -> tuple[float, float] | None:
    """Return what a whole number is multiplied by and what is added, where GDAL's metadata say so."""
    text = str(page.tags.valueof(42112) or "")  # XML, of which two items of the first channel count
    found = {}
    for attributes, value in re.findall(r"<Item\b([^>]*)>([^<]*)</Item>", text):
        role = re.search(r'\brole="(scale|offset)"', attributes)
        if role and not re.search(r'\bsample="(?!0")', attributes):
            try:
                found[role[1]] = float(value)
            except ValueError:
                found[role[1]] = math.nan
    if not found:
        return None
    scale, offset = found.get("scale", 1.0), found.get("offset", 0.0)
    if not (math.isfinite(scale) and math.isfinite(offset) and scale):
        raise DataError("says that its numbers have a scale or an offset that is no number", file=path)
    return scale, offset


@dataclass(frozen=True)
class _Geography:
    spacing: tuple[float, float] | None
    in_metres: bool  # heights are, after the factor
    height_unit: float = 1.0  # [m]
    notes: tuple[str, ...] = ()


_FOOT = {9001: 1.0, 9002: 0.3048, 9003: 1200.0 / 3937.0}  # EPSG units: metre, foot, US survey foot


def _geography(page: tifffile.TiffPage, rows_cols: tuple[int, ...], path: Path) -> _Geography:
    tags = page.tags
    scale, tie, matrix = (tags.valueof(code) for code in (33550, 33922, 34264))
    keys = _geo_keys(tags.valueof(34735))
    rows, _ = rows_cols
    middle = (rows - 1) / 2 + (0.0 if keys.get(1025) == 2 else 0.5)  # raster type 1: pixel is area
    if scale is not None and len(scale) >= 2:
        dx, dy = abs(float(scale[0])), abs(float(scale[1]))
        row, y = (float(tie[1]), float(tie[4])) if tie is not None and len(tie) >= 6 else (middle, math.nan)
        north = y - (middle - row) * dy
    elif matrix is not None and len(matrix) == 16:
        dx, dy = math.hypot(matrix[0], matrix[4]), math.hypot(matrix[1], matrix[5])
        north = float(matrix[5]) * middle + float(matrix[7])
        if matrix[1] or matrix[4]:
            return _Geography(None, False, notes=("its grid is turned against north, so no spacing",))
    else:
        return _Geography(None, False)
    if not (0.0 < dx < math.inf and 0.0 < dy < math.inf):
        raise DataError(f"says that a texel is {dx} x {dy}; expected lengths above zero", file=path)
    height_unit = _FOOT.get(keys.get(4099, 9001), 1.0)
    model = keys.get(1024)
    if model == 2:
        if not math.isfinite(north):
            return _Geography(None, True, height_unit, ("its texels are degrees at an unknown latitude",))
        degrees = math.degrees(1.0) if keys.get(2054) == 9101 else 1.0
        spacing, notes = spacing_from_degrees(dx * degrees, dy * degrees, north * degrees)
        return _Geography(spacing, True, height_unit, notes)
    if model == 1:
        unit = keys.get(3076, 9001)
        factor = _FOOT.get(unit, 1.0)
        notes = () if unit in _FOOT else (f"its unit of length, EPSG {unit}, is taken for a metre",)
        if keys.get(3072) == 3857 and math.isfinite(north):
            # Web Mercator stretches by 1 / cos(latitude), which is cosh(y / R), since
            # y = R artanh(sin(latitude)): Snyder 1987, p. 41, eq. (7-2a).
            factor /= math.cosh(north / 6378137.0)
        return _Geography((dx * factor, dy * factor), True, height_unit, notes)
    return _Geography(None, False, notes=("it has a texel size but does not say whether that is metres",))


def _geo_keys(directory: Any) -> dict[int, int]:
    # GeoKeyDirectory: groups of four numbers; those stored in place have location 0.
    numbers = [int(n) for n in directory] if directory is not None else []
    groups = [numbers[k : k + 4] for k in range(4, len(numbers) - 3, 4)]
    return {key: value for key, location, _, value in groups if location == 0}

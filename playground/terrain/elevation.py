"""Read real land from elevation files, mend its gaps, bring it to another size.

Whatever the file's order, heights come out as float32 with row 0 in the south
and NaN where the file has no data. Heights stand on nodes: n texels in a row
are n - 1 spacings long, so the corners of the land are the corners of the grid.

It does not reproject, reads no compressed archives but `.npz`, reads only the
first picture of a TIFF, and leaves raw numbers (0..65535) raw: which heights
they mean is the sketch's choice.

Sources: OGC GeoTIFF 1.1 (OGC 19-008r4, 2019) for tags and keys; GDAL's raster
driver documentation for tag 42113; Snyder 1987, "Map Projections: A Working
Manual", USGS Professional Paper 1395, for the lengths of a degree.
"""

from __future__ import annotations

import logging
import math
import re
import warnings
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError, nearest
from playground.images.files import MAX_TEXELS, checked_file, read_samples, reason

if TYPE_CHECKING:
    import tifffile

Heights = NDArray[np.float32]
Edge = Literal["north", "south"]
Packing = Literal["grey", "rgb"]

READABLE = (".png", ".tif", ".tiff", ".npy", ".npz", ".r16", ".raw", ".hgt")

_EIGHT_BIT = (0.0, 255.0)
_SIXTEEN_BIT = (0.0, 65535.0)
_PACKED = (0.0, 16777215.0)
_SHORT_VOID = -32768  # "no data" in 16-bit elevations: SRTM's value, and the custom since


@dataclass(frozen=True, eq=False)
class Elevation:
    """Heights on a grid, and what the file says about them."""

    heights: Heights  # (ny, nx) float32, row 0 in the south, NaN for no data; read-only
    name: str  # the file's name
    spacing: tuple[float, float] | None = None  # [m] a texel, east and north; None: the file is silent
    in_metres: bool = False  # heights are metres; else raw numbers, or the file is silent
    code_range: tuple[float, float] | None = None  # what raw numbers can be: (0, 255), (0, 65535),
    # (0, 16777215) when packed; None for metres and floats
    notes: tuple[str, ...] = ()  # sentences: what was assumed, what was lost

    @property
    def size(self) -> tuple[int, int]:
        """Return (nx, ny), in texels."""
        ny, nx = self.heights.shape
        return nx, ny

    @property
    def extent(self) -> tuple[float, float] | None:
        """Return the width and depth in metres, from first to last node; None if unknown."""
        if self.spacing is None:
            return None
        nx, ny = self.size
        return (nx - 1) * self.spacing[0], (ny - 1) * self.spacing[1]

    @cached_property
    def lowest(self) -> float:
        """Return the lowest height there is, no-data texels apart."""
        return float(np.nanmin(self.heights))

    @cached_property
    def highest(self) -> float:
        """Return the highest height there is, no-data texels apart."""
        return float(np.nanmax(self.heights))

    @cached_property
    def missing(self) -> int:
        """Return how many texels have no data."""
        return int(np.count_nonzero(np.isnan(self.heights)))


@dataclass(frozen=True)
class _Found:
    # What a format's reader hands over; rows in the file's order.
    values: NDArray[Any]  # (rows, cols), any real dtype
    spacing: tuple[float, float] | None = None
    in_metres: bool = False
    code_range: tuple[float, float] | None = None
    void: NDArray[np.bool_] | None = None  # where there is no data, NaN apart
    scale: float = 1.0  # metres in the file's unit of height
    notes: tuple[str, ...] = ()


def read_elevation(
    path: str | Path,
    *,
    raw_size: tuple[int, int] | None = None,
    packing: Packing = "grey",
    first_row: Edge = "north",
) -> Elevation:
    """Read an elevation file; the name's ending tells the format.

    * `.png`: 8 or 16 bits, grey, raw numbers. Fully transparent texels have no data.
    * `.tif`, `.tiff`: integers or floats. Tags of GeoTIFF give the spacing (degrees
      become metres at the middle latitude), the height's unit and what is no data.
    * `.npy`; `.npz`: the array `elevation`, or the only one of two dimensions; scalars
      `dx` and `dy` give the spacing. They are degrees if `xmin`, `xmax`, `ymin`, `ymax`
      are there, look like degrees (|x| <= 360, |y| <= 90, spacing below 0.05) and no
      string `units` says "m"; else metres.
    * `.r16`, `.raw`: unsigned 16-bit little-endian numbers, square unless `raw_size`
      (nx, ny) says otherwise.
    * `.hgt`: SRTM, signed 16-bit big-endian metres over one degree; the latitude is
      in the name, as `N36W085.hgt`.

    `packing="rgb"` reads R*65536 + G*256 + B from three 8-bit channels of a PNG or
    TIFF. `first_row` says which edge the file begins with: "north" for everything
    image-like and, by custom, for arrays; an `.npy` that `write_values` wrote is
    "south". In 16-bit signed files -32768 is no data.

    Raises:
        DataError: a file that is missing, damaged, too large (over 2**28 texels),
            not numbers, not a grid of at least 2 x 2, infinite somewhere or without
            any data; an unknown ending, packing or edge.
    """
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in READABLE:
        checked_file(path)
        shown = f"{ending!r} is" if ending else "a name without an ending is"
        raise DataError(f"{shown} no elevation format; readable are {', '.join(READABLE)}", file=path)
    for what, word, words in (
        ("packing", packing, ("grey", "rgb")),
        ("first row", first_row, ("north", "south")),
    ):
        if word not in words:
            raise DataError(f"no such {what}: {word!r}{nearest(str(word), words)}", file=path)
    path = checked_file(path)
    if packing == "rgb" and ending not in (".png", ".tif", ".tiff"):
        raise DataError(
            f"heights packed in three channels are read from PNG and TIFF, not {ending}", file=path
        )
    with _damage_explained(path):
        if ending == ".png":
            found = _from_channels(read_samples(path), packing, path)
        elif ending in (".tif", ".tiff"):
            found = _read_tiff(path, packing)
        elif ending == ".npy":
            found = _read_npy(path)
        elif ending == ".npz":
            found = _read_npz(path)
        elif ending == ".hgt":
            found = _read_hgt(path, raw_size)
        else:
            found = _Found(_raw_numbers(path, "<u2", raw_size), code_range=_SIXTEEN_BIT)
    return _finish(found, path, first_row)


@contextmanager
def _damage_explained(path: Path) -> Iterator[None]:
    # Decoders (tifffile, zlib, zipfile, NumPy's headers) raise a dozen kinds of exception
    # on damaged files, and warn about odd metadata.
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            yield
    except DataError:
        raise
    except MemoryError as error:
        raise DataError("there is not enough memory to read it", file=path) from error
    except PermissionError as error:
        raise DataError(f"cannot be read: {reason(error)}", file=path) from error
    except Exception as error:
        raise DataError(f"the file is damaged or cut short: {reason(error)}", file=path) from error


def _finish(found: _Found, path: Path, first_row: Edge) -> Elevation:
    values = found.values
    _check_grid(values.shape, values.dtype, path)
    void = found.void
    if values.dtype == np.int16:
        short = values == _SHORT_VOID
        void = short if void is None else void | short
    with np.errstate(all="ignore"):
        scaled = values if found.scale == 1.0 else values.astype(np.float64) * found.scale
        heights = np.array(scaled, dtype=np.float32)
    if void is not None:
        heights[void] = np.nan
    if first_row == "north":
        heights = np.ascontiguousarray(heights[::-1])
    if np.isinf(heights).any():
        y, x = np.argwhere(np.isinf(heights))[0]
        raise DataError(f"a height is infinite, at texel ({x}, {y}) from the south-west corner", file=path)
    gaps = np.isnan(heights)
    if gaps.all():
        raise DataError("no texel has any data", file=path)
    notes = found.notes
    if values.dtype.itemsize > 2 and values.dtype != np.float32:
        low, high = float(np.nanmin(heights)), float(np.nanmax(heights))
        grain = float(np.spacing(np.float32(max(abs(low), abs(high)))))
        if high > low and grain > (high - low) / 65536.0:
            notes += (f"{values.dtype} heights up to {high:.6g} are kept as float32, to {grain:.2g} only",)
    heights.setflags(write=False)
    return Elevation(heights, path.name, found.spacing, found.in_metres, found.code_range, notes)


def _check_grid(shape: tuple[int, ...], dtype: np.dtype[Any], path: Path) -> None:
    # Called with what a header declares, before anything is allocated.
    size = " x ".join(map(str, reversed(shape))) or "a single number"
    if dtype.kind not in "iuf":
        raise DataError(f"holds {dtype}, not heights; expected integers or real numbers", file=path)
    if len(shape) != 2:
        raise DataError(
            f"has {len(shape)} dimensions ({size}); expected two, rows from north to south", file=path
        )
    if min(shape) < 2:
        raise DataError(f"is {size} texels; expected at least 2 x 2", file=path)
    if math.prod(shape) > MAX_TEXELS:
        raise DataError(f"is {size} texels; the most is 2**28, as 16384 x 16384", file=path)


def _from_channels(samples: NDArray[Any], packing: Packing, path: Path) -> _Found:
    # samples: (rows, cols, channels); grey, grey + alpha, RGB, RGBA.
    channels = samples.shape[2]
    code_range = {"u1": _EIGHT_BIT, "u2": _SIXTEEN_BIT}.get(samples.dtype.str[1:])
    void = None
    if channels in (2, 4) and samples.dtype.kind == "u":
        void = samples[..., -1] == 0
    if packing == "rgb":
        if channels < 3 or samples.dtype != np.uint8:
            bits = 8 * samples.dtype.itemsize
            raise DataError(
                f"packed heights need three channels of 8 bits; found {channels} of {bits}", file=path
            )
        red, green, blue = (samples[..., k].astype(np.float32) for k in range(3))  # exact: below 2**24
        return _Found(red * 65536.0 + green * 256.0 + blue, code_range=_PACKED, void=void)
    grey = samples[..., 0]
    if channels >= 3 and not all(np.array_equal(grey, samples[..., k]) for k in (1, 2)):
        raise DataError(
            "is a picture in colour; expected grey, or packing 'rgb' for heights in three channels", file=path
        )
    return _Found(grey, code_range=code_range, void=void)


# Raw numbers


def _raw_numbers(path: Path, dtype: str, size: tuple[int, int] | None) -> NDArray[Any]:
    length = path.stat().st_size
    count = length // 2
    if size is None:
        if length % 2:
            raise DataError(f"holds {length} bytes, an odd number; expected two for each height", file=path)
        side = math.isqrt(count)
        if side * side != count:
            raise DataError(_not_square(length), file=path)
        size = side, side
    nx, ny = (int(n) for n in size)
    _check_grid((ny, nx), np.dtype(dtype), path)
    if 2 * nx * ny != length:
        raise DataError(
            f"holds {length} bytes; {nx} x {ny} heights of 16 bits need {2 * nx * ny}{_fitting(length)}",
            file=path,
        )
    return np.fromfile(path, dtype=dtype).reshape(ny, nx)


def _not_square(length: int) -> str:
    count = length // 2
    side = math.isqrt(count)
    said = f"holds {count} heights of 16 bits, which is no square ({side} x {side} would be {side * side}"
    said += f", {side + 1} x {side + 1} {(side + 1) ** 2})"
    for bits in (8, 32):
        other = math.isqrt(length * 8 // bits)
        if other * other * bits == length * 8:
            said += f"; it is {other} x {other} of {bits} bits, which is not read here"
    return said + (_fitting(length) or "; raw_size must give its width and height")


def _fitting(length: int) -> str:
    # The two ways of laying the numbers out that are nearest to a square.
    count = length // 2
    side = math.isqrt(min(count, MAX_TEXELS))
    widths = [n for n in range(side, 1, -1) if count % n == 0 and count // n <= 4 * n][:2]
    if length % 2 or not widths:
        return ""
    return "; raw_size could be " + " or ".join(f"{count // n} x {n}" for n in widths)


def _read_hgt(path: Path, size: tuple[int, int] | None) -> _Found:
    values = _raw_numbers(path, ">i2", size).astype(np.int16)
    named = re.match(r"([NS])(\d{1,2})([EW])(\d{1,3})", path.name, re.IGNORECASE)
    if not named:
        note = "an .hgt file's name tells its latitude, as N36W085.hgt; this one does not, so no spacing"
        return _Found(values, in_metres=True, notes=(note,))
    south = int(named[2]) * (1 if named[1].upper() == "N" else -1)
    ny, nx = values.shape
    spacing, notes = _from_degrees(1.0 / (nx - 1), 1.0 / (ny - 1), south + 0.5)
    return _Found(values, spacing, in_metres=True, notes=notes)


# NumPy


@dataclass(frozen=True)
class _Header:
    shape: tuple[int, ...]
    by_columns: bool  # Fortran order
    dtype: np.dtype[Any]


def _read_npy(path: Path) -> _Found:
    with path.open("rb") as handle:
        header = _array_header(handle, path)
        _check_grid(header.shape, header.dtype, path)
        return _Found(_array_body(handle, header, path.stat().st_size, path))


def _array_header(handle: IO[bytes], path: Path) -> _Header:
    # Read before any memory is taken; objects are refused here, so nothing is ever unpickled.
    version = np.lib.format.read_magic(handle)
    if version == (1, 0):
        header = _Header(*np.lib.format.read_array_header_1_0(handle))
    elif version == (2, 0):
        header = _Header(*np.lib.format.read_array_header_2_0(handle))
    else:
        raise DataError("holds records, not heights; expected integers or real numbers", file=path)
    if header.dtype.hasobject:
        raise DataError("holds Python objects, which are never loaded; expected numbers", file=path)
    return header


def _array_body(handle: IO[bytes], header: _Header, length: int, path: Path) -> NDArray[Any]:
    need, have = math.prod(header.shape) * header.dtype.itemsize, length - handle.tell()
    if need > have:
        raise DataError(f"is cut short: its header promises {need} bytes, {have} are there", file=path)
    flat = np.frombuffer(handle.read(need), dtype=header.dtype)
    return flat.reshape(header.shape[::-1]).T if header.by_columns else flat.reshape(header.shape)


class _Archive:
    # The arrays of an .npz, looked at by header and loaded one by one.

    def __init__(self, archive: zipfile.ZipFile, path: Path) -> None:
        self.archive, self.path = archive, path
        self.members = {m.filename.removesuffix(".npy"): m for m in archive.infolist() if not m.is_dir()}

    def header(self, name: str) -> _Header:
        with self.archive.open(self.members[name]) as handle:
            return _array_header(handle, self.path)

    def load(self, name: str) -> NDArray[Any]:
        member = self.members[name]
        with self.archive.open(member) as handle:
            return _array_body(handle, _array_header(handle, self.path), member.file_size, self.path)

    def grid(self) -> NDArray[Any]:
        name = "elevation"
        if name not in self.members:
            grids = [name for name in self.members if self._dimensions(name) == 2]
            if len(grids) != 1:
                listed = ", ".join(sorted(self.members)[:12]) or "nothing"
                raise DataError(
                    f"has no array 'elevation' and {len(grids)} of two dimensions; it holds {listed}",
                    file=self.path,
                )
            name = grids[0]
        header = self.header(name)
        _check_grid(header.shape, header.dtype, self.path)
        return self.load(name)

    def _dimensions(self, name: str) -> int:
        try:
            return len(self.header(name).shape)
        except (DataError, ValueError):  # not an array, or one of objects: some other content
            return -1

    def number(self, name: str) -> float | None:
        if name not in self.members:
            return None
        header = self.header(name)
        if header.dtype.kind not in "iuf" or math.prod(header.shape) != 1:
            raise DataError(f"'{name}' is {header.dtype} {header.shape}; expected one number", file=self.path)
        number = float(self.load(name).reshape(()))
        if not math.isfinite(number):
            raise DataError(f"'{name}' is {number}; expected a finite number", file=self.path)
        return number

    def word(self, name: str) -> str:
        if name not in self.members:
            return ""
        header = self.header(name)
        if header.dtype.kind not in "US" or math.prod(header.shape) != 1 or header.dtype.itemsize > 256:
            raise DataError(f"'{name}' is {header.dtype} {header.shape}; expected a word", file=self.path)
        return str(self.load(name).reshape(()).astype(str)).strip().lower()


def _read_npz(path: Path) -> _Found:
    with zipfile.ZipFile(path) as opened:
        archive = _Archive(opened, path)
        values = archive.grid()
        dx, dy = archive.number("dx"), archive.number("dy")
        x0, x1, y0, y1 = (archive.number(name) for name in ("xmin", "xmax", "ymin", "ymax"))
        units = archive.word("units")
    if dx is None and dy is None:
        return _Found(values)
    dx, dy = abs(dx or dy or 0.0), abs(dy or dx or 0.0)
    if not dx or not dy:
        raise DataError("'dx' and 'dy' are zero; expected the distance between texels", file=path)
    if x0 is None or x1 is None or y0 is None or y1 is None:
        in_degrees = False
    else:
        # The names differ from file to file (in some, ymin is the north edge): only the middle counts.
        in_degrees = max(abs(x0), abs(x1)) <= 360 and max(abs(y0), abs(y1)) <= 90 and max(dx, dy) < 0.05
    if units in ("m", "metre", "metres", "meter", "meters"):
        in_degrees = False
    elif units in ("deg", "degree", "degrees") and y0 is not None and y1 is not None:
        in_degrees = True
    elif units:
        raise DataError(
            f"'units' is {units!r}; expected 'm', or 'degrees' together with 'ymin' and 'ymax'", file=path
        )
    if not in_degrees:
        return _Found(values, (dx, dy), in_metres=True)
    assert y0 is not None and y1 is not None
    spacing, notes = _from_degrees(dx, dy, (y0 + y1) / 2)
    return _Found(values, spacing, in_metres=True, notes=notes)


# TIFF


def _read_tiff(path: Path, packing: Packing) -> _Found:
    import tifffile

    try:
        with _without_log("tifffile"):
            tif = tifffile.TiffFile(path)
    except tifffile.TiffFileError as error:
        raise DataError(f"not a TIFF file, whatever its name says: {reason(error)}", file=path) from error
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
        _check_grid(rows_cols, page.dtype, path)
        if samples > 4:
            raise DataError(f"has {samples} channels; expected one, or three with packing 'rgb'", file=path)
        end = max((o + n for o, n in zip(page.dataoffsets, page.databytecounts, strict=False)), default=0)
        if end > path.stat().st_size:
            raise DataError(f"is cut short: its data ends at byte {end}, the file before", file=path)
        values = _tiff_values(page, path)
        if axes == "SYX":
            values = np.moveaxis(values, 0, -1)
        geo = _geography(page, rows_cols, path)
        void = _tiff_void(page, values)
        notes = geo.notes
        if len(pages) > 1 and not getattr(pages[1], "is_reduced", True):
            notes += (f"the first of {len(pages)} pictures was read",)
    if values.ndim == 3:
        found = _from_channels(values, packing, path)
        void = None if void is None else void[..., 0]
        if found.void is not None:
            void = found.void if void is None else void | found.void
        values, code_range = found.values, found.code_range
    elif packing == "rgb":
        raise DataError("packed heights need three channels of 8 bits; found one", file=path)
    else:
        code_range = {"u1": _EIGHT_BIT, "u2": _SIXTEEN_BIT}.get(values.dtype.str[1:])
    in_metres = geo.in_metres and code_range in (None, _SIXTEEN_BIT)
    return _Found(
        values,
        geo.spacing,
        in_metres=in_metres,
        code_range=None if in_metres else code_range,
        void=void,
        scale=geo.height_unit if in_metres else 1.0,
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
    except (ValueError, KeyError, ImportError) as error:
        if "imagecodecs" not in str(error):
            raise
    # tifffile alone lacks LZW and the floating-point predictor; Pillow's libtiff has them.
    import PIL.Image

    assert page.dtype is not None
    modes = {"u1": ("L", "RGB", "RGBA", "LA"), "u2": ("I;16",), "i2": ("I",), "i4": ("I",), "f4": ("F",)}
    with suppress(PIL.UnidentifiedImageError), PIL.Image.open(path, formats=("TIFF",)) as picture:
        if picture.mode in modes.get(page.dtype.str[1:], ()):
            values = np.array(picture)
            if values.shape == page.shape:
                return values.astype(page.dtype.newbyteorder("="))
    raise DataError(
        f"its {page.dtype} numbers under compression {getattr(page.compression, 'name', page.compression)} "
        "cannot be read here; expected no compression or deflate, or the package imagecodecs installed",
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
        turn = math.degrees(1.0) if keys.get(2054) == 9101 else 1.0
        spacing, notes = _from_degrees(dx * turn, dy * turn, north * turn)
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


# Degrees


def degree_lengths(latitude: float) -> tuple[float, float]:
    """Return the metres in a degree of longitude and in one of latitude, on WGS 84.

    `latitude` is geodetic, in degrees, -90..90. Snyder 1987, p. 25: the radius of
    curvature along the meridian, eq. (4-18), and of the prime vertical, eq. (4-20);
    a and f of the ellipsoid from NIMA TR8350.2 (2000), table 3.1.
    """
    a, f = 6378137.0, 1.0 / 298.257223563
    e2 = f * (2.0 - f)
    phi = math.radians(latitude)
    w2 = 1.0 - e2 * math.sin(phi) ** 2
    meridian = a * (1.0 - e2) / w2**1.5
    prime_vertical = a / math.sqrt(w2)
    return math.radians(prime_vertical * math.cos(phi)), math.radians(meridian)


def _from_degrees(
    dx: float, dy: float, latitude: float
) -> tuple[tuple[float, float] | None, tuple[str, ...]]:
    if abs(latitude) > 89.9:
        return None, (f"its middle latitude is {latitude:.6g} degrees, so its spacing is unknown",)
    east, north = degree_lengths(latitude)
    return (dx * east, dy * north), ()


# Gaps


def fill_no_data(elevation: Elevation, mode: Literal["refuse", "fill"] = "refuse") -> Elevation:
    """Return the elevation without gaps; itself, if it has none.

    `"refuse"` makes a gap an error; `"fill"` spans gaps with a smooth sheet that
    meets the land around them (see `_filled`), and leaves every known height as it is.

    Raises:
        DataError: gaps, under "refuse", with their number and the first one's texel;
            another mode.
    """
    if mode not in ("refuse", "fill"):
        raise DataError(f"no such way with gaps: {mode!r}{nearest(str(mode), ('refuse', 'fill'))}")
    if not elevation.missing:
        return elevation
    if mode == "refuse":
        y, x = np.unravel_index(int(np.argmax(np.isnan(elevation.heights))), elevation.heights.shape)
        raise DataError(
            f"{elevation.missing} of {elevation.heights.size} texels have no data, the first at ({x}, {y}) "
            "from the south-west corner; expected none, or the mode 'fill'",
            file=elevation.name,
        )
    heights = _filled(elevation.heights)
    heights.setflags(write=False)
    note = f"{elevation.missing} texels without data were filled from their surroundings"
    return replace(elevation, heights=heights, notes=(*elevation.notes, note))


def _filled(heights: Heights) -> Heights:
    # Solve Laplace's equation in the gaps (free at the edges of the land), coarse to fine: the
    # pull and push of Gortler et al. 1996, "The Lumigraph", section 3.4, starts each level, a few
    # Gauss-Seidel sweeps finish it: the cascade of Bornemann and Deuflhard 1996.
    known = ~np.isnan(heights)
    with np.errstate(all="ignore"):
        level = np.where(known, heights, np.float32(0.0)).astype(np.float64)
        middle = level.sum() / np.count_nonzero(known)
        level[known] -= middle
        levels = [(level, known)]
        while not known.all():
            level, known = _halved(level, known)
            levels.append((level, known))
        coarse = levels.pop()[0]
        while levels:
            level, known = levels.pop()
            gaps = np.argwhere(~known)
            level[~known] = _interpolated(coarse, gaps)
            _relax(level, gaps)
            coarse = level
        result = heights.copy()
        gap = np.isnan(heights)
        result[gap] = coarse[gap] + middle
    return result


def _halved(
    level: NDArray[np.float64], known: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    # Means of the known among each 2 x 2; level is 0 where unknown.
    pad = [(0, n % 2) for n in level.shape]
    total, count = np.pad(level, pad), np.pad(known, pad).astype(np.uint8)
    total = total[::2] + total[1::2]
    total = total[:, ::2] + total[:, 1::2]
    count = count[::2] + count[1::2]
    count = count[:, ::2] + count[:, 1::2]
    return total / np.maximum(count, 1), count > 0


def _interpolated(coarse: NDArray[np.float64], texels: NDArray[np.intp]) -> NDArray[np.float64]:
    # Bilinear, where fine texel i lies at coarse (i - 0.5) / 2: 3/4 of its own cell, 1/4 of the next.
    own = texels // 2
    other = np.clip(own + np.where(texels % 2, 1, -1), 0, np.array(coarse.shape) - 1)
    (oy, ox), (ny, nx) = own.T, other.T
    return np.asarray(
        0.5625 * coarse[oy, ox] + 0.1875 * (coarse[ny, ox] + coarse[oy, nx]) + 0.0625 * coarse[ny, nx]
    )


def _relax(level: NDArray[np.float64], gaps: NDArray[np.intp]) -> None:
    rows, cols = level.shape
    flat = level.reshape(-1)
    y, x = gaps.T
    here = y * cols + x
    around = (
        np.where(y > 0, here - cols, here),
        np.where(y < rows - 1, here + cols, here),
        np.where(x > 0, here - 1, here),
        np.where(x < cols - 1, here + 1, here),
    )
    colour = (y + x) % 2 == 0
    halves = [(here[c], *(n[c] for n in around)) for c in (colour, ~colour)]
    # Coarse levels carry the error that is slow to go, and cost next to nothing.
    for _ in range(min(64, max(8, 1_000_000 // len(here)))):
        for centre, s, n, w, e in halves:
            flat[centre] = 0.25 * (flat[s] + flat[n] + flat[w] + flat[e])


# Size


def resample(heights: NDArray[np.floating[Any]], size: tuple[int, int]) -> Heights:
    """Return the heights (ny, nx) on a grid of another size (nx, ny), corners on corners.

    One cubic kernel (Keys 1981, a = -1/2: "Catmull-Rom"), as wide as the coarser of
    the two grids, so that shrinking averages and does not alias. Beyond its edges the
    land goes on as its image turned half round about the edge: the corners keep their
    heights, two tiles that share an edge still share it, a plane stays a plane, a
    constant stays exact. Next to a cliff the result may leave the range of the input
    by some 8 % of the cliff.

    Raises:
        DataError: not a grid of finite numbers, or a size below 2 x 2 or above 2**28.
    """
    given = np.asarray(heights)
    name = Path("heights to resample")
    _check_grid(given.shape, given.dtype, name)
    nx, ny = (int(n) for n in size)
    _check_grid((ny, nx), np.dtype(np.float32), Path("resampled heights"))
    bad = int(np.count_nonzero(~np.isfinite(given)))
    if bad:
        raise DataError(f"{bad} are not finite; expected gaps to be filled first", file=name)
    with np.errstate(all="ignore"):
        values = given.astype(np.float32)
        middle = np.float64(values.min()) / 2 + np.float64(values.max()) / 2
        part = values - middle  # float64, and zero for a constant
        # The axis that shrinks most goes first: less to do for the other.
        if ny / given.shape[0] <= nx / given.shape[1]:
            part = _resized(_resized(part, ny).T, nx).T
        else:
            part = _resized(_resized(part.T, nx).T, ny)
        return np.ascontiguousarray(part + middle, dtype=np.float32)


def _resized(values: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    # Along axis 0, to `count` rows.
    values = np.ascontiguousarray(values)
    if count == len(values):
        return values
    weights, sources, first, last = _taps(len(values), count)
    result = first[:, None] * values[0] + last[:, None] * values[-1]
    for start in range(0, count, 64):
        # A band of results needs a band of sources: small dense products, which are fast.
        band = slice(start, start + 64)
        low = int(sources[band].min())
        dense = np.zeros((len(result[band]), int(sources[band].max()) + 1 - low))
        np.add.at(dense, (np.arange(len(dense))[:, None], sources[band] - low), weights[band])
        result[band] += dense @ values[low : low + dense.shape[1]]
    return np.asarray(result)


def _taps(
    n: int, count: int
) -> tuple[NDArray[np.float64], NDArray[np.intp], NDArray[np.float64], NDArray[np.float64]]:
    # For each of `count` results its weights and their sources (both count x taps), and what
    # the first and the last value count besides.
    ratio = (n - 1) / (count - 1)
    scale = max(ratio, 1.0)
    places = np.linspace(0.0, n - 1, count)
    start = np.floor(places - 2.0 * scale).astype(np.intp) + 1
    index = start[:, None] + np.arange(math.ceil(4.0 * scale) + 1)
    away = index - places[:, None]
    weights = _catmull_rom(away / scale)
    weights /= weights.sum(axis=1, keepdims=True)
    if scale > 1.0:
        # Sampled between its knots the wide kernel has its mean not quite on the place; tilting
        # the weights (by a term that adds up to zero) puts it there, so that a plane stays one.
        broad = np.maximum(2.0 - np.abs(away) / scale, 0.0)
        tilt = broad * (away - (broad * away).sum(axis=1, keepdims=True) / broad.sum(axis=1, keepdims=True))
        mean = (weights * away).sum(axis=1, keepdims=True)
        weights -= tilt * (mean / (tilt * away).sum(axis=1, keepdims=True))
    # Turned half round about its edges, the land repeats with period p, raised each time by twice
    # its rise: v[q p + r] = 2 q (v[n-1] - v[0]) + (v[r] if r < n else 2 v[n-1] - v[p - r]).
    period = 2 * (n - 1)
    turns, place = np.divmod(index, period)
    inside = place < n
    first = -2.0 * (weights * turns).sum(axis=1)
    last = 2.0 * (weights * (turns + ~inside)).sum(axis=1)
    return np.where(inside, weights, -weights), np.where(inside, place, period - place), first, last


def _catmull_rom(x: NDArray[np.float64]) -> NDArray[np.float64]:
    x = np.abs(x)
    near = 1.0 + x * x * (1.5 * x - 2.5)
    far = 2.0 + x * (x * (2.5 - 0.5 * x) - 4.0)
    return np.where(x < 1.0, near, np.where(x < 2.0, far, 0.0))

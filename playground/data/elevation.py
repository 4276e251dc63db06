"""Read real terrain from elevation files, and span the gaps where a file has no data.

Heights come out as float32 with row 0 in the south
and NaN where the file has no data. Heights are on nodes: n texels in a row
are n - 1 spacings long, so the corners of the terrain are the corners of the grid.

GDAL reads what is georeferenced (`gis`), and `arrays` reads arrays; this finishes what they hand over:
whole, or at another size without ever having all of it in memory. Raw numbers (0..65535) stay raw: which
heights they mean is the sketch's choice.
"""

from __future__ import annotations

import logging
import math
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from playground.allowed_files import ELEVATIONS
from playground.data.arrays import read_npy, read_npz, read_raw
from playground.data.gis import read_raster
from playground.data.grid import Heights, Packing, RasterFile, check_grid, from_channels
from playground.data.image_files import read_samples, read_texts
from playground.data.place import Georeference
from playground.data.resample import decimate
from playground.errors import DataError, nearest
from playground.files import checked_file, reason
from playground.paths import shown

Edge = Literal["north", "south"]
Voids = Literal["refuse", "fill"]

_log = logging.getLogger(__name__)

_OVERVIEW = 2**20
"""Texels, at least, of the overview that tells how low and high a terrain is."""


@dataclass(frozen=True, eq=False)
class Elevation:
    """Heights on a grid, and what the file says about them."""

    heights: Heights  # (ny, nx) float32, row 0 in the south, NaN for no data; read-only
    name: str  # the file's name
    spacing: tuple[float, float] | None = None  # [m] a texel, east and north; None: the file is silent
    in_metres: bool = True  # heights are metres; else codes, as a picture's
    code_range: tuple[float, float] | None = None  # what raw numbers can be: (0, 255), (0, 65535),
    # (0, 16777215) when packed, or the metres that these mean where a PNG's texts say so;
    # None for other metres and for floats
    notes: tuple[str, ...] = ()  # sentences: what was assumed, what was lost
    path: Path | None = None  # where it was read from
    place: Georeference | None = None  # where all of the file's texels lie; None: the file is silent
    assumed: str = ""  # of the unit of its heights; "" where the file or its format says it
    range: tuple[float, float] | None = None  # the lowest and the highest of the file; None: of ``heights``

    @property
    def size(self) -> tuple[int, int]:
        """Return (nx, ny), in texels."""
        ny, nx = self.heights.shape
        return nx, ny

    @property
    def extent(self) -> tuple[float, float] | None:
        """Return the width and depth in metres, from first to last node; None if unknown."""
        return _extent(self.spacing, self.size)

    @cached_property
    def lowest(self) -> float:
        """Return the lowest height there is, no-data texels apart."""
        return float(np.nanmin(self.heights)) if self.range is None else self.range[0]

    @cached_property
    def highest(self) -> float:
        """Return the highest height there is, no-data texels apart."""
        return float(np.nanmax(self.heights)) if self.range is None else self.range[1]

    @cached_property
    def missing(self) -> int:
        """Return how many texels have no data."""
        return int(np.count_nonzero(np.isnan(self.heights)))


@dataclass(frozen=True, eq=False)
class ElevationFile:
    """An elevation file that was opened: its header is known, its heights can be read."""

    path: Path
    grid: RasterFile
    south_first: bool

    @property
    def size(self) -> tuple[int, int]:
        """Return (nx, ny), in texels."""
        return self.grid.size

    @property
    def extent(self) -> tuple[float, float] | None:
        """Return the width and depth in metres, from first to last node; None if unknown."""
        return _extent(self.grid.spacing, self.size)

    def read(self) -> Elevation:
        """Return all heights; raise ``DataError`` for more than fit."""
        check_grid(self.grid.rows.shape, self.grid.rows.dtype, self.path)
        heights = np.empty(self.grid.rows.shape, np.float32)
        in_order = heights if self.south_first else heights[::-1]
        with _damage_explained(self.path):
            for start, band in self.grid.rows.bands():
                in_order[start : start + len(band)] = self._heights(start, band)
        return self._finished(heights, self.grid.spacing)

    def read_at(self, size: tuple[int, int]) -> Elevation:
        """Return the heights at another size (nx, ny), corners on corners, a part of the file at a time.

        Where that is smaller than an overview of the file, the overview is read. The lowest and the highest
        are those of the file, or of an overview of a million texels or more.
        """
        rows, whole = self.grid.rows, self.size
        if size == whole:
            elevation = self.read()
            return replace(elevation, range=self.lowest_and_highest) if self.grid.overviews else elevation
        # Twice as fine as what is wanted: the mean that an overview's texel is counts little then.
        fine = [
            o
            for o in self.grid.overviews
            if all(a >= 2 * b for a, b in zip(o.shape, size[::-1], strict=True))
        ]
        with _damage_explained(self.path):
            made = decimate(fine[-1] if fine else rows, size, self._heights, whole if fine else None)
        extent = self.extent
        spacing = None
        if extent is not None:
            spacing = extent[0] / (size[0] - 1), extent[1] / (size[1] - 1)
        span = self.lowest_and_highest if self.grid.overviews else (made.lowest, made.highest)
        heights = made.heights if self.south_first else np.ascontiguousarray(made.heights[::-1])
        return replace(self._finished(heights, spacing), range=span)

    @cached_property
    def lowest_and_highest(self) -> tuple[float, float]:
        """Return those of an overview of a million texels or more, else of all texels."""
        large = [rows for rows in self.grid.overviews if math.prod(rows.shape) >= _OVERVIEW]
        rows = large[-1] if large else self.grid.rows
        low, high = math.inf, -math.inf
        with _damage_explained(self.path):
            for start, band in rows.bands():
                heights = self._heights(start, band)
                if not np.isnan(heights).all():
                    low, high = min(low, float(np.nanmin(heights))), max(high, float(np.nanmax(heights)))
        if low > high:
            raise self._nothing()
        return low, high

    def _heights(self, start: int, band: NDArray[Any]) -> NDArray[np.floating[Any]]:
        heights = self.grid.heights(band)
        if np.isinf(heights).any():
            row, x = (int(n) for n in np.argwhere(np.isinf(heights))[0])
            y = start + row if self.south_first else self.grid.rows.shape[0] - 1 - start - row
            message = f"a height is infinite, at texel ({x}, {y}) from the south-west corner"
            raise DataError(message, file=self.path)
        return heights

    def _nothing(self) -> DataError:
        return DataError("no texel has any data", file=self.path)

    def _finished(self, heights: Heights, spacing: tuple[float, float] | None) -> Elevation:
        grid, path = self.grid, self.path
        if np.isnan(heights).all():
            raise self._nothing()
        notes, dtype = grid.notes, grid.rows.dtype
        if dtype.itemsize > 2 and dtype != np.float32:
            low, high = float(np.nanmin(heights)), float(np.nanmax(heights))
            grain = float(np.spacing(np.float32(max(abs(low), abs(high)))))
            if high > low and grain > (high - low) / 65536.0:
                notes += (f"{dtype} heights up to {high:.6g} are kept as float32, to {grain:.2g} only",)
        heights.setflags(write=False)
        return Elevation(
            heights,
            path.name,
            spacing,
            grid.in_metres,
            grid.code_range,
            notes,
            path,
            grid.place,
            grid.assumed,
        )


def _extent(spacing: tuple[float, float] | None, size: tuple[int, int]) -> tuple[float, float] | None:
    return None if spacing is None else ((size[0] - 1) * spacing[0], (size[1] - 1) * spacing[1])


def read_elevation(
    path: str | Path,
    *,
    raw_size: tuple[int, int] | None = None,
    packing: Packing = "grey",
    first_row: Edge = "north",
) -> Elevation:
    """Read all heights of an elevation file; the arguments and mistakes are those of ``open_elevation``."""
    return open_elevation(path, raw_size=raw_size, packing=packing, first_row=first_row).read()


def open_elevation(
    path: str | Path,
    *,
    raw_size: tuple[int, int] | None = None,
    packing: Packing = "grey",
    first_row: Edge = "north",
) -> ElevationFile:
    """Open an elevation file; the name's ending tells the format.

    * `.png`: 8 or 16 bits, grey, raw numbers, or metres if its texts `scale_m` and `offset_m`
      say which, as `playground export` writes them, with the spacing in `spacing_m`. Fully
      transparent texels have no data.
    * `.npy`; `.npz`: the array `elevation`, or the only one of two dimensions, in metres
      unless a string `height_units` names another unit; scalars `dx` and `dy` give the
      spacing. They are degrees if `xmin`, `xmax`, `ymin`, `ymax` are there, look like degrees
      (|x| <= 360, |y| <= 90, spacing below 0.05) and no string `units` says "m"; else metres.
      A text `crs`, the well-known text of a reference system, says what they are instead;
      `first_row` is "north" or "south".
    * `.r16`, `.raw`: unsigned 16-bit little-endian numbers, square unless `raw_size`
      (nx, ny) says otherwise.
    * `.tif`, `.tiff`, `.vrt`, `.img`, `.jp2`, `.gpkg`, `.nc`, `.hgt`, `.asc`, and `.bil` and `.flt` with an
      `.hdr`: what GDAL reads, with its place, unit, scale and offset, mask and no data (degrees become metres
      at the middle latitude). 8 or 16 bits without a sign, a place or a unit are a picture's raw numbers.

    The `.aux.xml` that GDAL writes next to its files may have a unit, a scale and an offset of heights, and
    a reference system where the file has none. `assumed` says what nothing tells of the unit.

    `packing="rgb"` reads R*65536 + G*256 + B from three 8-bit channels of a PNG or
    TIFF. `first_row` says which edge the file begins with: "north" for everything
    image-like and, by custom, for arrays; an `.npy` that `write_values` wrote is
    "south". What the file itself says counts more than "north" does. In 16-bit signed
    files -32768 is no data.

    Raises:
        DataError: a file that is missing, damaged, too large (`data.bounds`),
            not numbers, not a grid of at least 2 x 2, infinite somewhere or without
            any data; an unknown ending, packing or edge.
    """
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in ELEVATIONS:
        checked_file(path)
        named = f"{ending!r} is" if ending else "a name without an ending is"
        raise DataError(f"{named} no elevation format; readable are {', '.join(ELEVATIONS)}", file=path)
    for what, word, words in (
        ("packing", packing, ("grey", "rgb")),
        ("first row", first_row, ("north", "south")),
    ):
        if word not in words:
            raise DataError(f"no such {what}: {word!r}{nearest(str(word), words)}", file=path)
    path = checked_file(path)
    _log.debug("read the heights of %s", shown(path))
    if packing == "rgb" and ending not in (".png", ".tif", ".tiff"):
        raise DataError(
            f"heights packed in three channels are read from PNG and TIFF, not {ending}", file=path
        )
    with _damage_explained(path):
        if ending == ".png":
            raster = from_channels(read_samples(path), packing, path)
            raster = _scaled(raster, read_texts(path)) if packing == "grey" else raster
        elif ending == ".npy":
            raster = read_npy(path)
        elif ending == ".npz":
            raster = read_npz(path)
        elif ending in (".r16", ".raw"):
            raster = read_raw(path, raw_size)
        else:
            raster = read_raster(path, packing)
    check_grid(raster.rows.shape, raster.rows.dtype, path, in_turn=True)
    return ElevationFile(path, raster, raster.south_first or first_row == "south")


def _scaled(grid: RasterFile, text: Mapping[str, str]) -> RasterFile:
    """Return what was found in metres, where a PNG's texts say what its numbers mean."""
    scale, offset = (_numbers(text.get(name, ""), 1) for name in ("scale_m", "offset_m"))
    if not scale or not offset or scale[0] <= 0.0 or grid.code_range is None:
        return grid
    low, high = (offset[0] + scale[0] * code for code in grid.code_range)
    spacing = _numbers(text.get("spacing_m", ""), 2)
    return replace(
        grid,
        in_metres=True,
        scale=scale[0],
        offset=offset[0],
        code_range=(low, high),
        spacing=(spacing[0], spacing[1]) if spacing and min(spacing) > 0.0 else None,
    )


def _numbers(text: str, count: int) -> list[float]:
    """Return so many finite numbers of a text, or none: a text may be anybody's."""
    try:
        numbers = [float(word) for word in text.split()]
    except ValueError:
        return []
    return numbers if len(numbers) == count and all(map(math.isfinite, numbers)) else []


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


# ── gaps ─────────────────────────────────────────────────────────────────────


def fill_no_data(elevation: Elevation, mode: Voids = "refuse") -> Elevation:
    """Return the elevation without gaps; itself, if it has none.

    `"refuse"` makes a gap an error; `"fill"` spans gaps with a smooth sheet that
    meets the terrain around them (see `_filled`), and leaves every known height as it is.

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
            'from the south-west corner; expected none, or no_data = "fill"',
            file=elevation.path or elevation.name,
        )
    heights = _filled(elevation.heights)
    heights.setflags(write=False)
    note = f"{elevation.missing} texels without data were filled from their surroundings"
    return replace(elevation, heights=heights, notes=(*elevation.notes, note))


def _filled(heights: Heights) -> Heights:
    # Solve Laplace's equation in the gaps (free at the edges of the terrain), coarse to fine: the
    # pull and push of Gortler et al. 1996, "The Lumigraph", section 3.4, starts each level, a few
    # Gauss-Seidel sweeps finish it: the cascade of Bornemann and Deuflhard 1996.
    has_data = ~np.isnan(heights)
    with np.errstate(all="ignore"):
        level = np.where(has_data, heights, np.float32(0.0)).astype(np.float64)
        middle = level.sum() / np.count_nonzero(has_data)
        level[has_data] -= middle
        levels = [(level, has_data)]
        while not has_data.all():
            level, has_data = _halved(level, has_data)
            levels.append((level, has_data))
        coarse = levels.pop()[0]
        while levels:
            level, has_data = levels.pop()
            gaps = np.argwhere(~has_data)
            level[~has_data] = _interpolated(coarse, gaps)
            _relax(level, gaps)
            coarse = level
        result = heights.copy()
        gap = np.isnan(heights)
        result[gap] = coarse[gap] + middle
    return result


def _halved(
    level: NDArray[np.float64], has_data: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    # Means of the known among each 2 x 2; level is 0 where unknown.
    pad = [(0, n % 2) for n in level.shape]
    total, count = np.pad(level, pad), np.pad(has_data, pad).astype(np.uint8)
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

"""Read elevations from files that hold nothing but 16-bit numbers: `.r16`, `.raw`, SRTM's `.hgt`."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np

from playground.data.bounds import MAX_TEXELS
from playground.data.geokeys import GEOGRAPHIC, IS_POINT, MODEL, RASTER
from playground.data.grid import SIXTEEN_BIT, Found, check_grid
from playground.data.place import Crs, Place
from playground.data.rows import FileRows
from playground.errors import DataError


def read_raw(path: Path, size: tuple[int, int] | None) -> Found:
    """Read unsigned little-endian numbers; the grid is square unless ``size`` (nx, ny) says otherwise."""
    return Found(_numbers(path, "<u2", size), in_metres=False, code_range=SIXTEEN_BIT)


def read_hgt(path: Path, size: tuple[int, int] | None) -> Found:
    """Read an SRTM tile: signed big-endian metres over one degree, whose place is in its name."""
    rows = _numbers(path, ">i2", size)
    named = re.match(r"([NS])(\d{1,2})([EW])(\d{1,3})", path.name, re.IGNORECASE)
    if not named:
        note = "an .hgt file's name tells its latitude, as N36W085.hgt; this one does not, so no spacing"
        return Found(rows, notes=(note,))
    south = int(named[2]) * (1 if named[1].upper() == "N" else -1)
    west = int(named[4]) * (1 if named[3].upper() == "E" else -1)
    ny, nx = rows.shape
    # Nodes lie on the degrees. WGS 84, as its keys in GeoTIFF.
    crs = Crs(((MODEL, 2), (RASTER, IS_POINT), (GEOGRAPHIC, 4326)))
    place = Place(west, south + 1, (1.0 / (nx - 1), 1.0 / (ny - 1)), (nx, ny), crs)
    spacing, notes = place.spacing
    return Found(rows, spacing, place=place, notes=notes)


def _numbers(path: Path, dtype: str, size: tuple[int, int] | None) -> FileRows:
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
    check_grid((ny, nx), np.dtype(dtype), path)
    if 2 * nx * ny != length:
        raise DataError(
            f"holds {length} bytes; {nx} x {ny} heights of 16 bits need {2 * nx * ny}{_fitting(length)}",
            file=path,
        )
    return FileRows(path, (ny, nx), np.dtype(dtype))


def _not_square(length: int) -> str:
    count = length // 2
    side = math.isqrt(count)
    message = f"holds {count} heights of 16 bits, which is no square ({side} x {side} would be {side * side}"
    message += f", {side + 1} x {side + 1} {(side + 1) ** 2})"
    for bits in (8, 32):
        other = math.isqrt(length * 8 // bits)
        if other * other * bits == length * 8:
            message += f"; it is {other} x {other} of {bits} bits, which is not read here"
    return message + (_fitting(length) or "; raw_size must give its width and height")


def _fitting(length: int) -> str:
    # The two ways of laying the numbers out that are nearest to a square.
    count = length // 2
    side = math.isqrt(min(count, MAX_TEXELS))
    widths = [n for n in range(side, 1, -1) if count % n == 0 and count // n <= 4 * n][:2]
    if length % 2 or not widths:
        return ""
    return "; raw_size could be " + " or ".join(f"{count // n} x {n}" for n in widths)

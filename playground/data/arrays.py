"""Read elevations from NumPy's `.npy` and `.npz` files, and from bare 16-bit numbers (`.r16`, `.raw`).

Nothing is unpickled, and no memory is taken before a header is judged.
"""

from __future__ import annotations

import math
import zipfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from playground.data.bounds import MAX_TEXELS, refuse_bomb
from playground.data.grid import SIXTEEN_BIT, FileRows, RasterFile, check_grid, in_memory
from playground.data.place import WGS_84, Crs, Georeference, spacing_from_degrees
from playground.errors import DataError
from playground.files import open_regular


@dataclass(frozen=True)
class ArrayHeader:
    """What an array in a file is."""

    shape: tuple[int, ...]
    by_columns: bool  # Fortran order
    dtype: np.dtype[Any]


def read_npy(path: Path) -> RasterFile:
    """Read the one array of an `.npy`; it says nothing of units."""
    with open_regular(path) as handle:
        header = array_header(handle, path)
        check_grid(header.shape, header.dtype, path, in_turn=not header.by_columns)
        length = path.stat().st_size
        if header.by_columns:
            return in_memory(array_body(handle, header, length, path)).in_unit(Crs())
        _refuse_cut(handle, header, length, path)
        rows = FileRows(path, (header.shape[0], header.shape[1]), header.dtype, handle.tell())
        return RasterFile(rows).in_unit(Crs())


def array_header(handle: IO[bytes], path: Path) -> ArrayHeader:
    """Read an array's header, before any memory is taken; raise ``DataError`` for objects and records."""
    version = np.lib.format.read_magic(handle)
    if version == (1, 0):
        header = ArrayHeader(*np.lib.format.read_array_header_1_0(handle))
    elif version == (2, 0):
        header = ArrayHeader(*np.lib.format.read_array_header_2_0(handle))
    else:
        raise DataError("holds records; expected integers or real numbers", file=path)
    if header.dtype.hasobject:
        raise DataError("holds Python objects, which are never loaded; expected numbers", file=path)
    return header


def _refuse_cut(handle: IO[bytes], header: ArrayHeader, length: int, path: Path) -> int:
    """Return how many bytes an array takes; raise ``DataError`` where they are not there."""
    need, have = math.prod(header.shape) * header.dtype.itemsize, length - handle.tell()
    if need > have:
        raise DataError(f"is cut short: its header promises {need} bytes, {have} are there", file=path)
    return need


def array_body(handle: IO[bytes], header: ArrayHeader, length: int, path: Path) -> NDArray[Any]:
    """Read the array after its header; ``length`` is that of the file [bytes]."""
    need = _refuse_cut(handle, header, length, path)
    flat = np.frombuffer(handle.read(need), dtype=header.dtype)
    return flat.reshape(header.shape[::-1]).T if header.by_columns else flat.reshape(header.shape)


class _Archive:
    # The arrays of an .npz, looked at by header and loaded one by one.

    def __init__(self, archive: zipfile.ZipFile, path: Path) -> None:
        self.archive, self.path = archive, path
        self.members = {m.filename.removesuffix(".npy"): m for m in archive.infolist() if not m.is_dir()}

    def header(self, name: str) -> ArrayHeader:
        with self.archive.open(self.members[name]) as handle:
            return array_header(handle, self.path)

    def load(self, name: str) -> NDArray[Any]:
        member = self.members[name]
        with self.archive.open(member) as handle:
            header = array_header(handle, self.path)
            refuse_bomb(self.path, math.prod(header.shape) * header.dtype.itemsize, member.compress_size)
            return array_body(handle, header, member.file_size, self.path)

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
        check_grid(header.shape, header.dtype, self.path)
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
        return self.text(name, 256).lower()

    def text(self, name: str, most: int = 2**16) -> str:
        if name not in self.members:
            return ""
        header = self.header(name)
        if header.dtype.kind not in "US" or math.prod(header.shape) != 1 or header.dtype.itemsize > most:
            raise DataError(f"'{name}' is {header.dtype} {header.shape}; expected a word", file=self.path)
        return str(self.load(name).reshape(()).astype(str)).strip()


def read_npz(path: Path) -> RasterFile:
    """Read the array `elevation` of an `.npz`, or its only grid, and its spacing where it has one."""
    with zipfile.ZipFile(path) as opened:
        archive = _Archive(opened, path)
        values = archive.grid()
        dx, dy = archive.number("dx"), archive.number("dy")
        x0, x1, y0, y1 = (archive.number(name) for name in ("xmin", "xmax", "ymin", "ymax"))
        units, crs, first = archive.word("units"), archive.text("crs"), archive.word("first_row")
        of_heights = archive.text("height_units", 256)
    if first not in ("", "north", "south"):
        raise DataError(f"'first_row' is {first!r}; expected 'north' or 'south'", file=path)
    grid = _placed(path, values, (dx, dy), ((x0, x1), (y0, y1)), units, crs)
    if not crs and (dx is not None or dy is not None):
        of_heights = of_heights or "m"  # as of its cells
    return replace(grid.in_unit(Crs(crs), of_heights), south_first=first == "south" if first else None)


def _placed(
    path: Path,
    values: NDArray[Any],
    steps: tuple[float | None, float | None],
    bounds: tuple[tuple[float | None, float | None], tuple[float | None, float | None]],
    units: str,
    crs: str,
) -> RasterFile:
    """Return what was found of a grid, with its metres and where it lies, as far as the file says."""
    (dx, dy), ((x0, x1), (y0, y1)) = steps, bounds
    if dx is None and dy is None:
        return in_memory(values)
    dx, dy = abs(dx or dy or 0.0), abs(dy or dx or 0.0)
    if not dx or not dy:
        raise DataError("'dx' and 'dy' are zero; expected the distance between texels", file=path)
    if crs:
        size, text_placed = (values.shape[1], values.shape[0]), None
        if x0 is not None and x1 is not None and y0 is not None and y1 is not None:
            text_placed = _bounded((x0, x1), (y0, y1), (dx, dy), size, Crs(crs))
        spacing, notes = (text_placed or Georeference(math.nan, math.nan, (dx, dy), size, Crs(crs))).spacing
        return in_memory(values, spacing, place=text_placed, notes=notes)
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
        return in_memory(values, (dx, dy))
    assert y0 is not None and y1 is not None
    spacing, notes = spacing_from_degrees(dx, dy, (y0 + y1) / 2)
    georeference = None
    if x0 is not None and x1 is not None:
        georeference = _bounded((x0, x1), (y0, y1), (dx, dy), (values.shape[1], values.shape[0]), WGS_84)
    return in_memory(values, spacing, place=georeference, notes=notes)


def _bounded(
    x: tuple[float, float],
    y: tuple[float, float],
    step: tuple[float, float],
    size: tuple[int, int],
    crs: Crs,
) -> Georeference | None:
    """Return where the nodes lie; None where the bounds are neither areas' nor nodes'."""
    inside = []
    for ends, of, count in zip((x, y), step, size, strict=True):
        more = abs(ends[1] - ends[0]) / of - (count - 1)  # 1 for areas, 0 for nodes
        if min(abs(more), abs(more - 1.0)) > 0.01:
            return None
        inside.append(0.5 * of * round(more))
    is_point = crs == WGS_84  # as where nothing but degrees is said
    return Georeference(min(x) + inside[0], max(y) - inside[1], step, size, crs, is_point)


def read_raw(path: Path, size: tuple[int, int] | None) -> RasterFile:
    """Read unsigned little-endian numbers; the grid is square unless ``size`` (nx, ny) says otherwise."""
    dtype = np.dtype("<u2")
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
    check_grid((ny, nx), dtype, path)
    if 2 * nx * ny != length:
        what = f"holds {length} bytes; {nx} x {ny} heights of 16 bits need {2 * nx * ny}{_fitting(length)}"
        raise DataError(what, file=path)
    return RasterFile(FileRows(path, (ny, nx), dtype), in_metres=False, code_range=SIXTEEN_BIT)


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

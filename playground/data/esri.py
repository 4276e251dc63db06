"""Read ESRI's grids: `.asc` of text, `.flt` and `.bil` of numbers with an `.hdr`; a `.prj` tells their place.

Sources: ESRI, "ESRI ASCII raster format" and "BIL, BIP, and BSQ raster files" (ArcGIS Desktop help).
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from playground.allowed_files import sidecars
from playground.data.band import band_facts, system_beside
from playground.data.grid import Found, check_grid
from playground.data.place import Crs, Place
from playground.data.rows import Band, FileRows, Rows, StreamRows
from playground.errors import DataError
from playground.regular_file import open_regular

_CHUNK = 2**24  # [bytes] of text at a time
_LONGEST_WORD = 2**16  # [bytes]
_NUMBERS = {
    ("unsignedint", 8): "u1",
    ("signedint", 8): "i1",
    ("unsignedint", 16): "u2",
    ("signedint", 16): "i2",
    ("unsignedint", 32): "u4",
    ("signedint", 32): "i4",
    ("float", 32): "f4",
    ("float", 64): "f8",
}

Header = Mapping[str, str]


def read_asc(path: Path) -> Found:
    """Read a grid of text, which its own header describes."""
    header, start = _text_header(path)
    size = _size(header, path)
    dtype = np.dtype(np.float32)
    check_grid(size[::-1], dtype, path, in_turn=True)
    rows = StreamRows(size[::-1], dtype, partial(_numbers_in_text, path, start, size))
    return _found(rows, header, path)


def read_flt(path: Path) -> Found:
    """Read 32-bit floats, which the `.hdr` next to them describes as an `.asc` does."""
    header = _header_beside(path)
    return _found(_stored(path, _size(header, path), "f4", header), header, path)


def read_bil(path: Path) -> Found:
    """Read whole or real numbers, which the `.hdr` next to them describes."""
    header = _header_beside(path)
    bands = _whole(header, "nbands", path, 1)
    if bands != 1:
        raise DataError(f"has {bands} bands; expected one", file=path)
    bits = _whole(header, "nbits", path, 16 if "pixeltype" not in header else 8)
    kind = header.get("pixeltype", "signedint" if bits == 16 else "unsignedint").lower()
    if (kind, bits) not in _NUMBERS:
        raise DataError(
            f"its header says {kind} of {bits} bits; expected signedint, unsignedint or float, of 8 to 64",
            file=path,
        )
    return _found(_stored(path, _size(header, path), _NUMBERS[kind, bits], header), header, path)


def _header_beside(path: Path) -> Header:
    """Return the words of a header file: a name and a value a line."""
    beside = next((file for file in sidecars(path) if file.suffix.lower() == ".hdr"), None)
    if beside is None:
        raise DataError(f"needs {path.with_suffix('.hdr').name} next to it, which says its size", file=path)
    lines = (line.split() for line in beside.read_text("utf-8", "replace").splitlines())
    return {words[0].lower(): words[1] for words in lines if len(words) >= 2}


def _text_header(path: Path) -> tuple[Header, int]:
    """Return the words at the head of a text, and the byte at which its numbers begin."""
    header: dict[str, str] = {}
    with open_regular(path) as handle:
        for _ in range(12):
            start = handle.tell()
            words = handle.readline(256).decode("utf-8", "replace").split()
            if len(words) != 2 or not words[0][:1].isalpha():
                return header, start
            header[words[0].lower()] = words[1]
    raise DataError("its header does not end; expected ncols, nrows, a corner, cellsize", file=path)


def _size(header: Header, path: Path) -> tuple[int, int]:
    return _whole(header, "ncols", path), _whole(header, "nrows", path)


def _whole(header: Header, name: str, path: Path, default: int | None = None) -> int:
    if name not in header and default is not None:
        return default
    if name not in header:
        listed = ", ".join(header) or "nothing"
        raise DataError(f"its header says no {name}; it says {listed}", file=path)
    text = header[name]
    if not text.isdecimal():
        raise DataError(f"its header says {name} {text}; expected a whole number", file=path)
    return int(text)


def _real(header: Header, name: str, path: Path) -> float | None:
    if name not in header:
        return None
    try:
        return float(header[name])
    except ValueError:
        raise DataError(f"its header says {name} {header[name]}; expected a number", file=path) from None


def _stored(path: Path, size: tuple[int, int], kind: str, header: Header) -> Rows:
    order = ">" if header.get("byteorder", "I").lower() in ("m", "msbfirst") else "<"
    dtype = np.dtype(order + kind)
    check_grid(size[::-1], dtype, path, in_turn=True)
    skipped = _whole(header, "skipbytes", path, 0)
    wide = _whole(header, "totalrowbytes", path, size[0] * dtype.itemsize)
    need, have = skipped + (size[1] - 1) * wide + size[0] * dtype.itemsize, path.stat().st_size
    if need > have or wide < size[0] * dtype.itemsize:
        raise DataError(
            f"holds {have} bytes; {size[0]} x {size[1]} numbers of {8 * dtype.itemsize} bits need {need}",
            file=path,
        )
    return FileRows(path, size[::-1], dtype, skipped, wide)


def _found(rows: Rows, header: Header, path: Path) -> Found:
    place = _place(header, rows.shape[::-1], path)
    spacing, notes = place.spacing if place is not None else (None, ())
    if place is not None and not place.crs.wkt:
        notes = (
            f"there is no {path.with_suffix('.prj').name} next to it, so its cells may be degrees or metres",
        )
    no_data = _real(header, "nodata_value", path)
    no_data = _real(header, "nodata", path) if no_data is None else no_data
    if no_data is None and path.suffix.lower() in (".asc", ".flt"):
        no_data = -9999.0  # where the header does not say
    band = band_facts(path)
    found = Found(
        rows,
        spacing,
        no_data=no_data,
        scale=band.scale,
        offset=band.offset,
        place=place,
        notes=notes,
    )
    return found.in_unit(Crs() if place is None else place.crs, band.unit)


def _place(header: Header, size: tuple[int, int], path: Path) -> Place | None:
    """Return where the cells' middles lie; None where the header does not say."""
    nx, ny = size
    cell = _real(header, "cellsize", path)
    steps = [_real(header, name, path) for name in ("xdim", "ydim")]
    if None in steps:
        steps = [_real(header, name, path) or cell for name in ("dx", "dy")]
    dx, dy = steps
    if dx is None or dy is None:
        return None
    if not (0.0 < dx < math.inf and 0.0 < dy < math.inf):
        raise DataError(f"says that a texel is {dx} x {dy}; expected lengths above zero", file=path)
    west, north = _real(header, "ulxmap", path), _real(header, "ulymap", path)
    if west is None or north is None:
        ends = []
        for axis, step in (("x", dx), ("y", dy)):
            centre, corner = (_real(header, f"{axis}ll{what}", path) for what in ("center", "corner"))
            if centre is None and corner is not None:
                centre = corner + 0.5 * step
            ends.append(centre)
        if ends[0] is None or ends[1] is None:
            return None
        west, north = ends[0], ends[1] + (ny - 1) * dy
    beside = next((file for file in sidecars(path) if file.suffix.lower() == ".prj"), None)
    wkt = beside.read_text("utf-8", "replace") if beside is not None else system_beside(path)
    return Place(west, north, (dx, dy), (nx, ny), Crs(wkt=wkt))


def _numbers_in_text(path: Path, start: int, size: tuple[int, int]) -> Iterator[Band]:
    """Yield the numbers of a text as rows, however its lines part them."""
    columns, rows = size
    row, left = 0, np.empty(0)
    with open_regular(path) as handle:
        handle.seek(start)
        rest = b""
        while row < rows:
            read = handle.read(_CHUNK)
            # A number may go on in the next part.
            rest += read
            cut = max(rest.rfind(end) for end in b" \n\t\r") + 1 if read else len(rest)
            text, rest = rest[:cut], rest[cut:]
            if len(rest) > _LONGEST_WORD:
                raise DataError("holds a word as long as a book; expected numbers", file=path)
            numbers = np.concatenate([left, _parsed(text, path)])
            count = min(len(numbers) // columns, rows - row)
            if count:
                yield row, numbers[: count * columns].reshape(count, columns).astype(np.float32)
            row, left = row + count, numbers[count * columns :]
            if not read and row < rows:
                found = row * columns + len(left)
                message = f"is cut short: it holds {found} numbers; {columns} x {rows} are {columns * rows}"
                raise DataError(message, file=path)


def _parsed(text: bytes, path: Path) -> np.ndarray[Any, np.dtype[np.float64]]:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            return np.fromstring(text.decode("ascii"), sep=" ")
        except (DeprecationWarning, ValueError):
            pass
    for word in text.split():
        try:
            float(word)
        except ValueError:
            shown = word[:20].decode("ascii", "replace")
            raise DataError(f"holds {shown!r} among its numbers", file=path) from None
    return np.array(text.split(), np.float64)

"""Read points, lines and polygons: GeoJSON here, other formats by OGR in the extra `gis` (pyogrio).

Heights of points are left out, and so are properties. Sources: RFC 7946 (Butler et al. 2016), "The GeoJSON
Format"; its forerunner of 2008 for "crs"; OGC 06-103r4 (2011), clause 8, for the binary form that OGR gives.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from mmap import ACCESS_READ, mmap
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.images.files import checked_file, reason
from playground.json_text import read_json
from playground.regular_file import irregularity, open_regular, read_regular
from playground.sketch.sidecars import sidecar_places
from playground.terrain.gis import advice

Kind = Literal["point", "line", "polygon"]
Line = NDArray[np.float64]  # (n, 2): x or longitude, y or latitude

MOST_BYTES = 2**28
"""Of a GeoJSON, which becomes some ten times as much in memory while it is read."""

_WGS_84 = "EPSG:4326"
_BEGINS = {  # what OGR may open by these names: others lead to further files, or into the network
    ".gpkg": rb"(?s)SQLite format 3\0.{52}(GPKG|GP10|GP11)",  # the mark of GeoPackage 1.3, 1.1.1
    ".shp": rb"\0\0\x27\x0a",
    ".fgb": rb"(?s)fgb\x03fgb.{4}\0",  # a header below 16 MiB, so that no text begins here
    ".kml": rb"<(\w+:)?kml[\s>]",
    ".gpx": rb"<(\w+:)?gpx[\s>]",
}
_DRIVERS = {
    ".gpkg": ("GPKG",),
    ".shp": ("ESRI Shapefile",),
    ".fgb": ("FlatGeobuf",),
    ".kml": ("LIBKML", "KML"),
    ".gpx": ("GPX",),
}
_PROLOG = re.compile(rb"\s*(?:<\?.*?\?>|<!--.*?-->)", re.DOTALL)
_LEADS_AWAY = re.compile(rb"<OGR|opengis\.net/gml")
"""In the text of what OGR may take for one of its lists of sources, wherever in a file, or for GML."""
_KINDS: dict[str, tuple[Kind, int]] = {  # with how deep their coordinates nest
    "Point": ("point", 0),
    "MultiPoint": ("point", 1),
    "LineString": ("line", 1),
    "MultiLineString": ("line", 2),
    "Polygon": ("polygon", 2),
    "MultiPolygon": ("polygon", 3),
}


@dataclass(frozen=True, eq=False)
class Shape:
    """A point, a line, or a polygon with the rings of its holes."""

    kind: Kind
    lines: tuple[Line, ...]


@dataclass(frozen=True, eq=False)
class Vectors:
    """The shapes of a file."""

    shapes: tuple[Shape, ...]
    crs: str = _WGS_84  # as GDAL takes it: a code or a text; "" where the file does not say
    notes: tuple[str, ...] = ()


def read_vectors(path: Path) -> Vectors:
    """Read all shapes of a file; raise ``DataError`` for what is none, damaged, empty or too big."""
    path = checked_file(path)
    for place in sidecar_places(path):  # OGR opens them itself
        if what := irregularity(place):
            raise DataError(what, file=place)
    ending = path.suffix.lower()
    if ending in (".geojson", ".json"):
        found = _geojson(path)
    elif ending in _BEGINS:
        found = _by_ogr(path, ending)
    else:
        known = ", ".join((".geojson", ".json", *_BEGINS))
        raise DataError(f"{ending!r} is no format of vector data; readable are {known}", file=path)
    if not found.shapes:
        raise DataError("holds no point, line or polygon", file=path)
    return found


# ── GeoJSON ──────────────────────────────────────────────────────────────────


def _geojson(path: Path) -> Vectors:
    size = path.stat().st_size
    if size > MOST_BYTES:
        raise DataError(
            f"has {size / 2**20:.0f} MiB; of GeoJSON {MOST_BYTES // 2**20} are read at most, of .gpkg more",
            file=path,
        )
    try:
        document = read_json(read_regular(path))
    except ValueError as error:
        raise DataError(f"is not GeoJSON: {reason(error)}", file=path) from None
    if not isinstance(document, dict) or not isinstance(document.get("type"), str):
        raise DataError('is not GeoJSON: expected an object that has a "type"', file=path)
    shapes = tuple(shape for geometry in _geometries(document, path) for shape in _shapes(geometry, path))
    return Vectors(shapes, _crs_of(document, path))


def _geometries(found: Any, path: Path) -> Iterator[dict[str, Any]]:
    """Yield the geometries of a document, of a feature, or of several of them."""
    waiting = [found]
    while waiting:
        one = waiting.pop()
        if not isinstance(one, dict):
            continue
        if one.get("type") == "Feature":
            waiting.append(one.get("geometry"))
        elif "features" in one or "geometries" in one:
            parts = [part for name in ("features", "geometries") for part in _listed(one, name, path)]
            waiting += parts[::-1]
        else:
            yield one


def _listed(one: dict[str, Any], name: str, path: Path) -> list[Any]:
    found = one.get(name)
    if not isinstance(found, list | None):
        message = f'is not GeoJSON: expected "{name}" to be a list; found {_shortened(found)}'
        raise DataError(message, file=path)
    return found or []


def _shortened(found: object) -> str:
    text = repr(found)
    return text if len(text) <= 40 else f"{text[:39]}…"


def _shapes(geometry: dict[str, Any], path: Path) -> Iterator[Shape]:
    word = geometry.get("type")
    if not isinstance(word, str) or word not in _KINDS:
        message = f"is not GeoJSON: it holds a {_shortened(word)}; expected {', '.join(_KINDS)}"
        raise DataError(message, file=path)
    kind, depth = _KINDS[word]
    wanted = {"point": 0, "line": 1, "polygon": 2}[kind]
    several: list[Any] = [geometry.get("coordinates")]
    try:
        for _ in range(depth - wanted):
            several = [part for one in several for part in one]
        for one in several:
            lines = one if kind == "polygon" else [one] if kind == "line" else [[one]]
            arrays = tuple(
                np.array([(x, y) for x, y, *_ in line], np.float64).reshape(-1, 2) for line in lines
            )
            if any(not np.isfinite(line).all() for line in arrays):
                raise ValueError
            if all(map(len, arrays)) and arrays:
                yield Shape(kind, arrays)
    except (TypeError, ValueError, IndexError, OverflowError):
        raise DataError(f"holds a {word} whose coordinates are no numbers", file=path) from None


def _crs_of(document: dict[str, Any], path: Path) -> str:
    """Return the reference system: WGS 84, unless the older form names another."""
    crs = document.get("crs")
    if crs is None:
        return _WGS_84
    properties = crs.get("properties") if isinstance(crs, dict) else None
    name = properties.get("name", "") if isinstance(properties, dict) else ""
    if re.search(r"CRS84$", str(name)):
        return _WGS_84
    code = re.search(r"EPSG:(?:[\d.]*:)?(\d+)$", str(name))
    if code is None:
        message = f"names an unknown reference system, {_shortened(name)}; expected an EPSG code"
        raise DataError(message, file=path)
    return f"EPSG:{code[1]}"


# ── other formats ────────────────────────────────────────────────────────────


def _by_ogr(path: Path, ending: str) -> Vectors:
    if find_spec("pyogrio") is None:
        raise DataError(f"{ending} is read by OGR; {advice()}", file=path)
    if not _is_what_it_says(path, ending):
        raise DataError(f"is no {ending[1:]} file, although its name says so", file=path)
    import pyogrio
    from pyogrio.errors import DataLayerError, DataSourceError

    found: list[Shape] = []
    systems: list[str] = []
    try:
        for name, kind in pyogrio.list_layers(path):
            if kind is None or str(name).endswith("_points"):  # of a GPX, once more what its lines are
                continue
            driver = pyogrio.read_info(path, layer=str(name))["driver"]
            if driver not in _DRIVERS[ending]:
                raise DataError(f"is no {ending[1:]} file to OGR, but one of {driver}", file=path)
            meta, _, shapes, _ = pyogrio.raw.read(path, layer=str(name), columns=[], force_2d=True)
            own = [shape for blob in shapes if blob is not None for shape in _from_binary(bytes(blob))]
            systems += [meta["crs"] or ""] if own else []
            found += own if systems[-1:] == systems[:1] else []
    except (DataLayerError, DataSourceError, UnicodeDecodeError) as error:
        raise DataError(f"cannot be read by OGR: {reason(error)}", file=path) from None
    same = systems.count(systems[0]) if systems else 0
    notes = (f"{len(systems) - same} layers in another reference system are left out",)
    return Vectors(tuple(found), systems[0] if systems else "", notes if same < len(systems) else ())


def _is_what_it_says(path: Path, ending: str) -> bool:
    """Return whether a file's first bytes, or the first element of its XML, are those of its ending.

    OGR goes by what a file holds, not by its name.
    """
    begins = re.compile(_BEGINS[ending])
    with open_regular(path) as handle:
        if ending not in (".kml", ".gpx"):
            return begins.match(handle.read(100)) is not None
        if not path.stat().st_size:
            return False
        with mmap(handle.fileno(), 0, access=ACCESS_READ) as text:
            at = 3 if text[:3] == b"\xef\xbb\xbf" else 0
            while (skipped := _PROLOG.match(text, at)) is not None:
                at = skipped.end()
            while text[at : at + 1].isspace():
                at += 1
            return begins.match(text, at) is not None and _LEADS_AWAY.search(text) is None


def _from_binary(blob: bytes) -> tuple[Shape, ...]:
    found: list[Shape] = []
    _geometry(blob, 0, found)
    return tuple(found)


def _geometry(blob: bytes, at: int, found: list[Shape]) -> int:
    """Add the shapes of a geometry at a byte, and return the byte after it; what is curved is left out."""
    order = "<" if blob[at] else ">"
    (word,) = struct.unpack_from(f"{order}I", blob, at + 1)
    at += 5
    if word == 1:
        line, at = _points(blob, at, order, 1)
        if np.isfinite(line).all():
            found.append(Shape("point", (line,)))
    elif word == 2:
        lines, at = _counted(blob, at, order, 1)
        found += [Shape("line", lines)] if len(lines[0]) else []
    elif word == 3:
        (count,) = struct.unpack_from(f"{order}I", blob, at)
        lines, at = _counted(blob, at + 4, order, count)
        found += [Shape("polygon", lines)] if lines and all(map(len, lines)) else []
    elif word in (4, 5, 6, 7):
        (count,) = struct.unpack_from(f"{order}I", blob, at)
        at += 4
        for _ in range(count):
            at = _geometry(blob, at, found)
    return at


def _counted(blob: bytes, at: int, order: str, lines: int) -> tuple[tuple[Line, ...], int]:
    found = []
    for _ in range(lines):
        (count,) = struct.unpack_from(f"{order}I", blob, at)
        line, at = _points(blob, at + 4, order, count)
        found.append(line)
    return tuple(found), at


def _points(blob: bytes, at: int, order: str, count: int) -> tuple[Line, int]:
    values = np.frombuffer(blob, f"{order}f8", 2 * count, at).astype(np.float64)
    return values.reshape(count, 2), at + 16 * count

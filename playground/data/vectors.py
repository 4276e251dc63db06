"""Points, lines and polygons of a file, and how much of each texel they cover.

Heights of points are left out, and so are properties. Sources: RFC 7946 (Butler et al. 2016), "The GeoJSON
Format"; its forerunner of 2008 for "crs"; OGC 06-103r4 (2011), clause 8, for the binary form that OGR gives.

A texel's share is worked out from its middle's distance to the nearest edge, as if that edge were straight:
exact where it runs along the texels, within 0.05 elsewhere, but at corners.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import compress
from mmap import ACCESS_READ, mmap
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from playground.allowed_files import sidecar_places
from playground.errors import DataError
from playground.extras import needs
from playground.files import checked_file, irregularity, open_regular, read_regular, reason
from playground.json_text import read_json

Kind = Literal["point", "line", "polygon"]
Line = NDArray[np.float64]  # (n, 2): x or longitude, y or latitude

MAX_BYTES = 2**28
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
class VectorShape:
    """A point, a line, or a polygon with the rings of its holes."""

    kind: Kind
    lines: tuple[Line, ...]


@dataclass(frozen=True, eq=False)
class Vectors:
    """The shapes of a file."""

    shapes: tuple[VectorShape, ...]
    crs: str = _WGS_84  # as GDAL takes it: a code or a text; "" where the file does not say
    notes: tuple[str, ...] = ()


def read_vectors(path: Path) -> Vectors:
    """Read all shapes of a file; raise ``DataError`` for what is none, damaged, empty or too big."""
    path = checked_file(path)
    for path_beside in sidecar_places(path):  # OGR opens them itself
        if what := irregularity(path_beside):
            raise DataError(what, file=path_beside)
    ending = path.suffix.lower()
    if ending in (".geojson", ".json"):
        vectors = _geojson(path)
    elif ending in _BEGINS:
        vectors = _by_ogr(path, ending)
    else:
        endings = ", ".join((".geojson", ".json", *_BEGINS))
        raise DataError(f"{ending!r} is no format of vector data; readable are {endings}", file=path)
    if not vectors.shapes:
        raise DataError("holds no point, line or polygon", file=path)
    return vectors


# ── GeoJSON ──────────────────────────────────────────────────────────────────


def _geojson(path: Path) -> Vectors:
    size = path.stat().st_size
    if size > MAX_BYTES:
        raise DataError(
            f"has {size / 2**20:.0f} MiB; of GeoJSON {MAX_BYTES // 2**20} are read at most, of .gpkg more",
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


def _geometries(value: Any, path: Path) -> Iterator[dict[str, Any]]:
    """Yield the geometries of a document, of a feature, or of several of them."""
    waiting = [value]
    while waiting:
        geometry = waiting.pop()
        if not isinstance(geometry, dict):
            continue
        if geometry.get("type") == "Feature":
            waiting.append(geometry.get("geometry"))
        elif "features" in geometry or "geometries" in geometry:
            parts = [part for name in ("features", "geometries") for part in _listed(geometry, name, path)]
            waiting += parts[::-1]
        else:
            yield geometry


def _listed(table: dict[str, Any], name: str, path: Path) -> list[Any]:
    items = table.get(name)
    if not isinstance(items, list | None):
        message = f'is not GeoJSON: expected "{name}" to be a list; found {_shortened(items)}'
        raise DataError(message, file=path)
    return items or []


def _shortened(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 40 else f"{text[:39]}…"


def _shapes(geometry: dict[str, Any], path: Path) -> Iterator[VectorShape]:
    word = geometry.get("type")
    if not isinstance(word, str) or word not in _KINDS:
        message = f"is not GeoJSON: it holds a {_shortened(word)}; expected {', '.join(_KINDS)}"
        raise DataError(message, file=path)
    kind, depth = _KINDS[word]
    depth_wanted = {"point": 0, "line": 1, "polygon": 2}[kind]
    several: list[Any] = [geometry.get("coordinates")]
    try:
        for _ in range(depth - depth_wanted):
            several = [part for item in several for part in item]
        for part in several:
            lines = part if kind == "polygon" else [part] if kind == "line" else [[part]]
            arrays = tuple(
                np.array([(x, y) for x, y, *_ in line], np.float64).reshape(-1, 2) for line in lines
            )
            if any(not np.isfinite(line).all() for line in arrays):
                raise ValueError
            if all(map(len, arrays)) and arrays:
                yield VectorShape(kind, arrays)
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
        raise DataError(needs(f"{ending} is read by OGR, which", "pyogrio", "gis"), file=path)
    if not matches_ending(path, ending):
        raise DataError(f"is no {ending[1:]} file, although its name ends like one", file=path)
    import pyogrio
    from pyogrio.errors import DataLayerError, DataSourceError

    result: list[VectorShape] = []
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
            result += own if systems[-1:] == systems[:1] else []
    except (DataLayerError, DataSourceError, UnicodeDecodeError) as error:
        raise DataError(f"cannot be read by OGR: {reason(error)}", file=path) from None
    same = systems.count(systems[0]) if systems else 0
    notes = (f"{len(systems) - same} layers in another reference system are left out",)
    return Vectors(tuple(result), systems[0] if systems else "", notes if same < len(systems) else ())


def matches_ending(path: Path, ending: str) -> bool:
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


def _from_binary(blob: bytes) -> tuple[VectorShape, ...]:
    shapes: list[VectorShape] = []
    _geometry(blob, 0, shapes)
    return tuple(shapes)


def _geometry(blob: bytes, at: int, shapes: list[VectorShape]) -> int:
    """Add the shapes of a geometry at a byte, and return the byte after it; what is curved is left out."""
    order = "<" if blob[at] else ">"
    (word,) = struct.unpack_from(f"{order}I", blob, at + 1)
    at += 5
    if word == 1:
        line, at = _points(blob, at, order, 1)
        if np.isfinite(line).all():
            shapes.append(VectorShape("point", (line,)))
    elif word == 2:
        lines, at = _counted(blob, at, order, 1)
        shapes += [VectorShape("line", lines)] if len(lines[0]) else []
    elif word == 3:
        (count,) = struct.unpack_from(f"{order}I", blob, at)
        lines, at = _counted(blob, at + 4, order, count)
        shapes += [VectorShape("polygon", lines)] if lines and all(map(len, lines)) else []
    elif word in (4, 5, 6, 7):
        (count,) = struct.unpack_from(f"{order}I", blob, at)
        at += 4
        for _ in range(count):
            at = _geometry(blob, at, shapes)
    return at


def _counted(blob: bytes, at: int, order: str, lines: int) -> tuple[tuple[Line, ...], int]:
    lines_read = []
    for _ in range(lines):
        (count,) = struct.unpack_from(f"{order}I", blob, at)
        line, at = _points(blob, at + 4, order, count)
        lines_read.append(line)
    return tuple(lines_read), at


def _points(blob: bytes, at: int, order: str, count: int) -> tuple[Line, int]:
    values = np.frombuffer(blob, f"{order}f8", 2 * count, at).astype(np.float64)
    return values.reshape(count, 2), at + 16 * count


_PIECE = 16.0  # [texels] of a line that are looked at together
_PAIRS = 2**21  # texels and pieces of lines that are compared at a time

Mask = NDArray[np.float32]
Segments = NDArray[np.float64]
"""(n, 2, 2): from and to, each x and y."""


@dataclass(frozen=True)
class Grid:
    """The texels of a mask."""

    size: tuple[int, int]  # east and north
    spacing: tuple[float, float]  # [m] a texel, east and north


def draw(shapes: Sequence[VectorShape], grid: Grid, width: float, *, filled: bool) -> Mask:
    """Return the shares 0..1 (ny, nx), row 0 in the south, of shapes whose places are in texels.

    Lines are ``width`` metres wide and points discs as wide as that; polygons are ``filled``, or lines.
    """
    mask = np.zeros(grid.size[::-1], np.float32)
    areas = [filled and shape.kind == "polygon" for shape in shapes]
    outlines = [shape for shape, area in zip(shapes, areas, strict=True) if not area]
    _stroke(mask, grid, _segments([line for shape in outlines for line in shape.lines]), 0.5 * width)
    for polygon in compress(shapes, areas):
        _fill(mask, grid, polygon)
    return mask


def _segments(lines: Sequence[Line]) -> Segments:
    """Return the segments of lines; of a single point one of no length."""
    pairs = [
        np.stack([line[:-1], line[1:]], 1) if len(line) > 1 else np.stack([line, line], 1) for line in lines
    ]
    return np.concatenate(pairs) if pairs else np.empty((0, 2, 2))


def _stroke(mask: Mask, grid: Grid, segments: Segments, radius: float) -> None:
    flat = mask.reshape(-1)
    for texels, away, side in _near(grid, segments, radius):
        inner = np.clip((radius - away) / side + 0.5, 0.0, 1.0)
        beyond = np.clip((-radius - away) / side + 0.5, 0.0, 1.0)  # of a line narrower than a texel
        np.maximum.at(flat, texels, (inner - beyond).astype(np.float32))


def _fill(mask: Mask, grid: Grid, polygon: VectorShape) -> None:
    rings = [np.concatenate([ring, ring[:1]]) for ring in polygon.lines]
    points = np.concatenate(rings)
    most = np.array(grid.size) - 1
    low = np.clip(np.floor(points.min(axis=0)) - 1.0, 0, most).astype(np.intp)
    high = np.clip(np.ceil(points.max(axis=0)) + 1.0, 0, most).astype(np.intp)
    share = _inside(_segments(rings), low, high).astype(np.float32)
    # Near the edge it is the fraction of the texel on the inner side.
    edges = [(texels, away / side) for texels, away, side in _near(grid, _segments(rings), 0.0)]
    if edges:
        texels, own = np.unique(np.concatenate([each[0] for each in edges]), return_inverse=True)
        steps = np.full(len(texels), np.inf)
        np.minimum.at(steps, own, np.concatenate([each[1] for each in edges]))
        y, x = texels // grid.size[0] - low[1], texels % grid.size[0] - low[0]
        share[y, x] = np.clip(0.5 + np.where(share[y, x] > 0.0, steps, -steps), 0.0, 1.0)
    part = mask[low[1] : high[1] + 1, low[0] : high[0] + 1]
    np.maximum(part, share, out=part)


def _inside(segments: Segments, low: NDArray[np.intp], high: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return which texels from low to high (x, y) are inside: west of each is an odd number of edges."""
    across, rows = high - low + 1
    crossings = np.zeros((rows, across + 1), np.int32)
    # An edge crosses the rows from its lower end on, and up to its upper end without that.
    lower, upper = segments[..., 1].min(axis=1), segments[..., 1].max(axis=1)
    first = np.clip(np.ceil(lower) - low[1], 0, rows).astype(np.intp)
    counts = np.clip(np.ceil(upper) - low[1], 0, rows).astype(np.intp) - first
    owner, number = _owners(counts)
    row = first[owner] + number
    (ax, ay), (bx, by) = segments[owner, 0].T, segments[owner, 1].T
    x = ax + (bx - ax) * (row + low[1] - ay) / (by - ay)
    column = np.clip(np.ceil(x) - low[0], 0, across).astype(np.intp)
    np.add.at(crossings, (row, column), 1)
    return np.asarray(np.cumsum(crossings[:, :-1], axis=1) % 2 == 1)


def _near(
    grid: Grid, segments: Segments, radius: float
) -> Iterator[tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.float64]]]:
    """Yield texels near segments: their numbers, the metres to the segment, those across a texel there."""
    spacing, most = np.array(grid.spacing), np.array(grid.size) - 1
    reach = radius / spacing + 1.0
    pieces = _pieces(_clipped(segments, -reach, most + reach))
    low = np.clip(np.ceil(pieces.min(axis=1) - reach), 0, most + 1).astype(np.intp)
    high = np.clip(np.floor(pieces.max(axis=1) + reach), -1, most).astype(np.intp)
    sides = np.maximum(high - low + 1, 0)
    counts = sides[:, 0] * sides[:, 1]
    ends = np.cumsum(counts)
    first = 0
    while first < len(pieces):
        before = ends[first - 1] if first else 0
        last = max(int(np.searchsorted(ends, before + _PAIRS, "right")), first + 1)
        owner, number = _owners(counts[first:last])
        owner += first
        x = low[owner, 0] + number % sides[owner, 0]
        y = low[owner, 1] + number // sides[owner, 0]
        away, side = _distance(np.stack([x, y], 1), pieces[owner], spacing)
        yield y * grid.size[0] + x, away, side
        first = last


def _distance(
    texels: NDArray[np.intp], segments: Segments, spacing: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the metres from each texel to its segment, and those across a texel in that direction."""
    begin, along = segments[:, 0] * spacing, (segments[:, 1] - segments[:, 0]) * spacing
    to = texels * spacing - begin
    square = (along**2).sum(axis=1)
    part = np.clip((to * along).sum(axis=1) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    off = to - part[:, None] * along
    away = np.hypot(off[:, 0], off[:, 1])
    # On the segment itself, at right angles to it.
    across = np.where(away[:, None] > 1e-9 * spacing.min(), off, along[:, ::-1] * (1.0, -1.0))
    length = np.hypot(across[:, 0], across[:, 1])
    unit = across / np.where(length > 0.0, length, 1.0)[:, None]
    side = np.hypot(unit[:, 0] * spacing[0], unit[:, 1] * spacing[1])
    return away, np.where(length > 0.0, side, spacing.min())


def _clipped(segments: Segments, low: NDArray[np.float64], high: NDArray[np.float64]) -> Segments:
    """Return the parts of segments inside a box: Liang and Barsky 1984, ACM Transactions on Graphics 3, 1."""
    begin, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        ways = np.stack([(low - begin) / along, (high - begin) / along])
    still = along == 0.0
    outside = (still & ((begin < low) | (begin > high))).any(axis=1)
    enters = np.where(still, 0.0, ways.min(axis=0)).max(axis=1).clip(0.0)
    leaves = np.where(still, 1.0, ways.max(axis=0)).min(axis=1).clip(None, 1.0)
    there = ~outside & (enters <= leaves)
    begin, along = begin[there], along[there]
    parts = [begin + along * share[there, None] for share in (enters, leaves)]
    return np.stack(parts, 1)


def _pieces(segments: Segments) -> Segments:
    """Return segments cut into pieces of a few texels: there is less to look at around them."""
    length = np.abs(segments[:, 1] - segments[:, 0]).max(axis=1, initial=0.0)
    counts = np.maximum(np.ceil(length / _PIECE), 1.0).astype(np.intp)
    owner, number = _owners(counts)
    step = ((segments[:, 1] - segments[:, 0]) / counts[:, None])[owner]
    begin = segments[owner, 0] + step * number[:, None]
    return np.stack([begin, begin + step], 1)


def _owners(counts: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return, of so many each, whose each is and its number: of 2, 0, 1 they are 0, 0, 2 and 0, 1, 0."""
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)

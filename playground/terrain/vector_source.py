"""Vector data on the terrain: points, lines and polygons of a file as a mask of the terrain's texels.

Where the terrain lies is what an elevation file says; shapes in another reference system are brought into
that one, by GDAL where it is more than a name. The datums WGS 84, NAD 83 and ETRS 89 are taken for one: they
differ by two metres at most.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.images.content_hash import content_key
from playground.sketch.model import Value
from playground.terrain.elevation import open_elevation
from playground.terrain.gis import advice, has_rasters, name_for_gdal, transformed
from playground.terrain.grid import check_grid
from playground.terrain.place import Place
from playground.terrain.vector_mask import Grid, draw
from playground.terrain.vectors import Line, Shape, read_vectors

_ALIKE = frozenset({"EPSG:4326", "EPSG:4269", "EPSG:4258", "OGC:CRS84"})
"""Degrees on datums that differ by metres."""

_MOST_PIECES = 512
"""Of a straight line, which is bent in another reference system."""


@dataclass(frozen=True, eq=False)
class _Placed:
    """The shapes of a file, in the reference system of the terrain."""

    place: Place
    shapes: tuple[Shape, ...]
    extent: tuple[float, float]  # [m]
    notes: tuple[str, ...]


def make(
    values: Mapping[str, Value], size: tuple[int, int], moment: None = None
) -> dict[str, NDArray[np.float32]]:
    """Return how much of each texel the shapes cover."""
    check_grid(size[::-1], np.dtype(np.float32), Path("mask of vector data"))
    placed = _placed(*_asked(values))
    west, south, east, north = placed.place.bounds
    scale = (size[0] - 1) / (east - west), (size[1] - 1) / (north - south)
    shapes = [
        replace(s, lines=tuple((line - (west, south)) * scale for line in s.lines)) for s in placed.shapes
    ]
    spacing = placed.extent[0] / (size[0] - 1), placed.extent[1] / (size[1] - 1)
    width = values["width"]
    assert isinstance(width, int | float)  # the kernel's file says so
    return {"mask": draw(shapes, Grid(size, spacing), float(width), filled=values["polygons"] == 0)}


def notes(values: Mapping[str, Value]) -> tuple[str, ...]:
    """Return what was left out of the file."""
    vectors = Path(str(values["vectors"]))
    return tuple(f"{vectors.name}: {note}" for note in _placed(*_asked(values)).notes)


def _asked(values: Mapping[str, Value]) -> tuple[str, str, str, str]:
    paths = [str(values[name]) for name in ("vectors", "elevation")]
    return paths[0], paths[1], content_key(Path(paths[0])), content_key(Path(paths[1]))


@lru_cache(maxsize=4)
def _placed(vectors: str, elevation: str, *contents: str) -> _Placed:
    path, terrain = Path(vectors), open_elevation(elevation)
    place, extent = terrain.found.place, terrain.extent
    if place is None or not place.crs.facts.kind or extent is None:
        message = "does not say where its terrain lies, so nothing can be laid on it; a GeoTIFF does"
        raise DataError(message, file=terrain.path)
    found = read_vectors(path)
    shapes = _in_system(found.shapes, found.crs, place, path)
    said = list(found.notes)
    lost = len(found.shapes) - len(shapes)
    if lost:
        said.append(
            f"{lost} of its {len(found.shapes)} shapes have no place in the terrain's reference system"
        )
    if not any(_meets(shape, place.bounds) for shape in shapes):
        said.append("none of its shapes lies on the terrain")
    return _Placed(place, shapes, extent, tuple(said))


def _in_system(shapes: tuple[Shape, ...], crs: str, place: Place, path: Path) -> tuple[Shape, ...]:
    """Return shapes in the terrain's reference system, without those that have no place in it."""
    if not crs:
        return shapes  # the file says nothing: it is taken for that of the terrain
    wanted = name_for_gdal(place.crs)
    if crs == wanted or {crs, wanted} <= _ALIKE:
        return shapes
    if not has_rasters() or not wanted:
        target = wanted.partition("[")[0] or "one without a code"
        message = f"its reference system is {crs.partition('[')[0]} and that of the terrain {target}"
        raise DataError(f"{message}; {advice('transforms')}", file=path)
    lines = [_dense(line) if shape.kind != "point" else line for shape in shapes for line in shape.lines]
    try:
        points = transformed(np.concatenate(lines), crs, wanted)
    except DataError as error:
        raise DataError(error.diagnostics[0].message, file=path) from None
    bent = iter(np.split(points, np.cumsum([len(line) for line in lines])[:-1]))
    made = (replace(shape, lines=tuple(next(bent) for _ in shape.lines)) for shape in shapes)
    return tuple(shape for shape in made if all(np.isfinite(line).all() for line in shape.lines))


def _dense(line: Line) -> Line:
    """Return a line with points between its own where they are far apart: it will be bent."""
    if len(line) < 2:
        return line
    degrees = np.abs(line).max() <= 360.0  # metres of a terrain near the origin are cut finer than need be
    length = np.hypot(*(line[1:] - line[:-1]).T)
    counts = np.clip(np.ceil(length / (0.01 if degrees else 1000.0)), 1, _MOST_PIECES).astype(np.intp)
    owner = np.repeat(np.arange(len(counts)), counts)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    step = (line[1:] - line[:-1]) / counts[:, None]
    return np.concatenate([line[owner] + step[owner] * number[:, None], line[-1:]])


def _meets(shape: Shape, bounds: tuple[float, float, float, float]) -> bool:
    """Return whether a shape may lie on the terrain, by what is around it."""
    points = np.concatenate(shape.lines)
    (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)
    west, south, east, north = bounds
    return bool(x0 <= east and x1 >= west and y0 <= north and y1 >= south)

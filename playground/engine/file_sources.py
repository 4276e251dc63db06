"""Sources that read a file: elevations, masks, painted numbers, models, vectors, terrain to quilt.

* Elevations: one of over ``LARGE`` texels is read at the requested size, a part at a time, and never has all
  of its texels in memory.
* Masks: an image's numbers are taken as they are, not as colours: nothing is decoded. Without an alpha
  channel the fourth weight is 0.
* Painted numbers: what was written is read again bit by bit, at the size it was written in.
* Models: texel by texel from the south-west, row by row, ``CORNERS`` in a row: the three corners of the first
  triangle, of the second, and so on. The fourth number of a texel is 1 where there is a corner, else 0.
* Vectors: an elevation file says where the terrain lies; GDAL brings shapes in another reference system into
  that one. The datums WGS 84, NAD 83 and ETRS 89 are taken for one: they differ by two metres at most.
* Examples: ``data.by_example`` makes terrain of pieces of a file's, in the metres that are known of it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from playground.data.by_example import SynthesisSettings, made_like
from playground.data.content_hash import content_key
from playground.data.elevation import (
    Edge,
    Elevation,
    ElevationFile,
    Voids,
    fill_no_data,
    open_elevation,
    read_elevation,
)
from playground.data.gis import transformed
from playground.data.grid import Packing, check_grid, fitted
from playground.data.image_files import Image, read_image
from playground.data.models import Model, read_model
from playground.data.place import Georeference
from playground.data.resample import resample
from playground.data.vectors import Grid, Line, VectorShape, draw, read_vectors
from playground.engine.source_kinds import Material, Terrain, number_of
from playground.errors import DataError
from playground.files import replacing
from playground.memo import FILES, SOURCES, bytes_held
from playground.paths import shown
from playground.sketch.model import Value

LARGE = 2**24
"""Texels of a file above which not all of them are read, unless the terrain has its size."""

DEFAULT_SIDE = 4097
"""Texels of the longer side of terrain from a large file, where nothing says how many."""

KEPT = 2**26
"""Texels above which heights are not kept in memory once a texture was made of them."""

ElevationRequest = tuple[str, str, tuple[int, int] | None, Packing, Voids, Edge]
"""A file's path, what changes whenever its contents do, and what its parameters say."""


def describe(values: Mapping[str, Value]) -> Terrain:
    """Return what the file knows of its terrain."""
    request = _request_of(values)
    file = _opened(request)
    size = _size(file, values)
    facts = _facts_of(request, size)
    low, high = facts.lowest, facts.highest
    metres = values["metres"]  # of the file's lowest and highest codes; equal: nothing is known
    relief = base = None
    assumed = ""
    if isinstance(metres, tuple) and metres[0] != metres[1]:
        codes = facts.code_range or (low, high)
        scale = (metres[1] - metres[0]) / ((codes[1] - codes[0]) or 1.0)
        base, relief = metres[0] + (low - codes[0]) * scale, (high - low) * scale
    elif facts.in_metres:
        base, relief, assumed = low, high - low, facts.assumed
    return Terrain(size, file.extent, relief, base, file.grid.place, assumed)


def make(
    values: Mapping[str, Value], size: tuple[int, int], moment: None = None
) -> dict[str, NDArray[np.float32]]:
    """Return the heights at a size: 0 at the file's lowest, 1 at its highest.

    Of a large file, those at less than half of the size that it has by itself are made of these: previews
    need not go through it again.
    """
    request = _request_of(values)
    own = _size(_opened(request), values)
    elevation = _at(request, own if all(2 * a <= b for a, b in zip(size, own, strict=True)) else size)
    low, span, made = elevation.lowest, elevation.highest - elevation.lowest, elevation.size
    with _memory_explained(Path(str(values["elevation"]))):
        if span > 0:
            heights = elevation.heights - np.float32(low)
            heights /= np.float32(span)
        else:
            heights = np.zeros_like(elevation.heights)
        if math.prod(made) > KEPT:
            SOURCES.drop_of(read_whole)
            SOURCES.drop_of(_large)
        del elevation
        if size != made:
            heights = resample(heights, size, within=(0.0, 1.0))
    return {"height": heights}


def notes(values: Mapping[str, Value]) -> tuple[str, ...]:
    """Return what was assumed of the file, or lost."""
    request = _request_of(values)
    file = _opened(request)
    size = _size(file, values)
    facts = _facts_of(request, size).notes
    if not values.get("longest") and size != file.size:
        texels, fewer = (f"{x} x {y}" for x, y in (file.size, size))
        facts += (f"has {texels} texels; unless a size or `longest` says how many, {fewer} are read",)
    return tuple(f"{file.path.name}: {note}" for note in facts)


def _size(file: ElevationFile, values: Mapping[str, Value]) -> tuple[int, int]:
    """Return the size of the terrain where the sketch says none."""
    longest = values.get("longest", 0)  # kernels made before it was there have none
    assert isinstance(longest, int)  # the kernel's file says so
    if longest:
        return fitted(file.size, longest)
    return fitted(file.size, DEFAULT_SIDE) if math.prod(file.size) > LARGE else file.size


def _request_of(values: Mapping[str, Value]) -> ElevationRequest:
    path = str(values["elevation"])
    raw = values["raw_size"]
    size = (int(raw[0]), int(raw[1])) if isinstance(raw, tuple) and raw[0] and raw[1] else None
    packing: Packing = "rgb" if values["packing"] == 1 else "grey"
    voids: Voids = "fill" if values["no_data"] == 1 else "refuse"
    first_row: Edge = "south" if values["first_row"] == 1 else "north"
    return path, content_key(Path(path)), size, packing, voids, first_row


@SOURCES.cached(weight=2**26)
def _opened(request: ElevationRequest) -> ElevationFile:
    path, _, raw_size, packing, _, first_row = request
    with _memory_explained(Path(path)):
        return open_elevation(path, raw_size=raw_size, packing=packing, first_row=first_row)


@dataclass(frozen=True)
class _ElevationFacts:
    """What is known of an elevation besides its heights."""

    lowest: float
    highest: float
    code_range: tuple[float, float] | None
    in_metres: bool
    assumed: str
    notes: tuple[str, ...]


@FILES.cached()
def _facts_of(request: ElevationRequest, size: tuple[int, int]) -> _ElevationFacts:
    elevation = _at(request, size)
    return _ElevationFacts(
        elevation.lowest,
        elevation.highest,
        elevation.code_range,
        elevation.in_metres,
        elevation.assumed,
        elevation.notes,
    )


def _at(request: ElevationRequest, size: tuple[int, int]) -> Elevation:
    """Return all heights of a file; of a large one, those of a size."""
    with _memory_explained(Path(request[0])):
        return _large(request, size) if math.prod(_opened(request).size) > LARGE else read_whole(request)


@SOURCES.cached(weight=bytes_held)
def read_whole(request: ElevationRequest) -> Elevation:
    """Read all heights, with no-data texels filled."""
    return fill_no_data(_opened(request).read(), request[4])


@SOURCES.cached(weight=bytes_held)
def _large(request: ElevationRequest, size: tuple[int, int]) -> Elevation:
    return fill_no_data(_opened(request).read_at(size), request[4])


@contextmanager
def _memory_explained(path: Path) -> Iterator[None]:
    try:
        yield
    except MemoryError:
        raise DataError("there is not enough memory to read it", file=shown(path)) from None


def read_mask(path: Path, size: tuple[int, int], stated: tuple[int, int] = (0, 0)) -> NDArray[np.float32]:
    """Return an image's four channels, (ny, nx, 4) for a size (nx, ny), 0..1, row 0 south.

    The image may have more texels than that or fewer, but the same proportions, to within
    one texel; and where a size is ``stated``, that one.

    Raises:
        DataError: missing, not a picture, damaged, of another size than stated, or of
            other proportions.
    """
    image = read_image(path)
    width, height = image.size
    if any(stated) and (width, height) != stated:
        raise DataError(
            f"this alpha map has {width} x {height} texels; {stated[0]} x {stated[1]} were expected",
            file=path,
        )
    if abs(width * size[1] - height * size[0]) > max(width, height, *size):
        raise DataError(
            f"this alpha map has {width} x {height} texels, which the terrain's weights, "
            f"{size[0]} x {size[1]}, would stretch; the same proportions were expected",
            file=path,
        )
    return resized(weights_of(image), size)


def weights_of(image: Image) -> NDArray[np.float32]:
    """Return an image's channels as four weights (ny, nx, 4), 0..1, row 0 south."""
    pixels = image.pixels[::-1]
    weights = np.array(pixels / np.float32(255) if pixels.dtype == np.uint8 else pixels, np.float32)
    np.clip(weights, 0.0, 1.0, out=weights)
    if not image.has_alpha:
        weights[..., 3] = 0.0
    return weights


def resized(weights: NDArray[np.float32], size: tuple[int, int]) -> NDArray[np.float32]:
    """Return four weights a texel on a grid of another size (nx, ny), corners on corners."""
    if weights.shape[1::-1] == size:
        return weights
    channels = [resample(weights[..., k], size, within=(0.0, 1.0)) for k in range(4)]
    return np.stack(channels, axis=-1).astype(np.float32)


def read_numbers(path: Path, size: tuple[int, int]) -> NDArray[np.float32]:
    """Return a file's numbers (ny, nx) at a size (nx, ny), row 0 south; any elevation file will do.

    Raises:
        DataError: missing, damaged, no grid of finite numbers.
    """
    elevation = read_elevation(path)
    if elevation.missing:
        raise DataError(f"{elevation.missing} texels have no data; expected a number in each", file=path)
    if elevation.size == size:
        return elevation.heights
    nx, ny = size
    return resample(elevation.heights, (max(nx, 2), max(ny, 2)))[:ny, :nx]


def write_numbers(path: Path, numbers: NDArray[np.float32]) -> None:
    """Write numbers (ny, nx), row 0 south, as a TIFF without compression, which takes a few milliseconds.

    Raises ``DataError`` where the file cannot be written.
    """
    import tifffile

    with replacing(path) as handle:
        tifffile.imwrite(
            handle, np.ascontiguousarray(numbers[::-1], "<f4"), photometric="minisblack", metadata=None
        )


CORNERS = 96
"""Corners in a row of texels."""


def size_of_model(values: Mapping[str, Value]) -> tuple[int, int]:
    """Return how many texels hold a model's corners."""
    corners = 3 * len(_model(values).corners)
    return CORNERS, -(-corners // CORNERS)


def make_model(
    values: Mapping[str, Value], size: tuple[int, int], moment: Any = None
) -> dict[str, NDArray[np.float32]]:
    """Return places (ny, nx, 4) [m], normals (ny, nx, 4) and colours (ny, nx, 4), linear.

    Raises:
        DataError: as ``read_model``, or the model has more corners than there are texels.
    """
    model = _model(values)
    texels, corners = size[0] * size[1], 3 * len(model.corners)
    if corners > texels:
        message = f"this model has {corners} corners; {texels} texels were expected to hold them"
        raise DataError(message, file=Path(str(values["model"])))
    arrays = {}
    for name, numbers in (("place", model.corners), ("facing", model.normals), ("tint", model.colours)):
        rows = np.zeros((texels, 4), np.float32)
        rows[:corners, :3] = numbers.reshape(-1, 3)
        rows[:corners, 3] = 1.0
        arrays[name] = rows.reshape(size[1], size[0], 4)
    return arrays


def _model(values: Mapping[str, Value]) -> Model:
    """Return a model, which is not read again while its file stays as it is: every plan needs its size."""
    path = Path(str(values["model"]))
    return _read(path, content_key(path))


@SOURCES.cached(weight=bytes_held)
def _read(path: Path, _: str) -> Model:
    return read_model(path)


_ALIKE = frozenset({"EPSG:4326", "EPSG:4269", "EPSG:4258", "OGC:CRS84"})
"""Degrees on datums that differ by metres."""

_MAX_PIECES = 512
"""Of a straight line, which is bent in another reference system."""


@dataclass(frozen=True, eq=False)
class _Placed:
    """The shapes of a file, in the reference system of the terrain."""

    place: Georeference
    shapes: tuple[VectorShape, ...]
    extent: tuple[float, float]  # [m]
    notes: tuple[str, ...]


def make_mask(
    values: Mapping[str, Value], size: tuple[int, int], moment: None = None
) -> dict[str, NDArray[np.float32]]:
    """Return how much of each texel the shapes cover."""
    check_grid(size[::-1], np.dtype(np.float32), Path("mask of vector data"))
    positioned = _placed(*_vector_request(values))
    west, south, east, north = positioned.place.bounds
    scale = (size[0] - 1) / (east - west), (size[1] - 1) / (north - south)
    shapes = [
        replace(s, lines=tuple((line - (west, south)) * scale for line in s.lines)) for s in positioned.shapes
    ]
    spacing = positioned.extent[0] / (size[0] - 1), positioned.extent[1] / (size[1] - 1)
    width = values["width"]
    assert isinstance(width, int | float)  # the kernel's file says so
    return {"mask": draw(shapes, Grid(size, spacing), float(width), filled=values["polygons"] == 0)}


def mask_notes(values: Mapping[str, Value]) -> tuple[str, ...]:
    """Return what was left out of the file."""
    vectors = Path(str(values["vectors"]))
    return tuple(f"{vectors.name}: {note}" for note in _placed(*_vector_request(values)).notes)


def _vector_request(values: Mapping[str, Value]) -> tuple[str, str, str, str]:
    paths = [str(values[name]) for name in ("vectors", "elevation")]
    return paths[0], paths[1], content_key(Path(paths[0])), content_key(Path(paths[1]))


@SOURCES.cached(weight=bytes_held)
def _placed(vectors: str, elevation: str, *contents: str) -> _Placed:
    path, terrain = Path(vectors), open_elevation(elevation)
    georeference, extent = terrain.grid.place, terrain.extent
    if georeference is None or not georeference.crs.facts.kind or extent is None:
        message = "does not say where its terrain lies, so nothing can be laid on it; a GeoTIFF does"
        raise DataError(message, file=terrain.path)
    text_placed = read_vectors(path)
    shapes = _in_system(text_placed.shapes, text_placed.crs, georeference, path)
    said = list(text_placed.notes)
    lost = len(text_placed.shapes) - len(shapes)
    if lost:
        said.append(
            f"{lost} of its {len(text_placed.shapes)} shapes have no place in the terrain's reference system"
        )
    if not any(_meets(shape, georeference.bounds) for shape in shapes):
        said.append("none of its shapes lies on the terrain")
    return _Placed(georeference, shapes, extent, tuple(said))


def _in_system(
    shapes: tuple[VectorShape, ...], crs: str, georeference: Georeference, path: Path
) -> tuple[VectorShape, ...]:
    """Return shapes in the terrain's reference system, without those that have no place in it."""
    if not crs:
        return shapes  # the file says nothing: it is taken for that of the terrain
    system = georeference.crs.name or georeference.crs.text
    if crs == system or {crs, system} <= _ALIKE:
        return shapes
    lines = [_dense(line) if shape.kind != "point" else line for shape in shapes for line in shape.lines]
    try:
        points = transformed(np.concatenate(lines), crs, system)
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
    counts = np.clip(np.ceil(length / (0.01 if degrees else 1000.0)), 1, _MAX_PIECES).astype(np.intp)
    owner = np.repeat(np.arange(len(counts)), counts)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    step = (line[1:] - line[:-1]) / counts[:, None]
    return np.concatenate([line[owner] + step[owner] * number[:, None], line[-1:]])


def _meets(shape: VectorShape, bounds: tuple[float, float, float, float]) -> bool:
    """Return whether a shape may lie on the terrain, by what is around it."""
    points = np.concatenate(shape.lines)
    (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)
    west, south, east, north = bounds
    return bool(x0 <= east and x1 >= west and y0 <= north and y1 >= south)


EXAMPLE_PARAMETERS = ("elevation", "texel", "rise", "piece", "candidates", "follow", "seed")
EXAMPLE_INPUTS = ("guide",)
_MAX_EXAMPLE = 2049  # texels of an example's longer side, of a file that has more
_EXAMPLE_SALT = crc32(b"generation/from_example")


def describe_example(values: Mapping[str, Value]) -> Terrain:
    """Return the example's relief, where it is known: what is made of it has about the same."""
    low, rise = _metres_of_example(values)
    assumed = "" if low is None else example_of(values)[0].assumed
    return Terrain(relief=rise, base_elevation=low, assumed=assumed)


def make_from_example(
    values: Mapping[str, Value], size: tuple[int, int], material: Material
) -> dict[str, NDArray[np.float32]]:
    """Return heights in units of the relief, the lowest 0."""
    (example, coarser), (_, rise) = example_of(values), _metres_of_example(values)
    span = example.highest - example.lowest
    texel = number_of(values, "texel")
    spacing = (texel * coarser, texel * coarser) if texel else example.spacing
    settings = SynthesisSettings(
        piece=number_of(values, "piece"),
        candidates=int(number_of(values, "candidates")),
        follow=number_of(values, "follow"),
        seed=(int(number_of(values, "seed")) + _EXAMPLE_SALT) % 2**32,
    )
    guide = material.inputs.get("guide")
    heights = made_like(
        example,
        spacing or material.spacing,
        size,
        material.spacing,
        settings,
        None if guide is None else guide.reshape(*guide.shape[:2], -1)[..., 0].astype(np.float64),
        material.report,
    )
    scale = (material.relief if rise is None else rise) / span if span > 0 else 0.0
    return {"height": ((heights - heights.min()) * (scale / material.relief)).astype(np.float32)}


def example_notes(values: Mapping[str, Value]) -> tuple[str, ...]:
    """Return what was assumed of the example."""
    example, _ = example_of(values)
    facts = [f"{example.name}: {note}" for note in example.notes]
    if example.spacing is None and not number_of(values, "texel"):
        facts.append(f"{example.name}: it does not say how large it is, so its texels are this terrain's")
    return tuple(facts)


def _metres_of_example(values: Mapping[str, Value]) -> tuple[float | None, float | None]:
    """Return the elevation of the example's lowest height, and how far it rises [m]; None: not known."""
    (example, _), rise = example_of(values), number_of(values, "rise")
    if rise:
        return None, rise
    if example.in_metres and example.highest > example.lowest:
        return example.lowest, example.highest - example.lowest
    return None, None


def example_of(values: Mapping[str, Value]) -> tuple[Elevation, float]:
    """Return the example, and how many of the file's texels go to one of it."""
    path = Path(str(values["elevation"]))
    return _read_example(str(path), content_key(path))


@SOURCES.cached(weight=bytes_held)
def _read_example(path: str, _: str) -> tuple[Elevation, float]:
    file = open_elevation(Path(path))
    size = fitted(file.size, _MAX_EXAMPLE)
    elevation = fill_no_data(file.read_at(size), "fill")
    if min(elevation.size) < 2:
        raise DataError("an example needs 2 x 2 texels at least", file=path)
    if size == file.size:
        return elevation, 1.0
    whole, fewer = (f"{x} x {y}" for x, y in (file.size, size))
    note = f"its {whole} texels are read as {fewer}, enough for an example"
    return replace(elevation, notes=(*elevation.notes, note)), (max(file.size) - 1) / (max(size) - 1)

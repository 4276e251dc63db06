"""Terrain from an elevation file: what is known of it, and its heights at the size of a pass.

A large file is read at that size, a part at a time, and never has all of its texels in memory.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.images.content_hash import content_key
from playground.paths import shown
from playground.sketch.model import Value
from playground.terrain.elevation import Edge, Elevation, ElevationFile, open_elevation
from playground.terrain.gaps import Voids, fill_no_data
from playground.terrain.grid import Packing, fitted
from playground.terrain.known import Terrain
from playground.terrain.resample import resample

LARGE = 2**24
"""Texels of a file above which not all of them are read, unless the terrain has its size."""

USUAL_SIDE = 4097
"""Texels of the longer side of terrain from a large file, where nothing says how many."""

KEPT = 2**26
"""Texels above which heights are not kept in memory once a texture was made of them."""

Asked = tuple[str, str, tuple[int, int] | None, Packing, Voids, Edge]
"""A file's path, what changes whenever its contents do, and what its parameters say."""


def describe(values: Mapping[str, Value]) -> Terrain:
    """Return what the file knows of its terrain."""
    asked = _asked(values)
    file = _opened(asked)
    size = _size(file, values)
    known = _known(asked, size)
    low, high = known.lowest, known.highest
    metres = values["metres"]  # of the file's lowest and highest codes; equal: nothing is known
    relief = base = None
    assumed = ""
    if isinstance(metres, tuple) and metres[0] != metres[1]:
        codes = known.code_range or (low, high)
        scale = (metres[1] - metres[0]) / ((codes[1] - codes[0]) or 1.0)
        base, relief = metres[0] + (low - codes[0]) * scale, (high - low) * scale
    elif known.in_metres:
        base, relief, assumed = low, high - low, known.assumed
    return Terrain(size, file.extent, relief, base, file.found.place, assumed)


def make(
    values: Mapping[str, Value], size: tuple[int, int], moment: None = None
) -> dict[str, NDArray[np.float32]]:
    """Return the heights at a size: 0 at the file's lowest, 1 at its highest.

    Of a large file, those at less than half of the size that it has by itself are made of these: previews
    need not go through it again.
    """
    asked = _asked(values)
    own = _size(_opened(asked), values)
    elevation = _at(asked, own if all(2 * a <= b for a, b in zip(size, own, strict=True)) else size)
    low, span, made = elevation.lowest, elevation.highest - elevation.lowest, elevation.size
    with _memory_explained(Path(str(values["elevation"]))):
        if span > 0:
            heights = elevation.heights - np.float32(low)
            heights /= np.float32(span)
        else:
            heights = np.zeros_like(elevation.heights)
        if math.prod(made) > KEPT:
            _whole.cache_clear()
            _large.cache_clear()
        del elevation
        if size != made:
            heights = resample(heights, size, within=(0.0, 1.0))
    return {"height": heights}


def notes(values: Mapping[str, Value]) -> tuple[str, ...]:
    """Return what was assumed of the file, or lost."""
    asked = _asked(values)
    file = _opened(asked)
    size = _size(file, values)
    found = _known(asked, size).notes
    if not values.get("longest") and size != file.size:
        texels, fewer = (f"{x} x {y}" for x, y in (file.size, size))
        found += (f"has {texels} texels; unless a size or `longest` says how many, {fewer} are read",)
    return tuple(f"{file.path.name}: {note}" for note in found)


def _size(file: ElevationFile, values: Mapping[str, Value]) -> tuple[int, int]:
    """Return the size of the terrain where the sketch says none."""
    longest = values.get("longest", 0)  # kernels made before it was there have none
    assert isinstance(longest, int)  # the kernel's file says so
    if longest:
        return fitted(file.size, longest)
    return fitted(file.size, USUAL_SIDE) if math.prod(file.size) > LARGE else file.size


def _asked(values: Mapping[str, Value]) -> Asked:
    path = str(values["elevation"])
    raw = values["raw_size"]
    size = (int(raw[0]), int(raw[1])) if isinstance(raw, tuple) and raw[0] and raw[1] else None
    packing: Packing = "rgb" if values["packing"] == 1 else "grey"
    voids: Voids = "fill" if values["no_data"] == 1 else "refuse"
    first_row: Edge = "south" if values["first_row"] == 1 else "north"
    return path, content_key(Path(path)), size, packing, voids, first_row


@lru_cache(maxsize=4)
def _opened(asked: Asked) -> ElevationFile:
    path, _, raw_size, packing, _, first_row = asked
    with _memory_explained(Path(path)):
        return open_elevation(path, raw_size=raw_size, packing=packing, first_row=first_row)


@dataclass(frozen=True)
class _Known:
    """What is known of an elevation besides its heights."""

    lowest: float
    highest: float
    code_range: tuple[float, float] | None
    in_metres: bool
    assumed: str
    notes: tuple[str, ...]


@lru_cache(maxsize=16)
def _known(asked: Asked, size: tuple[int, int]) -> _Known:
    found = _at(asked, size)
    return _Known(found.lowest, found.highest, found.code_range, found.in_metres, found.assumed, found.notes)


def _at(asked: Asked, size: tuple[int, int]) -> Elevation:
    """Return all heights of a file; of a large one, those of a size."""
    with _memory_explained(Path(asked[0])):
        return _large(asked, size) if math.prod(_opened(asked).size) > LARGE else _whole(asked)


@lru_cache(maxsize=4)
def _whole(asked: Asked) -> Elevation:
    return fill_no_data(_opened(asked).read(), asked[4])


@lru_cache(maxsize=2)
def _large(asked: Asked, size: tuple[int, int]) -> Elevation:
    return fill_no_data(_opened(asked).read_at(size), asked[4])


@contextmanager
def _memory_explained(path: Path) -> Iterator[None]:
    try:
        yield
    except MemoryError:
        raise DataError("there is not enough memory to read it", file=shown(path)) from None

"""The source ``example_file``: its parameters as GLSL declares them, and what it makes of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.images.content_hash import content_key
from playground.sketch.model import Value
from playground.terrain.elevation import Elevation, open_elevation
from playground.terrain.example.terrain import Wishes, made_like
from playground.terrain.gaps import fill_no_data
from playground.terrain.grid import fitted
from playground.terrain.known import Terrain
from playground.terrain.source_kinds import Material

PARAMETERS = ("elevation", "texel", "rise", "piece", "candidates", "follow", "seed")
INPUTS = ("guide",)
_LONGEST = 2049  # texels of an example's longer side, of a file that has more
_SALT = crc32(b"generation/from_example")


def describe(values: Mapping[str, Value]) -> Terrain:
    """Return the example's relief, where it is known: what is made of it has about the same."""
    low, rise = _metres(values)
    assumed = "" if low is None else _example(values)[0].assumed
    return Terrain(relief=rise, base_elevation=low, assumed=assumed)


def work(
    values: Mapping[str, Value], size: tuple[int, int], material: Material
) -> dict[str, NDArray[np.float32]]:
    """Return heights in units of the relief, the lowest 0."""
    (example, coarser), (_, rise) = _example(values), _metres(values)
    span = example.highest - example.lowest
    texel = _number(values, "texel")
    spacing = (texel * coarser, texel * coarser) if texel else example.spacing
    wishes = Wishes(
        piece=_number(values, "piece"),
        candidates=int(_number(values, "candidates")),
        follow=_number(values, "follow"),
        seed=(int(_number(values, "seed")) + _SALT) % 2**32,
    )
    guide = material.inputs.get("guide")
    heights = made_like(
        example,
        spacing or material.spacing,
        size,
        material.spacing,
        wishes,
        None if guide is None else guide.reshape(*guide.shape[:2], -1)[..., 0].astype(np.float64),
        material.report,
    )
    scale = (material.relief if rise is None else rise) / span if span > 0 else 0.0
    return {"height": ((heights - heights.min()) * (scale / material.relief)).astype(np.float32)}


def notes(values: Mapping[str, Value]) -> tuple[str, ...]:
    """Return what was assumed of the example."""
    example, _ = _example(values)
    found = [f"{example.name}: {note}" for note in example.notes]
    if example.spacing is None and not _number(values, "texel"):
        found.append(f"{example.name}: it does not say how large it is, so its texels are this terrain's")
    return tuple(found)


def _metres(values: Mapping[str, Value]) -> tuple[float | None, float | None]:
    """Return the elevation of the example's lowest height, and how far it rises [m]; None: not known."""
    (example, _), rise = _example(values), _number(values, "rise")
    if rise:
        return None, rise
    if example.in_metres and example.highest > example.lowest:
        return example.lowest, example.highest - example.lowest
    return None, None


def _example(values: Mapping[str, Value]) -> tuple[Elevation, float]:
    """Return the example, and how many of the file's texels go to one of it."""
    path = Path(str(values["elevation"]))
    return _read(str(path), content_key(path))


@lru_cache(maxsize=4)
def _read(path: str, content: str) -> tuple[Elevation, float]:  # ``content`` changes whenever the file does
    file = open_elevation(Path(path))
    size = fitted(file.size, _LONGEST)
    found = fill_no_data(file.read_at(size), "fill")
    if min(found.size) < 2:
        raise DataError("an example needs 2 x 2 texels at least", file=path)
    if size == file.size:
        return found, 1.0
    whole, fewer = (f"{x} x {y}" for x, y in (file.size, size))
    note = f"its {whole} texels are read as {fewer}, enough for an example"
    return replace(found, notes=(*found.notes, note)), (max(file.size) - 1) / (max(size) - 1)


def _number(values: Mapping[str, Value], name: str) -> float:
    value = values[name]
    assert isinstance(value, int | float)  # the kernel's file says so
    return value

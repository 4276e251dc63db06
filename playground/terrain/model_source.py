"""The source "model_file": a model's corners as texels, for a draw of mesh "triangles" to fetch.

Texel by texel from the south-west, row by row: the three corners of the first triangle, of the second, and so
on, ``CORNERS`` in a row. The fourth number of a place is 1 where there is a corner, 0 after the last.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.images.content_hash import content_key
from playground.sketch.model import Value
from playground.terrain.model_files import Model, read_model

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
        raise DataError(
            f"this model has {corners} corners; {texels} texels were expected to hold them",
            file=Path(str(values["model"])),
        )
    found = {}
    for name, numbers in (("place", model.corners), ("facing", model.normals), ("tint", model.colours)):
        rows = np.zeros((texels, 4), np.float32)
        rows[:corners, :3] = numbers.reshape(-1, 3)
        rows[:corners, 3] = 1.0
        found[name] = rows.reshape(size[1], size[0], 4)
    return found


def _model(values: Mapping[str, Value]) -> Model:
    """Return a model, which is not read again while its file stays as it is: every plan needs its size."""
    path = Path(str(values["model"]))
    return _read(path, content_key(path))


@lru_cache(maxsize=8)
def _read(path: Path, _: str) -> Model:
    return read_model(path)

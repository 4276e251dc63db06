"""Build the meshes that draws may ask for, by name.

A closed registry: a sketch is data and cannot bring Python. A builder takes the draw's
parameters that it declares, and nothing else, so that a mesh stays valid while they do not change.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from playground.engine import lod
from playground.errors import SketchError, nearest

_STRIP = 16  # squares side by side in a strip of a grid


@dataclass(frozen=True, slots=True)
class Mesh:
    """Vertices and how to join them."""

    attributes: dict[str, NDArray[np.float32]]  # name → (n, components)
    indices: NDArray[np.uint32]  # (m,), three a triangle


def grid(values: Mapping[str, int]) -> Mesh:
    """Return a square of ``grid`` by ``grid`` vertices with a skirt around it.

    Attribute ``corner``: east and north, 0..1, and 0 on the terrain or 1 at the skirt's foot.
    """
    corner, indices = skirted(np.linspace(0.0, 1.0, values["grid"], dtype=np.float32))
    return Mesh({"corner": corner}, indices)


def skirted(along: NDArray[np.float32]) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Return a square grid with a skirt around it, its vertices at the places ``along`` each side.

    Vertices (n, 3): east and north, and 0 on the terrain or 1 at the skirt's foot; indices, three a triangle.
    """
    n = len(along)
    east, north = np.meshgrid(along, along)
    top = np.stack([east.ravel(), north.ravel(), np.zeros(n * n, np.float32)], axis=1)
    index = np.arange(n * n, dtype=np.uint32).reshape(n, n)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    faces = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 6)
    rim = np.concatenate([index[0, :-1], index[:-1, -1], index[-1, :0:-1], index[:0:-1, 0]])
    foot = top[rim].copy()
    foot[:, 2] = 1.0
    low = np.arange(len(rim), dtype=np.uint32) + np.uint32(n * n)
    following = np.roll(np.arange(len(rim)), -1)
    wall = np.stack([rim, low, low[following], rim, low[following], rim[following]], axis=-1)
    return np.concatenate([top, foot]), np.concatenate([faces.ravel(), wall.ravel()]).astype(np.uint32)


def sheet(values: Mapping[str, int]) -> Mesh:
    """Return one flat square; attribute ``corner``: east and north, 0..1, and 0."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
    return Mesh({"corner": corners}, np.array([0, 1, 2, 0, 2, 3], np.uint32))


def triangles(values: Mapping[str, int]) -> Mesh:
    """Return ``count`` triangles whose vertices share nothing: where they lie is the draw's to say.

    Attribute ``corner``: which triangle, which of its vertices, 0 to 2, and 0.
    """
    n = values["count"]
    corner = np.zeros((n, 3, 3), np.float32)
    corner[..., 0] = np.arange(n)[:, None]
    corner[..., 1] = np.arange(3)
    return Mesh({"corner": corner.reshape(-1, 3)}, np.arange(3 * n, dtype=np.uint32))


def terrain(values: Mapping[str, int]) -> Mesh:
    """Return a grid, or, where ``detail`` is not 0, one tile with every list of indices of ``lod``.

    Attribute ``corner`` of a tile: nodes east and north, 0..16, and 0 on top or 1 at the skirt's foot.
    """
    if values["detail"] == 0:
        return grid(values)
    return Mesh({"corner": lod.vertices()}, np.concatenate(list(lod.pieces().values())))


MESHES: dict[str, tuple[Callable[[Mapping[str, int]], Mesh], dict[str, tuple[int, int]]]] = {
    "grid": (grid, {"grid": (2, 4097)}),
    "sheet": (sheet, {}),
    "triangles": (triangles, {"count": (1, 2**20)}),
    "land": (terrain, {"detail": (0, len(lod.DETAILS) - 1), "grid": (2, 4097)}),
}
"""Name → (builder, the draw's parameters that it reads with their least and greatest).

A draw's header may work out ``count``.
"""


def mesh_parameters(name: str) -> tuple[str, ...]:
    """Return the parameters that a mesh, or the choice from it, reads; none where there is no such mesh."""
    chosen = lod.CHOOSERS[name].parameters if name in lod.CHOOSERS else ()
    return (*MESHES[name][1], *chosen) if name in MESHES else ()


def mesh_key(name: str, values: Mapping[str, object]) -> tuple[tuple[str, int], ...]:
    """Return the parameters that a mesh depends on, with their values.

    Raises ``SketchError`` where one is missing or out of range.
    """
    if name not in MESHES:
        raise SketchError(f"there is no mesh '{name}'{nearest(name, MESHES)}")
    key = []
    for parameter, (low, high) in MESHES[name][1].items():
        value = values.get(parameter)
        if not isinstance(value, int):
            other = ', or count = "…" in its #pragma' if parameter == "count" else ""
            raise SketchError(f"mesh '{name}' needs a parameter 'uniform int {parameter}'{other}")
        if not low <= value <= high:
            raise SketchError(f"{parameter} = {value}: mesh '{name}' takes {low} to {high}")
        key.append((parameter, value))
    return tuple(key)


def build_mesh(name: str, key: tuple[tuple[str, int], ...]) -> Mesh:
    """Build a mesh from what ``mesh_key`` gave."""
    return MESHES[name][0](dict(key))


def drawn_mesh(name: str, key: tuple[tuple[str, int], ...]) -> Mesh:
    """Build a mesh as ``build_mesh`` does, the same triangles in an order that is quick to draw.

    A grid is drawn in strips that go north, its vertices numbered in the order of their use: a driver
    remembers the vertices that it shaded last. llvmpipe finds one by its number modulo 256: in rows of
    257, two of each square took each other's place, and each vertex was shaded four times.
    """
    mesh, settings = build_mesh(name, key), dict(key)
    if "grid" not in settings or settings.get("detail"):
        return mesh
    across = settings["grid"] - 1
    squares, skirt = np.split(mesh.indices, [6 * across**2])
    rows = squares.reshape(across, across, 6)
    strips = [rows[:, start : start + _STRIP].ravel() for start in range(0, across, _STRIP)]
    indices = np.concatenate([*strips, skirt])
    used, first = np.unique(indices, return_index=True)
    order = used[np.argsort(first)]
    number = np.empty(len(order), np.uint32)
    number[order] = np.arange(len(order), dtype=np.uint32)
    attributes = {attribute: array[order] for attribute, array in mesh.attributes.items()}
    return Mesh(attributes, number[indices])

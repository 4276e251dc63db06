"""Convert the terrain to a mesh that other programs understand, and write it as glTF, OBJ or STL.

x is east, y up and z south, as in glTF 2.0 (right-handed, +Y up); the middle of the terrain is at x = z = 0,
sea level at y = 0. A regular grid, its rows from the north: not reduced where the terrain is flat. OBJ
itself has no axes, and most programs take y for up. STL has neither axes nor a unit, and those who print it
take z for up: there x is east, y north and z up.

Sources: Khronos Group 2021, "glTF 2.0 Specification" (revision 2.0.1), sections 3 and 4, and the extension
KHR_materials_unlit; Wavefront Technologies, "Advanced Visualizer" manual, appendix B1 (OBJ); Ramey, Rose and
Tyerman 1995, "MTL material format (Lightwave, OBJ)", version 4.2;
3D Systems 1989, "StereoLithography Interface Specification" (STL, binary).
"""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.publish.export_formats import one_word


@dataclass(frozen=True, eq=False)
class TerrainMesh:
    """Vertices and how to join them."""

    positions: NDArray[np.float32]  # [m] (n, 3): x east, y up, z south
    normals: NDArray[np.float32]  # (n, 3), of length 1
    uv: NDArray[np.float32]  # (n, 2) 0..1: east and south, from the texture's north-western corner
    triangles: NDArray[np.uint32]  # (m, 3)


def sampled(values: NDArray[np.float32], size: tuple[int, int]) -> NDArray[np.float32]:
    """Return values on a grid of another size (nx, ny), corners on corners, between four texels.

    ``values`` is (rows, cols) or (rows, cols, channels). Where texels of both grids meet, and
    where nothing lies between, values are exact.
    """
    return _along(_along(values, 0, size[1]), 1, size[0])


def _along(values: NDArray[np.float32], axis: int, count: int) -> NDArray[np.float32]:
    here = values.shape[axis]
    if count == here:
        return values
    # Integers say exactly where texels of both grids meet.
    whole, rest = np.divmod(np.arange(count) * (here - 1), max(count - 1, 1))
    part = (rest / max(count - 1, 1)).astype(np.float32)
    part = part.reshape([-1 if k == axis else 1 for k in range(values.ndim)])
    low = np.take(values, whole, axis)
    high = np.take(values, np.minimum(whole + 1, here - 1), axis)
    with np.errstate(invalid="ignore"):  # what is not finite is its user's to refuse
        return np.asarray(low + (high - low) * part, dtype=np.float32)


def terrain_mesh(
    heights: NDArray[np.float32], extent: tuple[float, float], texels: tuple[int, int] = (2, 2)
) -> TerrainMesh:
    """Return the mesh with a vertex at each height.

    ``heights`` is (rows, cols) in metres, north row first; ``extent`` in metres, east and
    north; ``texels`` the size of the texture that is draped: its first and last texels'
    middles, not its edges, are on the terrain's edges. Normals are those of central differences.

    Raises:
        DataError: fewer than 2 x 2 heights, or some that are not finite.
    """
    rows, cols = heights.shape
    if min(rows, cols) < 2:
        raise DataError(f"terrain of {cols} x {rows} texels has no mesh; expected at least 2 x 2")
    bad = int(np.count_nonzero(~np.isfinite(heights)))
    if bad:
        raise DataError(f"{bad} of {heights.size} heights are not finite, and a mesh has no place for them")
    east, south = np.meshgrid(np.linspace(0.0, 1.0, cols), np.linspace(0.0, 1.0, rows))
    positions = np.empty((rows, cols, 3), np.float32)
    positions[..., 0] = (east - 0.5) * extent[0]
    positions[..., 1] = heights
    positions[..., 2] = (south - 0.5) * extent[1]

    metres = heights.astype(np.float64)
    normals = np.ones((rows, cols, 3))
    normals[..., 0] = -np.gradient(metres, extent[0] / (cols - 1), axis=1)
    normals[..., 2] = -np.gradient(metres, extent[1] / (rows - 1), axis=0)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)

    nx, ny = texels
    uv = np.stack([(east * (nx - 1) + 0.5) / nx, (south * (ny - 1) + 0.5) / ny], axis=-1)
    return TerrainMesh(
        positions.reshape(-1, 3),
        normals.reshape(-1, 3).astype(np.float32),
        uv.reshape(-1, 2).astype(np.float32),
        _triangles(rows, cols),
    )


def _triangles(rows: int, cols: int) -> NDArray[np.uint32]:
    """Return two triangles for each square, parted from south-west to north-east as in the playground."""
    index = np.arange(rows * cols, dtype=np.uint32).reshape(rows, cols)
    north_west, north_east = index[:-1, :-1], index[:-1, 1:]
    south_west, south_east = index[1:, :-1], index[1:, 1:]
    corners = [south_west, south_east, north_east, south_west, north_east, north_west]
    return np.stack(corners, axis=-1).reshape(-1, 3)


# ── glTF in one binary file ────────────────────────────────────────────────────


_MAGIC, _VERSION, _JSON, _BIN = 0x46546C67, 2, 0x4E4F534A, 0x004E4942
_VERTICES, _INDICES = 34962, 34963  # what a buffer view is for
_USHORT, _UINT, _FLOAT = 5123, 5125, 5126
_LINEAR, _LINEAR_MIPMAP_LINEAR, _CLAMP = 9729, 9987, 33071
_PRIMITIVE_RESTART = 65535  # vertices: index 65535 itself begins a new strip
_MAX_BYTES = 2**32 - 1  # bytes of a file, whose length is 32 bits


def encode_glb(
    mesh: TerrainMesh, name: str, *, texture: bytes = b"", unlit: bool = False, software: str = ""
) -> bytes:
    """Return the bytes of a .glb.

    ``texture`` is a PNG, sRGB; without one the terrain is white. ``unlit`` says that light is in
    the texture already, so that a program adds none. Indices have 16 bits where they can.

    Raises:
        DataError: more bytes than the format can count.
    """
    narrow = len(mesh.positions) <= _PRIMITIVE_RESTART
    indices = mesh.triangles.ravel().astype("<u2" if narrow else "<u4")
    parts: list[tuple[bytes, int]] = [
        (_bytes(mesh.positions), _VERTICES),
        (_bytes(mesh.normals), _VERTICES),
        (_bytes(mesh.uv), _VERTICES),
        (indices.tobytes(), _INDICES),
    ]
    count = len(mesh.positions)
    bounds = {
        "min": [float(v) for v in mesh.positions.min(axis=0)],
        "max": [float(v) for v in mesh.positions.max(axis=0)],
    }
    attributes = {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}
    primitive = {"attributes": attributes, "indices": 3, "material": 0}
    document: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": software},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": name}],
        "meshes": [{"name": name, "primitives": [primitive]}],
        "accessors": [
            _accessor(0, _FLOAT, count, "VEC3") | bounds,
            _accessor(1, _FLOAT, count, "VEC3"),
            _accessor(2, _FLOAT, count, "VEC2"),
            _accessor(3, _USHORT if narrow else _UINT, indices.size, "SCALAR"),
        ],
    }
    if texture:
        parts.append((texture, 0))
    return _packed(document | _material(name, textured=bool(texture), unlit=unlit), parts)


def _accessor(view: int, component: int, count: int, kind: str) -> dict[str, Any]:
    return {"bufferView": view, "componentType": component, "count": count, "type": kind}


def _material(name: str, *, textured: bool, unlit: bool) -> dict[str, Any]:
    """Return the entries of the one material, whose texture is in buffer view 4."""
    look: dict[str, Any] = {"metallicFactor": 0.0, "roughnessFactor": 1.0}
    material: dict[str, Any] = {"name": name, "pbrMetallicRoughness": look}
    entries: dict[str, Any] = {"materials": [material]}
    if textured:
        look["baseColorTexture"] = {"index": 0}
        entries["textures"] = [{"source": 0, "sampler": 0}]
        entries["images"] = [{"bufferView": 4, "mimeType": "image/png", "name": name}]
        entries["samplers"] = [
            {"magFilter": _LINEAR, "minFilter": _LINEAR_MIPMAP_LINEAR, "wrapS": _CLAMP, "wrapT": _CLAMP}
        ]
    if unlit:
        material["extensions"] = {"KHR_materials_unlit": {}}
        entries["extensionsUsed"] = ["KHR_materials_unlit"]
    return entries


def _bytes(values: NDArray[np.float32]) -> bytes:
    return values.astype("<f4").tobytes()


def _packed(document: dict[str, Any], parts: list[tuple[bytes, int]]) -> bytes:
    views, blobs, start = [], [], 0
    for data, target in parts:
        view = {"buffer": 0, "byteOffset": start, "byteLength": len(data)}
        views.append(view | ({"target": target} if target else {}))
        padded = _padded(data, b"\0")
        blobs.append(padded)
        start += len(padded)
    document["bufferViews"] = views
    document["buffers"] = [{"byteLength": start}]
    text = _padded(json.dumps(document, separators=(",", ":"), ensure_ascii=False).encode(), b" ")
    length = 12 + 8 + len(text) + 8 + start
    if length > _MAX_BYTES:
        raise DataError(f"{length} bytes are more than a .glb can count; choose a smaller texture or grid")
    head = struct.pack("<III", _MAGIC, _VERSION, length)
    return b"".join(
        [head, struct.pack("<II", len(text), _JSON), text, struct.pack("<II", start, _BIN), *blobs]
    )


def _padded(data: bytes, fill: bytes) -> bytes:
    return data + fill * (-len(data) % 4)


# ── OBJ and its MTL ────────────────────────────────────────────────────────────


_ROWS = 65536  # formatted at once


def encode_obj(mesh: TerrainMesh, name: str, *, library: str, software: str = "") -> bytes:
    """Return the text of an OBJ whose material ``land`` is in the file ``library``, in the same folder."""
    uv = mesh.uv.copy()
    uv[:, 1] = 1.0 - uv[:, 1]  # from the texture's southern edge
    corners = np.repeat(mesh.triangles.astype(np.int64) + 1, 3, axis=1)  # place, texture and normal are alike
    head = (
        f"# {software}: x east, y up, z south, in metres\n"
        f"mtllib {library}\no {one_word(name)}\nusemtl land\ns 1\n"
    )
    return b"".join(
        [
            head.encode(),
            _lines("v %.9g %.9g %.9g\n", mesh.positions),
            _lines("vt %.9g %.9g\n", uv),
            _lines("vn %.7g %.7g %.7g\n", mesh.normals),
            _lines("f %d/%d/%d %d/%d/%d %d/%d/%d\n", corners),
        ]
    )


def encode_mtl(*, texture: str = "", unlit: bool = False, software: str = "") -> bytes:
    """Return the text of an MTL: material ``land``, with a picture's name where there is one."""
    lines = [f"# {software}", "newmtl land", "Ka 0 0 0", "Kd 1 1 1", "Ks 0 0 0"]
    lines.append(f"illum {0 if unlit else 1}")  # 0: the colour as it is
    if texture:
        lines.append(f"map_Kd {texture}")
    return ("\n".join(lines) + "\n").encode()


def _lines(form: str, rows: NDArray[np.generic]) -> bytes:
    parts = []
    for start in range(0, len(rows), _ROWS):
        band = rows[start : start + _ROWS]
        parts.append(((form * len(band)) % tuple(band.ravel().tolist())).encode())
    return b"".join(parts)


# ── STL ────────────────────────────────────────────────────────────────────────


_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])
_STL_HEAD = 80  # bytes, which say what one likes


def encode_stl(mesh: TerrainMesh, software: str = "") -> bytes:
    """Return the bytes of a binary STL in metres: x east, y north, z up; normals are the triangles' own."""
    corners = mesh.positions[mesh.triangles].astype(np.float64)
    turned = np.stack([corners[..., 0], -corners[..., 2], corners[..., 1]], axis=-1)
    normals = np.cross(turned[:, 1] - turned[:, 0], turned[:, 2] - turned[:, 0])
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    triangles = np.zeros(len(turned), _TRIANGLE)
    triangles["normal"], triangles["corners"] = normals, turned
    head = f"{software}: x east, y north, z up, in metres".encode()[:_STL_HEAD].ljust(_STL_HEAD)
    return head + struct.pack("<I", len(turned)) + triangles.tobytes()

"""Write glTF 2.0 in one binary file (.glb): the terrain's mesh, its texture inside.

Source: Khronos Group 2021, "glTF 2.0 Specification" (revision 2.0.1), sections 3 and 4, and
the extension KHR_materials_unlit. A node, a mesh, a material, at most one image.
"""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.publish.mesh import TerrainMesh

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

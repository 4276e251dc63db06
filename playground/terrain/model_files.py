"""Read the triangles of a glTF 2.0 file: places, normals and colours, in metres, z up.

``.glb``, or ``.gltf`` whose buffers are inside it. What is read of it: the nodes of its scene with their
transforms, meshes of triangles, POSITION, NORMAL, COLOR_0, and the base colour of materials. What is not:
textures, skins, animations, cameras. A file is a stranger's: every offset and number in it is checked.

Source: Khronos Group 2021, "glTF 2.0 Specification" (section 3.6 for accessors, 3.5 for nodes, 4.4 for GLB).
"""

from __future__ import annotations

import base64
import binascii
import json
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError

Floats = NDArray[np.float32]

MOST_BYTES = 32 * 2**20
MOST_TRIANGLES = 2**16
_DEEPEST = 64  # nodes inside each other
_MOST_NODES = 2**14  # each as often as it is named
_TYPES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_GLB, _JSON, _BIN = 0x46546C67, 0x4E4F534A, 0x004E4942
_KNOWN = ("KHR_mesh_quantization", "KHR_materials_unlit")  # what changes nothing that is read here
_MODES = ("points", "lines", "a line loop", "a line strip", "triangles", "a triangle strip", "a triangle fan")


@dataclass(frozen=True, slots=True)
class Model:
    """Triangles, each with its own three corners."""

    corners: Floats  # (n, 3, 3) [m] east, north, up
    normals: Floats  # (n, 3, 3) unit vectors
    colours: Floats  # (n, 3, 3) linear, 0..1


class _Wrong(Exception):
    """What is wrong with a file, in words that follow its name."""


def read_model(path: Path) -> Model:
    """Return the triangles of a file.

    Raises:
        DataError: missing, too large, damaged, without triangles, or with what is not read here.
    """
    try:
        if path.stat().st_size > MOST_BYTES:
            raise _Wrong(f"is larger than {MOST_BYTES >> 20} MB, the most that a model may have")
        data = path.read_bytes()
        document, binary = _contents(data)
        return _Reader(document, binary).model()
    except _Wrong as wrong:
        raise DataError(f"this model {wrong}", file=path) from None
    except OSError as error:
        raise DataError(f"this model cannot be read: {error.strerror}", file=path) from None


def _contents(data: bytes) -> tuple[dict[str, Any], bytes | None]:
    """Return a file's JSON and, of a GLB, its binary chunk."""
    binary = None
    if data[:4] == b"glTF":
        if len(data) < 20:
            raise _Wrong("ends within its header; a GLB of 20 bytes or more was expected")
        _, version, length = struct.unpack_from("<III", data)
        if version != 2:
            raise _Wrong(f"is glTF {version}; version 2 was expected")
        if length > len(data):
            raise _Wrong(f"ends after {len(data)} bytes of the {length} that its header says")
        chunks = dict(reversed(list(_chunks(data[:length]))))
        if _JSON not in chunks:
            raise _Wrong("has no JSON chunk")
        text, binary = chunks[_JSON], chunks.get(_BIN, b"")
    else:
        text = data
    try:
        document = json.loads(text.decode("utf-8"))
    except (ValueError, RecursionError):
        raise _Wrong("is neither GLB nor JSON; glTF 2.0, .glb or .gltf, was expected") from None
    if not isinstance(document, dict) or not isinstance(document.get("asset"), dict):
        raise _Wrong("is JSON, but no glTF: it has no 'asset'")
    if not str(document["asset"].get("version", "")).startswith("2"):
        raise _Wrong(f"is glTF {document['asset'].get('version')}; version 2 was expected")
    needed = [name for name in document.get("extensionsRequired", ()) if name not in _KNOWN]
    if needed:
        raise _Wrong(f"needs {needed[0]}, which is not read here; export it without compression")
    return document, binary


def _chunks(data: bytes) -> Iterator[tuple[int, bytes]]:
    at = 12
    while at + 8 <= len(data):
        length, kind = struct.unpack_from("<II", data, at)
        if at + 8 + length > len(data):
            raise _Wrong("has a chunk that goes on after its end")
        yield kind, data[at + 8 : at + 8 + length]
        at += 8 + length


class _Reader:
    """Reads one document."""

    def __init__(self, document: Mapping[str, Any], binary: bytes | None) -> None:
        self.document = document
        self.binary = binary
        self.left = MOST_TRIANGLES
        self.nodes_left = _MOST_NODES
        self._buffers: dict[int, bytes] = {}

    def model(self) -> Model:
        parts = list(self._scene())
        if not parts:
            raise _Wrong("has no triangles in its scene")
        corners, normals, colours = (
            np.concatenate(each).astype(np.float32) for each in zip(*parts, strict=True)
        )
        if not (np.isfinite(corners).all() and np.isfinite(normals).all()):
            raise _Wrong("has places that are no numbers")
        return Model(_upright(corners), _upright(normals), np.clip(colours, 0.0, 1.0))

    def _entry(self, kind: str, index: Any) -> dict[str, Any]:
        """Return one of a list of the document."""
        entries = self.document.get(kind, [])
        whole = isinstance(index, int) and not isinstance(index, bool) and isinstance(entries, list)
        if not whole or not 0 <= index < len(entries) or not isinstance(entries[index], dict):
            raise _Wrong(f"names {kind}[{index}], which it does not have")
        found: dict[str, Any] = entries[index]
        return found

    def _scene(self) -> Iterator[tuple[NDArray[Any], NDArray[Any], NDArray[Any]]]:
        if self.document.get("scenes"):
            roots = self._entry("scenes", self.document.get("scene", 0)).get("nodes", [])
        else:
            nodes = self.document.get("nodes", [])
            inner = {child for node in nodes for child in node.get("children", ())}
            roots = [k for k in range(len(nodes)) if k not in inner]
        for root in roots:
            yield from self._node(root, np.eye(4), 0)

    def _node(
        self, index: Any, outer: NDArray[np.float64], depth: int
    ) -> Iterator[tuple[NDArray[Any], NDArray[Any], NDArray[Any]]]:
        if depth > _DEEPEST:
            raise _Wrong(f"has nodes more than {_DEEPEST} deep in each other, or a node inside itself")
        self.nodes_left -= 1
        if self.nodes_left < 0:
            raise _Wrong(f"has more than {_MOST_NODES} nodes")
        node = self._entry("nodes", index)
        matrix = outer @ _transform(node)
        if "mesh" in node:
            for primitive in self._entry("meshes", node["mesh"]).get("primitives", []):
                yield self._triangles(primitive, matrix)
        for child in node.get("children", ()):
            yield from self._node(child, matrix, depth + 1)

    def _triangles(
        self, primitive: Mapping[str, Any], matrix: NDArray[np.float64]
    ) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
        """Return corners, normals and colours of a primitive, (n, 3, 3) each."""
        mode = primitive.get("mode", 4)
        if mode != 4:
            named = _MODES[mode] if mode in range(len(_MODES)) else f"mode {mode}"
            raise _Wrong(f"has {named}; triangles (mode 4) were expected")
        attributes = primitive.get("attributes", {})
        if "POSITION" not in attributes:
            raise _Wrong("has a mesh without POSITION")
        places = self._numbers(attributes["POSITION"], "POSITION", (3,))
        count = len(places)
        order = np.arange(count)
        if "indices" in primitive:
            order = self._numbers(primitive["indices"], "indices", (1,))[:, 0].astype(np.int64)
        if len(order) % 3 or (len(order) and order.max() >= count):
            what = f"{len(order)} indices into {count} places"
            raise _Wrong(f"has {what}; threes of indices below that number were expected")
        self.left -= len(order) // 3
        if self.left < 0:
            raise _Wrong(f"has more than {MOST_TRIANGLES} triangles")
        corners = (places @ matrix[:3, :3].T + matrix[:3, 3])[order].reshape(-1, 3, 3)
        if np.linalg.det(matrix[:3, :3]) < 0:  # mirrored: the front would be the back
            corners, order = corners[:, ::-1], order.reshape(-1, 3)[:, ::-1].ravel()
        flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals = np.repeat(_unit(flat)[:, None], 3, axis=1)
        if "NORMAL" in attributes:
            given = self._numbers(attributes["NORMAL"], "NORMAL", (3,), count)
            turned = given @ np.linalg.pinv(matrix[:3, :3])
            normals = np.where(
                np.any(turned, axis=1)[order].reshape(-1, 3, 1),
                _unit(turned)[order].reshape(-1, 3, 3),
                normals,
            )
        base = np.ones(3)
        if "material" in primitive:
            rough = self._entry("materials", primitive["material"]).get("pbrMetallicRoughness", {})
            base = _vector(rough.get("baseColorFactor", [1, 1, 1, 1]), 4, "baseColorFactor")[:3]
        colours = np.broadcast_to(base, (count, 3))
        if "COLOR_0" in attributes:
            colours = self._numbers(attributes["COLOR_0"], "COLOR_0", (3, 4), count)[:, :3] * base
        return corners, normals, colours[order].reshape(-1, 3, 3)

    def _numbers(
        self, index: Any, name: str, widths: tuple[int, ...], count: int = -1
    ) -> NDArray[np.float64]:
        """Return an accessor's numbers (n, width)."""
        accessor = self._entry("accessors", index)
        kind, width = accessor.get("componentType"), _WIDTHS.get(accessor.get("type", ""))
        if kind not in _TYPES or width not in widths:
            expected = " or ".join(str(each) for each in widths)
            raise _Wrong(f"has {name} of a form that is not read; {expected} numbers each were expected")
        dtype = np.dtype(_TYPES[kind])
        many = accessor.get("count")
        if not isinstance(many, int) or not 0 <= many <= 3 * MOST_TRIANGLES or (count >= 0 and many != count):
            raise _Wrong(f"has {many} of {name}; {count if count >= 0 else 'fewer'} were expected")
        if "sparse" in accessor:
            raise _Wrong(f"has sparse {name}, which are not read here")
        if "bufferView" not in accessor:
            return np.zeros((many, width))
        view = self._entry("bufferViews", accessor["bufferView"])
        data = self._buffer(view.get("buffer"))
        size = dtype.itemsize * width
        stride = view.get("byteStride", size)
        numbers = [
            view.get("byteOffset", 0),
            accessor.get("byteOffset", 0),
            view.get("byteLength", 0),
            stride,
        ]
        if not all(isinstance(n, int) and 0 <= n <= MOST_BYTES for n in numbers) or stride < size:
            raise _Wrong(f"has {name} at no place that can be")
        start, end = numbers[0] + numbers[1], numbers[0] + numbers[2]
        if many and (end > len(data) or start + (many - 1) * stride + size > end):
            raise _Wrong(f"ends before its {name} do")
        rows = np.lib.stride_tricks.as_strided(
            np.frombuffer(data, np.uint8, offset=start)[: max(many - 1, 0) * stride + size]
            if many
            else np.empty(0, np.uint8),
            (many, size),
            (stride, 1),
        )
        found = np.ascontiguousarray(rows).view(dtype).astype(np.float64).reshape(many, width)
        normalised = accessor.get("normalized", False) and dtype.kind in "iu"
        return np.maximum(found / np.iinfo(dtype).max, -1.0) if normalised else found

    def _buffer(self, index: Any) -> bytes:
        if index in self._buffers:
            return self._buffers[index]
        buffer = self._entry("buffers", index)
        uri = buffer.get("uri")
        if uri is None:
            if index != 0 or self.binary is None:
                raise _Wrong(f"has no data for buffers[{index}]")
            data = self.binary
        elif isinstance(uri, str) and uri.startswith("data:") and ";base64," in uri[:100]:
            try:
                data = base64.b64decode(uri.partition(";base64,")[2], validate=True)
            except (binascii.Error, ValueError):
                raise _Wrong(f"has damaged data in buffers[{index}]") from None
        else:
            raise _Wrong(f"has its data in another file, {str(uri)[:60]}; one file, .glb, was expected")
        self._buffers[index] = data
        return data


def _transform(node: Mapping[str, Any]) -> NDArray[np.float64]:
    """Return a node's matrix, (4, 4), which acts on columns."""
    if "matrix" in node:
        return _vector(node["matrix"], 16, "matrix").reshape(4, 4).T
    x, y, z, w = _vector(node.get("rotation", [0, 0, 0, 1]), 4, "rotation")
    turned = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    found = np.eye(4)
    found[:3, :3] = turned * _vector(node.get("scale", [1, 1, 1]), 3, "scale")
    found[:3, 3] = _vector(node.get("translation", [0, 0, 0]), 3, "translation")
    return found


def _vector(given: Any, many: int, name: str) -> NDArray[np.float64]:
    numbers = isinstance(given, list) and all(isinstance(n, int | float) and abs(n) < 1e12 for n in given)
    if not numbers or len(given) != many:
        raise _Wrong(f"has a {name} that is not {many} numbers")
    return np.array(given, np.float64)


def _unit(vectors: NDArray[Any]) -> NDArray[Any]:
    """Return vectors of length 1; those of none point up as glTF has it."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(lengths > 0, vectors / np.maximum(lengths, 1e-300), [0.0, 1.0, 0.0])


def _upright(vectors: Floats) -> Floats:
    """Turn glTF's axes, y up and z to the viewer, into east, north and up."""
    return np.stack([vectors[..., 0], -vectors[..., 2], vectors[..., 1]], axis=-1)

"""The triangles of glTF 2.0 files: places, normals and colours, in metres, z up.

trimesh reads ``.glb``, or ``.gltf`` whose buffers are inside it: the nodes of its scene with their
transforms, meshes of triangles, POSITION, NORMAL, COLOR_0. The base colour of materials is read, too;
textures, skins, animations and cameras are not. A file is a stranger's: its JSON is looked at first, so that
what it asks for has a bound.

Source: Khronos Group 2021, "glTF 2.0 Specification" (section 3.5 for nodes, 3.6 for accessors, 4.4 for GLB).
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.extras import needs
from playground.files import read_regular, reason, require_regular
from playground.json_text import read_json

Floats = NDArray[np.float32]
Json = Mapping[str, Any]

MAX_BYTES = 32 * 2**20
MAX_TRIANGLES = 2**16
MAX_PARTS = 2**12  # primitives, each as often as a node shows it
MAX_NUMBERS = 2**22  # in accessors; with 3 corners of 11 numbers each the most triangles have half of them
_MAX_NODES = 2**14
_MAX_DISTANCE = 1e12  # [m] of places, and the most that a number of a transform may be
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_MODES = ("points", "lines", "a line loop", "a line strip", "triangles", "a triangle strip", "a triangle fan")
_KNOWN = (
    "KHR_mesh_quantization",
    "KHR_materials_unlit",
)  # extensions that need no reading here


@dataclass(frozen=True, slots=True)
class Model:
    """Triangles, each with its own three corners."""

    corners: Floats  # (n, 3, 3) [m] east, north, up
    normals: Floats  # (n, 3, 3) unit vectors
    colours: Floats  # (n, 3, 3) linear, 0..1


class _Wrong(Exception):
    """What is wrong with a file, as text that follows its name."""


def read_model(path: Path) -> Model:
    """Return the triangles of a file.

    Raises:
        DataError: missing, too large, damaged, without triangles, or with what is not read here; trimesh,
            which reads it, is not installed.
    """
    try:
        if require_regular(path).st_size > MAX_BYTES:
            raise _Wrong(f"is larger than {MAX_BYTES >> 20} MB, the most that a model may have")
        if find_spec("trimesh") is None:
            raise DataError(needs("a model", "trimesh", "models"), file=path)
        data = read_regular(path)
        header = _header(data)
        _check(header)
        with np.errstate(all="ignore"):  # what became of overflow is looked at, number by number
            return _triangles(data, header)
    except _Wrong as wrong:
        raise DataError(f"this model {wrong}", file=path) from None
    except OSError as error:
        raise DataError(f"this model cannot be read: {error.strerror}", file=path) from None
    except DataError:
        raise
    except Exception as error:  # trimesh raises a dozen kinds for damage
        what = f": {reason(error)}" if isinstance(error, ValueError) else ""
        raise DataError(f"this model is not as glTF 2.0 has it{what}", file=path) from None


# ── what a file asks for ─────────────────────────────────────────────────────


def _header(data: bytes) -> Json:
    """Return the JSON of a file."""
    text = data
    if data[:4] == b"glTF":
        if len(data) < 20:
            raise _Wrong("ends within its header; a GLB of 20 bytes or more was expected")
        version, length, chunk = struct.unpack_from("<III", data, 4)
        if version != 2:
            raise _Wrong(f"is glTF {version}; version 2 was expected")
        if length > len(data):
            raise _Wrong(f"ends after {len(data)} bytes of the {length} that its header says")
        text = data[20 : 20 + chunk]
    try:
        header = read_json(text.decode("utf-8"))
    except ValueError:
        raise _Wrong("is neither GLB nor JSON; glTF 2.0, .glb or .gltf, was expected") from None
    if not isinstance(header, dict) or not isinstance(header.get("asset"), dict):
        raise _Wrong("is JSON, but no glTF: it has no 'asset'")
    if not str(header["asset"].get("version", "")).startswith("2"):
        raise _Wrong(f"is glTF {str(header['asset'].get('version'))[:60]}; version 2 was expected")
    return header


def _check(header: Json) -> None:
    """Refuse what is not read here, and what becomes more than a model may have."""
    needed = [name for name in _list(header, "extensionsRequired", str) if name not in _KNOWN]
    if needed:
        raise _Wrong(f"needs {needed[0][:60]}, which is not read here; export it without compression")
    for buffer in _list(header, "buffers"):
        uri = buffer.get("uri", "data:")
        if not isinstance(uri, str) or not uri.startswith("data:"):
            raise _Wrong(f"has its data in another file, {str(uri)[:60]}; one file, .glb, was expected")
    if sum(_whole(view, "byteLength") for view in _list(header, "bufferViews")) > 4 * MAX_BYTES:
        raise _Wrong("has views of its buffers that are larger than these by far")
    numbers = 0
    for accessor in _list(header, "accessors"):
        if "sparse" in accessor or "bufferView" not in accessor:
            raise _Wrong("has numbers that are sparse or compressed, which are not read here")
        numbers += _whole(accessor, "count") * _WIDTHS.get(str(accessor.get("type")), 1)
    if numbers > MAX_NUMBERS:
        raise _Wrong(f"has more than {MAX_NUMBERS} numbers in its accessors")
    meshes = [_list(mesh, "primitives") for mesh in _list(header, "meshes")]
    for primitive in (part for mesh in meshes for part in mesh):
        mode = primitive.get("mode", 4)
        if type(mode) is not int or mode != 4:
            named = (
                _MODES[mode] if type(mode) is int and 0 <= mode < len(_MODES) else f"mode {str(mode)[:60]}"
            )
            raise _Wrong(f"has {named}; triangles (mode 4) were expected")
        if "POSITION" not in primitive.get("attributes", {}):
            raise _Wrong("has a mesh without POSITION")
    nodes, scenes = _list(header, "nodes"), _list(header, "scenes")
    children = [child for node in nodes for child in _list(node, "children", int)]
    roots = {root for scene in scenes for root in _list(scene, "nodes", int)}
    if max(len(nodes), len(children)) > _MAX_NODES:
        raise _Wrong(f"has more than {_MAX_NODES} nodes")
    if len(set(children)) < len(children) or not roots.isdisjoint(children):
        raise _Wrong("has a node inside itself, or inside two others")
    if any(not 0 <= node < len(nodes) for node in (*children, *roots)):
        raise _Wrong(f"names a node that is not among its {len(nodes)}")
    shown = [_whole(node, "mesh") for node in nodes if "mesh" in node]
    if any(mesh >= len(meshes) for mesh in shown):
        raise _Wrong(f"names meshes[{max(shown)}], which it does not have")
    if sum(len(meshes[mesh]) for mesh in shown) > MAX_PARTS:
        raise _Wrong(f"has more than {MAX_PARTS} parts")


def _list(owner: Json, key: str, kind: type = dict) -> list[Any]:
    """Return a list of an object, of objects unless another kind is named; none is empty."""
    values = owner.get(key, [])
    if not isinstance(values, list) or not all(type(each) is kind for each in values):
        raise _Wrong(f"has {key} {str(values)[:60]}; a list was expected")
    return values


def _whole(owner: Json, key: str) -> int:
    number = owner.get(key)
    if type(number) is not int or number < 0:
        raise _Wrong(f"has a {key} {str(number)[:60]}; a whole number was expected")
    return number


# ── what trimesh reads of it ─────────────────────────────────────────────────


def _triangles(data: bytes, header: Json) -> Model:
    from trimesh.exchange.gltf import load_glb, load_gltf

    load = load_glb if data[:4] == b"glTF" else load_gltf
    scene = load(BytesIO(data), resolver=None, skip_materials=True)  # it opens no other file, and no picture
    parts = list(_parts(scene, header))
    if not parts:
        raise _Wrong("has no triangles in its scene")
    corners, normals, colours = (np.concatenate(each) for each in zip(*parts, strict=True))
    if not (np.abs(corners) < _MAX_DISTANCE).all():
        raise _Wrong(f"has places more than {_MAX_DISTANCE:.0e} m away")
    return Model(_upright(corners), _upright(normals), np.clip(colours, 0.0, 1.0).astype(np.float32))


def _parts(scene: Json, header: Json) -> Iterator[tuple[NDArray[Any], NDArray[Any], NDArray[Any]]]:
    """Yield corners, normals and colours, (n, 3, 3) each, of all parts where its nodes show them."""
    primitives = [part for mesh in header.get("meshes", []) for part in mesh["primitives"]]
    kinds = dict(zip(scene["geometry"], primitives, strict=True))
    frames, left = {scene["base_frame"]: np.eye(4)}, MAX_TRIANGLES
    for edge in scene["graph"]:  # a node comes after the one that it is inside of
        if edge["frame_from"] not in frames:
            raise _Wrong("has a node inside a camera, which is not read here")
        matrix = frames[edge["frame_to"]] = frames[edge["frame_from"]] @ edge["matrix"]
        if not (np.abs(matrix) < _MAX_DISTANCE).all():
            raise _Wrong(f"has a transform whose numbers are {_MAX_DISTANCE:.0e} or more")
        if "geometry" in edge:
            geometry = scene["geometry"][edge["geometry"]]
            left -= len(geometry["faces"])
            if left < 0:
                raise _Wrong(f"has more than {MAX_TRIANGLES} triangles")
            yield _part(geometry, kinds[edge["geometry"]], header, matrix)


def _part(
    geometry: Json, primitive: Json, header: Json, matrix: NDArray[np.float64]
) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    order, count = geometry["faces"], len(geometry["vertices"])
    if order.dtype.kind not in "iu" or order.size == 0 or order.min() < 0 or order.max() >= count:
        raise _Wrong(f"has indices that are not those of its {count} places")
    turn = matrix[:3, :3]
    if np.linalg.det(turn) < 0:  # mirrored: the front would be the back
        order = order[:, ::-1]

    def numbers(key: str, name: str) -> NDArray[np.float64]:
        """Return an attribute of each corner, three numbers; whole ones that are normalised become -1..1."""
        array: NDArray[Any] = geometry[key]
        if array.ndim != 2 or array.shape[1] < 3 or len(array) != count:
            raise _Wrong(f"has {name} of a form that is not read; 3 numbers for each place were expected")
        array = array[order, :3]  # only what the triangles use: places may be shared by many parts
        if not np.isfinite(array).all():
            raise _Wrong(f"has {name} that are no numbers")
        stated = header["accessors"][primitive["attributes"][name]].get("normalized", False)
        whole = stated and array.dtype.kind in "iu"
        return np.maximum(array / np.iinfo(array.dtype).max, -1.0) if whole else array.astype(np.float64)

    corners = numbers("vertices", "POSITION") @ turn.T + matrix[:3, 3]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.repeat(_unit(flat)[:, None], 3, axis=1)
    if "vertex_normals" in geometry:
        turned = numbers("vertex_normals", "NORMAL") @ _normal_matrix(turn)
        normals = np.where(np.any(turned, axis=2, keepdims=True), _unit(turned), normals)
    material = header["materials"][primitive["material"]] if "material" in primitive else {}
    base = np.array(material.get("pbrMetallicRoughness", {}).get("baseColorFactor", [1, 1, 1, 1]), np.float64)
    colours = np.broadcast_to(base[:3], corners.shape)
    if "vertex_colors" in geometry:
        colours = numbers("vertex_colors", "COLOR_0") * base[:3]
    return corners, normals, colours


def _normal_matrix(turn: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the matrix that normals as rows are multiplied with, of any length, from that of places."""
    largest = np.abs(turn).max()
    return np.linalg.pinv(turn / largest) if largest > 0 else np.zeros((3, 3))


def _unit(vectors: NDArray[Any]) -> NDArray[Any]:
    """Return vectors of length 1; those of none point up as glTF has it."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(lengths > 0, vectors / np.maximum(lengths, 1e-300), [0.0, 1.0, 0.0])


def _upright(vectors: NDArray[np.float64]) -> Floats:
    """Turn glTF's axes, y up and z to the viewer, into east, north and up."""
    return np.stack([vectors[..., 0], -vectors[..., 2], vectors[..., 1]], axis=-1).astype(np.float32)

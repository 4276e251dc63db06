"""Read the triangles of a glTF 2.0 file: places, normals and colours, in metres, z up.

``.glb``, or ``.gltf`` whose buffers are inside it. What is read of it: the nodes of its scene with their
transforms, meshes of triangles, POSITION, NORMAL, COLOR_0, and the base colour of materials. What is not:
textures, skins, animations, cameras. How much work a file may ask for has a bound: nodes,
parts and triangles, each as often as it is used. ``model_document`` reads and checks the entries.

Source: Khronos Group 2021, "glTF 2.0 Specification" (section 3.5 for nodes, 3.7 for meshes).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.data.model_document import (
    MOST_BYTES,
    MOST_TRIANGLES,
    Document,
    WrongModel,
    brief,
    is_whole,
    list_of,
    object_of,
    read_document,
)
from playground.errors import DataError
from playground.regular_file import read_regular, require_regular

Floats = NDArray[np.float32]

MOST_PARTS = 2**12  # primitives, each as often as a node shows it
_DEEPEST = 64  # nodes inside each other
_MOST_NODES = 2**14  # each as often as it is named
_FARTHEST = 1e12  # [m] of places, and the most that a number of a transform may be
_MODES = ("points", "lines", "a line loop", "a line strip", "triangles", "a triangle strip", "a triangle fan")


@dataclass(frozen=True, slots=True)
class Model:
    """Triangles, each with its own three corners."""

    corners: Floats  # (n, 3, 3) [m] east, north, up
    normals: Floats  # (n, 3, 3) unit vectors
    colours: Floats  # (n, 3, 3) linear, 0..1


def read_model(path: Path) -> Model:
    """Return the triangles of a file.

    Raises:
        DataError: missing, too large, damaged, without triangles, or with what is not read here.
    """
    try:
        if require_regular(path).st_size > MOST_BYTES:
            raise WrongModel(f"is larger than {MOST_BYTES >> 20} MB, the most that a model may have")
        document = read_document(read_regular(path))
        with np.errstate(all="ignore"):  # what became of overflow is looked at, number by number
            return _Reader(document).model()
    except WrongModel as wrong:
        raise DataError(f"this model {wrong}", file=path) from None
    except (TypeError, AttributeError, LookupError, np.linalg.LinAlgError):
        raise DataError("this model is not as glTF 2.0 has it", file=path) from None
    except OSError as error:
        raise DataError(f"this model cannot be read: {error.strerror}", file=path) from None


class _Reader:
    """Reads the scene of one document."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.left = MOST_TRIANGLES
        self.parts_left = MOST_PARTS
        self.nodes_left = _MOST_NODES

    def model(self) -> Model:
        parts = list(self._scene())
        if not parts:
            raise WrongModel("has no triangles in its scene")
        corners, normals, colours = (np.concatenate(each) for each in zip(*parts, strict=True))
        if not (np.abs(corners) < _FARTHEST).all():
            raise WrongModel(f"has places more than {_FARTHEST:.0e} m away")
        return Model(_upright(corners), _upright(normals), np.clip(colours, 0.0, 1.0).astype(np.float32))

    def _scene(self) -> Iterator[tuple[NDArray[Any], NDArray[Any], NDArray[Any]]]:
        if list_of(self.document.json, "scenes"):
            scene = self.document.entry("scenes", self.document.json.get("scene", 0))
            roots = list_of(scene, "nodes")
        else:
            nodes = [
                self.document.entry("nodes", k) for k in range(len(list_of(self.document.json, "nodes")))
            ]
            inner = {brief(child) for node in nodes for child in list_of(node, "children")}
            roots = [k for k in range(len(nodes)) if str(k) not in inner]
        for root in roots:
            yield from self._node(root, np.eye(4), 0)

    def _node(
        self, index: Any, outer: NDArray[np.float64], depth: int
    ) -> Iterator[tuple[NDArray[Any], NDArray[Any], NDArray[Any]]]:
        if depth > _DEEPEST:
            raise WrongModel(f"has nodes more than {_DEEPEST} deep in each other, or a node inside itself")
        self.nodes_left -= 1
        if self.nodes_left < 0:
            raise WrongModel(f"has more than {_MOST_NODES} nodes")
        node = self.document.entry("nodes", index)
        matrix = outer @ _transform(node)
        if not (np.abs(matrix) < _FARTHEST).all():
            raise WrongModel(f"has a transform whose numbers are {_FARTHEST:.0e} or more")
        if "mesh" in node:
            for primitive in list_of(self.document.entry("meshes", node["mesh"]), "primitives"):
                yield self._triangles(object_of(primitive, "primitives"), matrix)
        for child in list_of(node, "children"):
            yield from self._node(child, matrix, depth + 1)

    def _triangles(
        self, primitive: Mapping[str, Any], matrix: NDArray[np.float64]
    ) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
        """Return corners, normals and colours of a primitive, (n, 3, 3) each."""
        self.parts_left -= 1
        if self.parts_left < 0:
            raise WrongModel(f"has more than {MOST_PARTS} parts")
        _check_mode(primitive.get("mode", 4))
        attributes = object_of(primitive.get("attributes", {}), "attributes")
        if "POSITION" not in attributes:
            raise WrongModel("has a mesh without POSITION")
        places = self.document.numbers(attributes["POSITION"], "POSITION", (3,))
        count = len(places)
        order = self.document.indices(primitive["indices"]) if "indices" in primitive else np.arange(count)
        if len(order) % 3 or order.max() >= count:
            what = f"{len(order)} indices into {count} places"
            raise WrongModel(f"has {what}; threes of indices below that number were expected")
        self.left -= len(order) // 3
        if self.left < 0:
            raise WrongModel(f"has more than {MOST_TRIANGLES} triangles")
        turn = matrix[:3, :3]
        if np.linalg.det(turn) < 0:  # mirrored: the front would be the back
            order = order.reshape(-1, 3)[:, ::-1].ravel()
        # Only what the triangles use is transformed: places may be shared by many parts.
        corners = (places[order] @ turn.T + matrix[:3, 3]).reshape(-1, 3, 3)
        flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals = np.repeat(_unit(flat)[:, None], 3, axis=1)
        if "NORMAL" in attributes:
            given = self.document.numbers(attributes["NORMAL"], "NORMAL", (3,), count)[order]
            turned = (given @ _normal_matrix(turn)).reshape(-1, 3, 3)
            normals = np.where(np.any(turned, axis=2, keepdims=True), _unit(turned), normals)
        base = np.ones(3)
        if "material" in primitive:
            material = self.document.entry("materials", primitive["material"])
            rough = object_of(material.get("pbrMetallicRoughness", {}), "pbrMetallicRoughness")
            base = _vector(rough.get("baseColorFactor", [1, 1, 1, 1]), 4, "baseColorFactor")[:3]
        colours = np.broadcast_to(base, (len(order), 3))
        if "COLOR_0" in attributes:
            tints = self.document.numbers(attributes["COLOR_0"], "COLOR_0", (3, 4), count)
            colours = tints[order, :3] * base
        return corners, normals, colours.reshape(-1, 3, 3)


def _check_mode(mode: Any) -> None:
    if not is_whole(mode) or mode != 4:
        named = _MODES[mode] if is_whole(mode) and 0 <= mode < len(_MODES) else f"mode {brief(mode)}"
        raise WrongModel(f"has {named}; triangles (mode 4) were expected")


def _normal_matrix(turn: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the matrix that normals as rows are multiplied with, of any length, from that of places."""
    largest = np.abs(turn).max()
    return np.linalg.pinv(turn / largest) if largest > 0 else np.zeros((3, 3))


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
    numbers = isinstance(given, list) and all(
        isinstance(n, int | float) and not isinstance(n, bool) and abs(n) < _FARTHEST for n in given
    )
    if not numbers or len(given) != many:
        raise WrongModel(f"has a {name} that is not {many} numbers")
    return np.array(given, np.float64)


def _unit(vectors: NDArray[Any]) -> NDArray[Any]:
    """Return vectors of length 1; those of none point up as glTF has it."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(lengths > 0, vectors / np.maximum(lengths, 1e-300), [0.0, 1.0, 0.0])


def _upright(vectors: NDArray[np.float64]) -> Floats:
    """Turn glTF's axes, y up and z to the viewer, into east, north and up."""
    return np.stack([vectors[..., 0], -vectors[..., 2], vectors[..., 1]], axis=-1).astype(np.float32)

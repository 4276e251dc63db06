"""Models from glTF files: what is read of them, against what was written; damaged ones say so."""

from __future__ import annotations

import base64
import json
import struct

import numpy as np
import pytest

from playground.errors import DataError
from playground.terrain.model_files import MOST_TRIANGLES, read_model
from playground.terrain.model_source import CORNERS, make_model, size_of_model

from ..models import DATA, FILES

PLACES = np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]], "<f4")
INDICES = np.array([0, 1, 2, 0, 2, 3], "<u2")
COLOURS = np.array([[255, 0, 0], [0, 255, 0], [0, 0, 255], [51, 102, 204]], "u1")


def document(**changes):
    """Return a glTF of two triangles; ``changes`` replace entries by "path.to.it"."""
    blob = PLACES.tobytes() + INDICES.tobytes() + COLOURS.tobytes()
    found = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4},
            {"bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 6},
            {"bufferView": 2, "componentType": 5121, "type": "VEC3", "count": 4, "normalized": True},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 12},
            {"buffer": 0, "byteOffset": 60, "byteLength": 12},
        ],
        "buffers": [{"byteLength": len(blob), "uri": "data:a/b;base64," + base64.b64encode(blob).decode()}],
    }
    for path, value in changes.items():
        at, *keys = [int(key) if key.isdigit() else key for key in path.split("__")]
        inner, key = found, at
        for following in keys:
            inner, key = inner[key], following
        inner[key] = value
    return found


@pytest.fixture
def read(tmp_path):
    def read_(found, name="a.gltf"):
        path = tmp_path / name
        path.write_bytes(found if isinstance(found, bytes) else json.dumps(found).encode())
        return read_model(path)

    return read_


def upright(places):
    """Turn y up into z up."""
    return np.stack([places[..., 0], -places[..., 2], places[..., 1]], -1)


def test_triangles_come_upright_with_their_own_faces_normals(read):
    model = read(document())
    np.testing.assert_array_equal(model.corners, upright(PLACES[INDICES]).reshape(2, 3, 3))
    np.testing.assert_allclose(model.normals[:, 0], upright(np.array([[0, 0, 1], [1, 0, 0]])), atol=1e-7)
    assert (model.colours == 1).all()


def test_colours_are_the_material_s_times_the_corners(read):
    model = read(
        document(
            meshes__0__primitives__0__attributes={"POSITION": 0, "COLOR_0": 2},
            meshes__0__primitives__0__material=0,
            materials=[{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 0.25, 1]}}],
        )
    )
    wanted = COLOURS[INDICES].reshape(2, 3, 3) / 255 * [0.5, 1, 0.25]
    np.testing.assert_allclose(model.colours, wanted, atol=1e-6)


def test_nodes_move_what_is_in_them(read):
    """Scaled, turned a quarter about y, moved; inside a node that moves again, by a matrix of columns."""
    inner = {"mesh": 0, "scale": [2, 1, 1], "rotation": [0, 0.5**0.5, 0, 0.5**0.5], "translation": [0, 0, 5]}
    outer = {"children": [1], "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 20, 30, 1]}
    model = read(document(nodes=[outer, inner]))
    x, y, z = (PLACES * [2, 1, 1]).T
    moved = np.stack([z + 10, y + 20, 35 - x], 1)
    np.testing.assert_allclose(model.corners, upright(moved[INDICES]).reshape(2, 3, 3), atol=1e-6)
    # Mirrored, the front stays in front: normals point away from where they pointed, mirrored.
    mirrored = read(document(nodes=[{"mesh": 0, "scale": [1, 1, -1]}]))
    face = mirrored.corners[0]
    np.testing.assert_allclose(
        mirrored.normals[0, 0], np.cross(face[1] - face[0], face[2] - face[0]) / 2, atol=1e-6
    )
    np.testing.assert_allclose(mirrored.normals[0, 0], upright(np.array([0, 0, -1])), atol=1e-6)


@pytest.mark.parametrize("name", list(FILES))
def test_the_shipped_models_are_what_the_script_makes(name):
    data = (DATA / name).read_bytes()
    assert data == FILES[name]() and len(data) < 30_000
    model = read_model(DATA / name)
    assert 0.9 < np.ptp(model.corners[..., 2 if name == "conifer.glb" else 0]) < 1.1
    # Faces look outwards: of a closed body the volume is positive, a tree's skirts are open below.
    a, b, c = model.corners.transpose(1, 0, 2).astype(float)
    assert (np.cross(a, b) * c).sum() > 0
    assert np.allclose(np.linalg.norm(model.normals, axis=-1), 1, atol=1e-5)


def test_texels_hold_corner_after_corner(tmp_path):
    path = tmp_path / "a.gltf"
    path.write_text(json.dumps(document()))
    size = size_of_model({"model": str(path)})
    made = make_model({"model": str(path)}, size)
    assert size == (CORNERS, 1) and made["place"].shape == (1, CORNERS, 4)
    np.testing.assert_array_equal(made["place"][0, :6, :3], upright(PLACES[INDICES]))
    assert (made["place"][0, :, 3] == [1] * 6 + [0] * (CORNERS - 6)).all()
    with pytest.raises(DataError, match="has 6 corners; 4 texels were expected"):
        make_model({"model": str(path)}, (4, 1))


GLB = struct.pack("<III", 0x46546C67, 2, 24) + struct.pack("<II", 4, 0x4E4F534A) + b"{}  "


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (b"solid ascii", "is neither GLB nor JSON; glTF 2.0"),
        (b"[1]", "is JSON, but no glTF"),
        (GLB, "is JSON, but no glTF"),
        (GLB[:22], "ends after 22 bytes of the 24"),
        (GLB[:4] + struct.pack("<II", 1, 24) + GLB[12:], "is glTF 1; version 2 was expected"),
        (document(asset={"version": "1.0"}), "is glTF 1.0"),
        (document(extensionsRequired=["KHR_draco_mesh_compression"]), "needs KHR_draco_mesh_compression"),
        (document(nodes=[{"children": [0]}]), "a node inside itself"),
        (document(scenes=[{"nodes": [3]}]), r"names nodes\[3\], which it does not have"),
        (document(meshes=[]), r"names meshes\[0\]"),
        (document(scenes=[{"nodes": []}]), "has no triangles in its scene"),
        (document(meshes__0__primitives__0__mode=1), r"has lines; triangles \(mode 4\) were expected"),
        (document(meshes__0__primitives__0__attributes={}), "without POSITION"),
        (document(accessors__0__count=9), "ends before its POSITION do"),
        (document(accessors__0__componentType=5), "POSITION of a form that is not read"),
        (document(accessors__1__count=5), "5 indices into 4 places"),
        (document(accessors__0__count=2), "6 indices into 2 places"),
        (document(accessors__1__count=10**9), "has 1000000000 of indices"),
        (document(bufferViews__0__byteOffset=-4), "has POSITION at no place that can be"),
        (document(buffers__0__uri="model.bin"), "has its data in another file, model.bin; one file, .glb"),
        (document(buffers__0__uri="data:a/b;base64,%"), "has damaged data"),
        (document(nodes=[{"mesh": 0, "matrix": [1, 2]}]), "has a matrix that is not 16 numbers"),
    ],
)
def test_what_is_wrong_is_said_in_a_sentence(read, wrong, message):
    with pytest.raises(DataError, match=f"this model .*{message}"):
        read(wrong)


def test_a_model_has_a_bound(read, tmp_path):
    indices = np.zeros(3 * (MOST_TRIANGLES // 2 + 1), "<u2")
    blob = PLACES.tobytes() + indices.tobytes()
    found = document(
        buffers=[{"byteLength": len(blob), "uri": "data:a/b;base64," + base64.b64encode(blob).decode()}],
        accessors__1__count=len(indices),
        bufferViews__1__byteLength=indices.nbytes,
        nodes=[{"mesh": 0}, {"mesh": 0}],
        scenes=[{"nodes": [0, 1]}],
    )
    with pytest.raises(DataError, match=f"has more than {MOST_TRIANGLES} triangles"):
        read(found)
    with pytest.raises(DataError, match="cannot be read: No such file"):
        read_model(tmp_path / "none.glb")

"""Models from glTF files: what is read of them, against what was written; damaged ones say so."""

from __future__ import annotations

import base64
import json
import os
import re
import struct

import numpy as np
import pytest

from playground.data import models
from playground.data.models import MAX_NUMBERS, MAX_PARTS, MAX_TRIANGLES, read_model
from playground.engine import file_sources
from playground.engine.file_sources import CORNERS, make_model, size_of_model
from playground.errors import DataError
from playground.extras import install_command

from ..models import DATA, FILES

PLACES = np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]], "<f4")
INDICES = np.array([0, 1, 2, 0, 2, 3], "<u2")
COLOURS = np.array([[255, 0, 0], [0, 255, 0], [0, 0, 255], [51, 102, 204]], "u1")


def document(**changes):
    """Return a glTF of two triangles; ``changes`` replace entries by "path.to.it"."""
    blob = PLACES.tobytes() + INDICES.tobytes() + COLOURS.tobytes()
    result = {
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
        inner, key = result, at
        for following in keys:
            inner, key = inner[key], following
        inner[key] = value
    return result


def rough(value):
    """Return a document whose material has that in place of an object."""
    return document(meshes__0__primitives__0__material=0, materials=[{"pbrMetallicRoughness": value}])


def with_blob(data, **changes):
    """Return a document whose buffer is that."""
    text = "data:a/b;base64," + base64.b64encode(data).decode()
    return document(buffers=[{"byteLength": len(data), "uri": text}], **changes)


def indexed(kind, last):
    """Return a document with indices of a component type, the last of them as given."""
    numbers = np.array([0, 1, 2, 0, 2, last], {5120: "i1", 5122: "<i2", 5123: "<u2", 5126: "<f4"}[kind])
    data = PLACES.tobytes() + numbers.tobytes()
    view = {"buffer": 0, "byteOffset": 48, "byteLength": numbers.nbytes}
    return with_blob(data, accessors__1__componentType=kind, bufferViews__1=view, bufferViews__2=view)


def placed_at(number):
    """Return a document with one number of a place as given."""
    places = PLACES.copy()
    places[1, 0] = number
    return with_blob(places.tobytes() + INDICES.tobytes() + COLOURS.tobytes())


def nested(scale, deep):
    """Return a document whose mesh, with normals, is inside so many nodes of a scale."""
    nodes = [{"scale": scale, "children": [k + 1]} for k in range(deep)] + [{"mesh": 0, "scale": scale}]
    return document(nodes=nodes, meshes__0__primitives__0__attributes={"POSITION": 0, "NORMAL": 0})


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
    expected = COLOURS[INDICES].reshape(2, 3, 3) / 255 * [0.5, 1, 0.25]
    np.testing.assert_allclose(model.colours, expected, atol=1e-6)


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
        (document(nodes=[{"children": [1] * 200}, {"children": [2] * 200}, {}]), "or inside two others"),
        (document(nodes=[{}] * 20000), "has more than 16384 nodes"),
        (document(scenes=[{"nodes": [3]}]), "names a node that is not among its 1"),
        (document(meshes=[]), r"names meshes\[0\]"),
        (document(scenes=[{"nodes": []}]), "has no triangles in its scene"),
        (document(meshes__0__primitives__0__mode=1), r"has lines; triangles \(mode 4\) were expected"),
        (document(meshes__0__primitives__0__attributes={}), "without POSITION"),
        (document(accessors__0__count=9), "is not as glTF 2.0 has it: cannot reshape"),
        (document(accessors__0__componentType=5), "is not as glTF 2.0 has it"),
        (document(accessors__1__count=5), "is not as glTF 2.0 has it: cannot reshape array of size 5"),
        (document(accessors__0__count=2), "has indices that are not those of its 2 places"),
        (document(accessors__1__count=10**9), "has more than 4194304 numbers in its accessors"),
        (document(bufferViews__0__byteOffset=-4), "is not as glTF 2.0 has it"),
        (document(buffers__0__uri="model.bin"), "has its data in another file, model.bin; one file, .glb"),
        (document(buffers__0__uri="data:a/b;base64,%"), "is not as glTF 2.0 has it"),
        (document(nodes=[{"mesh": 0, "matrix": [1, 2]}]), "is not as glTF 2.0 has it: cannot reshape"),
        # What is of another kind than it should be.
        (document(extensionsRequired=None), "has extensionsRequired None; a list was expected"),
        (document(scenes=[], nodes={"mesh": 0}), "has nodes {'mesh': 0}; a list was expected"),
        (document(scenes=[], nodes=[4]), r"has nodes \[4\]; a list was expected"),
        (document(scenes=[{"nodes": [True]}]), r"has nodes \[True\]; a list was expected"),
        (document(meshes__0__primitives=[9]), r"has primitives \[9\]; a list was expected"),
        (document(meshes__0__primitives__0__mode=1.0), r"has mode 1.0; triangles \(mode 4\) were"),
        (document(meshes__0__primitives__0__indices=None), "is not as glTF 2.0 has it"),
        (rough(None), "is not as glTF 2.0 has it"),
        (document(accessors__0__type=["VEC3"]), "is not as glTF 2.0 has it"),
        # Indices are whole numbers from 0; none is no triangle.
        (indexed(5126, 0), "has indices that are not those of its 4 places"),
        (indexed(5122, -1), "has indices that are not those of its 4 places"),
        (indexed(5123, 4), "has indices that are not those of its 4 places"),
        (document(accessors__1__count=0), "has indices that are not those of its 4 places"),
        (
            document(accessors__0__count=0, meshes__0__primitives__0__attributes={"POSITION": 0}),
            "has indices that are not those of its 0 places",
        ),
        # Numbers that are none, or too far away to be a place.
        (placed_at(np.nan), "has POSITION that are no numbers"),
        (placed_at(3e38), "has places more than 1e[+]12 m away"),
        (nested([1e11] * 3, 40), "has a transform whose numbers are 1e[+]12 or more"),
    ],
)
def test_what_is_wrong_is_said_in_a_sentence(read, wrong, message):
    with pytest.raises(DataError, match=f"this model .*{message}"):
        read(wrong)


def test_a_model_has_a_bound(read, tmp_path):
    indices = np.zeros(3 * (MAX_TRIANGLES // 2 + 1), "<u2")
    blob = PLACES.tobytes() + indices.tobytes()
    result = document(
        buffers=[{"byteLength": len(blob), "uri": "data:a/b;base64," + base64.b64encode(blob).decode()}],
        accessors__1__count=len(indices),
        bufferViews__1__byteLength=indices.nbytes,
        nodes=[{"mesh": 0}, {"mesh": 0}],
        scenes=[{"nodes": [0, 1]}],
    )
    with pytest.raises(DataError, match=f"has more than {MAX_TRIANGLES} triangles"):
        read(result)
    with pytest.raises(DataError, match="cannot be read: No such file"):
        read_model(tmp_path / "none.glb")


def test_what_nothing_is_left_of_has_its_own_normals(read):
    """Scaled by so little that a normal's length overflows: a triangle is still lit from somewhere."""
    model = read(nested([1e-200] * 3, 2))
    np.testing.assert_allclose(np.linalg.norm(model.normals, axis=-1), 1, atol=1e-6)
    small = read(nested([1e-9] * 3, 1))
    expected = np.where(PLACES.any(1)[:, None], PLACES, [0, 0, 1])[INDICES]
    expected = expected / np.linalg.norm(expected, axis=1, keepdims=True)
    corners = np.any(PLACES[INDICES], axis=1)
    result = small.normals.reshape(-1, 3)
    np.testing.assert_allclose(result[corners], upright(expected)[corners], atol=1e-6)


PART = {"attributes": {"POSITION": 0, "NORMAL": 0, "COLOR_0": 0}, "indices": 1}
MANY = np.zeros((3 * MAX_TRIANGLES, 3), "<f4").tobytes()


def much(nodes=1, parts=1, **changes):
    """Return parts of one triangle each out of as many places as a model may have, each used often."""
    data = MANY + INDICES[:3].tobytes()
    return with_blob(
        data,
        nodes=[{"mesh": 0}] * nodes,
        scenes=[{"nodes": list(range(nodes))}],
        meshes=[{"primitives": [PART] * parts}],
        accessors__0__count=3 * MAX_TRIANGLES,
        accessors__1__count=3,
        bufferViews__0__byteLength=len(MANY),
        bufferViews__1={"buffer": 0, "byteOffset": len(MANY), "byteLength": 6},
        **changes,
    )


def test_places_may_be_shared_by_many_parts(read):
    assert len(read(much(nodes=20, parts=5)).corners) == 100


@pytest.mark.slow
def test_parts_and_numbers_have_bounds(read):
    with pytest.raises(DataError, match=f"has more than {MAX_PARTS} parts"):
        read(much(nodes=MAX_PARTS // 64 + 1, parts=64))
    # Accessor after accessor over the same bytes, each of which would be read.
    result = much()
    result["accessors"] += [result["accessors"][0]] * 64
    result["meshes"][0]["primitives"] = [
        {"attributes": {"POSITION": k}, "indices": 1} for k in range(3, 3 + 64)
    ]
    with pytest.raises(DataError, match=f"has more than {MAX_NUMBERS} numbers"):
        read(result)


def test_a_whole_number_is_a_share_where_that_is_stated(read):
    """As files of quantised meshes have it: places of 16 bits, made larger by their node."""
    places = (PLACES * 10_000).astype("<i2")
    data = places.tobytes() + INDICES.tobytes()
    views = {f"bufferViews__{k}": {"buffer": 0, "byteOffset": 24, "byteLength": 12} for k in (1, 2)}
    model = read(
        with_blob(
            data,
            accessors__0__componentType=5122,
            accessors__0__normalized=True,
            nodes=[{"mesh": 0, "scale": [3.2767] * 3}],
            extensionsRequired=["KHR_mesh_quantization"],
            bufferViews__0={"buffer": 0, "byteLength": 24},
            **views,
        )
    )
    np.testing.assert_allclose(model.corners, upright(PLACES[INDICES]).reshape(2, 3, 3), atol=1e-6)


def test_a_file_of_pictures_and_of_other_files_opens_none(read, tmp_path, monkeypatch):
    result = document(images=[{"uri": "secret.png"}], textures=[{"source": 0}])
    (tmp_path / "secret.png").write_bytes(b"no picture")
    monkeypatch.setattr("PIL.Image.open", None)
    assert len(read(result).corners) == 2


def test_without_trimesh_the_extra_is_named(read, monkeypatch):
    monkeypatch.setattr(models, "find_spec", lambda _: None)
    with pytest.raises(DataError, match=f"a model needs trimesh: {re.escape(install_command('models'))}"):
        read(document())


def test_a_file_is_read_again_only_when_it_changes(tmp_path, monkeypatch):
    path = tmp_path / "a.gltf"
    path.write_text(json.dumps(document()))
    read_ = []
    monkeypatch.setattr(file_sources, "read_model", lambda value: read_.append(value) or read_model(value))
    values = {"model": str(path)}
    for _ in range(3):
        make_model(values, size_of_model(values))
    assert read_ == [path]
    result = document()
    result["nodes"][0]["translation"] = [5, 0, 0]
    path.write_text(json.dumps(result))
    assert make_model(values, size_of_model(values))["place"][0, 0, 0] == 5
    assert read_ == [path] * 2
    for far in range(6, 10):  # saves that keep inode, size and time of change
        time = path.stat().st_mtime_ns
        result["nodes"][0]["translation"] = [far, 0, 0]
        path.write_text(json.dumps(result))
        os.utime(path, ns=(time, time))
        assert make_model(values, size_of_model(values))["place"][0, 0, 0] == far

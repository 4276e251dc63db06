"""The terrain as a mesh, opened by trimesh: where its vertices are, which way it faces, its texture."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import PIL.Image
import pytest
import trimesh

import playground
from playground import Sketch
from playground.data.grid import fitted
from playground.engine.engine import Engine
from playground.publish.export import prepare, run
from playground.publish.export_formats import ExportOptions
from playground.publish.mesh import encode_glb, encode_obj, sampled, terrain_mesh

from .conftest import metres

ENDINGS = ["glb", "obj"]


def opened(path: Path) -> trimesh.Trimesh:
    """Open a mesh as its file has it, no vertex merged."""
    scene = trimesh.load_scene(path, process=False, maintain_order=True)
    (mesh,) = scene.geometry.values()
    (node,) = scene.graph.nodes_geometry
    np.testing.assert_array_equal(scene.graph[node][0], np.eye(4), "nothing is moved or turned")
    return mesh


def picture_of(mesh: trimesh.Trimesh) -> np.ndarray:
    material = mesh.visual.material
    picture = material.baseColorTexture if hasattr(material, "baseColorTexture") else material.image
    return np.asarray(picture.convert("RGB")).astype(int)


def document(path: Path) -> dict:
    data = path.read_bytes()
    length = struct.unpack("<I", data[12:16])[0]
    return json.loads(data[20 : 20 + length])


@pytest.mark.parametrize("ending", ENDINGS)
def test_vertices_stand_where_the_terrain_is(
    ending: str, any_engine: Engine, lop: Sketch, heightmap: np.ndarray, tmp_path: Path
):
    done = playground.export(lop, tmp_path / f"terrain.{ending}", engine=any_engine)
    mesh = opened(done.path)
    assert mesh.vertices.shape == (45, 3) and mesh.faces.shape == (64, 3)
    np.testing.assert_allclose(mesh.bounds, [[-400, 175, -150], [400, 925, 150]], rtol=1e-6)
    # The north-western corner is the highest: x least, z least.
    np.testing.assert_allclose(mesh.vertices[mesh.vertices[:, 1].argmax()], [-400, 925, -150], rtol=1e-6)
    for x, y, z in mesh.vertices:
        col, row = round((x + 400) / 100), round((z + 150) / 75)
        assert abs(y - heightmap[row, col]) < 1e-3
    assert "9 x 5 vertices, 64 triangles; 800 x 300 m, 175 to 925 m high; texture 17 x 13" in done.summary


@pytest.mark.parametrize("ending", ENDINGS)
def test_every_face_looks_up_and_none_is_missing(
    ending: str, any_engine: Engine, lop: Sketch, tmp_path: Path
):
    mesh = opened(playground.export(lop, tmp_path / f"terrain.{ending}", engine=any_engine).path)
    assert (mesh.face_normals[:, 1] > 0).all()
    a, b, c = (mesh.triangles[:, k][:, [0, 2]] for k in range(3))
    across = np.cross(np.c_[b - a, np.zeros(64)], np.c_[c - a, np.zeros(64)])[:, 2]
    assert np.abs(across).sum() / 2 == pytest.approx(800.0 * 300.0)
    assert len(mesh.outline().entities) == 1, "one rim: no hole, no crack"


@pytest.mark.parametrize("ending", ENDINGS)
def test_normals_are_those_of_the_slope(ending: str, any_engine: Engine, lop: Sketch, tmp_path: Path):
    fine = lop.with_values({"size": "65x33"})
    mesh = opened(playground.export(fine, tmp_path / f"terrain.{ending}", engine=any_engine).path)
    normals = mesh.vertex_normals  # from the file
    assert np.abs(np.linalg.norm(normals, axis=1) - 1.0).max() < 1e-5
    # The terrain's own derivatives; a finite difference of a parabola is off at the edges only.
    for (x, _, z), normal in zip(mesh.vertices[::7], normals[::7], strict=True):
        east, north = (x + 400) / 800, (150 - z) / 300
        to_east = 1000.0 * (-0.75 * north + 0.125 * east) / 800.0
        to_north = 1000.0 * 0.75 * (1.0 - east) / 300.0
        expected = np.array([-to_east, 1.0, to_north])
        expected /= np.linalg.norm(expected)
        assert normal @ expected > 1.0 - 1e-6


@pytest.mark.parametrize("ending", ENDINGS)
def test_the_texel_under_a_vertex_is_its_own(ending: str, any_engine: Engine, lop: Sketch, tmp_path: Path):
    """The colours are of 17 x 13 texels: those under the 9 x 5 vertices stand at every second and third."""
    mesh = opened(playground.export(lop, tmp_path / f"terrain.{ending}", engine=any_engine).path)
    picture, uv = picture_of(mesh), mesh.visual.uv
    assert picture.shape == (13, 17, 3)
    for (x, _, z), (u, v) in zip(mesh.vertices, uv, strict=True):
        # trimesh's v begins at the picture's foot, unlike the format's.
        col, row = u * 17 - 0.5, (1.0 - v) * 13 - 0.5
        assert abs(col - round(col)) < 1e-3 and abs(row - round(row)) < 1e-3, "in a texel's middle"
        east, north = (x + 400) / 800, (150 - z) / 300
        red, green = (
            255 * (12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055) for c in (east, north)
        )
        assert np.abs(picture[round(row), round(col)][:2] - [red, green]).max() <= 0.51


def test_a_glb_says_what_its_specification_asks(any_engine: Engine, lop: Sketch, tmp_path: Path):
    path = playground.export(lop, tmp_path / "terrain.glb", engine=any_engine).path
    data, gltf = path.read_bytes(), document(path)
    assert struct.unpack("<4sII", data[:12]) == (b"glTF", 2, len(data)) and len(data) % 4 == 0
    assert gltf["asset"]["version"] == "2.0"
    places = gltf["accessors"][gltf["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
    assert places["min"] == [-400.0, 175.0, -150.0] and places["max"] == [400.0, 925.0, 150.0]
    assert gltf["accessors"][3]["componentType"] == 5123
    assert all(view["byteOffset"] % 4 == 0 for view in gltf["bufferViews"])
    look = gltf["materials"][0]["pbrMetallicRoughness"]
    assert (look["metallicFactor"], look["roughnessFactor"]) == (0.0, 1.0)
    assert "extensions" not in gltf["materials"][0]


def test_light_is_baked_in_and_asks_for_no_other(any_engine: Engine, lop: Sketch, tmp_path: Path):
    done = playground.export(lop, tmp_path / "terrain.glb", light=True, engine=any_engine)
    gltf = document(done.path)
    assert gltf["materials"][0]["extensions"] == {"KHR_materials_unlit": {}} and gltf["extensionsUsed"]
    picture = picture_of(opened(done.path))
    # Blue is 0.25 everywhere; light grows from 0.5 in the south to 1.25 in the north.
    for row in range(13):
        linear = 0.25 * (1.25 - 0.75 * row / 12)
        assert abs(picture[row, 8, 2] - 255 * (1.055 * linear ** (1 / 2.4) - 0.055)) <= 0.51
    assert "outside 0 to 1" in done.warnings[0]
    playground.export(lop, tmp_path / "terrain.obj", light=True, engine=any_engine)
    assert "illum 0" in (tmp_path / "terrain.mtl").read_text()
    with PIL.Image.open(tmp_path / "terrain-texture.png") as texture:
        np.testing.assert_array_equal(np.asarray(texture), picture)


def test_another_texture_may_be_draped(any_engine: Engine, lop: Sketch, tmp_path: Path):
    done = playground.export(lop, tmp_path / "terrain.glb", texture="mix:weights", engine=any_engine)
    picture = picture_of(opened(done.path))
    assert picture.shape == (5, 9, 3)
    np.testing.assert_array_equal(picture[0, :, 0], np.rint(255 * np.arange(9) / 8))
    playground.export(lop, tmp_path / "terrain.glb", texture="height", engine=any_engine)
    grey = picture_of(opened(tmp_path / "terrain.glb"))
    np.testing.assert_array_equal(grey[0, 0], [223, 223, 223])  # 0.875
    with pytest.raises(playground.SketchError, match="no pass 'mixx'"):
        playground.export(lop, tmp_path / "terrain.glb", texture="mixx", engine=any_engine)


def test_terrain_without_colour_has_no_texture(any_engine: Engine, folder: Path, tmp_path: Path):
    text = (folder / "sketch.toml").read_text()
    start, end = text.index('[[pass]]\nname = "colour"'), text.index("[view]")
    (folder / "bare.toml").write_text(text[:start] + text[end:])
    bare = playground.load(folder / "bare.toml")
    for ending in ENDINGS:
        done = playground.export(bare, tmp_path / f"terrain.{ending}", engine=any_engine)
        assert "no texture: the view shows no colour" in done.summary
        assert opened(done.path).faces.shape == (64, 3)
    assert [path.name for path in done.sidecars] == ["terrain.mtl"]
    assert "map_Kd" not in (tmp_path / "terrain.mtl").read_text()
    with pytest.raises(playground.SketchError, match="has no light to bake in"):
        playground.export(bare, tmp_path / "terrain.glb", light=True, engine=any_engine)


def test_a_coarser_grid_lies_on_the_terrain(
    any_engine: Engine, lop: Sketch, heightmap: np.ndarray, tmp_path: Path
):
    mesh = opened(playground.export(lop, tmp_path / "terrain.glb", grid=5, engine=any_engine).path)
    assert len(mesh.vertices) == 15
    np.testing.assert_allclose(mesh.vertices[:, 1].reshape(3, 5), heightmap[::2, ::2], rtol=1e-6)
    done = playground.export(lop, tmp_path / "terrain.glb", grid=33, engine=any_engine)
    assert len(opened(done.path).vertices) == 45
    assert "the terrain has 9 texels on its longer side" in done.warnings[0]


def test_the_usual_grid_is_the_terrain_s_up_to_513(any_engine: Engine, lop: Sketch, tmp_path: Path):
    large = lop.with_values({"size": "1025x257"})
    done = playground.export(large, tmp_path / "terrain.glb", engine=any_engine)
    assert "513 x 129 vertices" in done.summary
    mesh = opened(done.path)
    np.testing.assert_allclose(mesh.vertices[:, 1].reshape(129, 513), metres((513, 129)), rtol=1e-6)
    assert document(done.path)["accessors"][3]["componentType"] == 5125, "66177 vertices: 32 bits"
    assert mesh.faces.max() == 513 * 129 - 1


@pytest.mark.parametrize(("cols", "rows", "kind"), [(257, 255, 5123), (256, 256, 5125)])
def test_indices_grow_where_sixteen_bits_end(cols: int, rows: int, kind: int, tmp_path: Path):
    """65535 vertices have indices up to 65534; 65535 itself is the mark of a new strip."""
    path = tmp_path / "flat.glb"
    path.write_bytes(encode_glb(terrain_mesh(np.zeros((rows, cols), np.float32), (9.0, 9.0)), "flat"))
    assert document(path)["accessors"][3]["componentType"] == kind
    mesh = opened(path)
    assert mesh.faces.max() == cols * rows - 1
    assert mesh.area == pytest.approx(81.0, rel=1e-4)


def test_an_obj_s_files_find_each_other(any_engine: Engine, lop: Sketch, tmp_path: Path):
    done = playground.export(lop, tmp_path / "my own terrain.obj", engine=any_engine)
    assert [path.name for path in done.sidecars] == ["my_own_terrain.mtl", "my_own_terrain-texture.png"]
    assert picture_of(opened(done.path)).shape == (13, 17, 3)


def test_an_obj_has_every_bit_of_its_floats():
    heightmap = np.random.default_rng(2).uniform(0.0, 3000.0, (7, 6)).astype(np.float32)
    mesh = terrain_mesh(heightmap, (29978.41, 31718.92), (50, 70))
    lines = encode_obj(mesh, "a b", library="c.mtl").decode().splitlines()
    places = np.array([line.split()[1:] for line in lines if line.startswith("v ")], dtype=np.float32)
    np.testing.assert_array_equal(places, mesh.positions)
    assert "o a_b" in lines


def test_grids_keep_the_terrain_s_shape():
    assert fitted((403, 344), 513) == (403, 344)
    assert fitted((1025, 513), 257) == (257, 129)
    assert fitted((4097, 2), 513) == (513, 2)
    assert fitted((403, 344), 2) == (2, 2)


def test_sampling_is_exact_where_texels_meet_and_linear_between():
    values = np.random.default_rng(4).normal(size=(9, 13)).astype(np.float32)
    np.testing.assert_array_equal(sampled(values, (13, 9)), values)
    np.testing.assert_array_equal(sampled(values, (7, 5)), values[::2, ::2])
    np.testing.assert_array_equal(sampled(values, (37, 25))[::3, ::3], values)
    east, south = np.meshgrid(np.linspace(0, 1, 13), np.linspace(0, 1, 9))
    plane = (3.0 * east - 2.0 * south).astype(np.float32)
    east, south = np.meshgrid(np.linspace(0, 1, 101), np.linspace(0, 1, 40))
    np.testing.assert_allclose(sampled(plane, (101, 40)), 3.0 * east - 2.0 * south, atol=1e-6)
    assert sampled(np.zeros((2, 3, 4), np.float32), (5, 5)).shape == (5, 5, 4)


def test_a_single_row_of_texels_has_no_mesh():
    with pytest.raises(playground.DataError, match="terrain of 5 x 1 texels has no mesh"):
        terrain_mesh(np.zeros((1, 5), np.float32), (1.0, 1.0))


def test_an_stl_has_the_triangles_of_the_glb_with_z_up(any_engine: Engine, lop: Sketch, tmp_path: Path):
    shape = trimesh.load_mesh(playground.export(lop, tmp_path / "a.stl", engine=any_engine).path)
    glb = opened(playground.export(lop, tmp_path / "a.glb", engine=any_engine).path)
    x, y, z = np.moveaxis(glb.triangles, -1, 0)
    np.testing.assert_allclose(shape.triangles, np.stack([x, -z, y], axis=-1), atol=1e-3)
    assert (shape.face_normals[:, 2] > 0).all()
    np.testing.assert_allclose(shape.bounds, [[-400, -150, 175], [400, 150, 925]], rtol=1e-6)


@pytest.mark.parametrize("ending", [*ENDINGS, "stl"])
def test_an_exaggerated_mesh_is_higher_over_height_0(
    ending: str, any_engine: Engine, lop: Sketch, heightmap: np.ndarray, tmp_path: Path
):
    path = tmp_path / f"a.{ending}"
    job = prepare(any_engine, lop, path, ExportOptions(exaggeration=3.0))
    done = run(any_engine, job)
    low, high = trimesh.load_mesh(path).bounds[:, 2 if ending == "stl" else 1]
    base = 50.0
    assert low == pytest.approx(base + 3 * (heightmap.min() - base), rel=1e-6)
    assert high == pytest.approx(base + 3 * (heightmap.max() - base), rel=1e-6)
    assert "3 times as high as it is" in done.summary

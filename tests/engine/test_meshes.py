"""Meshes are whole: every square twice over, nothing twice, no hole, every face to the outside."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from playground.engine.meshes import MESHES, Mesh, build_mesh, drawn_mesh, mesh_key, mesh_parameters
from playground.errors import SketchError


def grid(n: int) -> Mesh:
    return build_mesh("grid", mesh_key("grid", {"grid": n}))


def triangles(mesh: Mesh) -> np.ndarray:
    """Return (m, 3, 3): the corners of each triangle, the skirt's foot one deep."""
    corner = mesh.attributes["corner"].astype(np.float64)
    solid = np.column_stack([corner[:, :2], -corner[:, 2]])
    return solid[mesh.indices.reshape(-1, 3)]


def areas(faces: np.ndarray) -> np.ndarray:
    """Return the areas seen from above, positive where the corners run counter-clockwise."""
    (ax, ay), (bx, by) = (faces[:, 1, :2] - faces[:, 0, :2]).T, (faces[:, 2, :2] - faces[:, 0, :2]).T
    return 0.5 * (ax * by - ay * bx)


@pytest.mark.parametrize("n", [2, 3, 5, 33])
def test_the_terrain_is_covered_once(n):
    faces = triangles(grid(n))
    flat = faces[(faces[..., 2] == 0).all(axis=1)]
    assert len(flat) == 2 * (n - 1) ** 2
    np.testing.assert_allclose(areas(flat), 0.5 / (n - 1) ** 2, rtol=1e-4)
    assert areas(flat).sum() == pytest.approx(1.0), "each of them counter-clockwise from above"


@pytest.mark.parametrize("n", [2, 3, 5, 33])
def test_no_triangle_is_there_twice_or_empty(n):
    faces = grid(n).indices.reshape(-1, 3)
    assert len({tuple(sorted(face)) for face in faces.tolist()}) == len(faces)
    sizes = np.linalg.norm(
        np.cross(*(triangles(grid(n))[:, i] - triangles(grid(n))[:, 0] for i in (1, 2))), axis=1
    )
    assert sizes.min() > 0
    assert len(faces) == 2 * (n - 1) ** 2 + 2 * 4 * (n - 1)


@pytest.mark.parametrize("n", [2, 3, 5, 33])
def test_it_is_watertight_but_for_the_ground(n):
    """Every edge has two faces that run along it in opposite ways, but for the foot of the skirt."""
    edges: Counter[tuple[int, int]] = Counter()
    for a, b, c in grid(n).indices.reshape(-1, 3).tolist():
        edges.update([(a, b), (b, c), (c, a)])
    assert max(edges.values()) == 1
    open_edges = [edge for edge in edges if edge[::-1] not in edges]
    foot = grid(n).attributes["corner"][:, 2] == 1.0
    assert len(open_edges) == 4 * (n - 1)
    assert all(foot[a] and foot[b] for a, b in open_edges)


@pytest.mark.parametrize("n", [2, 3, 5])
def test_the_skirt_faces_outwards(n):
    faces = triangles(grid(n))
    walls = faces[(faces[..., 2] < 0).any(axis=1)]
    normal = np.cross(walls[:, 1] - walls[:, 0], walls[:, 2] - walls[:, 0])
    outwards = walls.mean(axis=1)[:, :2] - 0.5
    assert np.all((normal[:, :2] * outwards).sum(axis=1) > 0)
    np.testing.assert_allclose(normal[:, 2], 0.0, atol=1e-12)


def test_it_encloses_what_it_should():
    """The sum of signed volumes under all faces, with the ground put in, is that of a box one deep."""
    faces = triangles(grid(9))
    ground = np.array(
        [[[0, 0, -1], [0, 1, -1], [1, 1, -1]], [[0, 0, -1], [1, 1, -1], [1, 0, -1]]], np.float64
    )
    everything = np.concatenate([faces, ground])
    volume = np.einsum("ij,ij->i", everything[:, 0], np.cross(everything[:, 1], everything[:, 2])).sum() / 6
    assert volume == pytest.approx(1.0)


def test_corners_are_exact_and_of_one_type():
    corner = grid(257).attributes["corner"]
    assert corner.dtype == np.float32
    assert grid(257).indices.dtype == np.uint32
    assert corner[:, :2].min() == 0.0
    assert corner[:, :2].max() == 1.0
    assert set(np.unique(corner[:, 2])) == {0.0, 1.0}
    assert grid(257).indices.max() == len(corner) - 1


def test_a_sheet_is_one_square():
    faces = triangles(build_mesh("sheet", ()))
    assert areas(faces).tolist() == [0.5, 0.5]


def test_triangles_are_numbers_that_a_draw_gives_a_place():
    mesh = build_mesh("triangles", mesh_key("triangles", {"count": 70_000}))
    corner = mesh.attributes["corner"].reshape(70_000, 3, 3)
    assert corner.dtype == np.float32
    np.testing.assert_array_equal(corner[..., 0], np.arange(70_000)[:, None] * np.ones(3))
    np.testing.assert_array_equal(corner[..., 1], np.tile([0, 1, 2], (70_000, 1)))
    assert not corner[..., 2].any()
    np.testing.assert_array_equal(mesh.indices, np.arange(210_000))


def test_a_key_holds_only_what_the_mesh_depends_on():
    assert mesh_key("grid", {"grid": 9, "colour": "red"}) == (("grid", 9),)
    assert mesh_key("sheet", {"grid": 9}) == ()
    assert mesh_parameters("grid") == ("grid",)
    assert mesh_parameters("nothing") == ()


@pytest.mark.parametrize(
    ("name", "values", "message"),
    [
        ("gird", {}, "there is no mesh 'gird'; did you mean 'grid'"),
        ("grid", {}, "needs a parameter 'uniform int grid'"),
        ("grid", {"grid": 2.5}, "needs a parameter 'uniform int grid'"),
        ("grid", {"grid": 1}, "takes 2 to 4097"),
        ("grid", {"grid": 5000}, "takes 2 to 4097"),
        ("triangles", {}, "needs a parameter 'uniform int count', or count = \"…\" in its #pragma"),
        ("triangles", {"count": 0}, "takes 1 to 1048576"),
    ],
)
def test_mistakes_have_sentences(name, values, message):
    with pytest.raises(SketchError, match=message):
        mesh_key(name, values)


def test_every_mesh_builds_at_its_least():
    for name, (_, limits) in MESHES.items():
        mesh = build_mesh(name, tuple((key, low) for key, (low, _) in limits.items()))
        assert len(mesh.indices) % 3 == 0


def shaded(indices: np.ndarray, pieces: int = 1024, remembered: int = 256) -> int:
    """Return how many vertices llvmpipe shades: each that is not the last of its number modulo 256.

    It forgets all of them after so many indices (Mesa, draw_pt_vsplit.c).
    """
    count = 0
    for start in range(0, len(indices), pieces):
        last = np.full(remembered, -1)
        for index in indices[start : start + pieces].tolist():
            count += last[index % remembered] != index
            last[index % remembered] = index
    return count


@pytest.mark.parametrize(("name", "more"), [("grid", {}), ("land", {"detail": 0})])
@pytest.mark.parametrize("n", [2, 17, 97, 129, 257])
def test_grid_index_order_shades_few_vertices_twice(name: str, more: dict[str, int], n: int):
    key = mesh_key(name, {"grid": n, **more})
    built, drawn = build_mesh(name, key), drawn_mesh(name, key)
    assert shaded(drawn.indices) < 1.3 * len(drawn.attributes["corner"]) + 8
    # The same triangles, each from the same corner on.
    faces = [triangles(mesh).reshape(-1, 9) for mesh in (built, drawn)]
    first, second = (each[np.lexsort(each.T)] for each in faces)
    np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize(("name", "values"), [("sheet", {}), ("land", {"detail": 1, "grid": 9})])
def test_other_meshes_are_drawn_as_they_are(name: str, values: dict[str, int]):
    """Of tiles, draws take their pieces by their places among the indices."""
    key = mesh_key(name, values)
    built, drawn = build_mesh(name, key), drawn_mesh(name, key)
    np.testing.assert_array_equal(built.indices, drawn.indices)

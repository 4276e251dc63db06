"""Meshes are whole, at one level of detail or many."""

from __future__ import annotations

from collections import Counter
from itertools import pairwise

import numpy as np
import pytest

from playground.engine import lod
from playground.engine.camera import look
from playground.engine.meshes import MESHES, Mesh, build_mesh, drawn_mesh, mesh_key, mesh_parameters
from playground.errors import SketchError
from playground.sketch.model import Camera

from ..cases import each
from ..elevations import spans_of_tiles


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


# ── Tiles and their levels: whole meshes at any level, errors within the tolerance, visible tiles dr


EXTENT, RELIEF, SIZE = (1000.0, 800.0), 300.0, (640, 360)


def view_of(camera: Camera, size: tuple[int, int] = SIZE) -> lod.View:
    eye = look(camera, EXTENT, RELIEF, size)
    return lod.View(eye.clip_from_world.astype(np.float64), eye.position, EXTENT, RELIEF, size)


def random_camera(rng: np.random.Generator) -> Camera:
    target = (*rng.uniform(0, 800, 2), rng.uniform(0, 300))
    return Camera(
        rng.uniform(0, 360), rng.uniform(-20, 89), rng.uniform(30, 2500), target, rng.uniform(20, 100)
    )


def pixels(view: lod.View, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return where places are in the picture, (n, 2), and which of them are in it."""
    clip = places @ view.clip_from_world[:, :3].T + view.clip_from_world[:, 3]
    inside = (np.abs(clip[:, :3]) <= clip[:, 3:]).all(axis=1)
    at = clip[:, :2] / np.where(inside, clip[:, 3], 1.0)[:, None]
    return at * np.array(view.size) / 2, inside


# ── pieces ───────────────────────────────────────────────────────────────────


def faces_of(piece: lod.Piece) -> np.ndarray:
    """Return (m, 3, 3): nodes east and north, and whether at the foot."""
    return lod.vertices()[lod.pieces()[piece].reshape(-1, 3)].astype(int)


def test_five_lod_levels_share_vertices_of_one_tile():
    counts = [len(faces_of(("fans", level, 0))) for level in range(lod.LEVELS)]
    assert counts == [512, 128, 32, 8, 2]
    assert len(lod.vertices()) == 17 * 17 + 4 * 17
    assert all(indices.max() < len(lod.vertices()) for indices in lod.pieces().values())


@each("piece", [p for p in lod.pieces() if p[0] == "fans"], ids=str)
def test_a_tile_is_covered_once_with_any_neighbours(piece):
    faces = faces_of(piece)
    a, b = faces[:, 1, :2] - faces[:, 0, :2], faces[:, 2, :2] - faces[:, 0, :2]
    areas = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2
    assert (areas > 0).all()
    assert areas.sum() == 256
    edges = Counter((tuple(f[k]), tuple(f[(k + 1) % 3])) for f in faces.tolist() for k in range(3))
    assert max(edges.values()) == 1
    open_edges = {edge for edge in edges if edge[::-1] not in edges}
    expected = set()
    for side in lod.SIDES:
        step = 1 << (piece[1] + bool(piece[2] & side) if piece[1] < 4 else 4)
        nodes = [(*divmod(int(node), lod.CELLS + 1)[::-1], 0) for node in lod.edge_nodes(side, step)]
        expected |= set(pairwise(nodes))
    assert open_edges == expected, "its sides are those of its neighbours"


def test_a_tile_s_quarters_are_its_finest_triangles():
    quarters = [lod.pieces()["quarter", east, north].reshape(-1, 3) for east in (0, 1) for north in (0, 1)]
    whole = lod.pieces()["fans", 0, 0].reshape(-1, 3)
    assert sorted(np.concatenate(quarters).tolist()) == sorted(whole.tolist())
    for k, quarter in enumerate(quarters):
        nodes = lod.vertices()[quarter, :2]
        low = np.array([8 * (k // 2), 8 * (k % 2)])
        assert (nodes >= low).all() and (nodes <= low + 8).all()


def mesh_edges(chosen: lod.Chosen) -> Counter:
    """Count the directed edges of everything chosen, by their ends' nodes in the whole terrain."""
    edges: Counter = Counter()
    start = 0
    for piece, count in chosen.runs:
        for east, north, *_ in chosen.places[start : start + count].astype(int).tolist():
            moved = (faces_of(piece) + np.array([east, north, 0])).tolist()
            edges.update((tuple(f[k]), tuple(f[(k + 1) % 3])) for f in moved for k in range(3))
        start += count
    return edges


def far_view() -> lod.View:
    return view_of(Camera(elevation=60.0, distance=6000.0, target=(500.0, 400.0, 0.0)))


def boxes(ny: int, nx: int, view: lod.View) -> lod.Boxes:
    return lod.boxes_of(spans_of_tiles(np.tile([0, 1], (ny, nx, 1))), view)


def corners_of(around: lod.Boxes) -> tuple[np.ndarray, np.ndarray]:
    """Return the lower south-western and the upper north-eastern corners of boxes, (ny, nx, 3)."""
    ny, nx = around.up.shape[1:]
    each = [
        np.broadcast_arrays(around.east[k], around.north[k][:, None], around.up[k].reshape(ny, nx))
        for k in (0, 1)
    ]
    return np.stack(each[0], axis=-1), np.stack(each[1], axis=-1)


@pytest.mark.parametrize("seed", range(4))
def test_any_levels_make_one_surface_closed_but_for_the_ground(seed):
    expected = np.random.default_rng(seed).integers(0, 9, (5, 7)).clip(0, 4)
    j, i = np.indices((5, 7))
    levels = (expected + abs(j[..., None, None] - j) + abs(i[..., None, None] - i)).min(axis=(2, 3))
    assert len(set(levels.ravel().tolist())) >= 3
    view = far_view()
    around = boxes(5, 7, view)
    edges = mesh_edges(lod.tiles_at(levels, around, view))
    assert max(edges.values()) == 1
    for a, b in edges:
        assert (b, a) in edges or (a[2] == b[2] == 1), "an open edge that is not at a foot"


@pytest.mark.parametrize("fine", range(lod.LEVELS - 1))
@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("turned", [False, True])
def test_two_levels_side_by_side_leave_no_crack(fine, axis, turned):
    levels = np.array([[fine, fine + 1]])
    levels = levels[:, ::-1] if turned else levels
    levels = levels.T if axis else levels
    view = far_view()
    edges = mesh_edges(lod.tiles_at(levels, boxes(*levels.shape, view), view))
    open_edges = [(a, b) for a, b in edges if (b, a) not in edges]
    assert open_edges and all(a[2] == b[2] == 1 for a, b in open_edges)


def test_a_tile_that_forgets_its_neighbour_would_leave_one(monkeypatch):
    monkeypatch.setattr(lod, "coarser_of", np.zeros_like)
    view = far_view()
    edges = mesh_edges(lod.tiles_at(np.array([[1, 2]]), boxes(1, 2, view), view))
    assert any((b, a) not in edges and not (a[2] == b[2] == 1) for a, b in edges)


# ── the view ─────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("seed", range(6))
def test_screen_shift_of_raised_points_is_within_view_bound(seed):
    rng = np.random.default_rng(seed)
    view = view_of(random_camera(rng))
    corners = rng.uniform(-1, 1, (4000, 3))
    corners[:200, :2] = np.sign(corners[:200, :2])  # the picture's corners, where it is greatest
    clip = np.linalg.solve(view.clip_from_world, np.c_[corners, np.ones(4000)].T).T
    low = clip[:, :3] / clip[:, 3:]
    depth = low @ view.forward[:3] + view.forward[3]
    step = 1e-4 * depth
    high = low + step[:, None] * [0, 0, 1]
    moved = np.linalg.norm(pixels(view, high)[0] - pixels(view, low)[0], axis=1)
    bound = step / depth * view.pixels
    ends_in = pixels(view, low)[1] & pixels(view, high)[1]
    assert (moved[ends_in] <= bound[ends_in] * 1.001).all()
    assert (moved / bound)[ends_in].max() > 0.9, "and the bound is not far off"
    assert depth.min() >= view.near * 0.999


@pytest.mark.parametrize("seed", range(12))
def test_a_box_left_out_holds_nothing_that_is_seen(seed):
    rng = np.random.default_rng(seed)
    view = view_of(random_camera(rng))
    spans = spans_of_tiles(np.sort(rng.uniform(-0.2, 1.2, (9, 11, 2)), axis=-1))
    around = lod.boxes_of(spans, view)
    seen, depths = around.visible(view), around.depths(view)
    share = rng.uniform(0, 1, (400, 1, 1, 3))
    share[:200] = np.round(share[:200])  # corners
    low, high = corners_of(around)
    places = low + share * (high - low)
    _, inside = pixels(view, places.reshape(-1, 3))
    visible = inside.reshape(400, 9, 11)
    assert not (visible.any(axis=0) & ~seen).any()
    at = places @ view.forward[:3] + view.forward[3]
    assert (at[visible] >= np.broadcast_to(depths, visible.shape)[visible] * (1 - 1e-6)).all()


def test_looking_at_one_corner_leaves_most_of_the_terrain_out():
    view = view_of(Camera(45.0, 50.0, 60.0, (20.0, 20.0, 100.0)))
    assert lod.boxes_of(spans_of_tiles(np.tile([0, 1], (16, 16, 1))), view).visible(view).mean() < 0.2


# ── levels ───────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("tolerance", [0.0, 0.5, 2.0, 8.0])
@pytest.mark.parametrize("seed", range(3))
def test_tile_takes_coarsest_level_error_and_neighbours_allow(seed, tolerance):
    rng = np.random.default_rng(seed)
    view = view_of(random_camera(rng))
    errors = np.sort(10.0 ** rng.uniform(-7, -1, (7, 9, 4)), axis=-1).astype(np.float32)
    errors[2, 3] = 0.0
    around = boxes(7, 9, view)
    levels = lod.levels_of(errors, around, view, tolerance)
    low, high = corners_of(around)
    alone = np.zeros((7, 9), int)
    for j in range(7):
        for i in range(9):
            least = min(
                float(view.forward[:3] @ corner + view.forward[3])
                for corner in np.stack(
                    np.meshgrid(*zip(low[j, i], high[j, i], strict=True)), axis=-1
                ).reshape(-1, 3)
            )
            error = errors[j, i] * RELIEF * view.pixels / max(least, view.near)
            alone[j, i] = max([k + 1 for k in range(4) if error[k] <= tolerance], default=0)
    # A neighbour is one coarser at most: so a level is at most that of any tile plus the way to it.
    j, i = np.indices((7, 9))
    way = abs(j[..., None, None] - j) + abs(i[..., None, None] - i)
    np.testing.assert_array_equal(levels, (alone + way).min(axis=(2, 3)))


def test_holes_and_unbounded_heights_keep_finest_level():
    view = far_view()
    spans = np.float32([[[0, 1], [0, 1e30]], [[-1e30, 0], [np.nan, np.nan]]])
    around = lod.boxes_of(spans_of_tiles(np.nan_to_num(spans)), view)
    errors = np.full((2, 2, 4), 1e30, np.float32)
    assert not lod.levels_of(errors, around, view, 16.0).any()
    assert lod.tiles_at(np.zeros((2, 2), int), around, view).runs


def test_flat_terrain_has_two_triangles_a_tile_at_zero_tolerance():
    view = far_view()
    tables = {"spans": spans_of_tiles(np.zeros((3, 4, 2))), "errors": np.zeros((3, 4, 4), np.float32)}
    chosen = lod.geomipmap({"tolerance": 0.0}, tables, view)
    runs = dict(chosen.runs)
    assert runs["fans", 4, 0] == runs["fans", 4, 1] == 6

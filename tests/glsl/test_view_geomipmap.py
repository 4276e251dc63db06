"""Geomipmapping: errors against the planes of the triangles, no crack, no jump beyond the pixels allowed."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy import ndimage

from playground.engine import lod
from playground.engine import lod as sight
from playground.engine.camera import look
from playground.engine.engine import Engine
from playground.errors import PlaygroundError, SketchError
from playground.sketch.model import Camera

from ..truth.eyes import holes

HEIGHT = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) {{ return {}; }}\n'
ROUGH = (
    "0.5 + 0.3 * sin(float(texel.x) * 0.11) * cos(float(texel.y) * 0.09)"
    " + 0.1 * pow(float(texel.x) / float(size.x), 4.0) * random(texel, 5u)"
)
HOLE = "texel == ivec2(20, 3) ? uintBitsToFloat(0x7fc00000u) : float(texel.x & 7) * 0.1"
TERRAIN = '[[pass]]\nname = "height"\nuse = "./terrain"\n'
TILES = '[[pass]]\nname = "tiles"\nuse = "view/geomipmap/errors"\n'
TILES += 'size = ["(height.size.x + 14) // 16", "(height.size.y + 14) // 16"]\n'
GREEN = '#pragma kernel(output = "colour:rgba16f")\nvec4 kernel(ivec2 texel) { return vec4(0, 1, 0, 1); }\n'
SKY = 'zenith = "#ff00ff", horizon = "#ff00ff", nadir = "#ff00ff"'
VIEW = TERRAIN + '[[pass]]\nname = "colour"\nuse = "./green"\n[view]\nuse = "view/terrain"\nsamples = 1\n'
SIZE = (320, 180)


def terrain(text: str) -> str:
    include = '#include "noise/hash.glsl"\n' if "random(" in text else ""
    return include + HEIGHT.format(text)


@pytest.fixture
def errors_of(make_sketch):
    def make(engine: Engine, text: str, size):
        sketch = make_sketch(TERRAIN + TILES, size=size, terrain=terrain(text))
        spans, errors = (engine.read(sketch, f"tiles:{name}") for name in ("spans", "errors"))
        return engine.read(sketch, "height"), spans, errors

    return make


@pytest.fixture
def engine(any_engine):
    """What is drawn is the same whichever driver runs the kernels."""
    return any_engine


@pytest.fixture
def shown(make_sketch):
    def make(text=ROUGH, size=129, relief=250.0, detail="geomipmap", given=SKY):
        given = f'detail = "{detail}", earth = "#00ff00", {given}'
        view = VIEW + f"set = {{ {given} }}\n"
        return make_sketch(view, size=size, relief=relief, terrain=terrain(text), green=GREEN)

    return make


# ── errors ───────────────────────────────────────────────────────────────────


@cache
def weights(level: int, coarser: int, cells: tuple[int, int] = (16, 16)) -> np.ndarray:
    """Return (289, 289): how much of each node's height is in the mesh's height over each node.

    Nodes beyond the cells that a tile has, east and north, lie on its edge.
    """
    nodes = np.minimum(lod.vertices()[:289, :2].astype(np.float64), cells)
    array = np.full((289, 289), np.nan)
    for corners in lod.pieces()["fans", level, coarser].reshape(-1, 3):
        system = np.c_[nodes[corners], np.ones(3)]
        if abs(np.linalg.det(system)) < 0.5:
            continue
        shares = np.c_[nodes, np.ones(289)] @ np.linalg.inv(system)
        inside = (shares >= -1e-9).all(axis=1)
        array[inside] = 0
        array[np.ix_(inside, corners)] = shares[inside]
    assert not np.isnan(array).any()
    return array


def places_of(texels: int) -> np.ndarray:
    """Return the texel of each node along a side; those beyond the edge are on it."""
    return np.minimum(np.arange(-(-(texels - 1) // 16) * 16 + 1), texels - 1)


def nodes_of(heights: np.ndarray) -> np.ndarray:
    """Return the heights at the nodes."""
    return heights.astype(np.float64)[np.ix_(*map(places_of, heights.shape))]


def cells_of(j: int, i: int, shape: tuple[int, ...]) -> tuple[int, int]:
    """Return how many cells a tile has, east and north."""
    return min(shape[1] - 1 - 16 * i, 16), min(shape[0] - 1 - 16 * j, 16)


def tiles_of(nodes: np.ndarray) -> np.ndarray:
    """Return (ny, nx, 289)."""
    ny, nx = (n // 16 for n in nodes.shape)
    cut = [[nodes[16 * j : 16 * j + 17, 16 * i : 16 * i + 17].ravel() for i in range(nx)] for j in range(ny)]
    return np.array(cut)


def own_nodes(coarser: int, cells: tuple[int, int]) -> np.ndarray:
    """Say which nodes are the tile's to answer for: not those on the side of a coarser neighbour."""
    east, north = np.minimum(lod.vertices()[:289, :2], cells).T
    away = {
        lod.SOUTH: north == 0,
        lod.EAST: east == cells[0],
        lod.NORTH: north == cells[1],
        lod.WEST: east == 0,
    }
    return ~np.any([away[side] for side in lod.SIDES if coarser & side] or [np.zeros(289, bool)], axis=0)


def true_errors(heights: np.ndarray, level: int) -> np.ndarray:
    nodes = tiles_of(nodes_of(heights))
    worst = np.zeros(nodes.shape[:2])
    for j, i in np.ndindex(worst.shape):
        cells = cells_of(j, i, heights.shape)
        for coarser in range(16) if level < 4 else [(i + j) % 2]:
            away = np.abs(weights(level, coarser, cells) @ nodes[j, i] - nodes[j, i])
            own = own_nodes(coarser, cells) if level < 4 else slice(None)
            worst[j, i] = max(worst[j, i], away[own].max(initial=0.0))
    return worst


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "size"),
    [
        ("random(texel, 1u)", [33, 49]),
        ("0.003 * float(texel.x) - 0.001 * float(texel.y)", 33),
        ("sin(float(texel.x) * 0.2) * float(texel.y) * 0.01", [40, 29]),
        ("random(texel, 3u)", [40, 53]),
        ("random(texel, 4u)", [20, 24]),
        ("random(texel, 2u)", [2, 5]),
    ],
)
def test_tile_error_is_max_height_gap_between_level_and_terrain(any_engine, errors_of, text, size):
    heights, spans, errors = errors_of(any_engine, text, size)
    tiles = tiles_of(nodes_of(heights))
    truth = np.stack([true_errors(heights, level) for level in range(1, 5)], axis=-1)
    np.testing.assert_allclose(errors, np.maximum.accumulate(truth, axis=-1), atol=3e-6)
    np.testing.assert_allclose(spans[..., 0], tiles.min(axis=-1), atol=1e-6)
    np.testing.assert_allclose(spans[..., 1], tiles.max(axis=-1), atol=1e-6)
    assert true_errors(heights, 0).max() < 1e-12
    ends = [places_of(n)[16::16] / (n - 1) for n in heights.shape]
    np.testing.assert_allclose(spans[..., 2], np.broadcast_to(ends[1], spans.shape[:2]), atol=1e-7)
    np.testing.assert_allclose(spans[..., 3], np.broadcast_to(ends[0][:, None], spans.shape[:2]), atol=1e-7)


def test_tile_with_hole_stays_full_detail_with_finite_span(any_engine, errors_of):
    _, spans, errors = errors_of(any_engine, HOLE, 33)
    assert (errors[0, 1] > 1e29).all() and (errors[1] < 1).all() and (errors[0, 0] < 1).all()
    assert np.isfinite(spans).all() and spans[0, 1, :2].tolist() == [0.0, pytest.approx(0.7)]


# ── no crack ─────────────────────────────────────────────────────────────────


def flight(count: int):
    """Cameras on a way low over the terrain, turning."""
    for k in range(count):
        t = k / count
        yield Camera(
            azimuth=360.0 * t,
            elevation=12.0 + 40.0 * np.sin(9.0 * t) ** 2,
            distance=90.0 + 900.0 * t,
            target=(200.0 + 600.0 * t, 700.0 - 500.0 * t, 60.0),
            field_of_view=35.0 + 40.0 * t,
        )


@pytest.mark.parametrize(("tolerance", "size"), [(1.0, 129), (6.0, 129), (2.0, [124, 105])])
def test_no_background_shows_through_on_a_flight(engine, shown, tolerance, size):
    sketch = shown(size=size).with_values({"view.tolerance": tolerance})
    levels = set()
    for camera in flight(12):
        picture = engine.render(sketch.with_camera(camera), size=SIZE).array
        assert ((picture[..., 1] > 250) & (picture[..., 0] < 5)).mean() > 0.1
        assert holes(picture) == 0
        levels |= chosen_levels(engine, sketch.with_camera(camera), tolerance)
    assert len(levels) >= 3


def chosen_levels(engine, sketch, tolerance) -> set[int]:
    chosen = lod.geomipmap({"tolerance": tolerance}, tables_of(engine, sketch), view_of(sketch))
    return {piece[1] for piece, _ in chosen.runs if piece[0] == "fans"}


def tables_of(engine, sketch):
    return {name: engine.read(sketch, f"view.tiles:{name}") for name in ("spans", "errors")}


def view_of(sketch, size=SIZE) -> sight.View:
    eye = look(sketch.camera, sketch.terrain.extent, sketch.terrain.relief, size)
    matrix = eye.clip_from_world.astype(np.float64)
    return sight.View(matrix, eye.position, sketch.terrain.extent, sketch.terrain.relief, size)


PATTERNS = [np.indices((8, 8)).sum(axis=0) % 2, (np.indices((8, 8))[0] // 2 + np.indices((8, 8))[1]) % 2]


@pytest.mark.parametrize("fine", range(4))
def test_no_background_shows_between_any_two_levels(engine, shown, monkeypatch, fine):
    for number, pattern in enumerate(PATTERNS):
        monkeypatch.setattr(lod, "levels_of", lambda *_, levels=fine + pattern: levels)
        size = 129 if number == 0 else [124, 114]
        for camera in list(flight(12))[2::4]:
            # A tolerance of its own, or the picture would be taken from those kept.
            sketch = shown(size=size).with_camera(camera).with_values({"view.tolerance": number + 2.0})
            assert holes(engine.render(sketch, size=SIZE).array) == 0


def test_the_background_would_show_if_neighbours_were_forgotten(engine, shown, monkeypatch):
    monkeypatch.setattr(lod, "coarser_of", np.zeros_like)
    sketch = shown().with_values({"view.tolerance": 6.0})
    assert sum(holes(engine.render(sketch.with_camera(c), size=SIZE).array) for c in flight(12)) > 50


# ── nothing seen is left out ─────────────────────────────────────────────────


def test_what_is_left_out_is_nowhere_in_the_picture(engine, shown, monkeypatch):
    sketch = shown()
    left_out = 0
    for camera in flight(8):
        seen = sketch.with_camera(camera)
        engine.render(seen, size=SIZE)
        drawn = engine.runner.draws.triangles
        culled = engine.read(seen, "view.land", size=SIZE)
        with monkeypatch.context() as patch:
            patch.setattr(sight.Boxes, "visible", lambda self, view: np.ones(self.up.shape[1:], bool))
            other = seen.with_values({"view.tolerance": 1.0000001})  # or it would not be drawn again
            whole = engine.read(other, "view.land", size=SIZE)
        left_out += engine.runner.draws.triangles - drawn
        np.testing.assert_array_equal(culled, whole)
    assert left_out > 1000


# ── no jump ──────────────────────────────────────────────────────────────────


def surfaces(levels: np.ndarray, coarser: np.ndarray, heights: np.ndarray) -> np.ndarray:
    """Return the mesh's heights over the nodes of each tile, (ny, nx, 289)."""
    tiles = tiles_of(nodes_of(heights))
    for j, i in np.ndindex(levels.shape):
        sides = coarser[j, i] if levels[j, i] < 4 else (i + j) % 2
        tiles[j, i] = weights(int(levels[j, i]), int(sides), cells_of(j, i, heights.shape)) @ tiles[j, i]
    return tiles


def in_picture(surface: np.ndarray, texels: tuple[int, ...], view: sight.View) -> np.ndarray:
    """Return where the nodes of each tile are in the picture, NaN outside it."""
    north, east = (places_of(n) / (n - 1) for n in texels)
    nodes = tiles_of(np.broadcast_to(east * view.extent[0], (north.size, east.size)))
    up = tiles_of(np.broadcast_to(north[:, None] * view.extent[1], (north.size, east.size)))
    position = np.stack([nodes, up, surface * view.relief, np.ones_like(surface)], axis=-1)
    clip = position @ view.clip_from_world.T
    outside = (np.abs(clip[..., :3]) > clip[..., 3:]).any(axis=-1)
    at = clip[..., :2] / np.where(outside, 1.0, clip[..., 3])[..., None] * np.array(view.size) / 2
    at[outside] = np.nan
    return at


@pytest.mark.parametrize(
    ("tolerance", "size"),
    [
        (1.0, 129),
        (3.0, 129),
        (1.0, [100, 37]),
        (2.0, [88, 120]),
        pytest.param(1.0, [344, 403], marks=pytest.mark.slow),
    ],
)
def test_a_change_of_level_keeps_the_tolerance(engine, shown, tolerance, size):
    sketch = shown(size=size)
    tables = tables_of(engine, sketch)
    heights = engine.read(sketch, "height")
    tiles = tiles_of(nodes_of(heights))
    cameras = list(flight(40))[:20]
    changed, worst, before = 0, 0.0, None

    def where(surface: np.ndarray, view: sight.View) -> np.ndarray:
        return in_picture(surface, heights.shape, view)

    for camera in cameras:
        view = view_of(sketch.with_camera(camera))
        boxes = sight.boxes_of(tables["spans"], view)
        levels = lod.levels_of(tables["errors"], boxes, view, tolerance)
        now = surfaces(levels, lod.coarser_of(levels), heights)
        # In both pictures a place is as far from the terrain as is allowed, whatever the level.
        away = np.linalg.norm(where(now, view) - where(tiles, view), axis=-1)
        assert np.nanmax(away) <= tolerance * 1.0001
        if before is not None:
            old_levels, old, old_view = before
            for coarse, its_view in ((levels >= old_levels, view), (levels <= old_levels, old_view)):
                jump = np.linalg.norm(where(now, its_view) - where(old, its_view), axis=-1)[coarse]
                worst = max(worst, float(np.nanmax(jump, initial=0.0)))
            changed += int((levels != old_levels).sum())
        before = levels, now, view
    assert changed > 0.4 * levels.size
    assert worst <= tolerance * 1.0001
    assert worst > tolerance * 0.2, "and the bound is not far off"


def test_terrain_s_outline_moves_by_no_more_than_the_tolerance(engine, shown, monkeypatch):
    """Two frames a change of level apart, seen by one camera: each outline lies within the other, widened."""
    sketch = shown(size=257).with_values({"view.tolerance": 3.0})
    cameras = list(flight(60))[10:30:4]
    result = []
    for camera in cameras:
        near = replace(camera, distance=camera.distance * 1.15)
        other = lod.levels_of(
            tables_of(engine, sketch)["errors"],
            sight.boxes_of(tables_of(engine, sketch)["spans"], view_of(sketch.with_camera(near))),
            view_of(sketch.with_camera(near)),
            3.0,
        )
        masks = []
        for levels in (None, other):
            with monkeypatch.context() as patch:
                value = 3.0
                if levels is not None:
                    patch.setattr(lod, "levels_of", lambda *_, levels=levels: levels)
                    value = 3.0000001
                seen = sketch.with_camera(camera).with_values({"view.tolerance": value})
                masks.append(engine.render(seen, size=SIZE).array[..., 0] < 128)
        result.append((masks[0] != masks[1]).sum())
        reach = (
            np.hypot(*np.indices((9, 9)) - 4) <= 4.0
        )  # 3 pixels further off, and a pixel's own half on each side
        for first, two in (masks, masks[::-1]):
            assert not (first & ~ndimage.binary_dilation(two, reach)).any()
    assert sum(result) > 0


# ── what the view asks for ───────────────────────────────────────────────────


@pytest.mark.parametrize("size", [65, 60, 71])
def test_no_tolerance_at_all_is_the_full_grid(engine, shown, size):
    """On terrain whose every cell is flat, whichever way it is cut."""
    camera = list(flight(8))[5]
    text = "float((texel.x * 7) & 15) * 0.06 + float((texel.y * 5) & 15) * 0.03"
    pictures = []
    for values in ({"view.tolerance": 0.0}, {"view.detail": "full grid", "view.grid": size}):
        sketch = shown(text, size=size).with_camera(camera).with_values(values)
        pictures.append(engine.read(sketch, "view.land", size=SIZE))
    different = (pictures[0] != pictures[1]).any(axis=-1)
    assert different.mean() < 0.01


def test_tolerance_reduces_triangles_and_full_grid_has_no_errors(engine, shown):
    counts = []
    for tolerance in (0.0, 0.5, 1.0, 2.0, 4.0):
        engine.render(shown(size=257).with_values({"view.tolerance": tolerance}), size=SIZE)
        counts.append(engine.runner.draws.triangles)
    assert counts == sorted(counts, reverse=True) and counts[0] > 10 * counts[-1]
    full = shown(detail="full grid")
    assert engine.texture(full, "view.tiles:errors", size=SIZE).size == (1, 1)


def test_the_errors_are_read_back_once_for_each_terrain(engine, shown, monkeypatch):
    from playground.engine import results

    times = []
    right = results.read_texture
    monkeypatch.setattr(results, "read_texture", lambda texture: times.append(1) or right(texture))
    sketch = shown()
    for camera in flight(5):
        engine.draw(sketch.with_camera(camera), size=SIZE)
    assert len(times) == 2  # spans and errors
    engine.draw(shown("float(texel.x) * 0.001"), size=SIZE)
    assert len(times) == 4


def test_tiles_without_their_errors_have_a_sentence(engine, make_sketch):
    alone = make_sketch(
        TERRAIN + '[view]\nuse = "view/land"\nset = { detail = "geomipmap" }\n', terrain=terrain("0.0")
    )
    with pytest.raises(SketchError, match="at this detail needs the input 'spans' wired"):
        engine.render(alone, size=SIZE)


def test_a_draw_that_does_not_read_the_camera_has_a_sentence(engine, make_sketch):
    text = '#pragma draw(mesh = "land")\nuniform int detail = 0;\nuniform int grid = 3;\n'
    text += "vec4 vertex(vec3 corner) { return vec4(corner, 1.0); }\nvec4 fragment() { return vec4(1.0); }\n"
    blind = make_sketch(TERRAIN + '[view]\nuse = "./blind"\n', terrain=terrain("0.0"), blind=text)
    with pytest.raises(PlaygroundError, match="needs a draw that reads clip_from_world, eye, extent"):
        engine.render(blind, size=SIZE)


def test_levels_have_colours(engine, shown):
    sky = "wireframe = true, levels = true, faces = 0.0, skirt = 0.0, " + SKY
    sketch = shown(size=257, given=sky).with_values({"view.tolerance": 4.0})
    camera = Camera(elevation=35.0, distance=500.0, target=(500.0, 300.0, 100.0))
    view = engine.read(sketch.with_camera(camera), "view.land", size=SIZE).astype(float)
    levels = chosen_levels(engine, sketch.with_camera(camera), 4.0)
    colours = [(0.05, 0.25, 1.0), (0.02, 0.75, 0.25), (0.95, 0.8, 0.02), (1.0, 0.3, 0.02), (0.85, 0.02, 0.05)]
    assert len(levels) >= 3
    for level in levels:
        assert (np.abs(view[..., :3] - colours[level]).max(axis=-1) < 0.02).any(), f"level {level}"


@pytest.mark.parametrize("detail", ["geomipmap", "morph", "full grid"])
def test_terrain_of_one_texel_is_drawn(engine, shown, detail):
    assert engine.render(shown(size=1, detail=detail), size=(64, 36)).array.shape == (36, 64, 4)

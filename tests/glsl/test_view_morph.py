"""Tiles that morph: one surface without a crack, within the tolerance, and continuous as the eye moves."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from playground.engine import lod
from playground.engine import lod as sight
from playground.engine.camera import look
from playground.paths import GLSL
from playground.sketch.model import Camera

from ..elevations import spans_of_tiles
from ..sketch_texts import passes
from ..truth.eyes import holes

TERRAIN = """#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) {
    vec2 at = vec2(texel);
    float rough = 0.02 * pow(at.x / float(size.x), 2.0);
    return 0.5 + 0.25 * sin(at.x * 0.06) * cos(at.y * 0.05) + rough * (random(texel, 5u) - 0.5);
}
"""
GREEN = '#pragma kernel(output = "colour:rgba16f")\nvec4 kernel(ivec2 texel) { return vec4(0, 1, 0, 1); }\n'
# The mesh that a camera is shown, seen straight from above instead: its heights.
ABOVE = """#include "view/vertices.glsl"
#pragma draw(mesh = "land", output = "heights:rgba32f", depth = "none", samples = 1)
uniform sampler2D height;  //! input("linear")
uniform sampler2D spans;   //! input
uniform sampler2D errors;  //! input
uniform int detail = 2;    //! menu("full grid", "geomipmap", "morph")
uniform int grid = 257;
uniform float tolerance = 1.0;
vec4 vertex(vec3 corner, vec4 tile, out float up, out float level) {
    vec2 share = share_of_vertex(height, detail, corner, tile);
    up = textureLod(height, drape_uv(share, textureSize(height, 0)), 0.0).r * relief;
    level = tile.z;
    vec4 nothing = 0.0 * (clip_from_world * vec4(eye, extent.x));
    return vec4(share * 2.0 - 1.0, 0.0, 1.0) + nothing;  // walls have no area from here
}
vec4 fragment(float up, float level) { return vec4(up, level, 1.0, 1.0); }
"""
PASSES = passes(height="./terrain", colour="./green")
TILES = passes(
    tiles=("view/geomipmap/errors", 'size = ["(height.size.x + 14) // 16", "(height.size.y + 14) // 16"]'),
    above=("./above", "size = [331, 187]", 'inputs = { spans = "tiles:spans", errors = "tiles:errors" }'),
)
VIEW = """[view]
use = "view/terrain"
samples = 1
set = { detail = "morph", earth = "#00ff00", zenith = "#ff00ff", horizon = "#ff00ff", nadir = "#ff00ff" }
"""
SIZE = (331, 187)  # of the picture, and from above: no pixel's middle lies on an edge of the mesh
EXTENT, RELIEF = (1000.0, 1000.0), 200.0


@pytest.fixture
def engine(any_engine):
    """What is drawn is the same whichever driver runs the kernels."""
    return any_engine


@pytest.fixture
def shown(make_sketch):
    def make(size=257, tolerance=1.0, detail="morph"):
        files = {"terrain": TERRAIN, "green": GREEN, "above": ABOVE}
        sketch = make_sketch(PASSES + TILES + VIEW, size=size, relief=RELIEF, **files)
        value = {"tolerance": tolerance, "detail": detail}
        return sketch.with_values({f"{p}.{k}": v for p in ("view", "above") for k, v in value.items()})

    return make


def flight(count: int):
    """Cameras on a way over the terrain, near and far, turning."""
    for k in range(count):
        t = k / count
        target = (200.0 + 600.0 * t, 700.0 - 500.0 * t, 130.0)
        yield Camera(
            360.0 * t, 14.0 + 45.0 * np.sin(9.0 * t) ** 2, 90.0 + 1500.0 * t**2, target, 35.0 + 40.0 * t
        )


def view_of(camera: Camera, size=SIZE) -> sight.View:
    eye = look(camera, EXTENT, RELIEF, size)
    return sight.View(eye.clip_from_world.astype(np.float64), eye.position, EXTENT, RELIEF, size)


def tables_of(engine, sketch):
    return {name: engine.read(sketch, f"tiles:{name}") for name in ("spans", "errors")}


@pytest.fixture
def all_seen(monkeypatch):
    monkeypatch.setattr(sight.Boxes, "visible", lambda self, view: np.ones(self.up.shape[1:], bool))


# ── the choice ───────────────────────────────────────────────────────────────


def level_map(chosen: lod.Chosen, cells: tuple[int, int]) -> np.ndarray:
    """Return the level drawn in each tile of a terrain of so many cells; each is drawn once."""
    times = np.zeros((cells[1] // 16, cells[0] // 16), int)
    levels = np.zeros_like(times)
    done = 0
    for piece, count in chosen.runs:
        for east, north, level, _ in chosen.places[done : done + count].astype(int):
            side = 2**level
            if piece[0] == "quarter":
                side //= 2
                east, north = east + 16 * side * piece[1], north + 16 * side * piece[2]
            if piece[0] != "wall":
                square = np.s_[north // 16 :, east // 16 :]
                times[square][:side, :side] += 1
                levels[square][:side, :side] = level
        done += count
    assert (times == 1).all()
    return levels


def test_vertices_begin_to_slide_where_the_choice_of_levels_says():
    text = (GLSL / "view" / "vertices.glsl").read_text("utf-8")
    result = re.search(r"const float MORPH_START = ([\d.]+);", text)
    assert result is not None and float(result.group(1)) == lod.START


@pytest.mark.parametrize("size", [[257, 257], [300, 130], [129, 500]])
def test_levels_meet_where_one_is_morphed_and_next_not_started(engine, shown, all_seen, size):
    sketch = shown(size)
    tables = tables_of(engine, sketch)
    cells = [-(-(n - 1) // 16) * 16 for n in size]
    seen = set()
    for camera in flight(10):
        for tolerance in (0.5, 4.0):
            view = view_of(camera)
            squares = lod.pyramid(tables["spans"])
            reach = lod.level_distances(tables, squares, view, tolerance)
            levels = level_map(lod.morph({"tolerance": tolerance}, tables, view), tuple(cells))
            seen |= set(levels.ravel().tolist())
            boxes = sight.boxes_of(tables["spans"], view)
            for axis in (0, 1):
                pairs = [levels.take(range(k, levels.shape[axis] + k - 1), axis) for k in (0, 1)]
                assert abs(pairs[0] - pairs[1]).max() <= 1
                for fine, coarse in (pairs, pairs[::-1]):
                    for j, i in np.argwhere(fine < coarse):
                        # The tile before the edge between them, and that after it.
                        before, after = np.array([j, i]), np.array([j, i])
                        after[axis] += 1
                        away = np.linalg.norm(edge_of(boxes, before, after, axis) - view.eye, axis=1)
                        level = int(fine[j, i])
                        assert away.min() >= 0.99 * reach[level]
                        assert away.max() <= lod.START * reach[level + 1]
    assert len(seen) >= 3


def edge_of(boxes: sight.Boxes, before: np.ndarray, after: np.ndarray, axis: int) -> np.ndarray:
    """Return points between tiles, one north (axis 0) or east (1) of the other, as far as terrain may be."""
    (j, i), share = before, np.linspace(0, 1, 9)
    up = [fold(boxes.up[k][tuple(t)] for t in (before, after)) for k, fold in ((0, max), (1, min))]
    east = boxes.east[1, i : i + 1] if axis else boxes.east[0, i] + share * np.diff(boxes.east[:, i])
    north = boxes.north[0, j] + share * np.diff(boxes.north[:, j]) if axis else boxes.north[1, j : j + 1]
    return np.stack(np.meshgrid(east, north, up), axis=-1).reshape(-1, 3)


def test_a_pyramid_holds_the_least_and_the_most_of_its_squares():
    spans = spans_of_tiles(np.sort(np.random.default_rng(3).uniform(0, 1, (11, 5, 2)), axis=-1))
    pyramid = lod.pyramid(spans)
    assert [s.shape[:2] for s in pyramid] == [(11, 5), (6, 3), (3, 2), (2, 1), (1, 1)]
    for level, squares in enumerate(pyramid):
        for j, i in np.ndindex(squares.shape[:2]):
            inside = spans[j << level :, i << level :][: 1 << level, : 1 << level]
            assert squares[j, i].tolist() == [inside[..., 0].min(), *inside[..., 1:].max(axis=(0, 1))]


def test_box_distances_are_to_nearest_and_furthest_point():
    rng = np.random.default_rng(4)
    view = view_of(Camera())
    boxes = sight.boxes_of(spans_of_tiles(np.sort(rng.uniform(0, 1, (4, 3, 2)), axis=-1)), view)
    for eye in ((200.0, 300.0, 500.0), (-50.0, 400.0, 20.0), (1200.0, -90.0, 100.0)):
        for j, i in np.ndindex(4, 3):
            sides = np.array([boxes.east[:, i], boxes.north[:, j], boxes.up[:, j, i]])
            nearest = np.clip(eye, sides[:, 0], sides[:, 1])
            corners = np.stack(np.meshgrid(*sides), axis=-1).reshape(-1, 3)
            distances = [distance[j, i] for distance in boxes.distances(eye)]
            away = np.linalg.norm(corners - eye, axis=1)
            assert distances == pytest.approx([np.linalg.norm(nearest - eye), away.max()])
            assert boxes.longest >= np.linalg.norm(sides[:, 1] - sides[:, 0])


# ── no crack ─────────────────────────────────────────────────────────────────


@pytest.mark.slow
@pytest.mark.parametrize(("tolerance", "size"), [(1.0, 257), (8.0, 257), (2.0, [300, 130])])
def test_no_background_shows_through_on_a_flight(engine, shown, tolerance, size):
    sketch = shown(size, tolerance)
    for camera in flight(12):
        picture = engine.render(sketch.with_camera(camera), size=SIZE).array
        assert (picture[..., 1] > 250).mean() > 0.1
        assert holes(picture) == 0


def test_the_background_would_show_if_levels_met_too_early(engine, shown, monkeypatch):
    right = lod.level_distances
    monkeypatch.setattr(
        lod,
        "level_distances",
        lambda *value: right(*value) * (1.0, 0.4, 1.0, 0.4, 1.0)[: len(right(*value))],
    )
    sketch = shown(tolerance=8.0)
    assert sum(holes(engine.render(sketch.with_camera(c), size=SIZE).array) for c in flight(12)) > 10


@pytest.mark.slow
def test_what_is_left_out_is_nowhere_in_the_picture(engine, shown, monkeypatch):
    left_out = 0
    for camera in list(flight(12))[::2]:
        seen = shown().with_camera(camera)
        culled = engine.read(seen, "view.land", size=SIZE)
        drawn = engine.runner.draws.triangles
        with monkeypatch.context() as patch:
            patch.setattr(sight.Boxes, "visible", lambda self, view: np.ones(self.up.shape[1:], bool))
            other = seen.with_values({"view.land.tolerance": 1.0000001})  # or it would not be drawn again
            whole = engine.read(other, "view.land", size=SIZE)
        left_out += engine.runner.draws.triangles - drawn
        np.testing.assert_array_equal(culled, whole)
    assert left_out > 1000


# ── how far from the terrain, and how still ─────────────────────────────────────


def heights(engine, sketch, camera) -> np.ndarray:
    """Return the heights of what is drawn for a camera, from above."""
    result = engine.read(sketch.with_camera(camera), "above", size=SIZE)
    assert (result[..., 2] == 1).all(), "the mesh covers the terrain"
    return result[..., 0].astype(np.float64)


def pixels(view: sight.View, truth: np.ndarray) -> np.ndarray:
    """Return how many pixels a metre upwards takes over each place of the terrain, 0 outside the picture."""
    east, north = np.meshgrid(*((np.arange(n) + 0.5) / n * e for n, e in zip(SIZE, EXTENT, strict=True)))
    position = np.stack([east, north, truth, np.ones_like(truth)], axis=-1)
    low, high = (
        np.moveaxis((position + np.array([0, 0, up, 0])) @ view.clip_from_world.T, -1, 0)
        for up in (0.0, 0.01)
    )
    inside = (np.abs(low[:3]) <= low[3]).all(axis=0)
    low, high = (c[:2] / np.where(inside, c[3], 1.0) for c in (low, high))
    moved = np.hypot(*((high - low) * np.array(view.size)[:, None, None] / 2)) / 0.01
    return np.where(inside, moved, 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", [1.0, 2.0, 8.0])
@pytest.mark.parametrize("detail", ["morph", "geomipmap"])
@pytest.mark.parametrize("size", [257, [203, 146], [84, 115]], ids=str)
def test_drawn_surface_stays_within_tolerance_of_terrain(engine, shown, all_seen, tolerance, detail, size):
    sketch = shown(size, tolerance=tolerance, detail=detail)
    full = shown(size, tolerance=1e-9)
    worst = []
    for camera in flight(6):
        truth = heights(engine, full, camera)
        away = abs(heights(engine, sketch, camera) - truth) * pixels(view_of(camera), truth)
        worst.append(away.max())
    assert max(worst) <= tolerance
    assert max(worst) > 0.1 * tolerance


def jumps(engine, sketch, detail: str, step: float) -> float:
    """Return the largest move of any place of the mesh [pixels] when the eye moves by a share of its way."""
    sketch = sketch.with_values({"above.detail": detail})
    most = 0.0
    for camera in list(flight(12))[1::3]:
        result, before = 0.0, None
        for k in range(4):
            now = replace(camera, distance=camera.distance * (1.3 + 0.02 * k))
            near = replace(now, distance=now.distance * (1 + step))
            before = heights(engine, sketch, now)
            moved = abs(heights(engine, sketch, near) - before) * pixels(view_of(now), before)
            result = max(result, moved.max())
        most = max(most, result)
    return most


@pytest.mark.slow
def test_the_less_the_eye_moves_the_less_the_terrain_does(engine, shown, all_seen):
    sketch = shown(tolerance=4.0)
    large, small = (jumps(engine, sketch, "morph", step) for step in (0.008, 0.0005))
    assert 0 < small < 0.03
    assert small < large / 8
    # Levels that change at once do not: however small the step, some tile changes by a visible amount.
    assert jumps(engine, sketch, "geomipmap", 0.008) > 0.5


def test_it_has_fewer_triangles_the_more_is_allowed(engine, shown):
    counts = []
    for tolerance in (0.0, 0.5, 2.0, 8.0):
        engine.render(shown(513, tolerance).with_camera(list(flight(6))[4]), size=SIZE)
        counts.append(engine.runner.draws.triangles)
    assert counts == sorted(counts, reverse=True) and counts[0] > 8 * counts[-1]

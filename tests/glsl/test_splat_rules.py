"""texturing/alpha_map: four weights by height, slope, curvature, a path, and what is painted."""

from __future__ import annotations

import numpy as np
import pytest

from playground.sketch.model import Camera

from ..sketch_texts import passes, use

HEIGHT = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) {{ return {}; }}\n'
MASK = '#pragma kernel(output = "mask:rgba32f")\nvec4 kernel(ivec2 texel) {{ return {}; }}\n'
TERRAIN = passes(height="./terrain")
RULE = TERRAIN + passes(cover=("texturing/alpha_map/rule", "set = {{ {} }}"))
PATH = passes(cover=("texturing/alpha_map/path", "set = {{ {} }}"))


@pytest.fixture
def cover(any_engine, make_sketch):
    """Give the covers of a rule on terrain of a formula, row 0 south."""

    def read(given, terrain="0.0", **more):
        return any_engine.read(
            make_sketch(RULE.format(given), terrain=HEIGHT.format(terrain), **more), "cover"
        ).astype(float)

    return read


# ── height ───────────────────────────────────────────────────────────────────

EASTWARD = "float(texel.x) / float(size.x - 1)"


def test_height_begins_and_ends_about_its_thresholds(cover):
    result = cover("height_from = 0.3, height_to = 0.7, height_fade = 0.2", EASTWARD, size=[201, 3])[1]
    levels = np.linspace(0, 1, 201)
    expected = np.interp(levels, [0.2, 0.4, 0.6, 0.8], [0, 1, 1, 0])
    np.testing.assert_allclose(result, expected, atol=1e-3)


def test_an_edge_that_does_not_fade_is_a_step(cover):
    result = cover("height_from = 0.5, height_fade = 0", EASTWARD, size=[200, 3])[1]
    np.testing.assert_array_equal(result, np.arange(200) / 199 >= 0.5)


def test_by_default_a_rule_covers_everything(cover):
    assert (cover("", "0.5 + 0.5 * sin(float(texel.x) * 2.0)", relief=2000.0) == 1).all()


# ── slope ────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("size", [[65, 65], [33, 129]])
def test_slope_is_an_angle_in_metres_on_any_grid(cover, size):
    # 30 degrees towards the north-east, on 1000 m by 400 m of terrain.
    rise = np.tan(np.radians(30)) / np.sqrt(2)
    plane = f"dot(vec2(texel) / vec2(size - 1), vec2(1000.0, 400.0)) * {rise / 1000}"
    for edge, expected in ((30.0, 0.5), (27.0, 0.8), (33.0, 0.2), (36.0, 0.0)):
        text = f"slope_from = {edge}, slope_fade = 10"
        result = cover(text, plane, size=size, extent=[1000.0, 400.0], relief=1000.0)
        np.testing.assert_allclose(result, expected, atol=2e-3)


def test_steep_terrain_can_be_left_out(cover):
    steep = "float(texel.x) * 0.01"  # 1 m a metre: 45 degrees
    assert (cover("slope_to = 40, slope_fade = 2", steep, size=101, extent=100.0) == 0).all()
    assert (cover("slope_to = 50, slope_fade = 2", steep, size=101, extent=100.0) == 1).all()


# ── curvature ────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(("bend", "expected"), [(4.0, 1.0), (2.0, 0.5), (0.0, 0.0), (-4.0, 0.0)])
def test_a_paraboloid_has_its_curvature_everywhere(cover, bend, expected):
    # z = k r^2 / 2, k = bend per km, on 400 m of terrain with 10 m of relief; off its middle as well.
    bowl = (
        f"dot(vec2(texel) - vec2(40.0, 52.0), vec2(texel) - vec2(40.0, 52.0)) * 25.0 * {bend / 1000 / 2 / 10}"
    )
    value = "by_curvature = true, curvature_from = 2, curvature_fade = 2, curvature_distance = 40"
    result = cover(value, bowl, size=81, extent=400.0, relief=10.0)
    # Where any of the four lines fits; in the corners, within the reach of two edges, none does.
    inside = np.ones((81, 81), bool)
    for rows in (slice(None, 8), slice(73, None)):
        for columns in (slice(None, 8), slice(73, None)):
            inside[rows, columns] = False
    np.testing.assert_allclose(result[inside], expected, atol=0.01)


def test_a_saddle_and_a_plane_bend_neither_up_nor_down(cover):
    value = "by_curvature = true, curvature_from = -0.5, curvature_to = 0.5"
    value += ", curvature_fade = 0.2, curvature_distance = 20"
    saddle = "(float(texel.x) - 40.0) * (float(texel.y) - 40.0) * 0.0004"
    assert cover(value, saddle, size=81, extent=400.0)[6:-6, 6:-6].min() > 0.99
    assert cover(value, "float(texel.x) * 0.03 + float(texel.y) * 0.02", size=81, extent=400.0).min() > 0.99


# ── chance ───────────────────────────────────────────────────────────────────


def test_chance_moves_edges_and_nothing_far_from_them(cover):
    value = "height_from = 0.5, height_fade = 0.1, ragged = 1, grain = 300"
    result = cover(value, EASTWARD, size=[129, 65])
    straight = cover("height_from = 0.5, height_fade = 0.1", EASTWARD, size=[129, 65])
    assert np.abs(result - straight).max() > 0.1
    assert (result[:, :44] == 0).all() and (result[:, 84:] == 1).all()
    assert np.abs(result - cover(f"{value}, seed = 2", EASTWARD, size=[129, 65])).max() > 0.1


def test_terrain_that_is_no_number_has_no_cover(cover):
    result = cover("height_from = 0.1", "texel.x > 3 ? uintBitsToFloat(0x7fc00000u) : 0.9", size=9)
    assert np.isfinite(result).all()
    assert (result[:, 5:] == 0).all()


# ── a path ───────────────────────────────────────────────────────────────────


def path(any_engine, make_sketch, value, **more):
    return any_engine.read(make_sketch(PATH.format(value), **more), "cover").astype(float)


def test_a_path_goes_through_its_points(any_engine, make_sketch):
    points = {"first": (0.1, 0.2), "second": (0.4, 0.8), "third": (0.7, 0.3), "fourth": (0.9, 0.9)}
    text = ", ".join(f"{name} = [{x}, {y}]" for name, (x, y) in points.items())
    result = path(any_engine, make_sketch, f"{text}, width = 30, verge = 20", size=101)
    for east, north in points.values():
        assert result[round(north * 100), round(east * 100)] == 1
    assert 0.05 < result.mean() < 0.2
    assert result[95, 5] == 0


def test_a_straight_path_has_its_width_and_its_verges(any_engine, make_sketch):
    level = "first = [0, 0.5], second = [0.3, 0.5], third = [0.6, 0.5], fourth = [1, 0.5]"
    result = path(any_engine, make_sketch, f"{level}, width = 100, verge = 50, strength = 0.5", size=101)
    away = np.abs(np.arange(101) - 50) * 10.0
    expected = 0.5 * np.interp(away, [50, 100], [1, 0])
    np.testing.assert_allclose(result, np.broadcast_to(expected[:, None], result.shape), atol=1e-3)


def test_a_path_may_stand_still_and_have_no_verge(any_engine, make_sketch):
    spot = "first = [0.5, 0.5], second = [0.5, 0.5], third = [0.5, 0.5], fourth = [0.5, 0.5]"
    result = path(any_engine, make_sketch, f"{spot}, width = 200, verge = 0", size=101)
    y, x = np.indices(result.shape) - 50
    clear = np.abs(np.hypot(x, y) - 10) > 1e-3
    np.testing.assert_array_equal(result[clear], (np.hypot(x, y) < 10)[clear])


def test_a_path_may_wander_but_not_away(any_engine, make_sketch):
    straight = (
        "first = [0, 0.5], second = [0.3, 0.5], third = [0.6, 0.5], fourth = [1, 0.5], width = 40, verge = 10"
    )
    result = path(any_engine, make_sketch, f"{straight}, wander = 100", size=101)
    middles = np.array([np.flatnonzero(column > 0.5).mean() for column in result.T])
    assert 1.0 < np.abs(middles - 50).max() < 10


# ── the map ──────────────────────────────────────────────────────────────────

STACK = passes(rock="./one", snow="./two", path="./three")
WEIGHTS = "texturing/alpha_map/stack"
COVERS = {
    name: '#include "noise/hash.glsl"\n' + MASK.format(f"vec4(random(texel, {n}u))")
    for n, name in enumerate(("one", "two", "three"))
}


def painted(size=None, **values):
    """Return the stack with a brush over it."""
    weights = use(WEIGHTS, inputs={"painted": "brush"}, **values)
    return STACK + passes(brush=use("./brush", size=size), weights=weights)


def bytes_of(any_engine, sketch):
    result = any_engine.read(sketch, "weights").astype(float) * 255
    np.testing.assert_allclose(result, np.round(result), atol=1e-3)
    return np.round(result).astype(int)


def test_in_every_texel_the_weights_sum_to_one_exactly(engine, make_sketch):
    sketch = make_sketch(STACK + passes(weights=WEIGHTS), size=[97, 61], **COVERS)
    result = bytes_of(engine, sketch)
    assert (result.sum(axis=-1) == 255).all()
    covers = np.stack([engine.read(sketch, name)[..., 0] for name in ("rock", "snow", "path")], -1).astype(
        float
    )
    left = np.ones(covers.shape[:2])
    for k in (2, 1, 0):
        np.testing.assert_allclose(result[..., k + 1], 255 * left * covers[..., k], atol=2.0)
        left *= 1 - covers[..., k]


def test_the_whole_map_sums_to_one_on_terrain(any_engine, make_sketch):
    text = passes(height="generation/diamond_square", weights="texturing/alpha_map")
    result = bytes_of(any_engine, make_sketch(text, size=129, extent=2000.0, relief=900.0))
    assert (result.sum(axis=-1) == 255).all()
    assert (result.reshape(-1, 4).max(axis=0) > 100).all(), "each layer is somewhere"


@pytest.mark.parametrize("layers", [1, 2, 3])
def test_fewer_layers_leave_the_others_out(any_engine, make_sketch, layers):
    text = painted(layers=layers)
    result = bytes_of(any_engine, make_sketch(text, size=17, brush=MASK.format("vec4(0.2)"), **COVERS))
    assert (result[..., layers:] == 0).all()
    assert (result.sum(axis=-1) == 255).all()


def test_full_strength_paint_overrides_and_none_changes_nothing(any_engine, make_sketch):
    plain = bytes_of(any_engine, make_sketch(STACK + passes(weights=WEIGHTS), size=33, **COVERS))
    half = "texel.x < 11 ? vec4(0.0) : texel.x < 22 ? vec4(0.0, 0.0, 0.5, 0.0) : vec4(0.0, 0.0, 1.0, 1.0)"
    sketch = make_sketch(painted(), size=33, brush=MASK.format(half), **COVERS)
    result = bytes_of(any_engine, sketch)
    np.testing.assert_array_equal(result[:, :11], plain[:, :11])
    np.testing.assert_allclose(
        result[:, 11:22], 0.5 * plain[:, 11:22] + 0.5 * np.array([0, 0, 255, 0]), atol=1.51
    )
    np.testing.assert_allclose(result[:, 22:], np.broadcast_to([0, 0, 127.5, 127.5], (33, 11, 4)), atol=0.51)


def test_a_mask_may_be_finer_or_coarser_than_the_map(any_engine, make_sketch):
    slope = MASK.format("vec4(size.x - 1 - texel.x, texel.x, 0.0, 0.0) / float(size.x - 1)")
    for size in (9, 129):
        sketch = make_sketch(painted(size), size=33, brush=slope, **COVERS)
        result = bytes_of(any_engine, sketch)
        np.testing.assert_allclose(result[5, :, 1], np.linspace(0, 255, 33), atol=0.6)


def test_another_layer_can_stand_in_by_name(any_engine, make_sketch):
    weights = use("texturing/alpha_map", inputs={"weights.rock": "marsh"}, path=0)
    text = TERRAIN + passes(marsh="./marsh", weights=weights)
    sketch = make_sketch(
        text, terrain=HEIGHT.format("0.2"), marsh=MASK.format("vec4(float(texel.y > 8))"), size=17
    )
    result = bytes_of(any_engine, sketch)
    assert (result[:9, :, 0] == 255).all() and (result[9:, :, 1] == 255).all()


def test_more_than_four_layers_are_refused_in_one_sentence(make_sketch):
    from playground.errors import PlaygroundError

    with pytest.raises(PlaygroundError) as caught:
        make_sketch(
            TERRAIN + passes(weights=use("texturing/alpha_map", layers=5)),
            terrain=HEIGHT.format("0.0"),
        )
    assert "layers" in str(caught.value) and "1" in str(caught.value) and "4" in str(caught.value)
    assert "\n" not in str(caught.value)


# ── distance to the eye ──────────────────────────────────────────────────────


def test_far_away_one_layer_gives_way_to_another(any_engine, make_sketch):
    ways = {"near": "rock", "far": "snow", "begins": 700, "ends": 1100}
    weights = use("texturing/alpha_map/distance", inputs={"weights": "plain"}, **ways)
    text = TERRAIN + passes(plain="./plain", weights=weights)
    hill = "0.3 + 0.002 * float(texel.x)"
    sketch = make_sketch(
        text, size=[41, 21], extent=[1000.0, 500.0], relief=300.0,
        terrain=HEIGHT.format(hill), plain=MASK.format("vec4(0.2, 0.6, 0.0, 0.2)"),
    ).with_camera(Camera(azimuth=230, elevation=20, distance=900, target=(500, 250, 90)))  # fmt: skip
    result = bytes_of(any_engine, sketch)
    assert (result.sum(axis=-1) == 255).all()
    y, x = np.indices((21, 41))
    places = np.stack([x * 25.0, y * 25.0, 300 * (0.3 + 0.002 * x)], axis=-1)
    away = np.linalg.norm(places - np.array(any_engine.record.plan.eye.position), axis=-1)
    assert away.min() < 700 and away.max() > 1100
    gone = np.clip((away - 700) / 400, 0, 1)
    np.testing.assert_allclose(result[..., 2], 153 * gone, atol=1.01)
    np.testing.assert_allclose(result[..., 1], 153 * (1 - gone), atol=1.01)
    assert (result[..., 0] == 51).all() and (result[..., 3] == 51).all()


def test_a_moved_camera_runs_the_distance_and_not_the_rules(any_engine, make_sketch):
    weights = use("texturing/alpha_map/distance", inputs={"weights": "rules"})
    text = TERRAIN + passes(rules="texturing/alpha_map", weights=weights)
    sketch = make_sketch(text, terrain=HEIGHT.format("0.5"))
    any_engine.read(sketch, "weights")
    any_engine.read(sketch.with_camera(Camera(azimuth=100)), "weights")
    assert any_engine.record.ran == ["weights"]

"""L·N and the ray cast: closed forms, symmetries, a slow march in float64, shadows in metres.

``light`` is rgba16f: comparisons allow a half float's rounding, 2^-11 of the value.
"""

from functools import partial

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from ..sketch_texts import passes
from ..truth.land import towards
from ..truth.marches import Views
from .terrains import HILLS

HALF = 2.0**-11
BOTH = pytest.mark.parametrize("method", ["l_dot_n", "ray_cast"])

PLANE = """
#pragma kernel(output = "height:r32f")
uniform vec2 rise = vec2(0.0);   // heights a texel
uniform float base = 0.0;
float kernel(ivec2 texel) { return base + dot(vec2(texel), rise); }
"""
WALL = """
#pragma kernel(output = "height:r32f")
uniform ivec2 at = ivec2(-1);   // the column or row that stands up
uniform float high = 1.0;
float kernel(ivec2 texel) { return texel.x == at.x || texel.y == at.y ? high : 0.0; }
"""


@pytest.fixture
def lit(lit):
    """Give the same with a gain of 1."""
    return partial(lit, gain=1.0)


def shade(heights, sun, spacing):
    """Return max(0, N·L) with normals from cross products of the surface's two tangents, float64."""
    north, east = np.gradient(heights, *spacing[::-1])
    tangent_x = np.stack([np.ones_like(east), np.zeros_like(east), east], axis=-1)
    tangent_y = np.stack([np.zeros_like(east), np.ones_like(east), north], axis=-1)
    normal = np.cross(tangent_x, tangent_y)
    return np.maximum((normal @ sun) / np.linalg.norm(normal, axis=-1), 0)


# The sun


def test_the_sun_is_where_the_compass_says(on_gpu):
    places = {
        (0, 0): (0, 1, 0),
        (90, 0): (1, 0, 0),
        (180, 0): (0, -1, 0),
        (270, 0): (-1, 0, 0),
        (45, 90): (0, 0, 1),
    }
    result = on_gpu("lighting/sun.glsl", "to_sun(place)", place=np.array(list(places), np.float64))
    np.testing.assert_array_equal(result, list(places.values()))


def test_the_sun_is_a_unit_vector_at_its_angles(on_gpu):
    places = np.random.default_rng(1).uniform((-720, -90), (720, 90), (500, 2)).astype(np.float32)
    result = on_gpu("lighting/sun.glsl", "to_sun(place)", place=places).astype(np.float64)
    np.testing.assert_allclose(np.linalg.norm(result, axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(np.degrees(np.arcsin(np.clip(result[:, 2], -1, 1))), places[:, 1], atol=0.03)
    np.testing.assert_allclose(result, [towards(*p) for p in places.astype(np.float64)], atol=2e-6)


def test_a_normal_is_perpendicular_to_its_slope(on_gpu):
    slopes = np.random.default_rng(2).normal(0, 2, (300, 2))
    result = on_gpu("lighting/sun.glsl", "normal_of_slope(slope)", slope=slopes).astype(np.float64)
    np.testing.assert_allclose(np.linalg.norm(result, axis=1), 1, atol=1e-6)
    east = np.stack([np.ones(300), np.zeros(300), slopes[:, 0]], axis=1)
    north = np.stack([np.zeros(300), np.ones(300), slopes[:, 1]], axis=1)
    for tangent in (east, north):
        np.testing.assert_allclose((result * tangent).sum(axis=1), 0, atol=2e-6)


# Both methods


@BOTH
@pytest.mark.parametrize("normal", ["central differences", "one triangle"])
@pytest.mark.parametrize("sun", [(135, 25), (300, 50), (90, 10), (0, 90)], ids=str)
def test_an_inclined_plane_is_the_cosine_of_its_angle(engine, lit, method, normal, sun):
    rise = (0.012, -0.007)  # 100 m of relief; 10 m a texel east, 25 m north
    sketch = lit(PLANE, method, sun, size=[41, 17], extent=[400, 400], given={"rise": rise}, normal=normal)
    light = engine.read(sketch, "light")[..., :3]
    normal = np.cross([1, 0, rise[0] * 100 / 10], [0, 1, rise[1] * 100 / 25])
    truth = max(0, normal @ towards(*sun) / np.linalg.norm(normal))
    np.testing.assert_allclose(light, truth, rtol=1.5 * HALF, atol=1e-4)


@BOTH
@pytest.mark.parametrize("sun", [(135, 25), (0, 30), (211, 8)], ids=str)
def test_rough_terrain_is_shaded_by_its_own_normals(engine, lit, method, sun):
    sketch = lit(HILLS, method, sun, size=[65, 49], extent=[640, 960], relief=300.0)
    heights = engine.read(sketch, "height").astype(np.float64) * 300
    light = engine.read(sketch, "light").astype(np.float64)
    truth = shade(heights, towards(*sun), (10.0, 20.0))
    inner = light[1:-1, 1:-1]
    np.testing.assert_allclose(inner[..., 0], truth[1:-1, 1:-1] * inner[..., 3], rtol=2 * HALF, atol=1e-3)
    np.testing.assert_allclose(light[..., 0], truth * light[..., 3], rtol=2 * HALF, atol=1e-3)


def test_the_one_triangle_is_the_thesis_triangle(engine, lit):
    sun = (135, 25)
    sketch = lit(HILLS, "l_dot_n", sun, relief=300.0, extent=640.0, normal="one triangle")
    h = engine.read(sketch, "height").astype(np.float64) * 300
    south_west, south_east, north_east = h[:-2, :-2], h[:-2, 2:], h[2:, 2:]
    flat = np.zeros_like(south_west)
    normal = np.cross(
        np.stack([flat + 20, flat, south_east - south_west], axis=-1),
        np.stack([flat, flat + 20, north_east - south_east], axis=-1),
    )
    truth = np.maximum(normal @ towards(*sun) / np.linalg.norm(normal, axis=-1), 0)
    result = engine.read(sketch, "light")[1:-1, 1:-1, 0]
    np.testing.assert_allclose(result, truth, rtol=2 * HALF, atol=1e-3)


@BOTH
def test_colours_gain_and_ambient(engine, lit, method):
    values = {"gain": 2.0, "sun_colour": (1.0, 0.5, 0.25), "sky_colour": (0.0, 0.5, 1.0), "ambient": 0.2}
    light = engine.read(lit(PLANE, method, (0, 90), **values), "light")
    np.testing.assert_allclose(light[3, 3], [2.0, 1.1, 0.7, 1.0], rtol=2 * HALF)


@BOTH
def test_gain_is_not_cut_at_1_and_is_2_by_default(engine, lit, method, make_sketch):
    text = passes(height="./terrain", light=f"lighting/{method}")
    sketch = make_sketch(text, terrain=PLANE)
    light = engine.read(sketch.with_values({"light.sun": (0, 90)}), "light")
    np.testing.assert_array_equal(light, [[[2, 2, 2, 1]] * 33] * 33)


@BOTH
def test_a_terrain_without_relief_is_flat(engine, lit, method):
    light = engine.read(lit(HILLS, method, (135, 30), relief=0.0), "light")
    np.testing.assert_allclose(light[..., 0], 0.5, rtol=HALF)


@BOTH
def test_a_finer_light_map_agrees_where_they_meet(engine, lit, method):
    values = {"size": [65, 49], "extent": [640, 960], "relief": 300.0}
    same = engine.read(lit(HILLS, method, (135, 25), **values), "light")
    fine = engine.read(
        lit(HILLS, method, (135, 25), light_size='["2*size.x-1", "2*size.y-1"]', **values), "light"
    )
    np.testing.assert_array_equal(fine[::2, ::2], same)
    coarse = engine.read(lit(HILLS, method, (135, 25), light_size="[33, 25]", **values), "light")
    np.testing.assert_array_equal(coarse, same[::2, ::2])


@BOTH
def test_a_light_map_of_any_size_sees_the_same_slopes(engine, lit, method):
    values = {"size": 65, "relief": 100.0, "given": {"rise": (0.01, 0.004)}}
    for size in ("[65, 65]", "[130, 33]", "[17, 201]"):
        light = engine.read(lit(PLANE, method, (200, 35), light_size=size, **values), "light")
        # Texels of the border see the plane from one side only, which is the same plane.
        np.testing.assert_allclose(light, np.broadcast_to(light[5, 5], light.shape), rtol=2 * HALF)


# The ray cast


@pytest.mark.parametrize("step_length", [1.0, 0.5, 2.0, 0.75])
@pytest.mark.parametrize("sun", [(135, 25), (90, 15), (0, 5), (317, 40), (45, 10), (222.5, 60)], ids=str)
def test_shadows_are_those_of_a_slow_march(engine, lit, sun, step_length):
    sketch = lit(
        HILLS, "ray_cast", sun, size=[65, 49], extent=[640, 960], relief=300.0, step_length=step_length
    )
    heights = engine.read(sketch, "height").astype(np.float64) * 300
    visible = engine.read(sketch, "light")[..., 3]
    direction = towards(*sun)
    room = Views(heights, sun[0], (10.0, 20.0), step_length).clearance(sun[1])
    facing = shade(heights, direction, (10.0, 20.0))
    sure = (np.abs(room) > 0.01) & (np.abs(facing) > 1e-4)
    assert sure.mean() > 0.5
    truth = (room > 0) & (facing > 0)
    np.testing.assert_array_equal(visible[sure & (facing > 0)] > 0, truth[sure & (facing > 0)])
    np.testing.assert_array_equal(visible[facing == 0], 0)


@pytest.mark.parametrize(("scale", "base"), [(3.0, -1.0), (0.5, 10.0), (1.0, -20.0)])
def test_heights_beyond_0_to_1_throw_their_shadows(engine, lit, scale, base):
    sun = (120, 20)
    sketch = lit(HILLS, "ray_cast", sun, extent=640.0, relief=200.0, given={"scale": scale, "base": base})
    heights = engine.read(sketch, "height").astype(np.float64) * 200
    visible = engine.read(sketch, "light")[..., 3]
    room = Views(heights, sun[0], (10.0, 10.0)).clearance(sun[1])
    facing = shade(heights, towards(*sun), (10.0, 10.0)) > 1e-4
    sure = (np.abs(room) > 0.05) & facing
    assert (room[sure] < 0).any()
    np.testing.assert_array_equal(visible[sure] > 0, room[sure] > 0)


@pytest.mark.parametrize("azimuth", [90.0, 270.0, 70.0, 300.0])
@pytest.mark.parametrize("elevation", [15.0, 30.0, 50.0])
def test_a_wall_throws_its_shadow_in_metres_to_the_west_and_east(engine, lit, azimuth, elevation):
    """High 100 m on column 64; texels are 10 m by 20 m."""
    sun = (azimuth, elevation)
    sketch = lit(WALL, "ray_cast", sun, size=[129, 65], extent=[1280, 1280], given={"at": (64, -1)})
    row = engine.read(sketch, "light")[32, :, 3]
    length = 100 / np.tan(np.radians(elevation)) * abs(np.sin(np.radians(azimuth)))
    away = (np.arange(129) - 64) * 10.0 * (-1 if azimuth < 180 else 1)  # metres behind the wall
    behind = (away > 10) & (np.abs(away - length) > 0.5)
    np.testing.assert_array_equal(row[behind] == 0, away[behind] < length)
    np.testing.assert_array_equal(row[away < -10], 1)


@pytest.mark.parametrize("azimuth", [0.0, 180.0, 30.0, 200.0])
def test_wall_shadow_has_metric_length_north_and_south(engine, lit, azimuth):
    sun = (azimuth, 25.0)
    sketch = lit(
        WALL, "ray_cast", sun, size=[129, 65], extent=[1280, 1280], given={"at": (-1, 32)}, step_length=0.25
    )
    column = engine.read(sketch, "light")[:, 64, 3]
    length = 100 / np.tan(np.radians(25)) * abs(np.cos(np.radians(azimuth)))
    away = (np.arange(65) - 32) * 20.0 * (-1 if np.cos(np.radians(azimuth)) > 0 else 1)
    # A step_length that is not whole may miss the crest itself, which is one texel sharp.
    behind = (away > 20) & (np.abs(away - length) > 20)
    np.testing.assert_array_equal(column[behind] == 0, away[behind] < length)
    np.testing.assert_array_equal(column[away < -20], 1)


@pytest.mark.parametrize("form", ["march", "sweep"])
def test_sun_change_reuses_terrain_and_its_block_maxima(any_engine, lit, form):
    sketch = lit(HILLS, "ray_cast", (135, 25), form=form)
    any_engine.read(sketch, "light")
    existing = {"light.visibility.fast.block_maxima", "light.visibility.fast.range.whole"}
    assert existing | {"height"} < set(any_engine.record.ran)
    any_engine.read(sketch.with_values({"light.sun": (140, 25)}), "light")
    assert any_engine.record.ran == ["light.horizon", "light.visibility.fast.visibility", "light.light"]
    shapes = {step.path: step.size for step in any_engine.record.plan.walk()}
    assert shapes["light.horizon"] == ((65, 65) if form == "sweep" else (1, 1))


# What every method of shadows ends with


def test_light_is_what_is_seen_of_the_sun_and_of_the_sky(engine, make_sketch):
    """V falls on the sun's light and F on the sky's, each channel for itself."""
    value = """
#pragma kernel(output = "v:rgba32f")
uniform vec3 step_of = vec3(0.1, 0.0, 0.0);
vec4 kernel(ivec2 texel) { return vec4(float(texel.x) * step_of, 1.0); }
"""
    text = passes(
        height=("./terrain", "set = { rise = [0.05, 0.02] }"),
        visibility="./given",
        sky_factor=("./given", "set = { step_of = [0.0, 0.05, 0.1] }"),
        light=(
            "lighting/shade",
            "[pass.set]",
            "sun = [200.0, 40.0]",
            "gain = 1.5",
            "sun_colour = [1.0, 0.8, 0.6]",
            "sky_colour = [0.5, 0.6, 0.7]",
            "ambient = 0.3",
        ),
    )
    sketch = make_sketch(text, size=9, extent=80.0, relief=50.0, terrain=PLANE, given=value)
    light = engine.read(sketch, "light")
    x = np.broadcast_to(np.arange(9), (9, 9))
    normal = np.array([-0.05 * 50 / 10, -0.02 * 50 / 10, 1.0])
    received = normal @ towards(200, 40) / np.linalg.norm(normal)
    expected = np.stack(
        [
            1.0 * 1.5 * received * 0.1 * x,
            0.8 * 1.5 * received * 0.1 * x + 0.6 * 0.3 * 0.05 * x,
            0.6 * 1.5 * received * 0.1 * x + 0.7 * 0.3 * 0.1 * x,
            0.1 * x,
        ],
        axis=-1,
    )
    np.testing.assert_allclose(light, expected, rtol=2 * HALF, atol=1e-4)


def test_light_of_other_size_interpolates_its_inputs(engine, make_sketch):
    value = """
#pragma kernel(output = "v:r32f")
float kernel(ivec2 texel) { return float(texel.x + 2 * texel.y) / 64.0; }
"""
    text = passes(
        height="./terrain",
        visibility="./given",
        light=("lighting/shade", "size = [25, 33]", "set = { sun = [0.0, 90.0] }"),
    )
    light = engine.read(make_sketch(text, size=9, terrain=PLANE, given=value), "light")
    y, x = np.mgrid[0:33, 0:25]
    np.testing.assert_allclose(light[..., 3], (x / 3 + 2 * (y / 4)) / 64, rtol=2 * HALF, atol=1e-4)


def test_slopes_between_texels_are_interpolated_from_texels(engine, lit):
    """Texels of the light on texels of the terrain are next to others that are not."""
    sun = (135, 25)
    sketch = lit(HILLS, "l_dot_n", sun, light_size="[129, 97]", relief=300.0, extent=640.0)
    heights = engine.read(sketch, "height").astype(np.float64) * 300
    places = np.meshgrid(np.linspace(0, 64, 97), np.linspace(0, 64, 129), indexing="ij")
    slopes = [map_coordinates(s, places, order=1) for s in np.gradient(heights, 10.0)]
    normal = np.stack([-slopes[1], -slopes[0], np.ones_like(slopes[0])], axis=-1)
    expected = np.maximum(normal @ towards(*sun) / np.linalg.norm(normal, axis=-1), 0)
    np.testing.assert_allclose(engine.read(sketch, "light")[..., 0], expected, rtol=2 * HALF, atol=1e-3)

"""scene/: where each pixel lies, what it covers of the ground, and its light, lit once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from playground.engine.plan import Window
from playground.engine.textures import read_picture
from playground.errors import SketchError
from playground.shader.colours import srgb_to_linear
from playground.sketch.model import Camera

HEIGHT = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) {{ return {}; }}\n'
COLOUR = '#pragma kernel(output = "colour:rgba16f")\nvec4 kernel(ivec2 texel) {{ return {}; }}\n'
PASSES = '[[pass]]\nname = "height"\nuse = "./terrain"\n[[pass]]\nname = "colour"\nuse = "./cover"\n'
EXTENT = (900.0, 700.0)
RELIEF = 300.0
SIZE = (150, 97)
RIDGE = 16.0  # [m] between neighbouring pixels: one of them sees past a ridge; level ground has 8
LOOK = Camera(azimuth=200, elevation=35, distance=700, target=(450, 330, 60))
# Heights 0..1 of a plane that rises to the east and, less, to the north.
RISE = np.array([0.5, 0.3])
PLANE = f"{RISE[0]} * float(texel.x) / float(size.x - 1) + {RISE[1]} * float(texel.y) / float(size.y - 1)"
SLOPE = RISE * RELIEF / np.array(EXTENT)
BUMPY = "0.5 + 0.2 * sin(float(texel.x) * 0.4) * cos(float(texel.y) * 0.3)"
TINTED = (
    "vec4(0.2 + 0.6 * float(texel.x) / float(size.x), 0.4, 0.9 - 0.6 * float(texel.y) / float(size.y), 1.0)"
)


@pytest.fixture
def scene(make_sketch):
    """Give a function that makes a sketch of a height and a colour, and what else its text has."""

    def make(height=PLANE, colour=TINTED, view="scene/terrain", given="", passes="", wired="", **more):
        given = ", ".join(filter(None, [given, "antialias = false" if view.startswith("scene") else ""]))
        set_ = f"set = {{ grid = 65{', ' if given else ''}{given} }}"
        inputs = f"inputs = {{ {wired} }}\n" if wired else ""
        text = f'{PASSES}{passes}[view]\nuse = "{view}"\nsamples = 1\n{inputs}{set_}\n'
        size = {"size": [65, 41], "extent": list(EXTENT), "relief": RELIEF} | more
        sketch = make_sketch(text, terrain=HEIGHT.format(height), cover=COLOUR.format(colour), **size)
        return sketch.with_camera(LOOK)

    return make


def rays(plan, pixels):
    """Return the eye and the directions of pixels' middles (column, row from the south) in float64."""
    eye = np.array(plan.eye.position, float)
    back = np.linalg.inv(plan.eye.clip_from_world.astype(float))
    position = (np.asarray(pixels, float) + 0.5) / np.array(plan.frame_size) * 2 - 1
    far = np.concatenate([position, np.ones((*position.shape[:-1], 2))], axis=-1) @ back.T
    return eye, far[..., :3] / far[..., 3:] - eye


def on_plane(eye, ahead):
    """Return where rays meet the plane of PLANE."""
    normal = np.array([-SLOPE[0], -SLOPE[1], 1.0])
    return eye + ahead * (-(eye @ normal) / (ahead @ normal))[..., None]


def inside(points, margin=8.0):
    """Return which points are on the terrain and not at its edge."""
    return np.all((points[..., :2] > margin) & (points[..., :2] < np.array(EXTENT) - margin), axis=-1)


def all_pixels(size=SIZE):
    """Return the column and the row of every pixel, row by row from the south."""
    rows, columns = np.indices(size[::-1])
    return np.stack([columns, rows], axis=-1)


# ── surfaces ─────────────────────────────────────────────────────────────────────


def test_what_a_pixel_is_comes_back(on_gpu):
    file = "scene/surfaces.glsl"
    depth = np.linspace(0.0, 1.0, 33, dtype=np.float32)
    cut = on_gpu(file, "packed_cut(d)", d=depth)
    np.testing.assert_allclose(on_gpu(file, "depth_of_cut(w)", w=cut), depth, atol=1e-6)
    kinds = np.array([-1.0, 0.0, 1.0, cut[0], cut[-1], 3.0, 4.0, 2.0**22], np.float32)
    names = ["is_broken", "is_sky", "is_top", "is_cut", "is_cut", "is_water", "is_object", "is_object"]
    for name in dict.fromkeys(names):
        result = on_gpu(file, f"{name}(w) ? 1.0 : 0.0", w=kinds)
        np.testing.assert_array_equal(result, [float(other == name) for other in names])


# ── where ───────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("detail", ["full grid", "morph"])
def test_each_pixel_has_the_point_of_a_plane_that_its_ray_meets(any_engine, scene, detail):
    sketch = scene(given=f'detail = "{detail}"').with_camera(replace(LOOK, distance=1500))
    result = any_engine.read(sketch, "view.where", size=SIZE).astype(float)
    eye, ahead = rays(any_engine.record.plan, all_pixels())
    points = on_plane(eye, ahead)
    land = inside(points)
    assert land.sum() > 4000
    assert np.all(result[land][:, 3] == 1)
    np.testing.assert_allclose(result[land][:, :3], points[land], atol=2e-3)
    missed = np.any((points[..., :2] < -500) | (points[..., :2] > 1500), axis=-1)
    assert missed.sum() > 100 and np.all(result[missed][:, 3] == 0)
    cut = (result[..., 3] >= 2) & (result[..., 3] < 3)
    assert cut.sum() > 100
    rim = np.minimum(result[cut][:, :2], np.array(EXTENT) - result[cut][:, :2]).min(axis=1)
    np.testing.assert_allclose(rim, 0.0, atol=1e-2)


STRIPES = """
#pragma kernel(output = "ground:rgba16f")
vec4 kernel(ivec2 texel) { return vec4(0.0, 0.0, float((size.x > size.y ? texel.x : texel.y) % 2), 1.0); }
"""
MEAN = """
#include "maths/land.glsl"
#include "scene/ground_reading.glsl"
#pragma kernel(output = "mean:r32f")
uniform sampler2D ground;  //! input("linear", "mipmap")
float kernel(ivec2 texel) {
    return ground_at(ground, (0.1 + 0.8 * share_of_texel(texel, size)) * extent, extent, 16.0).sky;
}
"""


@pytest.mark.parametrize("size", [[64, 256], [256, 64]])
def test_the_ground_is_read_by_its_finer_axis(any_engine, make_sketch, size):
    """Stripes one texel wide, 4 m along the finer axis: a square of 16 m has as much of either."""
    passes = f'[[pass]]\nname = "ground"\nuse = "./stripes"\nsize = {size}\n'
    passes += '[[pass]]\nname = "mean"\nuse = "./reading"\nsize = 33'
    sketch = make_sketch(passes, size=size, extent=[1024.0, 1024.0], stripes=STRIPES, reading=MEAN)
    np.testing.assert_allclose(any_engine.read(sketch, "mean"), 0.5, atol=0.02)


# ── footprint ───────────────────────────────────────────────────────────────────


def test_a_footprint_is_the_way_to_the_points_of_the_next_pixels(any_engine, on_gpu, scene):
    any_engine.read(scene(), "view.where", size=SIZE)
    plan = any_engine.record.plan
    pixels = np.array([[70, 60], [20, 40], [140, 30], [75, 10]])
    eye, ahead = rays(plan, pixels)
    normal = np.array([-SLOPE[0], -SLOPE[1], 1.0]) / np.linalg.norm([*SLOPE, 1.0])
    back = plan.eye.world_from_clip.astype(np.float32)
    columns = {f"c{i}": tuple(float(v) for v in back[:, i]) for i in range(4)}
    ray = f"pixel_ray(mat4(c0, c1, c2, c3), from, p, vec2{SIZE})"
    values = {
        **columns,
        "from": tuple(map(float, eye)),
        "p": (pixels + 0.5).astype(np.float32),
        "way": (on_plane(eye, ahead) - eye).astype(np.float32),
        "n": tuple(map(float, normal)),
    }
    for name, step in (("right", (1, 0)), ("up", (0, 1))):
        result = on_gpu("scene/footprint.glsl", f"footprint_of({ray}, way, n).{name}", **values)
        # The mean of both neighbours: what is left is of third order in a pixel.
        away = [on_plane(*rays(plan, pixels + sign * np.array(step)))[:, :2] for sign in (1, -1)]
        np.testing.assert_allclose(result, 0.5 * (away[0] - away[1]), rtol=2e-3, atol=2e-4)


# ── the ground ──────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("size", ["", "size = [33, 57]\n"])
def test_scene_ground_has_metric_slopes_and_input_light(any_engine, make_sketch, size):
    maps = '#pragma kernel(output = "{}:rgba16f")\nvec4 kernel(ivec2 t) {{ return vec4({}); }}\n'
    text = PASSES + '[[pass]]\nname = "sun"\nuse = "./sun"\n[[pass]]\nname = "sky"\nuse = "./sky"\n'
    text += f'[[pass]]\nname = "ground"\nuse = "scene/ground"\n{size}'
    value = {"size": [65, 41], "extent": list(EXTENT), "relief": RELIEF, "terrain": HEIGHT.format(PLANE)}
    value |= {"cover": COLOUR.format("vec4(1.0)"), "sun": maps.format("sun", "float(t.x) / 64.0")}
    value |= {"sky": maps.format("sky", "0.25, 0.5, 0.75, 1.0")}
    bare = any_engine.read(make_sketch(text, **value), "ground").astype(float)
    np.testing.assert_allclose(bare[..., :2], np.broadcast_to(SLOPE, bare[..., :2].shape), rtol=1e-3)
    np.testing.assert_array_equal(bare[..., 2:], 1.0)
    wired = text + 'inputs = { visibility = "sun", sky_factor = "sky" }\n'
    result = any_engine.read(make_sketch(wired, **value), "ground").astype(float)
    np.testing.assert_array_equal(result[..., 2], 0.5)
    along = np.linspace(0.0, 1.0, result.shape[1])
    np.testing.assert_allclose(result[..., 3], np.broadcast_to(along, result.shape[:2]), atol=1e-3)


# ── the picture ─────────────────────────────────────────────────────────────────

HAZE = 'haze = 0.4, horizon = "#a07040", tone = "film"'
SUN = '[[pass]]\nname = "light"\nuse = "lighting/shade"\nset = {{ {} }}\n'
LIT = "sun = { azimuth = 100.0, elevation = 30.0 }, gain = 1.5, ambient = 0.2"
LIT += ', sun_colour = "#ffeedd", sky_colour = "#aaccff"'


def pictures(engine, *sketches, size=SIZE):
    """Return the pictures of sketches, and which pixels show the terrain and no edge of it."""
    result = [engine.render(sketch, size=size).array.astype(int) for sketch in sketches]
    seen = engine.read(sketches[-1], "view.where", size=size)[::-1]
    top = (seen[..., 3] == 1) & inside(seen.astype(float))
    for axis in (0, 1):
        for step in (1, -1):
            beside = np.roll(seen, step, axis)
            top &= (beside[..., 3] == 1) & (np.linalg.norm((seen - beside)[..., :3], axis=-1) < RIDGE)
    return [*result, top]


@pytest.mark.parametrize("height", [PLANE, BUMPY])
def test_with_a_baked_light_it_is_view_terrain(any_engine, scene, height):
    """Mesh, cut, colour, light, haze and sky: within a level, edges within their own pixel."""
    both = [
        scene(height, view=view, passes=SUN.format(LIT), given=HAZE)
        for view in ("view/terrain", "scene/terrain")
    ]
    expected, result, top = pictures(any_engine, *both)
    assert top.sum() > 4000 and expected[top].std() > 10
    assert np.abs(result - expected)[top].max() <= 1
    seen = any_engine.read(both[1], "view.where", size=SIZE)[::-1, :, 3]
    sky, cut = seen == 0, (seen >= 2) & (seen < 3)
    assert sky.sum() > 100 or cut.sum() > 100
    np.testing.assert_array_equal(result[sky], expected[sky])
    np.testing.assert_allclose(result[cut], expected[cut], atol=1)


def test_each_pixel_is_lit_as_a_plane_is_by_a_map(any_engine, scene):
    """On a plane the slope under every pixel is that of every texel."""
    baked = scene(view="view/terrain", passes=SUN.format(LIT), given=HAZE)
    expected, result, top = pictures(any_engine, baked, scene(given=f"{HAZE}, {LIT}"))
    assert np.abs(result - expected)[top].max() <= 1


@pytest.mark.parametrize("blend", ["even", "by heights"])
def test_four_tiles_by_their_weights_are_view_splat(any_engine, scene, blend):
    tiles = {name: COLOUR.format(text) for name, text in zip(LAYERS, TILES, strict=True)}
    weights = "vec4(0.4, 0.3, 0.2, 0.1) + 0.05 * vec4(1, -1, 1, -1) * float(texel.x) / 64.0"
    tiles["weights"] = COLOUR.format(weights).replace("colour:rgba16f", "weights:rgba8")
    passes = '[[pass]]\nname = "weights"\nuse = "./weights"\n'
    passes += "".join(f'[[pass]]\nname = "{name}"\nuse = "./{name}"\nsize = 16\n' for name in LAYERS)
    text = f'repeats = 3, blend = "{blend}", skirt = 0.03'
    plain = scene(BUMPY, view="view/splat", passes=SUN.format(LIT) + passes, given=text, **tiles)
    own = ", ".join(f"{name}_repeats = 3" for name in LAYERS)
    text = text.replace("repeats = 3", own)
    mine = scene(BUMPY, passes=SUN.format(LIT) + passes, given=text, **tiles)
    expected, result, top = pictures(any_engine, plain, mine)
    assert expected[top].std() > 10
    assert (np.abs(result - expected)[top].max(axis=-1) > 2).mean() < 0.01, "levels of detail round otherwise"


LAYERS = ("grass", "rock", "snow", "path")
TILES = [
    "vec4(0.2, 0.5 + 0.1 * sin(float(texel.x)), 0.1, 1.0)",
    "vec4(0.5, 0.4 + 0.1 * cos(float(texel.y) * 0.8), 0.4, 1.0)",
    "vec4(0.9)",
    "vec4(0.6, 0.3, 0.1, 1.0)",
]


def test_bumps_turn_a_pixel_s_slope_and_a_shadow_hides_the_sun(any_engine, scene):
    """Both are pictures of pixels; level ground with bumps of a plane's slope is lit as that plane."""
    maps = '#pragma kernel(output = "{}:rgba16f")\nvec4 kernel(ivec2 t) {{ return {}; }}\n'
    passes = '[[pass]]\nname = "{0}"\nuse = "./{0}"\nsize = [150, 97]\n'
    more = {"bumps": maps.format("bumps", f"vec4({SLOPE[0]}, {SLOPE[1]}, 0.0, 0.0)")}
    sketch = scene("0.1", given=LIT, passes=passes.format("bumps"), **more)
    frame = any_engine.read(sketch, "view.shaded", size=SIZE)[..., :3].astype(float)
    albedo = any_engine.read(sketch, "view.cover", size=SIZE)[..., :3].astype(float)
    seen = any_engine.read(sketch, "view.where", size=SIZE)
    top = seen[..., 3] == 1
    azimuth, elevation = np.radians([100.0, 30.0])
    to_sun = [np.sin(azimuth) * np.cos(elevation), np.cos(azimuth) * np.cos(elevation), np.sin(elevation)]
    normal = np.array([*-SLOPE, 1.0]) / np.linalg.norm([*SLOPE, 1.0])
    linear = lambda text: np.array([srgb_to_linear(int(text[i : i + 2], 16) / 255) for i in (0, 2, 4)])  # noqa: E731
    sky = 0.2 * linear("aaccff")
    expected = 1.5 * linear("ffeedd") * (normal @ np.array(to_sun)) + sky
    np.testing.assert_allclose(frame[top], albedo[top] * expected, rtol=2e-3)
    more = {"shadow": maps.format("shadow", "vec4(0.0)")}
    dark = scene("0.1", given=LIT, passes=passes.format("shadow"), **more)
    frame = any_engine.read(dark, "view.shaded", size=SIZE)[..., :3].astype(float)
    np.testing.assert_allclose(frame[top], albedo[top] * sky, rtol=2e-3)


def test_the_air_lets_through_and_adds(any_engine, scene):
    """Of air that is alike at all distances, what is left and what is added are its own."""
    maps = '#pragma kernel(output = "scattered:rgba16f, left:rgba16f")\n'
    maps += "void kernel(ivec2 t, out vec4 scattered, out vec4 left) "
    maps += "{ scattered = vec4(0.125, 0.25, 0.5, 0.0); left = vec4(0.75, 0.5, 0.25, 0.0); }\n"
    passes = '[[pass]]\nname = "air"\nuse = "./air"\nsize = [64, 40]\n'
    clear = scene(BUMPY, given=LIT)
    aired = scene(BUMPY, given=f"{LIT}, haze = 0.7", passes=passes, air=maps)
    before = any_engine.read(clear, "view.shaded", size=SIZE)[..., :3].astype(float)
    result = any_engine.read(aired, "view.shaded", size=SIZE)[..., :3].astype(float)
    seen = any_engine.read(aired, "view.where", size=SIZE)
    land = seen[..., 3] > 0
    expected = before[land] * [0.75, 0.5, 0.25] + [0.125, 0.25, 0.5]
    np.testing.assert_allclose(result[land], expected, rtol=3e-3)
    np.testing.assert_array_equal(result[~land], before[~land])


def test_another_picture_of_the_sky_takes_the_plain_one_s_place(any_engine, scene):
    picture = COLOUR.format("vec4(vec2(texel) / 256.0, 0.5, 1.0)").replace("colour:", "sky_picture:")
    passes = f'[[pass]]\nname = "sky_picture"\nuse = "./picture"\nsize = [{SIZE[0]}, {SIZE[1]}]\n'
    sketch = scene(passes=passes, picture=picture).with_camera(replace(LOOK, distance=1500))
    result = any_engine.read(sketch, "view.shaded", size=SIZE)[..., :3].astype(float)
    sky = any_engine.read(sketch, "view.where", size=SIZE)[..., 3] == 0
    expected = np.concatenate([all_pixels() / 256, np.full((*SIZE[::-1], 1), 0.5)], axis=-1)
    assert sky.sum() > 500
    np.testing.assert_allclose(result[sky], expected[sky], atol=1e-3)
    assert any_engine.record.plan.step("view.sky") is None, "which is not made in vain"


def test_nothing_lights_up_at_night(any_engine, scene):
    """An hour after midnight in winter, a white terrain, its cut and the sky are as good as black."""
    passes = '[[pass]]\nname = "daylight"\nuse = "lighting/daylight"\n'
    passes += "set = { latitude = 50, day = 355, hour = 1.0, adaptation = 0 }\n"
    value = 'sky = "daylight", gain = 1, ambient = 1, haze = 0.3'
    sketch = scene(BUMPY, "vec4(1.0)", given=value, passes=passes).with_camera(replace(LOOK, distance=1500))
    night = any_engine.read(sketch, "view.shaded", size=SIZE)[..., :3]
    noon = any_engine.read(sketch.with_values({"daylight.hour": 12.0}), "view.shaded", size=SIZE)[..., :3]
    assert night.max() < 1e-3 * noon.mean()


def test_what_is_no_number_is_marked(any_engine, scene):
    sketch = scene("texel == ivec2(30, 20) ? uintBitsToFloat(0x7fc00000u) : 0.1")
    picture = any_engine.render(sketch, size=SIZE).array
    seen = any_engine.read(sketch, "view.where", size=SIZE)[::-1]
    assert (seen[..., 3] < 0).sum() > 5
    assert np.all(picture[seen[..., 3] < 0][:, :3] == (255, 0, 255))


def test_a_picture_in_parts_is_the_whole_picture(any_engine, scene):
    """All but three passes read pictures of pixels at their own pixel alone; those can be switched off."""
    sketch = scene(BUMPY, given=f"{HAZE}, {LIT}, vignette = 0.3")
    window = Window((0, 0), (70, 50), SIZE)
    for name, value in (("antialias", True), ("bloom", 0.1), ("adapts", True)):
        looking = sketch.with_values({"view.antialias": False, f"view.{name}": value})
        with pytest.raises(SketchError, match=f"turn '{name}' off or choose a smaller picture"):
            any_engine.draw_window(looking, window)
    sketch = sketch.with_values({"view.antialias": False})
    whole = any_engine.render(sketch, size=SIZE).array
    for part in (window, Window((70, 50), (80, 47), SIZE)):
        (x, y), (width, height) = part.origin, part.size
        picture = read_picture(any_engine.draw_window(sketch, part))
        rows = slice(SIZE[1] - y - height, SIZE[1] - y)
        np.testing.assert_array_equal(picture, whole[rows, x : x + width])

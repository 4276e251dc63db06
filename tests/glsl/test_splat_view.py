"""view/splat and view/splat_multipass: the mixture at every pixel, in one draw and in one draw a layer."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from playground.shader.colours import linear_to_srgb
from playground.sketch.model import Camera

from ..sketch_texts import passes
from ..truth.eyes import on_level

COLOUR = '#include "noise/hash.glsl"\n#pragma kernel(output = "colour:rgba16f")\n'
COLOUR += "vec4 kernel(ivec2 texel) {{ return {}; }}\n"
WEIGHTS = COLOUR.replace("colour:rgba16f", "weights:rgba8").replace("return", "{}; return")
HEIGHT = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) {{ return {}; }}\n'
NAMES = ("grass", "rock", "snow", "path")
LAYERS = np.array([[0.6, 0.1, 0.05], [0.1, 0.5, 0.1], [0.05, 0.1, 0.9], [0.7, 0.7, 0.05]])
FLAT = {
    name: COLOUR.format(f"vec4({r}, {g}, {b}, 1.0)") for name, (r, g, b) in zip(NAMES, LAYERS, strict=True)
}
TILES = "".join(f'[[pass]]\nname = "{name}"\nuse = "./{name}"\nsize = 64\n' for name in NAMES)
BILINEAR = "vec4(s.x * s.y, (1.0 - s.x) * s.y, s.x * (1.0 - s.y), (1.0 - s.x) * (1.0 - s.y))"
SPREAD = WEIGHTS.format("vec2 s = vec2(texel) / vec2(size - 1)", BILINEAR)
HILLS = HEIGHT.format("0.5 + 0.5 * sin(float(texel.x) * 0.4) * cos(float(texel.y) * 0.3)")
TERRAIN = passes(height="./terrain", weights="./weights") + TILES
SUN = '[[pass]]\nname = "light"\nuse = "lighting/l_dot_n"\n'
VIEW = '[view]\nuse = "{}"\nsamples = {}\nset = {{ grid = 65{} }}\n'
LOOK = Camera(azimuth=200, elevation=35, distance=1500, target=(500, 500, 0))
SIZE = (160, 100)


def real_terrain(view, samples=1, more=""):
    """Return the passes of a whole splatted terrain: its own weights, tiles and light."""
    text = '[[pass]]\nname = "height"\nuse = "generation/diamond_square"\n'
    text += '[[pass]]\nname = "weights"\nuse = "texturing/alpha_map"\nset = { rock_slope = 20 }\n'
    for name, use in (("grass", "grass"), ("rock", "rock"), ("snow", "snow"), ("path", "rock")):
        text += f'[[pass]]\nname = "{name}"\nuse = "texturing/{use}"\nsize = 64\n'
    return text + SUN + VIEW.format(view, samples, more)


def above(sketch):
    return sketch.with_camera(Camera(azimuth=180, elevation=89.9, distance=2200, target=(500, 500, 0)))


def test_level_terrain_pixels_mix_layers_by_their_weights(any_engine, make_sketch):
    sketch = make_sketch(
        TERRAIN + VIEW.format("view/splat", 1, ""), terrain=HEIGHT.format("0.0"), weights=SPREAD, **FLAT
    )
    result = any_engine.read(above(sketch), "view.land", size=(128, 128))[..., :3].astype(float)
    position, _ = on_level(any_engine.record.plan.eye, (128, 128))
    x, y = np.moveaxis(position[..., :2] / 1000, -1, 0)
    inside = (np.abs(x - 0.5) < 0.49) & (np.abs(y - 0.5) < 0.49)
    assert inside.sum() > 2000
    shares = np.stack([x * y, (1 - x) * y, x * (1 - y), (1 - x) * (1 - y)], axis=-1)
    # A level of detail between two smooths the slopes of the weights a little at the terrain's corners.
    np.testing.assert_allclose(result[inside], (shares @ LAYERS)[inside], atol=8e-3)


@pytest.mark.parametrize("samples", [1, 4])
def test_where_one_layer_lies_it_is_the_terrain_of_that_colour(any_engine, make_sketch, samples):
    """Mesh, cut, light, haze and sky are those of view/terrain."""
    haze = ', haze = 0.3, horizon = "#a07040"'
    files = {"terrain": HILLS, "weights": WEIGHTS.format("", "vec4(0.0, 1.0, 0.0, 0.0)"), **FLAT}
    plain = f'[[pass]]\nname = "colour"\nuse = "./rock"\n{SUN}{VIEW.format("view/terrain", samples, haze)}'
    splat = SUN + VIEW.format("view/splat", samples, haze)
    expected, result = (
        any_engine.render(make_sketch(TERRAIN + text, **files).with_camera(LOOK), size=SIZE).array.astype(int)
        for text in (plain, splat)
    )
    assert expected[..., :3].std() > 20
    np.testing.assert_allclose(result, expected, atol=1.01)


@pytest.mark.slow
@pytest.mark.parametrize("samples", [1, 4])
def test_many_draws_blended_give_the_picture_of_one(any_engine, make_sketch, samples):
    item, many = (
        make_sketch(real_terrain(view, samples, ", haze = 0.2, repeats = 9"), size=65, relief=400.0)
        for view in ("view/splat", "view/splat_multipass")
    )
    for azimuth, elevation in ((200, 35), (20, 60), (110, 12)):
        camera = Camera(azimuth=azimuth, elevation=elevation, distance=1500, target=(500, 500, 0))
        expected, result = (
            any_engine.render(sketch.with_camera(camera), size=(200, 120)).array.astype(int)
            for sketch in (item, many)
        )
        assert expected[..., :3].std() > 10
        np.testing.assert_allclose(result, expected, atol=2.01)


COUNT = """
#include "view/surface.glsl"
#include "view/vertices.glsl"
#pragma draw(mesh = "land", output = "frame:rgba16f", blend = "add", depth = "equal")
uniform sampler2D height;   //! input("linear")
uniform sampler2D spans;    //! input("black")
uniform sampler2D errors;   //! input("black")
uniform int detail = 0;
uniform int grid = 257;
uniform float tolerance = 1.0;
uniform float skirt = 0.03;
vec4 vertex(vec3 corner, vec4 tile) {
    vec2 share = share_of_vertex(height, detail, corner, tile);
    return clip_from_world * vec4(place_of_vertex(height, share, corner.z, extent, relief, skirt).xyz, 1.0);
}
vec4 fragment() { return vec4(1.0, 0.0, 0.0, 0.0); }
"""


TIES = (
    passes(first="view/splat_multipass/first", terrain=("./count", 'inputs = { initial = "first" }'))
    + '[inputs]\nheight = ["first.height", "terrain.height"]\ngrass = "first.colour"\n'
)


@pytest.mark.slow
@pytest.mark.parametrize("samples", [1, 4])
def test_only_where_two_parts_tie_in_depth_the_many_draws_differ(any_engine, make_sketch, tmp_path, samples):
    """At crests, along which the slope beyond begins at the depth of the one in front: both are blended."""
    rough = (
        real_terrain("view/splat", samples)
        .replace("grid = 65", "")
        .replace(
            '"generation/diamond_square"',
            '"generation/gradient_noise"\nset = { octaves = 8, frequency = 2.2 }',
        )
    )
    (tmp_path / "ties.toml").write_text(TIES)
    texts = (
        rough,
        rough.replace("view/splat", "view/splat_multipass"),
        rough.replace("view/splat", "./ties"),
    )
    terrain = {"size": 257, "extent": 2560.0, "relief": 470.0, "count": COUNT}
    # In their plain forms: what the fast variant differs by is in tests/glsl/test_view_ground.py.
    item, many, ties = (make_sketch(text, **terrain).plainly() for text in texts)
    for azimuth, elevation in ((70, 22), (200, 12)):
        camera = Camera(azimuth=azimuth, elevation=elevation, distance=1800, target=(1280, 1280, 100))
        mixed, blended = (
            any_engine.render(s.with_camera(camera), size=(480, 270)).array.astype(int) for s in (item, many)
        )
        differs = np.abs(mixed - blended).max(axis=-1) > 2
        assert differs.mean() < 1e-4
        if samples == 1:
            frames = [
                any_engine.read(ties.with_camera(camera), f"view.{name}", size=(480, 270))[::-1, :, 0]
                for name in ("first", "terrain")
            ]
            times = frames[1].astype(float) - frames[0]
            assert (times > 0.9).mean() > 0.3 and (times[differs] > 1.9).all()


def test_a_tie_moves_a_quarter_of_the_weights_at_most(any_engine, make_sketch):
    """On white noise, where ties are many: of layers of one colour each, by the contrast between these."""
    noise = TERRAIN.replace("./terrain", "generation/white_noise")
    terrain = {"size": 257, "extent": 2560.0, "relief": 470.0, "weights": SPREAD, **FLAT}
    camera = Camera(azimuth=70, elevation=22, distance=1800, target=(1280, 1280, 100))
    frames = []
    for view, last in (("view/splat", "land"), ("view/splat_multipass", "fourth")):
        sketch = make_sketch(noise + VIEW.format(view, 1, "").replace("grid = 65", ""), **terrain)
        frame = any_engine.read(sketch.plainly().with_camera(camera), f"view.{last}", size=(480, 270))
        frames.append(frame[..., :3].astype(float))
    item, many = frames
    difference = np.abs(many - item)
    assert (difference > 0.02).any(axis=-1).sum() > 20 and difference.max() > 0.1
    assert (difference <= np.ptp(LAYERS, axis=0) / 4 + 2e-3).all()


@pytest.mark.parametrize("detail", ["geomipmap", "morph"])
def test_tiles_of_the_mesh_give_the_picture_of_the_full_grid(any_engine, make_sketch, detail):
    """With a tolerance below a pixel, in one draw and in four; the four meet the one to 2 of 255 here too."""
    full, tiled, many = (
        make_sketch(real_terrain(view, 4, more), size=65, relief=400.0).with_camera(LOOK)
        for view, more in (
            ("view/splat", ""),
            ("view/splat", f', detail = "{detail}", tolerance = 0.1'),
            ("view/splat_multipass", f', detail = "{detail}", tolerance = 0.1'),
        )
    )
    expected, result, blended = (
        any_engine.render(sketch, size=(200, 120)).array.astype(int) for sketch in (full, tiled, many)
    )
    difference = np.abs(result - expected).max(axis=-1)
    assert np.mean(difference > 8) < 0.005
    np.testing.assert_allclose(blended, result, atol=2.01)


def test_no_layer_of_the_many_draws_is_idle(any_engine, make_sketch):
    sketch = make_sketch(real_terrain("view/splat_multipass"), size=65, relief=400.0).with_camera(LOOK)
    frames = [
        any_engine.read(sketch, f"view.{name}", size=SIZE)[..., :3].astype(float)
        for name in ("first", "second", "third", "fourth")
    ]
    for before, after in pairwise(frames):
        assert 0.002 < np.mean(np.abs(after - before).max(axis=-1) > 0.01) < 0.95


def test_hidden_hills_stay_hidden_in_every_draw(any_engine, make_sketch):
    """Behind a wall lies terrain of another layer; none of it is blended over the wall."""
    wall = HEIGHT.format("texel.y > 12 && texel.y < 18 ? 1.0 : 0.0")
    behind = WEIGHTS.format("", "texel.y < 24 ? vec4(1.0, 0.0, 0.0, 0.0) : vec4(0.0, 0.0, 0.5, 0.5)")
    text = TERRAIN + VIEW.format("view/splat_multipass", 1, "")
    sketch = make_sketch(text, relief=400.0, terrain=wall, weights=behind, **FLAT)
    low = Camera(azimuth=180, elevation=4, distance=900, target=(500, 500, 100))
    result = any_engine.read(sketch.with_camera(low), "view.fourth", size=SIZE)[..., :3].astype(float)
    grass = np.abs(result - LAYERS[0]).max(axis=-1) < 2e-3
    assert grass[45:60, 40:120].all()


def test_weights_taken_for_alphas_favour_the_last_layers(any_engine, make_sketch):
    """The formula to the letter: the first of two halves keeps a half, of three thirds 4/9."""
    third = WEIGHTS.format("", "vec4(85.0, 85.0, 85.0, 0.0) / 255.0")
    value = ', alphas = "as in the map"'
    text = TERRAIN + VIEW.format("view/splat_multipass", 1, value)
    sketch = above(make_sketch(text, terrain=HEIGHT.format("0.0"), weights=third, **FLAT))
    result = any_engine.read(sketch, "view.fourth", size=(64, 64))[32, 32, :3]
    np.testing.assert_allclose(result, np.array([4 / 9, 2 / 9, 1 / 3]) @ LAYERS[:3], atol=2e-3)
    sketch = sketch.with_values({"view.alphas": "shares"})
    result = any_engine.read(sketch, "view.fourth", size=(64, 64))[32, 32, :3]
    np.testing.assert_allclose(result, LAYERS[:3].mean(axis=0), atol=2e-3)


@pytest.mark.parametrize("view", ["view/splat", "view/splat_multipass"])
def test_a_hole_in_the_numbers_shows_and_harms_nothing_else(any_engine, make_sketch, view):
    hole = HEIGHT.format("all(lessThan(abs(texel - 16), ivec2(2))) ? uintBitsToFloat(0x7fc00000u) : 0.0")
    sketch = make_sketch(TERRAIN + VIEW.format(view, 1, ""), terrain=hole, weights=SPREAD, **FLAT)
    picture = any_engine.render(above(sketch), size=(64, 64)).array
    magenta = (picture[..., :3] == (255, 0, 255)).all(axis=-1)
    assert magenta[32, 32]
    assert 4 < magenta.sum() < 60


def test_tiles_repeat_so_often_each(any_engine, make_sketch):
    half = {**FLAT, "rock": COLOUR.format("vec4(vec3(float(texel.x >= size.x / 2)), 1.0)")}
    alone = WEIGHTS.format("", "vec4(0.0, 1.0, 0.0, 0.0)")
    text = TERRAIN + VIEW.format("view/splat", 1, ", rock_repeats = 5, grass_repeats = 11")
    sketch = above(make_sketch(text, terrain=HEIGHT.format("0.0"), weights=alone, **half))
    row = any_engine.read(sketch, "view.land", size=(200, 200))[100, :, 0].astype(float)
    clip = (
        any_engine.record.plan.eye.clip_from_world.astype(float)
        @ np.array([[0, 500, 0, 1], [1000, 500, 0, 1]]).T
    )
    left, right = ((clip[0] / clip[3] + 1) * 100).round().astype(int)
    inside = row[left + 2 : right - 2] > 0.5
    assert np.count_nonzero(~inside[:-1] & inside[1:]) == 5


def test_by_heights_it_is_the_mixture_of_the_baked_terrain(any_engine, make_sketch):
    """Seen from above, texel for pixel, the draw and texturing/splat agree."""
    grainy = {
        name: COLOUR.format(f"vec4(vec3({0.2 + 0.2 * k} * (0.5 + random(texel / 8, {k}u))), 1.0)")
        for k, name in enumerate(NAMES)
    }
    files = {"terrain": HEIGHT.format("0.0"), "weights": SPREAD, **grainy}
    set_ = ', blend = "by heights", contrast = 8.0, repeats = 1'
    baked = '[[pass]]\nname = "colour"\nuse = "texturing/splat"\nsize = 257\n'
    baked += f"set = {{ variety = 0{set_} }}\n"
    pictures = [
        any_engine.render(above(make_sketch(TERRAIN + text, **files)), size=(128, 128)).array.astype(int)
        for text in (baked + VIEW.format("view/terrain", 4, ""), VIEW.format("view/splat", 4, set_))
    ]
    difference = np.abs(pictures[0] - pictures[1])[20:108, 20:108]
    assert pictures[0][20:108, 20:108, 0].std() > 20
    assert difference.mean() < 3.0


def test_the_parts_are_tiles_over_their_maps_and_the_result(any_engine, make_sketch):
    text = (
        TERRAIN
        + '[[pass]]\nname = "colour"\nuse = "./path"\n[view]\nuse = "view/splat/parts"\nset = { gap = 4 }\n'
    )
    quarters = "vec4 w = vec4(0.0); w[2 * (texel.y / 16 % 2) + texel.x / 16 % 2] = 1.0"
    sketch = make_sketch(
        text, size=32, terrain=HEIGHT.format("0.0"), weights=WEIGHTS.format(quarters, "w"), **FLAT
    )
    # Six parts of 20 pixels, two rows, gaps of 4: 140 by 44, in the middle.
    picture = any_engine.render(sketch, size=(144, 52)).array[..., :3].astype(float)
    encoded = linear_to_srgb(LAYERS) * 255
    for k in range(4):
        left = 2 + 24 * k
        np.testing.assert_allclose(
            picture[6:22, left + 2 : left + 18], np.broadcast_to(encoded[k], (16, 16, 3)), atol=1
        )
        map_ = picture[28:48, left : left + 20, 0]
        low, high = (slice(11, 19), slice(1, 9)) if k < 2 else (slice(1, 9), slice(11, 19))
        here, there = (slice(1, 9), slice(11, 19)) if k % 2 == 0 else (slice(11, 19), slice(1, 9))
        assert (map_[low, here] == 255).all()
        assert (map_[high, :] == 0).all() and (map_[low, there] == 0).all()
    np.testing.assert_allclose(picture[8:44, 100:136], np.broadcast_to(encoded[3], (36, 36, 3)), atol=1)
    assert (picture[0] == 255).all()

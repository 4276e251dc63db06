"""water/sea and water/sheet: one surface of sea, lakes and rivers, against shapes with known shores."""

from __future__ import annotations

import numpy as np
import pytest

from ..sketch_texts import passes, use

BOWL = """
#include "maths/land.glsl"
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) {
    vec2 off = share_of_texel(texel, size) * extent - vec2(480.0, 310.0);
    return 0.1 + dot(off, off) / 160000.0;
}
"""
LAKE = """
#pragma kernel(output = "depth:r32f")
uniform sampler2D height;  //! input
float kernel(ivec2 texel) { return max(relief * (0.35 - texelFetch(height, texel, 0).r), 0.0); }
"""
SLANT = """
#include "maths/land.glsl"
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return 0.5 - 0.4 * share_of_texel(texel, size).x; }
"""
STRIP = """
#include "maths/land.glsl"
#pragma kernel(output = "river:r32f, width:r32f")
void kernel(ivec2 texel, out float river, out float width) {
    float away = abs(share_of_texel(texel, size).y * extent.y - 400.0);
    river = clamp((30.0 - away) / spacing.y + 0.5, 0.0, 1.0);
    width = 60.0;
}
"""
THIN = """
#pragma kernel(output = "river:r32f, width:r32f")
void kernel(ivec2 texel, out float river, out float width) {
    river = texel.y == 20 ? 1.0 : 0.0;
    width = 60.0;
}
"""
READ = """
#include "maths/land.glsl"
#include "terrain/heightfield.glsl"
#include "water/sheet_reading.glsl"
#pragma kernel(output = "depth:r32f")
uniform sampler2D height;  //! input
uniform sampler2D water;   //! input
float kernel(ivec2 texel) {
    vec2 share = share_of_texel(texel, size);
    return sheet_at(water, share).level
            - relief * height_at(height, share * vec2(textureSize(height, 0) - 1));
}
"""
EXTENT = (1000.0, 800.0)


WIDE = {"river": "river:river", "width": "river:width"}


def sketch_of(make_sketch, terrain, size, water="water/sheet", **files):
    """Return a sketch of passes by files' names, the water made of them, and what is read of it."""
    made = {name: f"./{name}" for name in files}
    over = use("./read", size=[801, 641], inputs={"water": "water"})
    text = passes(height="./terrain", **made, water=water, over=over)
    return make_sketch(text, size=size, extent=list(EXTENT), terrain=terrain, read=READ, **files)


def places():
    """Return the places of the texels of `over` east and north [m]."""
    return np.meshgrid(np.linspace(0, EXTENT[0], 801), np.linspace(0, EXTENT[1], 641))


def test_the_sea_is_level_everywhere(any_engine, make_sketch):
    sketch = sketch_of(make_sketch, BOWL, [41, 33], use("water/sea", size=1, sea_level=37.5))
    np.testing.assert_array_equal(any_engine.read(sketch, "water")[0, 0], [37.5, 0, 0, -1])
    east, north = places()
    depth = any_engine.read(sketch, "over").astype(float)
    away = np.hypot(east - 480, north - 310)
    true = 37.5 - 100 * (0.1 + away**2 / 160000)
    np.testing.assert_allclose(depth, true, atol=0.25)  # squares bend 25^2 / 8 / 800 m between texels


@pytest.mark.parametrize("size", [[41, 33], [83, 71]])
def test_a_lake_ends_where_its_depth_does(any_engine, make_sketch, size):
    """The shore is a circle of 200 m: between texels, and not at them."""
    sketch = sketch_of(make_sketch, BOWL, size, depth=LAKE)
    wet = any_engine.read(sketch, "over") > 0
    east, north = places()
    away = np.hypot(east - 480, north - 310)
    # A parabola between two texels is off by an eighth of the squared spacing over its width.
    spacing = max(EXTENT[0] / (size[0] - 1), EXTENT[1] / (size[1] - 1))
    band = 1.0 + 2 * spacing**2 / (8 * 200)
    assert wet[away < 200 - band].all() and not wet[away > 200 + band].any()
    level = any_engine.read(sketch, "water")[..., 0]
    column, row = round(480 / EXTENT[0] * (size[0] - 1)), round(310 / EXTENT[1] * (size[1] - 1))
    reach = int(190 / spacing)
    inside = level[row - reach // 2 : row + reach // 2, column - reach // 2 : column + reach // 2]
    np.testing.assert_allclose(inside, 35.0, atol=1e-3)


def test_a_river_elsewhere_floods_no_shore(any_engine, make_sketch):
    """A river that is wired and nowhere changes nothing."""
    nowhere = '#pragma kernel(output = "river:r32f")\nfloat kernel(ivec2 texel) { return 0.0; }\n'
    with_river, without = (
        any_engine.read(sketch_of(make_sketch, BOWL, [41, 33], depth=LAKE, **river), "over")
        for river in ({"river": nowhere}, {})
    )
    np.testing.assert_array_equal(with_river, without)


def test_a_lake_does_not_go_on_over_its_outlet(any_engine, make_sketch):
    """On a slope that falls to the east, dry ground that lies lower stays dry."""
    lake = '#pragma kernel(output = "depth:r32f")\nfloat kernel(ivec2 t) { return t.x < 20 ? 5.0 : 0.0; }\n'
    wet = any_engine.read(sketch_of(make_sketch, SLANT, [41, 33], depth=lake), "over") > 0
    east, _ = places()
    assert wet[east < 474].all() and not wet[east > 501].any()


def test_a_river_is_as_wide_as_it_is_and_runs_downhill(any_engine, make_sketch):
    sketch = sketch_of(make_sketch, SLANT, [101, 81], use("water/sheet", inputs=WIDE), river=STRIP)
    wet = any_engine.read(sketch, "over") > 0
    _, north = places()
    assert wet[abs(north - 400) < 28.5].all() and not wet[abs(north - 400) > 31.5].any()
    water = any_engine.read(sketch, "water")
    middle = water[40, 50]
    # Manning: depth 0.06 * 60^0.8 = 1.59 m on a slope of 0.04: 6.8 m/s, no more than 4 are given.
    np.testing.assert_allclose(middle[1:3], [4.0, 0.0], atol=1e-3)
    assert 0.0 < middle[3] < 0.2
    np.testing.assert_array_equal(water[5, :, 1:], 0.0)


@pytest.mark.parametrize("sea", ["false", "true"])
def test_a_river_one_texel_wide_keeps_its_width_high_above_a_sea(any_engine, make_sketch, sea):
    """Between 1.59 m of water and 0.3 m of dry ground 25 m away; ground beyond is far from water."""
    water = use("water/sheet", inputs=WIDE, sea=sea, sea_level=1.0)
    over = any_engine.read(sketch_of(make_sketch, SLANT, [41, 33], water, river=THIN), "over")
    _, north = places()
    deep = 0.06 * 60**0.8
    width = (over > 0).sum(axis=0) * EXTENT[1] / 640
    np.testing.assert_allclose(width, 2 * 25 * deep / (deep + 0.3), atol=1.25)
    assert over[abs(north - 500) > 50].max() < -8.9


def test_the_sea_meets_a_river(any_engine, make_sketch):
    water = use("water/sheet", inputs={"river": "river:river"}, sea=True, sea_level=22.0)
    water = any_engine.read(sketch_of(make_sketch, SLANT, [101, 81], water, river=STRIP), "water")
    assert np.all(water[40, 75:, 3] == -1) and np.all(water[40, 75:, 0] == 22.0)
    assert np.all(water[40, :60, 3] >= 0) and np.all(water[5, :, 3] == -1)

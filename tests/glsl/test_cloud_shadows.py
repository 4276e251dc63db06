"""clouds/shadow.glsl, clouds/shade: shadows lie where the sun's rays meet the clouds, in metres."""

import numpy as np
import pytest

from ..sketch_texts import passes
from ..truth.land import towards

WIDE = 8000.0
DOT = """
#pragma kernel(output = "cloud:rgba16f")
// One round cloud, a twelfth of the tile wide, at 5/8 and 3/8 of it.
vec4 kernel(ivec2 texel) {
    float away = distance((vec2(texel) + 0.5) / vec2(size), vec2(0.625, 0.375));
    return vec4(exp(-pow(24.0 * away, 2.0)));
}
"""
LEVEL = """
#pragma kernel(output = "height:r32f")
uniform float at = 0.5;
float kernel(ivec2 texel) { return at; }
"""
SKETCH = passes(
    height="./level",
    cloud=("./dot", "size = 256"),
    drift=("clouds/drift", "size = 1", "set = { wind = [12.0, -7.0], base = 2000.0, wide = 8000.0 }"),
    overhead=("clouds/shade", "size = [201, 161]", "set = { sun = [150.0, 40.0] }"),
)


def sketch_of(make_sketch, rest=""):
    text = SKETCH + rest
    # A terrain as wide as the tile, so that each place of the tile is there once.
    return make_sketch(text, size=[33, 41], extent=WIDE, relief=1000.0, dot=DOT, level=LEVEL)


@pytest.mark.parametrize("sun", [(150.0, 40.0), (260.0, 65.0), (20.0, 22.0)])
@pytest.mark.parametrize(("height", "time"), [(0.0, 0.0), (0.8, 0.0), (0.3, 333.0)])
def test_a_shadow_lies_where_the_sun_s_ray_meets_the_cloud(any_engine, make_sketch, sun, height, time):
    sketch = sketch_of(make_sketch).with_values({"overhead.sun": list(sun), "height.at": height})
    result = any_engine.read(sketch, "overhead", time=time).astype(np.float64)[:-1, :-1]
    ny, nx = result.shape
    # The dot is what is left: bright, so that its middle can be found on the circle that the tile is.
    y, x = np.mgrid[0:ny, 0:nx] * 2j * np.pi / np.array([ny, nx])[:, None, None]
    middle = np.angle([(result * np.exp(x)).sum(), (result * np.exp(y)).sum()]) / (2 * np.pi) * WIDE
    to_sun = towards(*sun)
    up = 2000.0 + 270.0 - 1000.0 * height
    truth = np.array([0.625, 0.375]) * WIDE + np.array([12.0, -7.0]) * time - to_sun[:2] / to_sun[2] * up
    off = (middle - truth + WIDE / 2) % WIDE - WIDE / 2
    assert np.abs(off).max() < 5.0  # of texels of 40 and 50 m


def test_the_mean_of_what_clouds_leave_does_not_change(any_engine, make_sketch):
    """With the wind, with the sun, and as the shadows blur: what a tile lets through stays."""
    sketch = sketch_of(make_sketch)
    whole = any_engine.read(sketch, "cloud").astype(np.float64)[..., 3].mean()
    for time, sun in ((0.0, 60.0), (100.0, 60.0), (900.0, 30.0), (900.0, 8.0), (50.0, 1.0)):
        now = sketch.with_values({"overhead.sun": [130.0, sun]})
        result = any_engine.read(now, "overhead", time=time).astype(np.float64)[:-1, :-1]
        assert result.mean() == pytest.approx(whole, rel=0.02)


def test_shadows_blur_as_the_sun_sets_and_end_in_the_clouds(any_engine, make_sketch):
    sketch = sketch_of(make_sketch)
    spread = []
    for sun in (80.0, 30.0, 10.0, 3.0, 0.3, -5.0):
        now = sketch.with_values({"overhead.sun": [130.0, sun]})
        spread.append(np.ptp(any_engine.read(now, "overhead")))
    assert (np.diff(spread) <= 1e-3).all() and spread[-1] < 0.05 * spread[0]
    below = sketch.with_values({"drift.base": 1000.0, "height.at": 1.0, "overhead.sun": [130.0, 60.0]})
    within = below.with_values({"drift.base": 865.0})
    above = below.with_values({"drift.base": 729.0})
    low, high = (any_engine.read(s, "overhead").astype(np.float64) for s in (below, within))
    assert low.min() < 0.02 and 0.4 < high.min() < 0.6
    np.testing.assert_array_equal(any_engine.read(above, "overhead"), 1)


@pytest.mark.parametrize("clouds", [0.3, 0.7])
def test_light_under_clouds_is_in_the_mean_that_of_the_cover(any_engine, make_sketch, clouds):
    """Between clouds the sun is whole, below them it is not, and flat ground receives what it did."""
    text = f"set = {{ clouds = {clouds}, hour = 11.0 }}"
    day = f'[[pass]]\nname = "daylight"\nuse = "lighting/daylight"\n{text}\n'
    light = '[[pass]]\nname = "light"\nuse = "lighting/ray_cast"\nset = { gain = 1.0, ambient = 1.0 }\n'
    rest = SKETCH.replace('use = "./dot"', 'use = "clouds/field"')
    sketch = make_sketch(day + rest + light, size=161, extent=WIDE, relief=1000.0, dot=DOT, level=LEVEL)
    plain = make_sketch(
        day + '[[pass]]\nname = "height"\nuse = "./level"\n' + light, size=161, extent=WIDE, level=LEVEL
    )
    result = any_engine.read(sketch, "light").astype(np.float64)[:-1, :-1, :3]
    expected = any_engine.read(plain, "light").astype(np.float64)[0, 0, :3]
    np.testing.assert_allclose(result.mean(axis=(0, 1)), expected, rtol=0.02)
    row = any_engine.read(sketch, "daylight")[0].astype(np.float64)
    beam = (1 - 0.75 * clouds**3.4) * (1 - clouds**2)
    whole = row[1, :3] / beam * row[0, 2] + row[2, :3]
    np.testing.assert_allclose(result.max(axis=(0, 1)), whole, rtol=0.02)
    np.testing.assert_allclose(result.min(axis=(0, 1)), row[2, :3], rtol=0.1)

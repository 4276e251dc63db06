"""texturing/triplanar: on inclined planes the image hardly stretches; on level terrain it is plain tiles."""

from __future__ import annotations

import numpy as np
import pytest

HEIGHT = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) {{ return {}; }}\n'
# Smooth noise, the same in every direction, 16 cells to the tile.
EVEN = """#include "noise/periodic.glsl"
#pragma kernel(output = "colour:rgba16f")
vec4 kernel(ivec2 texel) {
    vec2 place = (vec2(texel) + 0.5) / vec2(size) * 16.0;
    return vec4(vec3(0.5 + 0.5 * gradient_noise_periodic(place, ivec2(16), 5u)), 1.0);
}
"""
SIZE, METRES, RELIEF = 513, 1000.0, 1000.0


@pytest.fixture
def plane(make_sketch):
    """Give ``plane(technique, angle, azimuth)``: a plane that faces so far clockwise from north."""

    def make(technique, angle, azimuth=90.0, given="", repeats=2):
        rise = np.tan(np.radians(angle)) * METRES / RELIEF / (SIZE - 1)
        east, north = -rise * np.sin(np.radians(azimuth)), -rise * np.cos(np.radians(azimuth))
        height = HEIGHT.format(f"0.5 + {east:.9f} * float(texel.x) + {north:.9f} * float(texel.y)")
        text = (
            '[[pass]]\nname = "height"\nuse = "./terrain"\n'
            '[[pass]]\nname = "even"\nuse = "./even"\nsize = 256\n'
            f'[[pass]]\nname = "c"\nuse = "texturing/{technique}"\ninputs = {{ colour = "even" }}\n'
        )
        more = f"set = {{ repeats = {repeats}{given} }}\n"
        return make_sketch(text + more, size=SIZE, extent=METRES, relief=RELIEF, terrain=height, even=EVEN)

    return make


def stretch(grey, angle, azimuth):
    """How much longer patterns are down the slope than across it, measured on the slope itself.

    A pattern that is twice as long changes half as fast: so by the steps' root mean squares.
    """
    north, east = np.diff(grey, axis=0)[:, :-1], np.diff(grey, axis=1)[:-1]
    down = east * np.sin(np.radians(azimuth)) + north * np.cos(np.radians(azimuth))
    across = east * np.cos(np.radians(azimuth)) - north * np.sin(np.radians(azimuth))
    # A step of one spacing on the map is 1 / cos(angle) long down the slope.
    return np.sqrt((across**2).mean() / (down**2).mean()) / np.cos(np.radians(angle))


def grey_of(engine, sketch):
    return engine.read(sketch, "c").astype(float)[..., 1]


@pytest.mark.parametrize("angle", [60, 75])
@pytest.mark.parametrize("azimuth", [90, 0, 45, 115])
def test_on_a_cliff_the_image_hardly_stretches(any_engine, plane, angle, azimuth):
    from_above = stretch(
        grey_of(any_engine, plane("tiled", angle, azimuth, ", variety = 0.0")), angle, azimuth
    )
    np.testing.assert_allclose(from_above, 1 / np.cos(np.radians(angle)), rtol=0.12)
    value = stretch(grey_of(any_engine, plane("triplanar", angle, azimuth)), angle, azimuth)
    # Facing an axis, one plane lies nearly flat on the cliff: measured 1.1 to 1.2. Between the axes,
    # planes cut it at up to 45 degrees, and patterns may be longer either way: 0.73 to 1.45.
    assert 1 / 1.5 < value < (1.25 if azimuth in (0, 90) else 1.5)
    assert abs(np.log(value)) < 0.6 * np.log(from_above)


def test_the_contrast_of_a_cliff_is_that_of_level_terrain(any_engine, plane):
    level = grey_of(any_engine, plane("triplanar", 0))
    for azimuth in (90, 45):
        cliff = grey_of(any_engine, plane("triplanar", 60, azimuth))
        np.testing.assert_allclose(cliff.mean(), level.mean(), rtol=0.03)
        np.testing.assert_allclose(cliff.std(), level.std(), rtol=0.15)


def test_triplanar_below_slope_limit_matches_plain_tiles_exactly(engine, plane):
    for angle in (0, 25):
        result = engine.read(plane("triplanar", angle), "c")
        np.testing.assert_array_equal(
            result, engine.read(plane("tiled", angle, given=", variety = 0.0"), "c")
        )


def test_the_limits_say_where_the_sides_begin_to_count(any_engine, plane):
    """Halfway between the limits, the sides have half of their weight and half is the level plane's."""
    tiles = grey_of(any_engine, plane("tiled", 40, given=", variety = 0.0"))

    def likeness(limits):
        grey = grey_of(any_engine, plane("triplanar", 40, given=f", cliffs = {limits}"))
        return np.corrcoef(grey.ravel(), tiles.ravel())[0, 1]

    several = [likeness(limits) for limits in ([41, 60], [30, 50], [10, 20])]
    assert several[0] > 0.999
    assert several == sorted(several, reverse=True)
    assert several[2] < several[1] - 0.05


@pytest.mark.parametrize("angle", [0, 60, 89])
def test_much_finer_than_the_texture_it_is_the_mean(any_engine, plane, angle):
    grey = grey_of(any_engine, plane("triplanar", angle, repeats=256))
    assert np.isfinite(grey).all()
    np.testing.assert_allclose(grey.mean(), 0.5, atol=0.02)
    assert grey.std() < 0.04

"""The width of penumbras: ramps of known width, and the shadow of a wall from its angles, in float64."""

from __future__ import annotations

import math

import numpy as np
import pytest

RAMP = """
#pragma kernel(output = "visibility:r32f")
uniform vec2 pace = vec2(0.1, 0.0);   // a texel
uniform float start = 0.0;
float kernel(ivec2 texel) { return clamp(start + dot(vec2(texel), pace), 0.0, 1.0); }
"""
WALL = """
#pragma kernel(output = "height:r32f")
uniform int column = 100;
float kernel(ivec2 texel) { return texel.x == column ? 1.0 : 0.0; }
"""
HIGH = 100.0  # metres


@pytest.fixture
def ramp(make_sketch):
    def make(*, size=(60, 40), extent=(590.0, 1170.0), pace=(0.1, 0.0), start=0.0):
        passes = (
            f'[[pass]]\nname = "seen"\nuse = "./seen"\nset = {{ pace = {list(pace)}, start = {start} }}\n'
            '[[pass]]\nname = "width"\nuse = "lighting/penumbra_width"\ninputs = { visibility = "seen" }\n'
        )
        return make_sketch(passes, size=list(size), extent=list(extent), seen=RAMP)

    return make


def widths(engine, sketch):
    return [engine.read(sketch, f"width:{name}").astype(np.float64) for name in ("texels", "metres")]


@pytest.mark.parametrize("pace", [(0.1, 0.0), (-0.1, 0.0), (0.0, 0.07), (0.04, 0.03), (-0.02, 0.05)], ids=str)
def test_a_ramp_is_as_wide_as_its_slope_says(engine, ramp, pace):
    """Texels are 10 m by 30 m. At a ramp's rim, too, where a neighbour is whole light or none."""
    start = 0.5 - 30 * pace[0] - 20 * pace[1]
    sketch = ramp(pace=pace, start=start)
    seen = engine.read(sketch, "seen")
    texels, metres = widths(engine, sketch)
    partly = (seen > 0) & (seen < 1)
    assert 50 < partly.sum() < seen.size
    for result, step in ((texels, (1, 1)), (metres, (10, 30))):
        np.testing.assert_array_equal(result[~partly], 0)
        expected = 1 / math.hypot(pace[0] / step[0], pace[1] / step[1])
        inner = partly & (np.abs(seen - 0.5) < 0.5 - np.abs(pace).max())
        np.testing.assert_allclose(result[inner], expected, rtol=1e-4)
        # Where one neighbour along an axis is beyond the rim, the other still tells the slope.
        np.testing.assert_allclose(result[partly][seen[partly] > np.abs(pace).max()], expected, rtol=0.35)


def test_a_border_within_a_texel_is_two_wide_at_most(engine, ramp):
    for part in (0.1, 0.5, 0.8):
        sketch = ramp(pace=(1.0, 0.0), start=part - 20.0)
        texels, metres = widths(engine, sketch)
        assert (texels[:, 20] == pytest.approx(1 / max(part, 1 - part))) and (texels[:, :20] == 0).all()
        np.testing.assert_allclose(metres[:, 20], 10 * texels[:, 20], rtol=1e-5)


def test_where_nothing_changes_the_width_is_the_terrain_s(engine, ramp):
    texels, metres = widths(engine, ramp(pace=(0.0, 0.0), start=0.5))
    np.testing.assert_allclose(texels, math.hypot(60, 40), rtol=1e-5)
    np.testing.assert_allclose(metres, math.hypot(590, 1170), rtol=1e-5)


def test_shares_are_of_the_widest(any_engine, ramp):
    sketch = ramp().with_values({"width.widest": 50.0})
    shares = any_engine.read(sketch, "width:share")
    np.testing.assert_allclose(shares, widths(any_engine, sketch)[1] / 50, rtol=1e-6)
    assert shares.max() > 1


@pytest.mark.parametrize("size", [(1, 1), (2, 2), (1, 7), (7, 1)], ids=str)
def test_tiny_maps_have_finite_widths(engine, ramp, size):
    for start in (0.0, 0.4, 1.0):
        for width in widths(engine, ramp(size=size, pace=(0.0, 0.0), start=start)):
            assert np.isfinite(width).all() and (width >= 0).all()
            assert (width > 0).all() == (start == 0.4)


@pytest.fixture
def wall(make_sketch):
    """Give a sketch of a wall 100 m high on a plain, its shadow thrown to the west."""

    def make(use, sun, size=129, **values):
        setting = "".join(f"{name} = {value}\n" for name, value in values.items())
        passes = (
            f'[[pass]]\nname = "height"\nuse = "./wall"\nset = {{ column = {size - 10} }}\n'
            f'[[pass]]\nname = "light"\nuse = "lighting/{use}"\n[pass.set]\nsun = [90.0, {sun}]\n{setting}'
            '[[pass]]\nname = "width"\nuse = "lighting/penumbra_width"\n'
            'inputs = { visibility = "light.visibility" }\n'
        )
        return make_sketch(passes, size=[size, 5], extent=[4.0 * (size - 1), 16.0], relief=HIGH, wall=WALL)

    return make


@pytest.mark.parametrize(("elevation", "delta_r"), [(20.0, 0.05), (20.0, 0.02), (35.0, 0.08), (12.0, 0.02)])
def test_the_shadow_of_a_wall_is_as_wide_as_its_distance_says(any_engine, wall, elevation, delta_r):
    """Across the ray the cone is distance · 2 tan(half angle) wide; on the ground that over sin(e).

    On the ground, d behind a wall, the cone's middle stands d tan(e) high and its upright radius is
    d Δr / cos(e). So V = 1/2 + (tan(e) - H/d) cos(e) / (2 Δr), whose slope is H cos(e) / (2 Δr d²).
    """
    sketch = wall("soft_cone", elevation, size=257, delta_r=delta_r)
    seen = any_engine.read(sketch, "light.visibility")[2].astype(np.float64)
    texels, metres = (width[2] for width in widths(any_engine, sketch))
    away = (247 - np.arange(257)) * 4.0
    tangent, cosine = math.tan(math.radians(elevation)), math.cos(math.radians(elevation))
    with np.errstate(divide="ignore"):
        expected = np.where(away > 0, 2 * delta_r * away**2 / (HIGH * cosine), 0)
    partly = (seen > 0.15) & (seen < 0.85) & (away > 0)
    assert partly.sum() >= 4
    np.testing.assert_allclose(metres[partly], expected[partly], rtol=0.13)
    np.testing.assert_allclose(metres[partly], 4 * texels[partly], rtol=1e-5)
    # In the middle: the cone's diameter across the ray, seen at the slant at which it meets the ground.
    end = HIGH / tangent
    across = end / cosine * 2 * delta_r * cosine
    middle = partly & (np.abs(seen - 0.5) < 0.15)
    np.testing.assert_allclose(metres[middle], across / math.sin(math.radians(elevation)), rtol=0.3)


def test_a_hard_shadow_has_no_penumbra(any_engine, wall):
    for width in widths(any_engine, wall("ray_cast", 20.0)):
        np.testing.assert_array_equal(width, 0)

"""The method of height differences: a loop in float64, planes, and its two limits."""

from __future__ import annotations

import numpy as np
import pytest

HALF = 2.0**-10
TERRAIN = """
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")
uniform vec2 rise = vec2(0.0);
uniform float rough = 0.0;
float kernel(ivec2 texel) { return dot(vec2(texel), rise) + rough * random(texel, 3u); }
"""


@pytest.fixture
def lit(make_sketch):
    def make(*, size=(21, 17), extent=(1000.0, 800.0), rise=(0.0, 0.0), rough=0.0, **values):
        setting = "".join(
            f"{k} = {list(v) if isinstance(v, tuple) else v}\n"
            for k, v in ({"ambient": 0.0} | values).items()
        )
        passes = (
            '[[pass]]\nname = "height"\nuse = "./terrain"\n'
            f"set = {{ rise = {list(rise)}, rough = {rough} }}\n"
            f'[[pass]]\nname = "light"\nuse = "lighting/height_difference"\n[pass.set]\n{setting}'
        )
        return make_sketch(passes, size=list(size), extent=list(extent), terrain=TERRAIN)

    return make


def slow(
    heights: np.ndarray, azimuth: float, spacing: tuple[float, float], softness: float, step_length: float
):
    """Go over the texels one by one, reading between the four around the place towards the sun."""
    ny, nx = heights.shape
    way = np.array([np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))]) / spacing
    way *= step_length / np.abs(way).max()
    share = np.ones((ny, nx))
    for y in range(ny):
        for x in range(nx):
            px, py = x + way[0], y + way[1]
            if not (-1e-3 <= px <= nx - 1 + 1e-3 and -1e-3 <= py <= ny - 1 + 1e-3):
                continue
            px, py = min(max(px, 0), nx - 1), min(max(py, 0), ny - 1)
            x0, y0 = min(int(px), nx - 2), min(int(py), ny - 2)
            fx, fy = px - x0, py - y0
            weights = np.outer([1 - fy, fy], [1 - fx, fx])
            there = (heights[y0 : y0 + 2, x0 : x0 + 2] * weights).sum()
            share[y, x] = min(max(1 - (there - heights[y, x]) / softness, 0), 1)
    return share


@pytest.mark.parametrize("azimuth", [0.0, 45.0, 123.0, 270.0, 301.0])
@pytest.mark.parametrize("step_length", [1.0, 2.5])
def test_it_is_the_difference_of_two_heights_over_the_softness(engine, lit, azimuth, step_length):
    sketch = lit(rough=0.1, sun=(azimuth, 30.0), softness=0.08, step_length=step_length)
    heights = engine.read(sketch, "height").astype(np.float64)
    expected = slow(heights, azimuth, (1000.0 / 20, 800.0 / 16), 0.08, step_length)
    assert 0.05 < (expected < 1).mean() < 0.95
    result = engine.read(sketch, "light")
    np.testing.assert_allclose(result[..., 3], expected, atol=HALF)
    np.testing.assert_allclose(result[..., 0], expected, atol=HALF)


def test_plane_rising_toward_sun_loses_light_linearly_with_slope(engine, lit):
    for rise in (0.0, 0.01, 0.02, 0.06):
        light = engine.read(lit(rise=(rise, 0.0), sun=(90.0, 30.0), softness=0.05), "light")
        np.testing.assert_allclose(light[:, :-1, 3], max(1 - rise / 0.05, 0), atol=HALF)
        np.testing.assert_array_equal(light[:, -1, 3], 1.0)


def test_gain_and_colours_are_multiplied_in(engine, lit):
    colours = {"sun_colour": (0.5, 0.25, 1.0), "sky_colour": (1.0, 0.5, 0.0)}
    light = engine.read(lit(gain=2.0, ambient=0.5, **colours), "light")
    np.testing.assert_allclose(light[3, 3, :3], [1.5, 0.75, 2.0], rtol=HALF)

"""A horizon in one direction and a cylinder of light: marches in float64, and the library's other methods.

A place on the way is off by a rounding of its texel, the ray by one of its height: together
``OFF`` of the relief, by float32's 24 bits over paths of at most 64 texels.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

SIZE, EXTENT, RELIEF = (41, 33), (1000.0, 1200.0), 300.0
OFF = 64 * 2.0**-23 * 4
"""Of the relief: a place's rounding, 64 · 2⁻²³ texels, and the ray's."""

SUNS = [(270.0, 15.0), (37.0, 24.0), (130.0, 8.0)]


@pytest.fixture
def lit(make_sketch):
    def make(use, **values):
        text = ", ".join(f"{key} = {value}" for key, value in values.items())
        passes = (
            '[[pass]]\nname = "height"\nuse = "generation/fbm"\n'
            "set = { hurst = 0.8, frequency = 3.0, seed = 5 }\n"
            f'[[pass]]\nname = "light"\nuse = "{use}"\nset = {{ {text} }}\n'
        )
        return make_sketch(passes, size=list(SIZE), extent=list(EXTENT), relief=RELIEF)

    return make


def sun_of(sun):
    return f"{{ azimuth = {sun[0]}, elevation = {sun[1]} }}"


class Way:
    """From each texel, step by step: metres on the ground, and how far terrain is over the texel [m]."""

    def __init__(self, heights, azimuth):
        ny, nx = heights.shape
        north, east = np.mgrid[0:ny, 0:nx].astype(float)
        metres = np.array(EXTENT) / (np.array(SIZE) - 1)
        ahead = np.array([np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))]) / metres
        self.run = 1 / np.abs(ahead).max()
        self.steps = []
        for k in range(1, max(nx, ny) + 1):
            x, y = east + k * self.run * ahead[0], north + k * self.run * ahead[1]
            inside = (x > -1e-3) & (y > -1e-3) & (x < nx - 1 + 1e-3) & (y < ny - 1 + 1e-3)
            result = map_coordinates(heights, [np.clip(y, 0, ny - 1), np.clip(x, 0, nx - 1)], order=1)
            self.steps.append((k * self.run, np.where(inside, (result - heights) * RELIEF, -np.inf)))

    def least_part(self, elevation, radius):
        """Return the least share of an upright stick around the ray that stands over the terrain."""
        least = np.full(self.steps[0][1].shape, 0.5)
        for far, over in self.steps:
            middle = far * np.tan(np.radians(elevation))
            low = np.clip(over, middle - radius, middle + radius)
            least = np.minimum(least, (middle + radius - low) / (2 * radius))
        return least


@pytest.mark.parametrize("sun", SUNS, ids=str)
def test_a_cone_without_growth_is_the_cylinder(engine, lit, sun):
    """And as a slow march finds it: of the ground itself a half is free."""
    use = "lighting/soft_cone/visibility"
    sketch = lit(use, sun=sun_of(sun), at_ground=24.0, delta_r=0.0)
    result = engine.read(sketch, "light").astype(float)
    cylinder = lit("lighting/soft_cylinder", sun=sun_of(sun), radius=24.0 / RELIEF * 255)
    way = Way(engine.read(sketch, "height").astype(float), sun[0])
    bound = OFF * RELIEF / (2 * 24.0)
    np.testing.assert_allclose(result, way.least_part(sun[1], 24.0), atol=bound, rtol=0)
    np.testing.assert_allclose(result, engine.read(cylinder, "light.visibility"), atol=bound, rtol=0)
    assert result.max() == 0.5 and result.min() < 0.1


@pytest.mark.parametrize("azimuth", [270.0, 37.0, 130.0])
def test_a_horizon_is_the_steepest_line_to_terrain(engine, lit, azimuth):
    sketch = lit("lighting/horizons/tangent", azimuth=azimuth)
    way = Way(engine.read(sketch, "height").astype(float), azimuth)
    expected = np.max([np.maximum(over, 0) / far for far, over in way.steps], axis=0)
    result = engine.read(sketch, "light")
    np.testing.assert_allclose(result, expected, atol=OFF * RELIEF / way.run, rtol=0)
    assert expected.max() > 0.3


@pytest.mark.parametrize(
    ("azimuth", "output", "channel"), [(0.0, "ahead", 0), (270.0, "ahead", 2), (90.0, "behind", 2)]
)
def test_a_horizon_is_one_of_all_horizons(engine, lit, azimuth, output, channel):
    """Along the texels, to the sun's diameter where the library sweeps: tests/glsl/test_horizons.py."""
    library = engine.read(lit("lighting/horizons", directions=8), f"light:{output}")[..., channel]
    result = engine.read(lit("lighting/horizons/tangent", azimuth=azimuth), "light")
    off = np.degrees(np.abs(np.arctan(result) - np.arctan(library.astype(float))))
    assert off.max() < 0.53 + 0.03 and np.degrees(np.arctan(result.max())) > 15

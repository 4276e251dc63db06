"""A horizon in one direction and a cylinder of light: marches in float64, and the library's other methods.

A place on the way is off by a rounding of its texel, the ray by one of its height: together
``OFF`` of the relief, by float32's 24 bits over paths of at most 64 texels.
"""

from __future__ import annotations

import numpy as np
import pytest

from ..sketch_texts import passes, use
from ..truth.marches import Views

SIZE, EXTENT, RELIEF = (41, 33), (1000.0, 1200.0), 300.0
OFF = 64 * 2.0**-23 * 4
"""Of the relief: a place's rounding, 64 · 2⁻²³ texels, and the ray's."""

SUNS = [(270.0, 15.0), (37.0, 24.0), (130.0, 8.0)]


@pytest.fixture
def lit(make_sketch):
    def make(technique, **values):
        hills = use("generation/fbm", hurst=0.8, frequency=3.0, seed=5)
        text = passes(height=hills, light=use(technique, **values))
        return make_sketch(text, size=SIZE, extent=EXTENT, relief=RELIEF)

    return make


def views_of(engine, sketch, azimuth):
    heights = engine.read(sketch, "height").astype(float) * RELIEF
    return Views(heights, azimuth, tuple(np.array(EXTENT) / (np.array(SIZE) - 1)))


@pytest.mark.parametrize("sun", SUNS, ids=str)
def test_a_cone_without_growth_is_the_cylinder(engine, lit, sun):
    """And as a slow march finds it: of the ground itself a half is free."""
    sketch = lit("lighting/soft_cone/visibility", sun=sun, at_ground=24.0, delta_r=0.0)
    result = engine.read(sketch, "light").astype(float)
    cylinder = lit("lighting/soft_cylinder", sun=sun, radius=24.0 / RELIEF * 255)
    slow = views_of(engine, sketch, sun[0]).free_of_beam(sun[1], lambda _: 24.0, first=0.5)
    bound = OFF * RELIEF / (2 * 24.0)
    np.testing.assert_allclose(result, slow, atol=bound, rtol=0)
    np.testing.assert_allclose(result, engine.read(cylinder, "light.visibility"), atol=bound, rtol=0)
    assert result.max() == 0.5 and result.min() < 0.1


@pytest.mark.parametrize("azimuth", [270.0, 37.0, 130.0])
def test_a_horizon_is_the_steepest_line_to_terrain(engine, lit, azimuth):
    sketch = lit("lighting/horizons/tangent", azimuth=azimuth)
    views = views_of(engine, sketch, azimuth)
    expected = views.tangents()
    result = engine.read(sketch, "light")
    np.testing.assert_allclose(result, expected, atol=OFF * RELIEF / views.run, rtol=0)
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

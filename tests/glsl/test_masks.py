"""Masks for texturing: metres and areas to 0..1, snow by height, slope and wind, scree below faces."""

from __future__ import annotations

import numpy as np
import pytest

from ..sketch_texts import passes

RAMP = """#pragma kernel(output = "amount:r32f")
float kernel(ivec2 texel) { return exp2(float(texel.x) - 8.0); }
"""
LAND = """#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) {{
    vec2 place = vec2(texel) * spacing;
    return ({rise}) / relief;
}}
"""


@pytest.fixture
def cover(engine, make_sketch):
    """Give ``cover(use, rise, **parameters)`` on 1 km of terrain whose height [m] is a GLSL expression."""

    def read(use, rise, relief=100.0, **values):
        text = ", ".join(f"{name} = {value}" for name, value in values.items())
        made = passes(height="./land", cover=(f"texturing/{use}", f"set = {{ {text} }}"))
        sketch = make_sketch(made, size=65, extent=1000.0, relief=relief, land=LAND.format(rise=rise))
        return engine.read(sketch, "cover").astype(np.float64)

    return read


@pytest.mark.parametrize("by_factors", [False, True])
def test_a_mask_goes_from_nothing_to_all(engine, make_sketch, by_factors):
    set_ = f"set = {{ from = 0.25, to = 64.0, by_factors = {str(by_factors).lower()}, strength = 0.8 }}"
    made = passes(amount="./ramp", cover=("texturing/mask", 'inputs = { amount = "amount" }', set_))
    result = engine.read(make_sketch(made, size=17, ramp=RAMP), "cover")[0].astype(float)
    amount = 2.0 ** (np.arange(17) - 8)
    if by_factors:
        expected = np.interp(np.log2(amount), (-2, 6), (0, 0.8))
    else:
        expected = np.interp(amount, (0.25, 64), (0, 0.8))
    np.testing.assert_allclose(result, expected, atol=2**-11)  # half floats


def test_snow_lies_above_its_line_and_not_on_cliffs(cover):
    flat = {"drift": 0.0, "line": 0.5, "fade": 0.2, "holds": 40.0, "holds_fade": 10.0}
    for level, expected in ((35.0, 0), (50.0, 0.5), (55.0, 0.75), (65.0, 1)):
        np.testing.assert_allclose(cover("snow_cover", f"{level}", **flat), expected, atol=1e-3)
    for degrees, expected in ((30.0, 1), (40.0, 0.5), (50.0, 0)):
        slope = f"200.0 + place.x * {np.tan(np.radians(degrees))}"
        result = cover("snow_cover", slope, **flat)[:, 1:-1]
        np.testing.assert_allclose(result, expected, atol=2e-3)


def test_snow_collects_in_the_lee_of_the_wind(cover):
    ridge = "50.0 - 0.2 * abs(place.x - 500.0)"
    value = {"drift": 0.3, "line": 0.4, "fade": 0.5}
    east = cover("snow_cover", ridge, wind=270.0, **value)
    west = cover("snow_cover", ridge, wind=90.0, **value)
    south = cover("snow_cover", ridge, wind=180.0, **value)
    np.testing.assert_allclose(east, west[:, ::-1], atol=2**-9)
    np.testing.assert_allclose(south, south[:, ::-1], atol=2**-9)
    lee, windward = np.s_[:, 36:46], np.s_[:, 23:30]
    assert (east[lee] > south[lee]).all() and (south[windward] > east[windward]).all()


def test_scree_lies_at_its_angle_below_a_face(cover):
    scree = np.tan(np.radians(33.0))
    below = f"place.x < 600.0 ? {scree} * place.x : {scree} * 600.0 + 3.0 * (place.x - 600.0)"
    result = cover("scree_cover", below, rolls=300.0)
    x = np.linspace(0, 1000, 65)
    assert (result[:, (x > 500) & (x < 570)] > 0.9).all(), "below the face"
    assert (result[:, x > 650] == 0).all(), "not on the face"
    assert (result[:, (x > 20) & (x < 280)] == 0).all(), "not so far away"
    assert (cover("scree_cover", f"{scree} * place.x") == 0).all(), "nor where there is no face"
    assert (cover("scree_cover", "place.x < 600.0 ? 0.1 * place.x : 3.0 * place.x") == 0)[:, :30].all()

"""texturing/height_colour: a colour by height, as NumPy interpolates; bands; any size; limits."""

from __future__ import annotations

import numpy as np
import pytest

RAMP = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) {{ return {}; }}\n'
EASTWARD = RAMP.format("float(texel.x) / float(size.x - 1)")
COLOURS = {
    "low": [0.0, 0.5, 0.1],
    "middle": [0.9, 0.6, 0.2],
    "high": [0.3, 0.1, 0.4],
    "top": [1.0, 1.0, 0.8],
}


@pytest.fixture
def sketch(make_sketch):
    def make(given="", size=(256, 3), ramp=EASTWARD, colour_size=""):
        colours = ", ".join(f"{name} = {given}" for name, given in COLOURS.items())
        text = '[[pass]]\nname = "height"\nuse = "./ramp"\n'
        text += '[[pass]]\nname = "colour"\nuse = "texturing/height_colour"\n'
        return make_sketch(f"{text}{colour_size}set = {{ {colours}{given} }}\n", size=list(size), ramp=ramp)

    return make


def interpolated(levels, heights):
    stops = np.array(list(COLOURS.values()))
    return np.stack([np.interp(heights, levels, stops[:, channel]) for channel in range(3)], axis=-1)


@pytest.mark.parametrize("levels", [[20, 95, 165, 225], [0, 1, 2, 255], [100, 101, 200, 201]])
def test_colours_between_the_levels_are_interpolated(engine, sketch, levels):
    colour = engine.read(sketch(f", levels = {levels}"), "colour").astype(float)
    np.testing.assert_allclose(colour[1, :, :3], interpolated(levels, np.arange(256.0)), atol=6e-4)
    assert (colour[..., 3] == 1).all()


def test_bands_are_one_colour_from_a_level_to_the_next(engine, sketch):
    colour = engine.read(sketch(", levels = [0, 50, 150, 200], bands = true"), "colour").astype(float)
    which = np.searchsorted([50, 150, 200], np.arange(256), side="right")
    np.testing.assert_allclose(colour[0, :, :3], np.array(list(COLOURS.values()))[which], atol=4e-4)


def test_with_fewer_texels_each_is_the_colour_of_its_own_height(engine, sketch):
    """Not the mean of what lies around it: a vertex has one height."""
    steep = RAMP.format("float((texel.x / 8) % 2)")
    colour = engine.read(sketch(size=(33, 33), ramp=steep, colour_size="size = 5\n"), "colour").astype(float)
    expected = np.array([COLOURS["low"], COLOURS["top"]])[[0, 1, 0, 1, 0]]
    np.testing.assert_allclose(colour[2, :, :3], expected, atol=4e-4)


@pytest.mark.parametrize("levels", [[200, 100, 50, 10], [80, 80, 80, 80]])
def test_levels_that_meet_or_cross_leave_numbers(engine, sketch, levels):
    colour = engine.read(sketch(f", levels = {levels}"), "colour").astype(float)
    assert np.isfinite(colour).all()
    np.testing.assert_allclose(colour[0, -1, :3], COLOURS["top"], atol=4e-4)
    np.testing.assert_allclose(colour[0, 0, :3], COLOURS["low"], atol=4e-4)


def test_a_height_that_is_no_number_leaves_the_colour_a_number(any_engine, sketch):
    nowhere = RAMP.format("uintBitsToFloat(0x7fc00000u)")
    assert np.isfinite(any_engine.read(sketch(ramp=nowhere, size=(5, 5)), "colour")).all()

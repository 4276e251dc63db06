"""colour/: encoding, tone curves and the ramp, against their definitions in float64."""

from __future__ import annotations

import numpy as np
import pytest


def encoded(linear: np.ndarray) -> np.ndarray:
    """IEC 61966-2-1, piece by piece."""
    return np.array([12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055 for v in linear])


def luminance(colour: np.ndarray) -> np.ndarray:
    return colour @ [0.2126, 0.7152, 0.0722]


def grey(values: np.ndarray) -> np.ndarray:
    return np.repeat(values[:, None], 3, axis=1)


def test_encoding_is_the_srgb_curve(on_gpu):
    linear = np.concatenate([np.linspace(0, 0.01, 101), np.linspace(0, 1, 501)])
    result = on_gpu("colour/encode.glsl", "srgb_from_linear(c)", c=grey(linear))
    np.testing.assert_allclose(result[:, 1], encoded(linear), atol=2e-6)


def test_encoding_keeps_within_the_screen_s_range(on_gpu):
    result = on_gpu("colour/encode.glsl", "srgb_from_linear(c)", c=grey(np.array([-1.0, 0.0, 1.0, 9.0])))
    np.testing.assert_allclose(result[:, 0], [0, 0, 1, 1], atol=1e-6)


def test_ramp_lightness_increases_even_for_colour_blindness(on_gpu):
    colours = on_gpu("colour/ramp.glsl", "ramp_blue_yellow(t)", t=np.linspace(0, 1, 257)).astype(float)
    linear = np.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)
    assert (np.diff(luminance(linear)) > 0).all()
    # Without red, and without green, what is left still rises from end to end.
    for kept in (1, 0):
        assert (np.diff(linear[::32, kept]) > 0).all()


def test_the_ramp_holds_its_ends(on_gpu):
    ends = on_gpu("colour/ramp.glsl", "ramp_blue_yellow(t)", t=np.array([-3.0, 0.0, 1.0, 3.0]))
    np.testing.assert_array_equal(ends[0], ends[1])
    np.testing.assert_array_equal(ends[2], ends[3])


# From the authors' own tables of 256: places, and their colours of 0..255 rounded.
PUBLISHED = {
    "viridis": {
        0: (68, 1, 84),
        64: (59, 82, 139),
        128: (33, 145, 140),
        192: (94, 201, 98),
        255: (253, 231, 37),
    },
    "cividis": {0: (0, 34, 78), 128: (125, 124, 120), 255: (254, 232, 56)},
    "cool_warm": {0: (59, 76, 192), 64: (141, 176, 254), 127.5: (221, 221, 221), 255: (180, 4, 38)},
}


@pytest.mark.parametrize("name", PUBLISHED)
def test_the_published_ramps_have_their_colours(on_gpu, name):
    places = np.array(list(PUBLISHED[name])) / 255
    result = on_gpu("colour/ramp.glsl", f"ramp_{name}(t)", t=places).astype(float) * 255
    np.testing.assert_allclose(result, list(PUBLISHED[name].values()), atol=3.0)


@pytest.mark.parametrize("name", ["viridis", "cividis"])
def test_published_ramps_grow_lighter_at_every_step(on_gpu, name):
    colours = on_gpu("colour/ramp.glsl", f"ramp_{name}(t)", t=np.linspace(0, 1, 257)).astype(float)
    linear = np.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)
    assert (np.diff(luminance(linear)) > 0).all()


def test_diverging_ramp_is_lightest_mid_and_sides_stay_distinct(on_gpu):
    colours = on_gpu("colour/ramp.glsl", "ramp_cool_warm(t)", t=np.linspace(0, 1, 257)).astype(float)
    linear = np.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)
    light = luminance(linear)
    assert (np.diff(light[:129]) > 0).all() and (np.diff(light[128:]) < 0).all()
    # Blue is what people with red-green blindness keep: it tells the two sides apart.
    cool, warm = colours[:96, 2], colours[:160:-1, 2]
    assert (cool > warm + 0.2).all()


@pytest.mark.parametrize("number", range(5))
def test_a_ramp_by_its_number_is_the_one_of_its_name(on_gpu, number):
    names = [
        "vec3(clamp(t, 0.0, 1.0))",
        "ramp_blue_yellow(t)",
        "ramp_viridis(t)",
        "ramp_cividis(t)",
        "ramp_cool_warm(t)",
    ]
    places = np.linspace(-0.2, 1.2, 50)
    result = on_gpu("colour/ramp.glsl", f"ramp_colour({number}, t)", t=places)
    np.testing.assert_array_equal(result, on_gpu("colour/ramp.glsl", names[number], t=places))


@pytest.mark.parametrize("white", [1.0, 3.0, 16.0])
def test_reinhard_brings_white_to_one_and_keeps_hues(on_gpu, white):
    light = np.random.default_rng(4).uniform(0, 8, (300, 3))
    result = on_gpu("colour/tone.glsl", "tone_reinhard(c, w)", c=light, w=white).astype(float)
    before = luminance(light)
    np.testing.assert_allclose(luminance(result), before * (1 + before / white**2) / (1 + before), rtol=1e-5)
    hue_found, hue = (c / c.sum(axis=1, keepdims=True) for c in (result, light))
    np.testing.assert_allclose(hue_found, hue, rtol=1e-5)
    brightest = on_gpu("colour/tone.glsl", "tone_reinhard(vec3(w), w)", w=np.array([white]))
    np.testing.assert_allclose(brightest, 1.0, rtol=1e-6)


def test_film_curve_rises_from_black_and_saturates_at_white(on_gpu):
    light = np.concatenate([[-1.0, 0.0], np.geomspace(1e-4, 1e4, 400)])
    result = on_gpu("colour/tone.glsl", "tone_film(c)", c=grey(light))[:, 0].astype(float)
    assert result[0] == result[1] == 0
    assert (np.diff(result) >= 0).all()
    assert result[-1] == 1
    # Published with the curve: about 0.8 for light of 1.
    assert result[np.searchsorted(light, 1.0)] == pytest.approx(0.80, abs=0.02)


def test_luminance_is_that_of_the_screen_s_primaries(on_gpu):
    """ITU-R BT.709-6: of three primaries, by x and y, as much as makes white of D65."""
    places = np.array([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06], [0.3127, 0.3290]])
    stimuli = np.array([[x / y, 1.0, (1 - x - y) / y] for x, y in places])
    result = on_gpu("colour/luminance.glsl", "luminance(c)", c=np.eye(3, dtype=np.float32))
    np.testing.assert_allclose(result, np.linalg.solve(stimuli[:3].T, stimuli[3]), atol=1e-4)

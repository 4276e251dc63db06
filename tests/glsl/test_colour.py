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
    found = on_gpu("colour/encode.glsl", "srgb_from_linear(c)", c=grey(linear))
    np.testing.assert_allclose(found[:, 1], encoded(linear), atol=2e-6)


def test_encoding_keeps_within_the_screen_s_range(on_gpu):
    found = on_gpu("colour/encode.glsl", "srgb_from_linear(c)", c=grey(np.array([-1.0, 0.0, 1.0, 9.0])))
    np.testing.assert_allclose(found[:, 0], [0, 0, 1, 1], atol=1e-6)


def test_the_ramp_grows_lighter_at_every_step_and_for_the_colour_blind(on_gpu):
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


@pytest.mark.parametrize("white", [1.0, 3.0, 16.0])
def test_reinhard_brings_white_to_one_and_keeps_hues(on_gpu, white):
    light = np.random.default_rng(4).uniform(0, 8, (300, 3))
    found = on_gpu("colour/tone.glsl", "tone_reinhard(c, w)", c=light, w=white).astype(float)
    before = luminance(light)
    np.testing.assert_allclose(luminance(found), before * (1 + before / white**2) / (1 + before), rtol=1e-5)
    hue_found, hue = (c / c.sum(axis=1, keepdims=True) for c in (found, light))
    np.testing.assert_allclose(hue_found, hue, rtol=1e-5)
    brightest = on_gpu("colour/tone.glsl", "tone_reinhard(vec3(w), w)", w=np.array([white]))
    np.testing.assert_allclose(brightest, 1.0, rtol=1e-6)


def test_the_film_curve_rises_from_black_to_white_and_stays_there(on_gpu):
    light = np.concatenate([[-1.0, 0.0], np.geomspace(1e-4, 1e4, 400)])
    found = on_gpu("colour/tone.glsl", "tone_film(c)", c=grey(light))[:, 0].astype(float)
    assert found[0] == found[1] == 0
    assert (np.diff(found) >= 0).all()
    assert found[-1] == 1
    # Published with the curve: about 0.8 for light of 1.
    assert found[np.searchsorted(light, 1.0)] == pytest.approx(0.80, abs=0.02)

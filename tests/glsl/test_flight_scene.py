"""flight/scene.glsl: the air hides the terrain's end, water the ground, and grain is gone from afar."""

from __future__ import annotations

import numpy as np

from playground.shader.colours import linear_to_srgb

FILE = "flight/scene.glsl"


def test_the_air_hides_nothing_here_and_all_at_the_end(on_gpu):
    far = np.linspace(0, 12_000, 400)
    share = on_gpu(FILE, "air_share(d, 10000.0)", d=far)
    assert share[0] == 0 and (np.diff(share) >= 0).all()
    assert (share[far >= 9_800] == 1).all() and share[far < 2_000].max() < 0.06
    np.testing.assert_allclose(on_gpu(FILE, "air_share(3.0 * d, 30000.0)", d=far), share, atol=1e-6)


def test_water_hides_ground_with_depth_and_mirrors_at_grazing(on_gpu):
    depth = np.array([0.0, 5.0, 20.0, 500.0])
    glsl = "under_water(vec3(1.0), d, vec3(0.0, sqrt(1.0 - z * z), z), vec3(0.0), 10.0, vec3(0.0, 0.0, 1.0))"
    down = on_gpu(FILE, glsl, d=depth, z=1.0)
    # Straight down 2 in 100 are mirrored; of the rest, the ground's part is 0.6 exp(-depth / clarity).
    np.testing.assert_allclose(down[:, 0], 0.98 * 0.6 * np.exp(-depth / 10), atol=1e-5)
    np.testing.assert_allclose(down[:, 2] - down[:, 0], 0.02, atol=1e-5)
    flat = on_gpu(FILE, glsl, d=depth, z=0.0)
    np.testing.assert_allclose(flat, np.tile([0, 0, 1], (4, 1)), atol=1e-6)


def test_bright_sky_compression_keeps_order_and_hue(on_gpu):
    light = np.geomspace(1e-3, 1e3, 60)
    result = on_gpu(FILE, "eased(vec3(l, 0.5 * l, 2.0 * l))", l=light)
    assert (np.diff(result[:, 0]) > 0).all() and (result[light < 0.01, 0] > 0.99 * light[light < 0.01]).all()
    np.testing.assert_allclose(result / result[:, :1], np.tile([1, 0.5, 2], (60, 1)), rtol=1e-5)
    assert (result @ [0.2126, 0.7152, 0.0722]).max() < 4.0


def test_grain_around_a_half_changes_nothing(on_gpu):
    half = (np.array([0.5]),) * 4
    coarse = np.stack(half, -1)
    assert on_gpu(FILE, "close_ground(a, a)", a=coarse)[0] == 1.0
    assert on_gpu(FILE, "close_ground(a, a)", a=coarse + 0.1)[0] > 1.05


def test_presenting_is_exposure_then_tone_then_encoding(on_gpu):
    light = np.array([0.0, 0.0031308, 0.18, 0.5, 1.0, 4.0])
    result = on_gpu(FILE, "presented(vec3(l), 0.0, 0, 3.0).x", l=light)
    np.testing.assert_allclose(result, linear_to_srgb(np.minimum(light, 1.0)), atol=2e-4)
    np.testing.assert_allclose(
        on_gpu(FILE, "presented(vec3(0.25 * l), 2.0, 2, 3.0).x", l=light),
        on_gpu(FILE, "presented(vec3(l), 0.0, 2, 3.0).x", l=light),
        atol=1e-5,
    )

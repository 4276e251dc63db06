"""sky/drops.glsl: light among drops, against photons that are followed one by one in float64.

A photon goes on for a length drawn from Beer and Lambert's law, turns by Henyey and Greenstein's
phase function with g = 0.85, and never ends but at the top or the bottom.
"""

import numpy as np
import pytest

DROPS = "sky/drops.glsl"
G = 0.85
SCALE = 1 - G**2


def photons(depth, rise, count=20_000):
    """Return (share that leaves below, mean intensity of turned light at mid depth) for a unit beam."""
    rng = np.random.default_rng(7)
    at, down, left_below = np.zeros(count), np.full(count, -1.0), 0
    down[:] = rise
    turned = np.zeros(count, bool)
    crossed = 0.0
    while len(at):
        go = at + down * rng.exponential(size=len(at))
        over = ((at - depth / 2) * (go - depth / 2) < 0) & turned
        crossed += (1 / np.maximum(np.abs(down[over]), 1e-3)).sum()
        left_below += int((go > depth).sum())
        inside = (go > 0) & (go < depth)
        at, down, turned = go[inside], down[inside], np.ones(inside.sum(), bool)
        u = rng.random(len(at))
        cosine = (1 + G**2 - ((1 - G**2) / (1 - G + 2 * G * u)) ** 2) / (2 * G)
        side = np.sqrt(np.clip((1 - down**2) * (1 - cosine**2), 0, None))
        down = np.clip(down * cosine + side * np.cos(rng.uniform(0, 2 * np.pi, len(at))), -1, 1)
    # Each crossing of a level plane at an angle is so much of the intensity of all directions.
    return left_below / count, crossed * rise / count / (4 * np.pi)


@pytest.mark.parametrize(("depth", "rise"), [(4.0, 0.5), (12.0, 1.0), (12.0, 0.3), (40.0, 0.7)])
def test_a_layer_lets_through_what_photons_do(on_gpu, depth, rise):
    """Within 0.04 of all light, as the approximation's authors found; the rest it sends back."""
    result = on_gpu(DROPS, f"crossing({depth * SCALE}, {rise}).through")[0]
    back = on_gpu(DROPS, f"crossing({depth * SCALE}, {rise}).reflected")[0]
    below, middle = photons(depth, rise)
    assert result == pytest.approx(below, abs=0.04) and result + back == pytest.approx(1, abs=1e-6)
    call = f"diffuse_of_beam({0.5 * depth * SCALE}, {depth * SCALE}, {rise}).mean"
    # What was turned by next to nothing counts as beam there. The mean of all directions is the
    # weakest of what the approximation gives (a quarter off in thin layers).
    beam = np.exp(-0.5 * depth * SCALE / rise) - np.exp(-0.5 * depth / rise)
    assert on_gpu(DROPS, call)[0] == pytest.approx(middle - beam / (4 * np.pi), rel=0.25)


def test_no_light_is_lost_on_the_way_down(on_gpu):
    """Beam and turned light cross each depth alike; none comes in from above, none from below."""
    for whole in (0.01, 1.0, 11.0, 60.0):
        for rise in (0.02, 0.3, 1.0):
            depth = np.linspace(0, whole, 9).astype(np.float32)
            call = f"vec2(diffuse_of_beam(d, {whole}, {rise}).mean, diffuse_of_beam(d, {whole}, {rise}).down)"
            mean, down = on_gpu(DROPS, call, d=depth).T.astype(np.float64)
            beam = np.exp(-np.minimum(depth.astype(np.float64) / rise, 80))
            net = 4 * np.pi / 3 * down + rise * beam
            through = on_gpu(DROPS, f"crossing({whole}, {rise}).through")[0]
            np.testing.assert_allclose(net, through * rise, atol=2e-5)
            assert mean[0] + 2 / 3 * down[0] == pytest.approx(0, abs=1e-5)
            assert mean[-1] - 2 / 3 * down[-1] == pytest.approx(0, abs=1e-5)
            assert (mean >= 0).all()


def test_phases_send_light_once_round_the_sphere_and_forwards(on_gpu):
    x, weight = np.polynomial.legendre.leggauss(300)
    for name, forward in (("drops_phase_wide", G / (1 + G)), ("drops_peak", 0.92), ("drops_phase", None)):
        result = on_gpu(DROPS, f"{name}(c)", c=x).astype(np.float64)
        assert 2 * np.pi * result @ weight == pytest.approx(1, abs=1e-4)
        if forward:
            assert 2 * np.pi * (result * x) @ weight == pytest.approx(forward, abs=1e-4)


def test_among_drops_light_goes_from_that_above_to_that_below(on_gpu):
    """Lit alike from both sides it is that everywhere; a thin layer's is the mean of both."""
    call = "diffuse_between(vec3(0.4), vec3(0.4), d, 7.0).x"
    np.testing.assert_allclose(on_gpu(DROPS, call, d=np.array([0.0, 3.0, 7.0])), 0.4, rtol=1e-6)
    assert on_gpu(DROPS, "diffuse_between(vec3(1.0), vec3(0.2), 0.0, 0.0).x")[0] == pytest.approx(0.6)
    assert on_gpu(DROPS, "diffuse_between(vec3(1.0), vec3(0.0), 0.0, 1e3).x")[0] == pytest.approx(1, abs=2e-3)

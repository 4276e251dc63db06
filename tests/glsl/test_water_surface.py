"""water/: what a water surface mirrors, lets through and scatters, against float64."""

from __future__ import annotations

import numpy as np
import pytest

from ..sketch_texts import passes
from ..truth.surfaces import reflected

INDEX = 1.333
DISSOLVED = np.array([0.95, 1.0, 1.35])


def towards(azimuth, elevation):
    """Return unit vectors, in degrees."""
    a, e = np.radians(azimuth), np.radians(elevation)
    return np.stack(
        [np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.broadcast_to(np.sin(e), a.shape)], axis=-1
    )


# ── Fresnel ──────────────────────────────────────────────────────────────────────


def test_water_mirrors_the_mean_of_both_polarisations(on_gpu):
    cosine = np.linspace(0.001, 0.9999, 400)
    result = on_gpu("water/fresnel.glsl", "fresnel_of_water(c)", c=cosine.astype(np.float32))
    np.testing.assert_allclose(result, reflected(cosine), rtol=2e-4, atol=1e-6)
    assert on_gpu("water/fresnel.glsl", "fresnel_of_water(c)", c=np.float32([0.0]))[0] == 1.0


def test_schlick_is_off_by_up_to_six_percent_of_the_light(on_gpu):
    """As the lesson on water says, and `water/fresnel.glsl`: the most, at 84°, and too bright there."""
    cosine = np.linspace(0.001, 0.9999, 2001)
    off = 0.02 + 0.98 * (1.0 - cosine) ** 5 - reflected(cosine)
    worst = np.argmax(np.abs(off))
    assert off[worst] == pytest.approx(0.059, abs=5e-4)
    assert np.degrees(np.arccos(cosine[worst])) == pytest.approx(84.0, abs=0.5)
    schlick = "0.02 + 0.98 * pow(1.0 - c, 5.0) - fresnel_of_water(c)"
    result = on_gpu("water/fresnel.glsl", schlick, c=cosine.astype(np.float32))
    np.testing.assert_allclose(result, off, atol=2e-5)


def test_what_it_mirrors_of_an_even_sky_is_the_integral(on_gpu):
    cosine = (np.arange(100_000) + 0.5) / 100_000
    whole = np.mean(2 * cosine * reflected(cosine))
    assert on_gpu("water/fresnel.glsl", "DIFFUSE_MIRRORED")[0] == pytest.approx(whole, abs=2e-4)


# ── waves ────────────────────────────────────────────────────────────────────────

SEA = "sea_of(wind, fetch, vec2(0.6, 0.8))"
PROBE = """
#include "noise/hash.glsl"
#include "water/waves.glsl"
#pragma kernel(output = "slopes:rgba32f")
uniform sampler2D waves;    //! input
uniform int row = 0;        //! slider(0, 1)
uniform float pixel = 1.0;  //! log_slider(0.001, 100)
#include "water/parameters/wind.glsl"
vec4 kernel(ivec2 texel) {
    Footprint foot = Footprint(vec2(pixel, 0.0), vec2(0.0, 3.0 * pixel));
    Sea sea = row == 0 ? sea_of(wind, fetch, vec2(0.6, 0.8)) : river_of(1.5, 0.2);
    vec2 place = 20000.0 * random_pair(texel, 9u);
    Waves found = waves_at(waves, row, sea, place, time, foot);
    return vec4(found.slope, found.variance, sea.variance);
}
"""
PASSES = passes(waves=("water/wave_table", "size = [26, 2]"), slopes=("./probe", "size = 78"))


@pytest.fixture
def waves(make_sketch, any_engine):
    """Give a function: values → the slopes east and north, the variance left, all of it; at 6084 places."""
    sketch = make_sketch(PASSES, probe=PROBE)

    def read(name="slopes", time=12.5, **values):
        by = {}
        for key, value in values.items():
            by |= {
                f"{name}.{key}": value
                for name in ("waves", "slopes")
                if name == "slopes" or key in ("wind", "fetch")
            }
        return any_engine.read(sketch.with_values(by), name, time=time).astype(float)

    return read


@pytest.mark.parametrize(("wind", "fetch", "row"), [(2.0, 1500.0, 0), (9.0, 60000.0, 0), (3.0, 1500.0, 1)])
def test_drawn_slopes_and_variance_are_the_same_at_any_distance(waves, wind, fetch, row):
    """By Cox and Munk 0.003 + 0.00512 U; 6084 places, many waves apart: their mean is off by 2 % or so."""
    drawn, whole = [], []
    for pixel in [0.005, 0.05, 0.2, 0.7, 2.0, 6.0, 40.0]:
        result = waves(wind=wind, fetch=fetch, row=row, pixel=pixel).reshape(-1, 4)
        square = (result[:, :2] ** 2).sum(axis=1).mean()
        drawn.append(square)
        whole.append(square + result[:, 2].mean())
    np.testing.assert_allclose(whole, result[0, 3], rtol=0.05)
    if row == 0:
        assert result[0, 3] == pytest.approx(0.003 + 0.00512 * wind)
    assert drawn[0] > 0.25 * whole[0] and drawn[-1] == 0.0
    assert np.all(np.diff(drawn) <= 0.03 * whole[0])


def test_waves_move_as_on_deep_water(waves):
    """A wave of length L takes sqrt(2 pi L / g) for its own length."""
    before, after = waves("waves", 0.0), waves("waves", 0.2)
    length = 1 / np.hypot(before[..., 0], before[..., 1])
    np.testing.assert_allclose(length, before[..., 3], rtol=1e-5)
    turned = (before[..., 2] - after[..., 2]) % 1.0
    np.testing.assert_allclose(turned, 0.2 / np.sqrt(2 * np.pi * length / 9.81) % 1.0, atol=1e-4)
    ahead = before[..., :2] * length[..., None]
    wind = [np.sin(np.radians(60)), np.cos(np.radians(60))]
    assert (ahead[0] @ wind).mean() > 0.5 and abs((ahead[1] @ wind).mean()) < 0.2


def test_without_wind_there_is_no_wave(waves):
    np.testing.assert_array_equal(waves(wind=0.0, fetch=500.0, pixel=0.01), 0.0)


def test_wave_length_and_height_are_limited_by_fetch(on_gpu):
    """A fully grown sea by Pierson and Moskowitz: its peak at 0.88 g / U, 0.21 U^2 / g high."""
    wind = np.float32([5.0, 10.0, 10.0])
    fetch = np.float32([1e6, 5e6, 2000.0])
    result = on_gpu("water/waves.glsl", f"vec2({SEA}.longest, {SEA}.high)", wind=wind, fetch=fetch)
    np.testing.assert_allclose(result[1], [2 * np.pi * 100 / (9.81 * 0.88**2), 0.21 * 100 / 9.81], rtol=1e-3)
    # JONSWAP, 10 m/s over 2 km: a peak frequency of 3.5 g/U (g F / U^2)^-0.33 = 0.567 Hz, 0.23 m high.
    peak = 3.5 * 9.81 / 10 * (9.81 * 2000 / 100) ** -0.33
    assert result[2, 0] == pytest.approx(9.81 / (2 * np.pi * peak**2), rel=0.05)
    assert result[2, 1] == pytest.approx(0.0016 * np.sqrt(9.81 * 2000 / 100) * 100 / 9.81, rel=1e-3)
    assert np.all(result[0] < result[1]) and np.all(result[2] < result[0])


# ── the rough mirror ─────────────────────────────────────────────────────────────


def mirrored_by_slopes(to_eye, slope, variance, steps=801):
    """Return what a surface mirrors of an even sky, and its visible area, by a sum over its slopes."""
    spread = np.sqrt(variance / 2)
    s = np.linspace(-6, 6, steps) * spread
    x, y = np.meshgrid(s, s)
    weight = np.exp(-(x**2 + y**2) / variance)
    x, y = x + slope[0], y + slope[1]
    area = np.maximum(to_eye[2] - x * to_eye[0] - y * to_eye[1], 0.0)
    facing = area / np.sqrt(1 + x**2 + y**2)
    weight /= weight.sum()
    return (weight * area * reflected(facing)).sum() / (weight * area).sum(), (weight * area).sum()


@pytest.mark.slow
def test_a_rough_surface_mirrors_what_its_visible_slopes_do(on_gpu):
    """From straight above down to 3 degrees, up to a gale."""
    for elevation, bound in [
        (90.0, 0.03),
        (45.0, 0.03),
        (20.0, 0.03),
        (10.0, 0.03),
        (6.0, 0.06),
        (3.0, 0.06),
    ]:
        for variance in [1e-4, 0.01, 0.03, 0.06]:
            to_eye = towards(np.float64(70.0), elevation)
            mirrors = "mirrors_of(v, s, variance)"
            result = on_gpu(
                "water/rough_mirror.glsl",
                f"vec2({mirrors}.mirrored, {mirrors}.area)",
                v=tuple(map(float, to_eye)),
                s=(0.03, -0.02),
                variance=np.float32(variance),
            )[0]
            share, area = mirrored_by_slopes(to_eye, (0.03, -0.02), variance)
            assert result[0] == pytest.approx(share, abs=bound), (elevation, variance)
            assert result[1] == pytest.approx(area, abs=0.012), (elevation, variance)


def test_calm_water_is_a_mirror(on_gpu):
    to_eye = towards(np.linspace(0, 300, 20), 17.0)
    result = on_gpu(
        "water/rough_mirror.glsl", "mirrors_of(v, vec2(0.0), 0.0).to[1]", v=to_eye.astype(np.float32)
    )
    np.testing.assert_allclose(result, to_eye * [-1, -1, 1], atol=1e-5)
    share = on_gpu(
        "water/rough_mirror.glsl", "mirrors_of(v, vec2(0.0), 0.0).mirrored", v=to_eye.astype(np.float32)
    )
    np.testing.assert_allclose(share, reflected(np.sin(np.radians(17.0))), rtol=1e-3)


@pytest.mark.parametrize(("elevation", "variance"), [(60.0, 0.02), (35.0, 0.01), (25.0, 0.005)])
def test_all_of_the_glint_is_what_the_surface_mirrors(on_gpu, elevation, variance):
    """Over all places of the sun: the integral of glint / pi is F within 5 %."""
    to_eye = towards(np.float64(200.0), elevation)
    rise = (np.arange(400) + 0.5) / 400
    turn = (np.arange(800) + 0.5) / 800 * 360
    turn, rise = (a.ravel() for a in np.meshgrid(turn, rise))
    sun = towards(turn, np.degrees(np.arcsin(rise))).astype(np.float32)
    area = on_gpu(
        "water/rough_mirror.glsl",
        "mirrors_of(v, vec2(0.0), w).area",
        v=tuple(map(float, to_eye)),
        w=np.float32(variance),
    )
    glint = on_gpu(
        "water/rough_mirror.glsl",
        "sun_glint(v, sun, vec2(0.0), w, area)",
        v=tuple(map(float, to_eye)),
        sun=sun,
        w=np.float32(variance),
        area=np.float32(area[0]),
    )
    whole = glint.astype(float).mean() * 2 * np.pi / np.pi
    share, _ = mirrored_by_slopes(to_eye, (0.0, 0.0), variance)
    assert whole == pytest.approx(share, rel=0.05)


# ── in the water ─────────────────────────────────────────────────────────────────


def test_light_is_lost_along_both_bent_paths(on_gpu):
    """Step by step down from the sun and up to the eye, by Snell's angles, in float64."""
    depth, sun, view = 2.7, np.radians(31.0), np.radians(12.0)
    kept = on_gpu(
        "water/body.glsl",
        "light_left(attenuation_of(2.0), path_in_water(d, s, v))",
        d=np.float32(depth),
        s=np.float32(np.sin(sun)),
        v=np.float32(np.sin(view)),
    )[0]
    pure = np.array([0.2755, 0.0565, 0.00922])
    loss = pure + DISSOLVED * (1 / 2.0 - pure[1])
    left = np.ones(3)
    for angle in (sun, view):
        bent = np.arcsin(np.cos(angle) / INDEX)  # to the vertical
        step = depth / np.cos(bent) / 10_000
        for _ in range(10_000):
            left = left * (1 - loss * step)
    np.testing.assert_allclose(kept, left, rtol=2e-3)
    green = on_gpu("water/body.glsl", "light_left(attenuation_of(2.0), 2.0).g")
    assert green[0] == pytest.approx(np.exp(-1), rel=1e-5)


def test_red_goes_first_and_no_more_goes_in_than_falls_on_it(on_gpu):
    clarity = np.float32([0.2, 1.0, 5.0, 15.0])
    kept = on_gpu("water/body.glsl", "light_left(attenuation_of(c), 3.0)", c=clarity)
    assert np.all(kept[2:, 0] < kept[2:, 1]) and np.all(np.diff(kept, axis=0) >= 0)
    rise = np.linspace(0.01, 0.999, 30).astype(np.float32)
    down = on_gpu("water/body.glsl", "light_down(vec3(1.0), vec3(0.0), s).r", s=rise)
    np.testing.assert_allclose(down, 1 - reflected(rise), atol=1e-4)


# ── foam ─────────────────────────────────────────────────────────────────────────


def test_the_pattern_of_foam_has_its_cover(on_gpu):
    """200,000 places, of which 1000 are foam at the least: their share is off by 3 % or so."""
    position = np.random.default_rng(2).uniform(0, 20_000, (200_000, 2)).astype(np.float32)
    for cover in (0.005, 0.02, 0.1, 0.5):
        for pixel in (0.05, 0.7, 30.0):
            value = {"cover": np.float32(cover), "pixel": np.float32(pixel)}
            result = on_gpu("water/foam.glsl", "foam_of(cover, place, 2.0, pixel)", place=position, **value)
            assert result.mean() == pytest.approx(cover, rel=0.15), (cover, pixel)
            assert result.min() >= 0 and result.max() <= 1


def test_sparse_foam_is_no_specks_of_a_pixel(on_gpu):
    """Of a cover of 0.005 patches are about 0.28 m wide in lumps of 2 m: seen by less than 0.14 m."""
    position = np.random.default_rng(3).uniform(0, 20_000, (20_000, 2)).astype(np.float32)
    near, far = (
        on_gpu(
            "water/foam.glsl", "foam_of(0.005, place, 2.0, pixel)", place=position, pixel=np.float32(pixel)
        )
        for pixel in (0.05, 0.15)
    )
    assert near.max() > 0.9
    np.testing.assert_allclose(far, 0.005, rtol=1e-5)


def test_waves_break_where_it_is_shallow(on_gpu):
    depth = np.float32([0.0, 0.3, 1.0, 1.3, 3.0])
    result = on_gpu("water/foam.glsl", "shore_cover(d, 1.0, 2.0, 0.3)", d=depth)
    assert np.all(result[:3] > 0.01) and np.all(result[3:] == 0)
    assert on_gpu("water/foam.glsl", "shore_cover(0.001, 0.0, 2.0, 0.3)")[0] == 0


@pytest.mark.parametrize("pixel", [0.1, 0.7, 3.0, 40.0])
def test_pixels_of_any_width_have_as_much_of_the_wash(on_gpu, pixel):
    """A ramp from 1 at the shore to 0 at 4 m has the area 2 m, however it is cut into pixels."""
    away = (np.arange(-50, 1000) * pixel + 0.3 * pixel).astype(np.float32)
    result = on_gpu("water/foam.glsl", "wash_cover(away, 4.0, pixel)", away=away, pixel=np.float32(pixel))
    assert result.sum() * pixel == pytest.approx(2.0, rel=1e-3)
    assert result.min() >= 0 and result.max() <= 1 and np.all(result[away > 4.0 + pixel] == 0)

"""The kernels that lessons on air, clouds, water and trees quote, against float64 and against counts."""

from __future__ import annotations

import numpy as np
import pytest

from playground.paths import SKETCHES

from ..loading import load
from ..truth.surfaces import reflected

RADIUS, TOP, EYE = 6360.0, 100.0, 0.001
WAVES = np.array([0.627, 0.539, 0.440])


@pytest.fixture
def shown():
    def make(name, **values):
        return load(SKETCHES / f"{name}.toml").with_values(
            {key.replace("__", "."): v for key, v in values.items()}
        )

    return make


def air_of(turbidity):
    molecules = 0.008735 * WAVES**-4.08 / 8
    aerosol = (0.04608 * turbidity - 0.04586) * WAVES**-1.3 / 1.2
    return molecules, aerosol, 0.35 * np.array([0.095, 0.067, 0.0]) / 15


def height_at(height, rise, path):
    return np.sqrt((RADIUS + height) ** 2 + path * (path + 2 * (RADIUS + height) * rise)) - RADIUS


def far_of(height, rise):
    along = (RADIUS + height) * rise
    return np.sqrt(along**2 + (RADIUS + TOP) ** 2 - (RADIUS + height) ** 2) - along


def taken(air, height):
    height = np.asarray(height, float)[..., None]
    molecules, aerosol, ozone = air
    tent = np.clip(1 - np.abs(height - 25) / 15, 0, None)
    return molecules * np.exp(-height / 8) + aerosol * np.exp(-height / 1.2) + ozone * tent


SHARES, WEIGHTS = (0.5 * part for part in np.polynomial.legendre.leggauss(100))
SHARES = SHARES + 0.5


def depth_of(air, height, rise, far):
    """Return the optical depth; by the square of a fraction, since the air is dense at the start."""
    parts = taken(air, height_at(height, rise, far * SHARES**2))
    return (parts * (WEIGHTS * 2 * SHARES * far)[:, None]).sum(axis=0)


def sky_towards(up, aside, elevation, turbidity):
    """Return the light of one scattering, worked out by quadrature [of a white sheet's]."""
    air = air_of(turbidity)
    rise, sun = np.sin(up), np.sin(elevation)
    together = np.sin(up) * sun + np.cos(up) * np.cos(elevation) * np.cos(aside)
    by_molecules = 3 / (16 * np.pi) * (1 + together**2)
    g = 0.8
    by_aerosol = 3 / (8 * np.pi) * (1 - g * g) * (1 + together**2) / (2 + g * g)
    by_aerosol /= (1 + g * g - 2 * g * together) ** 1.5
    far = far_of(EYE, rise)

    def added(share):
        path = far * share**2
        height = height_at(EYE, rise, path)
        sun_there = ((RADIUS + EYE) * sun + path * together) / (RADIUS + height)
        depth = depth_of(air, EYE, rise, path) + depth_of(air, height, sun_there, far_of(height, sun_there))
        scattered = air[0] * np.exp(-height / 8) * by_molecules
        scattered = scattered + 0.9 * air[1] * np.exp(-height / 1.2) * by_aerosol
        return np.exp(-depth) * scattered * 2 * share * far

    return np.pi * sum(weight * added(share) for share, weight in zip(SHARES, WEIGHTS, strict=True))


def test_the_sky_is_the_integral_of_light_scattered_once(engine, shown):
    """24 and 12 steps: each is a midpoint rule, off by (1 / 24) / 12 of its smallest layer; so, 4 %."""
    elevation, turbidity, exposure = 35.0, 1.5, 5.0
    sky = engine.read(
        shown("sky_once", sky__elevation=elevation, sky__turbidity=turbidity, sky__exposure=exposure),
        "sky:sky",
    ).astype(float)
    ny, nx = sky.shape[:2]
    for row, column in ((5, 30), (60, 200), (235, 400)):
        up, aside = 0.5 * np.pi * (row + 0.5) / ny, np.pi * ((column + 0.5) / nx - 0.5)
        expected = sky_towards(up, aside, np.radians(elevation), turbidity)
        result = -np.log(1 - sky[row, column, :3]) / exposure
        np.testing.assert_allclose(result, expected, rtol=0.04)


def test_ridges_follow_koschmieder(engine, shown):
    sketch = shown("ridges_in_air", ridges__turbidity=2.0)
    far = engine.read(sketch, "ridges:distance_of").astype(float)
    picture = engine.read(sketch, "ridges:picture").astype(float)[..., :3]
    molecules, aerosol, _ = air_of(2.0)
    left = np.exp(-(molecules + aerosol) * far[..., None])
    expected = np.array([0.045, 0.055, 0.03]) * left + np.array([0.62, 0.70, 0.80]) * (1 - left)
    terrain = far > 0
    assert len(np.unique(far)) == 9 and 0.3 < terrain.mean() < 0.9
    # Half floats hold eleven bits.
    np.testing.assert_allclose(picture[terrain], expected[terrain], rtol=2.0**-10)


def test_clouds_keep_to_their_layer(engine, shown):
    values = engine.read(shown("cloud_slice"), "slice:density").astype(float)
    metres = np.linspace(0, 3600, values.shape[0])
    outside = (metres < 1300) | (metres > 2900)
    assert values[outside, :, 0].max() == 0 and 0.02 < (values[..., 0] > 0.5).mean() < 0.4


def test_the_beam_is_that_of_beer_and_lambert(engine, shown):
    """The sun overhead: a sum down each column, by another rule, whose steps of 20 m are the bound."""
    sketch = shown("cloud_slice", light__sun=90.0, light__extinction=0.004)
    dense = engine.read(sketch, "slice:density").astype(float)[..., 0]
    beam = engine.read(sketch, "light:beam").astype(float)
    step = 3600 / (dense.shape[0] - 1)
    above = np.cumsum(dense[::-1], axis=0)[::-1] - 0.5 * dense
    # Each end of a cloud may be off by a step of either sum; a column of 5 clouds has 10 ends.
    bound = 0.004 * (step + 0.7 * 3600 / 96)
    here = -np.log(np.maximum(beam[:60], 1e-30))
    expected = 0.004 * step * above[:60]
    sure = expected < 20
    assert (expected > 1).any()
    np.testing.assert_allclose(here[sure], expected[sure], atol=2 * bound)


def test_calm_water_mirrors_by_fresnel(engine, shown):
    mirrored = engine.read(shown("water_view", water__down=30.0), "water:mirrored").astype(float)
    ny, nx = mirrored.shape
    x = (np.arange(nx) + 0.5 - nx / 2) / ny
    y = (np.arange(ny) + 0.5 - ny / 2) / ny
    sinks = np.radians(30)
    z = (y * np.cos(sinks) - np.sin(sinks))[:, None] / np.sqrt(1 + x[None] ** 2 + y[:, None] ** 2)
    np.testing.assert_allclose(mirrored, reflected(-z), atol=2e-6)


@pytest.mark.parametrize("wind", [2.0, 8.0])
def test_slopes_of_waves_vary_as_cox_and_munk_found(engine, shown, wind):
    """Seen from so near that no wave is left out; of 24 waves over some metres chance leaves a tenth."""
    sketch = shown("water_view", water__wind=wind, water__down=60.0, water__eye_height=5.0)
    slope = engine.read(sketch, "water:slope").astype(float)
    assert (slope**2).sum(axis=-1).mean() == pytest.approx(0.00512 * wind, rel=0.15)


def test_trees_are_as_many_as_cells_and_cover_as_much_when_fewer(engine, shown):
    """Crowns of 3 m, one in each cell of 20 m, hardly overlap: they cover pi 9 / 400 of the ground."""
    value = {"trees__cell": 20.0, "density__clearings": 0.0, "density__steep": (4.0, 5.0)}
    whole = engine.read(shown("trees_from_above", **value), "trees:crown").mean()
    assert whole == pytest.approx(9 * np.pi / 400, rel=0.05)
    fewer = engine.read(shown("trees_from_above", trees__kept=0.25, **value), "trees:crown").mean()
    # 225 of 900 trees: chance leaves sqrt(225) of them and the overlap of Poisson's squares.
    assert fewer == pytest.approx(whole, rel=0.2)


def test_a_tree_that_is_drawn_stays_as_the_eye_comes_nearer(engine, shown):
    drawn = engine.read(shown("trees_in_time"), "drawn")[::-1]  # the first picture first
    assert (np.diff(drawn, axis=0) >= 0).all()
    item = drawn[2::4, 2::4]
    away = 4000 * (1 - np.arange(len(item)) / len(item))
    expected = np.minimum(1000 / away, 1) ** 2
    # 120 trees: the largest deviation of their count is below 0.15 but for one time in 100.
    assert np.abs(item.mean(axis=1) - expected).max() < 0.15

"""Fractional Brownian motion: its octaves and its curves against twins, its spectrum, its self-affinity."""

from itertools import pairwise

import numpy as np
import pytest

from .drawing import salt
from .test_gradient_noise import SHIFT, perlin, places

WHOLE = 2**32


@pytest.fixture
def sketch_of(make_sketch):
    def make(size=(65, 65), use="generation/fbm", **values):
        text = "".join(f"{k} = {v!r}\n" for k, v in values.items())
        return make_sketch(
            f'[[pass]]\nname = "terrain"\nuse = "{use}"\n[pass.set]\n{text}',
            size=list(size),
            extent=[1000.0, 1000.0 * max(size[1] - 1, 1) / max(size[0] - 1, 1)],
        )

    return make


def slope_of_bins(frequency, power, low, high):
    """Return how power falls with frequency: the line through means over even steps of its logarithm."""
    edges = np.geomspace(low, high, 17)
    means = [power[(frequency >= a) & (frequency < b)].mean() for a, b in pairwise(edges)]
    return np.polyfit(np.log(np.sqrt(edges[1:] * edges[:-1])), np.log(means), 1)[0]


# ── the terrain ─────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("hurst", "frequency", "lacunarity", "octaves"), [(0.8, 2.0, 2.0, 16), (0.3, 3.0, 2.5, 4)]
)
def test_octaves_are_added(any_engine, sketch_of, hurst, frequency, lacunarity, octaves):
    """Places are off by a rounding, 2^-24 of them an octave; noise rises by less than 4 a cell."""
    size, seed = (129, 65), 7 + salt("generation/fbm")
    values = {"hurst": hurst, "frequency": frequency, "lacunarity": lacunarity, "octaves": octaves}
    x, y, texels = places(size, (1000.0, 500.0), frequency)
    expected, bound = np.zeros(x.shape), 0.0
    for k in range(octaves):
        cells, gain = lacunarity**k, lacunarity ** (-hurst * k)
        weight = gain * np.clip(texels / cells - 1, 0, 1)
        if weight == 0:
            break
        expected += weight * perlin(x * cells + SHIFT, y * cells, seed * 0x2545F491 + k * 0xC2B2AE3D)
        bound += gain * (4 * (k + 4) * frequency * cells + 16) * 2.0**-24
    sketch = sketch_of(size, use="generation/fbm/sum", **values)
    assert np.abs(any_engine.read(sketch, "terrain") - expected).max() <= bound


@pytest.mark.parametrize("hurst", [0.2, 0.4, 0.6, 0.8])
@pytest.mark.parametrize("seed", [7, 3])
def test_its_power_falls_as_fractional_brownian_motion_s(any_engine, sketch_of, hurst, seed):
    """Radial power spectrum f^-(2H + 2): 1024 texels a side, 8 octaves from frequency 4, a Hann window."""
    n = 1024
    terrain = any_engine.read(sketch_of((n, n), hurst=hurst, seed=seed), "terrain").astype(float)
    window = np.hanning(n)
    power = np.abs(np.fft.fft2((terrain - terrain.mean()) * np.outer(window, window))) ** 2
    along = np.fft.fftfreq(n, 1 / n)
    slope = slope_of_bins(np.hypot(along[None], along[:, None]), power, 8, 256)
    assert abs(slope + 2 * hurst + 2) < 0.2


def test_each_octave_is_weaker_by_the_hurst_exponent(any_engine, sketch_of):
    def octaves(**values):
        terrains = [
            any_engine.read(sketch_of((257, 257), octaves=k, normalise="none", **values), "terrain").astype(
                float
            )
            for k in range(5)
        ]
        return [after - before for before, after in pairwise(terrains)]

    for hurst, lacunarity in ((0.5, 2.0), (0.8, 3.0), (1.0, 2.0)):
        alike, falling = (octaves(hurst=h, lacunarity=lacunarity) for h in (0.0, hurst))
        for k in range(4):
            assert np.abs(alike[k]).max() > 0.3
            np.testing.assert_allclose(falling[k], lacunarity ** (-hurst * k) * alike[k], atol=2e-6)


def test_it_has_eight_octaves_from_four_on(any_engine, sketch_of):
    said = sketch_of((257, 257), octaves=8, frequency=4.0, lacunarity=2.0, hurst=0.8)
    np.testing.assert_array_equal(
        any_engine.read(sketch_of((257, 257)), "terrain"), any_engine.read(said, "terrain")
    )


def test_a_part_of_it_is_like_the_whole(any_engine, sketch_of):
    """Self-affinity: heights t apart differ by t^H, over the terrain and over a part an eighth as wide."""
    for hurst in (0.3, 0.7):
        differences = []
        for seed in range(6):
            terrain = any_engine.read(
                sketch_of((513, 513), hurst=hurst, seed=seed, normalise="none"), "terrain"
            )
            differences.append([np.abs(terrain[t:] - terrain[:-t]).mean() for t in (4, 8, 16, 32)])
        grown = np.polyfit(np.log([4, 8, 16, 32]), np.log(np.mean(differences, axis=0)), 1)[0]
        assert abs(grown - hurst) < 0.12


def test_a_smaller_exponent_is_rougher_terrain(any_engine, sketch_of):
    rough = [
        np.abs(np.diff(any_engine.read(sketch_of(hurst=h), "terrain"))).mean() for h in (0.9, 0.6, 0.3, 0.0)
    ]
    assert rough == sorted(rough) and rough[-1] > 1.5 * rough[0]


def test_limits(engine, sketch_of):
    for values in ({"octaves": 0}, {"hurst": 0.0}, {"hurst": 1.0}, {"frequency": 1024.0}, {"octaves": 16}):
        for size in ((2, 2), (33, 20)):
            terrain = engine.read(sketch_of(size, **values), "terrain")
            assert np.isfinite(terrain).all()
            assert (terrain.min(), terrain.max()) == (
                (0, 0) if "octaves" in values and not values["octaves"] else (0, 1)
            )


# ── curves ───────────────────────────────────────────────────────────────────

CURVES = "generation/fbm/curve"


def mixed(key):
    key = key % WHOLE
    key = (key ^ key >> 15) * 0x7FEB352D % WHOLE
    return key | 1


def slope_at(cell, line, seed):
    """Return the random slope at a whole number of one line of noise, -1..1."""
    bits = mixed(cell * 0x9E3779B1 + seed) * mixed(line * 0x85EBCA77 + seed) % WHOLE
    return (bits - WHOLE if bits >= WHOLE // 2 else bits) / 2**31


def curve(n, line, hurst, octaves, frequency, seed):
    """Return one row, point by point."""
    nodes = max(n - 1, 1)
    row, squares = np.zeros(n), 0.0
    for k in range(octaves):
        cells = min(frequency, nodes / 2) * 2**k
        weight = 2.0 ** (-hurst * k) * min(max(nodes / cells - 1, 0), 1)
        which = ((seed + salt("generation/fbm/curve")) * 0x2545F491 + k * 0xC2B2AE3D) % WHOLE
        squares += weight**2
        for i in range(n):
            position = i * cells / nodes + 0.618034
            cell = int(np.floor(position))
            t = position - cell
            fade = t**3 * (10 - 15 * t + 6 * t * t)
            low, high = slope_at(cell, line, which) * t, slope_at(cell + 1, line, which) * (t - 1)
            row[i] += weight * (low * (1 - fade) + high * fade)
    return row / (0.140695 * np.sqrt(squares)) if squares else row


@pytest.mark.parametrize("size", [(65, 6), (40, 2), (1, 3), (2, 5)], ids=str)
def test_curves_are_octaves_of_noise_along_a_line(engine, sketch_of, size):
    exponents = (0.9, 0.5, 0.4, 0.1)
    values = {"hurst": list(exponents), "hurst_last": 0.7, "octaves": 5, "frequency": 3.0, "seed": 9}
    result = engine.read(sketch_of(size, CURVES, **values), "terrain")
    truth = [curve(size[0], r, (*exponents, 0.7, 0.7)[r], 5, 3.0, 9) for r in range(size[1])]
    np.testing.assert_allclose(result, truth, atol=3e-5)


def many_curves(any_engine, sketch_of, hurst):
    values = {"hurst": [hurst] * 4, "hurst_last": hurst, "octaves": 12}
    return any_engine.read(sketch_of((4096, 48), CURVES, **values), "terrain").astype(float)


@pytest.mark.parametrize("hurst", [0.2, 0.4, 0.6, 0.8])
def test_curve_power_spectrum_matches_fractional_brownian_motion(any_engine, sketch_of, hurst):
    """Power spectrum f^-(2H + 1), the mean over 48 curves."""
    rows = many_curves(any_engine, sketch_of, hurst)
    windowed = (rows - rows.mean(axis=1, keepdims=True)) * np.hanning(4096)
    power = (np.abs(np.fft.rfft(windowed)) ** 2).mean(axis=0)
    assert abs(slope_of_bins(np.arange(power.size), power, 8, 512) + 2 * hurst + 1) < 0.1


def test_curves_are_self_affine_and_of_one_deviation(any_engine, sketch_of):
    for hurst in (0.3, 0.5, 0.7):
        rows = many_curves(any_engine, sketch_of, hurst)
        steps = 2 ** np.arange(2, 9)
        grown = [np.abs(rows[:, t:] - rows[:, :-t]).mean() for t in steps]
        assert abs(np.polyfit(np.log(steps), np.log(grown), 1)[0] - hurst) < 0.08
        assert abs(rows.std() - 1) < 0.06


def test_curves_know_nothing_of_each_other(any_engine, sketch_of):
    values = {"hurst": [0.0] * 4, "hurst_last": 0.0, "frequency": 64.0, "octaves": 5}
    rows = any_engine.read(sketch_of((2049, 12), CURVES, **values), "terrain").astype(float)
    assert np.abs(np.corrcoef(rows)[np.triu_indices(12, 1)]).max() < 0.25
    other = any_engine.read(sketch_of((2049, 12), CURVES, seed=8, **values), "terrain").astype(float)
    assert abs(np.corrcoef(rows[0], other[0])[0, 1]) < 0.25


def test_no_octaves_are_a_level_curve(engine, sketch_of):
    np.testing.assert_array_equal(engine.read(sketch_of((33, 5), CURVES, octaves=0), "terrain"), 0)

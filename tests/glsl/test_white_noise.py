"""White noise: a number a texel, even over 0..1, none of which knows of another."""

import numpy as np
import pytest

from .drawing import salt

N = 512


@pytest.fixture
def sketch_of(make_sketch):
    def make(size=(N, N), seed=7):
        use = f'[[pass]]\nname = "terrain"\nuse = "generation/white_noise"\nset = {{ seed = {seed} }}\n'
        return make_sketch(use, size=list(size))

    return make


@pytest.mark.parametrize("size", [(33, 33), (40, 17), (1, 1), (2, 2)], ids=str)
def test_each_height_is_the_hash_of_its_place(engine, sketch_of, python_random, size):
    y, x = np.mgrid[0 : size[1], 0 : size[0]]
    expected = python_random(x, y, 11 + salt("generation/white_noise"))
    np.testing.assert_array_equal(engine.read(sketch_of(size, seed=11), "terrain"), expected)


@pytest.mark.parametrize("seed", [0, 7, 9999])
def test_heights_know_nothing_of_each_other(any_engine, sketch_of, seed):
    """Autocorrelation over n² texels: nearest lags at most 4/n, any lag at most 6/n."""
    terrain = any_engine.read(sketch_of(seed=seed), "terrain").astype(float)
    power = np.abs(np.fft.fft2(terrain - terrain.mean())) ** 2
    correlation = np.fft.ifft2(power).real / power.mean()
    correlation[0, 0] = 0
    nearest = [correlation[0, 1], correlation[1, 0], correlation[1, 1], correlation[1, -1]]
    assert np.abs(nearest).max() <= 4 / N
    assert np.abs(correlation).max() <= 6 / N


@pytest.mark.parametrize("seed", [0, 7, 9999])
def test_heights_are_even_over_0_to_1(any_engine, sketch_of, seed):
    terrain = any_engine.read(sketch_of(seed=seed), "terrain").astype(float)
    # Four standard errors of the mean and of the variance of N² even numbers.
    assert abs(terrain.mean() - 1 / 2) < 4 / np.sqrt(12) / N
    assert abs(terrain.var() - 1 / 12) < 4 / np.sqrt(180) / N
    counts = np.histogram(terrain, 64, (0, 1))[0]
    chi = ((counts - N * N / 64) ** 2 / (N * N / 64)).sum()
    assert 63 - 4 * np.sqrt(126) < chi < 63 + 5 * np.sqrt(126)


def test_seeds_are_terrains_of_their_own(any_engine, sketch_of):
    terrains = [any_engine.read(sketch_of(seed=s), "terrain").astype(float).ravel() for s in (7, 8, 7)]
    np.testing.assert_array_equal(terrains[0], terrains[2])
    assert abs(np.corrcoef(terrains[0], terrains[1])[0, 1]) < 4 / N

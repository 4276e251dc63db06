"""The first lesson's kernel: octaves of interpolated random numbers, in float64."""

import numpy as np
import pytest


@pytest.fixture
def sketch_of(make_sketch):
    def make(size, roughness=0.5, seed=7):
        values = f"{{ roughness = {roughness}, seed = {seed} }}"
        use = f'[[pass]]\nname = "terrain"\nuse = "generation/first_height"\nset = {values}\n'
        return make_sketch(use, size=list(size))

    return make


def passage(texels, cells):
    """Return the matrix that makes heights at texels of those at nodes, along one axis."""
    position = cells * np.arange(texels) / (texels - 1)
    node = np.floor(position).astype(int)
    share = position - node
    bent = 3 * share**2 - 2 * share**3
    result = np.zeros((texels, cells + 2))
    rows = np.arange(texels)
    result[rows, node] = 1 - bent
    result[rows, node + 1] += bent
    return result


@pytest.mark.parametrize(
    ("size", "roughness", "seed"), [((33, 33), 0.5, 7), ((257, 257), 0.3, 7), ((65, 40), 0.7, 4711)], ids=str
)
def test_heights_are_interpolated_random_numbers(any_engine, sketch_of, python_random, size, roughness, seed):
    """A place of up to 64 cells is off by 64 * 2^-24, an octave by 3 times that, and by its weight less."""
    expected = np.zeros(size[::-1])
    bound = 0.0
    for k in range(5):
        cells, weight = 4 * 2**k, 0.5 * roughness**k
        nodes = python_random(*np.meshgrid(np.arange(cells + 2), np.arange(cells + 2)), seed)
        expected += weight * (passage(size[1], cells) @ nodes.astype(float) @ passage(size[0], cells).T)
        bound += weight * (3 * cells + 4) * 2.0**-24
    heights = any_engine.read(sketch_of(size, roughness, seed), "terrain")
    assert np.abs(heights - expected).max() <= bound
    if roughness <= 0.5:
        assert heights.min() >= 0 and heights.max() <= 1


def test_its_terrain_is_the_same_at_every_size(any_engine, sketch_of):
    fine = any_engine.read(sketch_of((257, 257)), "terrain")
    coarse = any_engine.read(sketch_of((65, 65)), "terrain")
    np.testing.assert_allclose(fine[::4, ::4], coarse, atol=4e-5)

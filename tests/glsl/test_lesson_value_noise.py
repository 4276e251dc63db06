"""The value noise that the lesson quotes: interpolation of random numbers, in float64."""

import numpy as np
import pytest

from .drawing import salt

PASSAGES = {
    "line": ((0, 1), 1.0),
    "cubic": ((0, 0, 3, -2), 1.5),
    "quintic": ((0, 0, 0, 10, -15, 6), 1.875),
}  # factors of the powers of a; steepest


def at_nodes(texels, cells):
    """Return the node before each texel, and the fraction of the way to the next one."""
    position = cells * np.arange(texels) / (texels - 1)
    node = np.minimum(np.floor(position).astype(int), cells - 1)
    return node, position - node


@pytest.fixture
def read(any_engine, make_sketch):
    def one(name, size, passage, cells, seed):
        values = f'{{ passage = "{passage}", cells = {cells}, seed = {seed} }}'
        use = f'[[pass]]\nname = "terrain"\nuse = "generation/{name}"\nset = {values}\n'
        return any_engine.read(make_sketch(use, size=list(size)), "terrain").astype(float)

    return one


@pytest.mark.parametrize("passage", PASSAGES)
def test_heights_are_random_numbers_interpolated(read, python_random, passage):
    """A share is off by a place's rounding, a height by as much times the steepest, along both axes."""
    cells, seed, size = 13, 4, (97, 64)
    factors, steepest = PASSAGES[passage]
    nodes = np.arange(cells + 1)
    numbers = python_random(*np.meshgrid(nodes, nodes), seed + salt("lessons/value_noise")).astype(float)
    matrices = []
    for texels in size:
        node, share = at_nodes(texels, cells)
        bent = np.polynomial.polynomial.polyval(share, factors)
        matrix = np.zeros((texels, cells + 1))
        matrix[np.arange(texels), node] = 1 - bent
        matrix[np.arange(texels), node + 1] += bent
        matrices.append(matrix)
    expected = matrices[1] @ numbers @ matrices[0].T
    bound = (2 * steepest * 2 * cells + 40) * 2.0**-24
    assert np.abs(read("value_noise", size, passage, cells, seed) - expected).max() <= bound


@pytest.mark.parametrize("passage", PASSAGES)
def test_the_curve_and_its_derivative(read, python_random, passage):
    """The derivative is that of a polynomial by its factors, which share nothing with the kernel's text."""
    cells, seed, texels = 7, 3, 1281
    factors, steepest = PASSAGES[passage]
    result = read("value_noise/curve", (texels, 2), passage, cells, seed)
    key = seed + salt("lessons/value_noise_curve")
    numbers = 2 * python_random(np.arange(cells + 1), np.zeros(cells + 1, int), key).astype(float) - 1
    node, share = at_nodes(texels, cells)
    step = numbers[node + 1] - numbers[node]
    polynomial = np.polynomial.Polynomial(factors)
    bound = (4 * 6 * cells + 100) * 2.0**-24
    assert np.abs(result[0] - (numbers[node] + step * polynomial(share))).max() <= 2 * steepest * bound
    expected = 0.5 * step * polynomial.deriv()(share)
    inside = (share > 1e-4) & (share < 1 - 1e-4)  # which side of a node a texel on it takes is rounding
    assert np.abs(result[1] - expected)[inside].max() <= 6 * bound
    assert np.isclose(polynomial.deriv()(0.5), steepest)

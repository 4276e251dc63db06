"""Numbers of texels and the eight neighbours, against NumPy."""

import numpy as np
import pytest

FILE = "water/texels.glsl"


@pytest.mark.parametrize("whole", [(1, 1), (7, 5), (1025, 1025), (4096, 4096)], ids=str)
def test_numbers_are_those_of_numpy_and_back(on_gpu, whole):
    rng = np.random.default_rng(5)
    y, x = rng.integers(0, whole[1], 400), rng.integers(0, whole[0], 400)
    y[0], x[0] = whole[1] - 1, whole[0] - 1
    expected = np.ravel_multi_index((y, x), whole[::-1])
    texels = np.stack([x, y], 1).astype(np.int32)
    number = on_gpu(FILE, "number_of(texel, whole)", texel=texels, whole=whole)
    np.testing.assert_array_equal(number, expected)
    np.testing.assert_array_equal(on_gpu(FILE, "texel_of(n, whole)", n=number, whole=whole), texels)


def test_a_number_that_is_no_texel_is_taken_to_the_nearest(on_gpu):
    result = on_gpu(FILE, "texel_of(n, whole)", n=np.array([-5.0, 35.0, 1e30]), whole=(7, 5))
    np.testing.assert_array_equal(result, [[0, 0], [6, 4], [6, 4]])


def test_the_neighbours_are_the_eight_around(on_gpu):
    result = on_gpu(FILE, "neighbour_of(k)", k=np.arange(8, dtype=np.int32))
    expected = [(x, y) for y in (-1, 0, 1) for x in (-1, 0, 1) if (x, y) != (0, 0)]
    np.testing.assert_array_equal(result, expected)


def test_the_edge_and_what_is_inside(on_gpu):
    x, y = np.meshgrid(np.arange(-1, 8), np.arange(-1, 6))
    texels = np.stack([x.ravel(), y.ravel()], 1).astype(np.int32)
    within = (texels >= 0).all(1) & (texels < (7, 5)).all(1)
    inner = (texels >= 1).all(1) & (texels < (6, 4)).all(1)
    np.testing.assert_array_equal(on_gpu(FILE, "int(inside(t, ivec2(7, 5)))", t=texels), within)
    np.testing.assert_array_equal(on_gpu(FILE, "int(on_edge(t, ivec2(7, 5)))", t=texels), ~inner)

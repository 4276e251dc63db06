"""Random numbers: the same whole numbers as in Python, and the statistics they must have."""

import numpy as np
import pytest

RNG = np.random.default_rng(5)
SIDE = 256
Y, X = (a.ravel() for a in np.mgrid[0:SIDE, 0:SIDE])


def pcg3d(key):
    """Return pcg3d of one key, in the notation of Jarzynski and Olano's paper."""
    m = 0xFFFFFFFF
    x, y, z = ((int(k) * 1664525 + 1013904223) & m for k in key)
    x = (x + y * z) & m
    y = (y + z * x) & m
    z = (z + x * y) & m
    x, y, z = x ^ (x >> 16), y ^ (y >> 16), z ^ (z >> 16)
    x = (x + y * z) & m
    y = (y + z * x) & m
    return x, y, (z + x * y) & m


def test_the_hash_is_pcg3d(on_gpu):
    keys = RNG.integers(0, 2**32, (400, 3), dtype=np.uint32)
    keys[:3] = [[0, 0, 0], [1, 0, 0], [2**32 - 1] * 3]
    result = on_gpu("noise/hash.glsl", "hash3(key)", key=keys)
    np.testing.assert_array_equal(result, [pcg3d(key) for key in keys])


def test_its_values_are_pinned(on_gpu):
    result = on_gpu("noise/hash.glsl", "hash3(key)", key=np.array([[0, 0, 0], [1, 2, 3]], np.uint32))
    np.testing.assert_array_equal(result, [pcg3d((0, 0, 0)), pcg3d((1, 2, 3))])
    assert result[0].tolist() == [2611992518, 2833812075, 1058359340]


def test_a_number_is_the_upper_24_bits(on_gpu, python_random):
    points = RNG.integers(-(2**31), 2**31, (400, 2))
    result = on_gpu("noise/hash.glsl", "random(point, seed)", point=points, seed=np.uint32(9))
    np.testing.assert_array_equal(result, [python_random(x, y, 9) for x, y in points])
    assert result.min() >= 0 and result.max() < 1


def test_the_largest_and_smallest_numbers(on_gpu):
    bits = np.array([0, 255, 256, 2**32 - 1], np.uint32)
    result = on_gpu("noise/hash.glsl", "unit_from_bits(bits)", bits=bits)
    np.testing.assert_array_equal(result, [0, 0, 2.0**-24, 1 - 2.0**-24])


def test_signed_and_paired_numbers(on_gpu):
    points = np.stack([X, Y], axis=1)[:2000]
    single = on_gpu("noise/hash.glsl", "random(point, seed)", point=points, seed=np.uint32(1))
    signed = on_gpu("noise/hash.glsl", "random_signed(point, seed)", point=points, seed=np.uint32(1))
    pair = on_gpu("noise/hash.glsl", "random_pair(point, seed)", point=points, seed=np.uint32(1))
    np.testing.assert_array_equal(signed, 2 * single.astype(np.float64) - 1)
    np.testing.assert_array_equal(pair[:, 0], single)
    assert abs(np.corrcoef(pair.T)[0, 1]) < 4 / np.sqrt(len(points))


@pytest.fixture
def field(on_gpu):
    """Give random numbers on a square, float64, by seed."""

    def make(seed):
        points = np.stack([X, Y], axis=1)
        result = on_gpu("noise/hash.glsl", "random(point, seed)", point=points, seed=np.uint32(seed))
        return result.astype(np.float64).reshape(SIDE, SIDE)

    return make


@pytest.mark.parametrize("seed", [0, 7, 9999])
def test_numbers_are_even(field, seed):
    values = field(seed)
    spread = 1 / SIDE  # one standard error of a mean of SIDE² numbers, times their deviation
    assert abs(values.mean() - 1 / 2) < 4 * spread / np.sqrt(12)
    assert abs(values.var() - 1 / 12) < 4 * spread / np.sqrt(180)
    counts = np.histogram(values, 64, (0, 1))[0]
    chi = ((counts - SIDE**2 / 64) ** 2 / (SIDE**2 / 64)).sum()
    assert 63 - 4 * np.sqrt(126) < chi < 63 + 5 * np.sqrt(126)


@pytest.mark.parametrize("seed", [0, 7, 9999])
def test_neighbours_know_nothing_of_each_other(field, seed):
    values = field(seed) - 0.5
    power = np.abs(np.fft.fft2(values)) ** 2
    correlation = np.fft.ifft2(power).real / power.mean()
    correlation[0, 0] = 0
    assert (
        np.abs([correlation[0, 1], correlation[1, 0], correlation[1, 1], correlation[1, -1]]).max() < 4 / SIDE
    )
    assert np.abs(correlation).max() < 6 / SIDE


def test_seeds_know_nothing_of_each_other(field):
    terrains = np.stack([field(s).ravel() for s in (0, 1, 2, 3, 1000)])
    correlations = np.corrcoef(terrains)[np.triu_indices(5, 1)]
    assert np.abs(correlations).max() < 4 / SIDE


# ── keys of terrains made by halving ─────────────────────────────────────────


@pytest.mark.parametrize("side", [1, 2, 64, 1024, 32768])
def test_a_point_s_place_on_the_finest_lattice(on_gpu, side):
    points = RNG.integers(0, side + 1, (100, 2)).astype(np.int32)
    result = on_gpu("noise/finest.glsl", "finest_point(p, side)", p=points, side=np.int32(side))
    np.testing.assert_array_equal(result, points * (32768 // side))


@pytest.mark.parametrize("shift", [0, 5, 10])
def test_points_far_apart_have_numbers_as_good_as_neighbours(on_gpu, shift):
    """On a coarse lattice the lower bits of every key are 0."""
    points = (np.stack([X % 64, Y % 64, X // 64 + 4 * (Y // 64)], axis=1)).astype(np.int64)
    values = on_gpu(
        "noise/hash.glsl",
        f"random(p.xy * {1 << shift}, uint(p.z) + 0xfaac44f9u)",
        p=points.astype(np.int32),
    ).astype(np.float64)
    # Sixteen lattices of 64 x 64 points, a seed each.
    values = values[np.lexsort(points.T)].reshape(16, 64, 64) - 0.5
    assert abs(values.mean()) < 4 / np.sqrt(12 * values.size)
    assert abs((values**2).mean() - 1 / 12) < 4 / np.sqrt(180 * values.size)
    for a, b in (
        (values[:, 1:], values[:, :-1]),
        (values[:, :, 1:], values[:, :, :-1]),
        (values[:, 1:, 1:], values[:, :-1, :-1]),
        (values[1:], values[:-1]),
    ):
        assert abs(np.corrcoef(a.ravel(), b.ravel())[0, 1]) < 4 / np.sqrt(a.size)

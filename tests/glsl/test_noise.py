"""Random numbers and value noise: Python's whole numbers, the statistics they must have, and periods."""

import numpy as np
import pytest

from ..truth.noise import assert_even, assert_white, fade, pcg3d, python_random, salt

RNG = np.random.default_rng(5)
HASH = "noise/hash.glsl"
SIDE = 256
Y, X = (a.ravel() for a in np.mgrid[0:SIDE, 0:SIDE])
SEEDS = pytest.mark.parametrize("seed", [0, 7, 9999])


def test_the_hash_is_pcg3d_and_its_values_are_pinned(on_gpu):
    keys = RNG.integers(0, 2**32, (400, 3), dtype=np.uint32)
    keys[:4] = [[0, 0, 0], [1, 0, 0], [1, 2, 3], [2**32 - 1] * 3]
    result = on_gpu(HASH, "hash3(key)", key=keys)
    np.testing.assert_array_equal(result, np.stack(pcg3d(*keys.T), axis=1))
    assert result[0].tolist() == [2611992518, 2833812075, 1058359340]


def test_a_number_is_the_upper_24_bits(on_gpu):
    points = RNG.integers(-(2**31), 2**31, (400, 2))
    result = on_gpu(HASH, "random(point, seed)", point=points, seed=np.uint32(9))
    np.testing.assert_array_equal(result, python_random(*points.T, 9))
    bits = np.array([0, 255, 256, 2**32 - 1], np.uint32)
    np.testing.assert_array_equal(on_gpu(HASH, "unit_from_bits(bits)", bits=bits), [0, 0, 2**-24, 1 - 2**-24])


def test_signed_and_paired_numbers(on_gpu):
    given = {"point": np.stack([X, Y], axis=1)[:2000], "seed": np.uint32(1)}
    single, signed, pair = (
        on_gpu(HASH, f"random{name}(point, seed)", **given) for name in ("", "_signed", "_pair")
    )
    np.testing.assert_array_equal(signed, 2 * single.astype(np.float64) - 1)
    np.testing.assert_array_equal(pair, np.stack([single, python_random(*given["point"].T, 1, 1)], axis=1))
    assert abs(np.corrcoef(pair.T)[0, 1]) < 4 / np.sqrt(2000)


@pytest.fixture
def field(on_gpu):
    """Give random numbers on a square, float64, by seed."""

    def make(seed):
        points = np.stack([X, Y], axis=1)
        result = on_gpu(HASH, "random(point, seed)", point=points, seed=np.uint32(seed))
        return result.astype(np.float64).reshape(SIDE, SIDE)

    return make


@SEEDS
def test_numbers_are_even_and_know_nothing_of_each_other(field, seed):
    assert_even(field(seed))
    assert_white(field(seed))


def test_seeds_know_nothing_of_each_other(field):
    terrains = np.stack([field(s).ravel() for s in (0, 1, 2, 3, 1000)])
    assert np.abs(np.corrcoef(terrains)[np.triu_indices(5, 1)]).max() < 4 / SIDE


@pytest.mark.parametrize("side", [1, 2, 64, 1024, 32768])
def test_a_point_s_place_on_the_finest_lattice(on_gpu, side):
    points = RNG.integers(0, side + 1, (100, 2)).astype(np.int32)
    result = on_gpu("noise/finest.glsl", "finest_point(p, side)", p=points, side=np.int32(side))
    np.testing.assert_array_equal(result, points * (32768 // side))


@pytest.mark.parametrize("shift", [0, 5, 10])
def test_points_far_apart_have_numbers_as_good_as_neighbours(on_gpu, shift):
    """On a coarse lattice the lower bits of every key are 0."""
    points = (np.stack([X % 64, Y % 64, X // 64 + 4 * (Y // 64)], axis=1)).astype(np.int32)
    call = f"random(p.xy * {1 << shift}, uint(p.z) + 0xfaac44f9u)"
    values = on_gpu(HASH, call, p=points).astype(np.float64)
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


# ── white noise ──────────────────────────────────────────────────────────────


@pytest.mark.parametrize("size", [(33, 33), (40, 17), (1, 1), (2, 2)], ids=str)
def test_each_height_is_the_hash_of_its_place(engine, single, size):
    y, x = np.mgrid[0 : size[1], 0 : size[0]]
    expected = python_random(x, y, 11 + salt("generation/white_noise"))
    result = engine.read(single("generation/white_noise", size, seed=11), "terrain")
    np.testing.assert_array_equal(result, expected)


@SEEDS
def test_salted_heights_are_even_and_know_nothing_of_each_other(any_engine, single, seed):
    terrain = any_engine.read(single("generation/white_noise", 512, seed=seed), "terrain").astype(float)
    assert_even(terrain)
    assert_white(terrain)


# ── value noise: interpolation of random numbers ─────────────────────────────

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


def passage_matrix(texels, cells, factors):
    """Return the matrix that makes heights at texels of those at nodes, along one axis."""
    node, share = at_nodes(texels, cells)
    bent = np.polynomial.polynomial.polyval(share, factors)
    matrix = np.zeros((texels, cells + 1))
    matrix[np.arange(texels), node] = 1 - bent
    matrix[np.arange(texels), node + 1] += bent
    return matrix


def interpolated(size, cells, factors, seed):
    """Return random numbers at nodes, interpolated."""
    nodes = python_random(*np.meshgrid(np.arange(cells + 1), np.arange(cells + 1)), seed)
    return passage_matrix(size[1], cells, factors) @ nodes @ passage_matrix(size[0], cells, factors).T


@pytest.mark.parametrize(
    ("size", "roughness", "seed"), [((33, 33), 0.5, 7), ((257, 257), 0.3, 7), ((65, 40), 0.7, 4711)], ids=str
)
def test_the_first_lesson_s_heights_are_octaves_of_value_noise(any_engine, single, size, roughness, seed):
    """A place of up to 64 cells is off by 64 * 2^-24, an octave by 3 times that, and by its weight less."""
    expected, bound = np.zeros(size[::-1]), 0.0
    for k in range(5):
        cells, weight = 4 * 2**k, 0.5 * roughness**k
        expected += weight * interpolated(size, cells, PASSAGES["cubic"][0], seed)
        bound += weight * (3 * cells + 4) * 2.0**-24
    sketch = single("generation/first_height", size, roughness=roughness, seed=seed)
    heights = any_engine.read(sketch, "terrain")
    assert np.abs(heights - expected).max() <= bound
    if roughness <= 0.5:
        assert heights.min() >= 0 and heights.max() <= 1


@pytest.mark.parametrize("passage", PASSAGES)
def test_heights_are_random_numbers_interpolated(any_engine, single, passage):
    """A share is off by a place's rounding, a height by as much times the steepest, along both axes."""
    cells, seed, size = 13, 4, (97, 64)
    factors, steepest = PASSAGES[passage]
    expected = interpolated(size, cells, factors, seed + salt("lessons/value_noise"))
    bound = (2 * steepest * 2 * cells + 40) * 2.0**-24
    sketch = single("generation/value_noise", size, passage=passage, cells=cells, seed=seed)
    assert np.abs(any_engine.read(sketch, "terrain").astype(float) - expected).max() <= bound


@pytest.mark.parametrize("passage", PASSAGES)
def test_the_curve_and_its_derivative(any_engine, single, passage):
    """The derivative is that of a polynomial by its factors, which share nothing with the kernel's text."""
    cells, seed, texels = 7, 3, 1281
    factors, steepest = PASSAGES[passage]
    sketch = single("generation/value_noise/curve", (texels, 2), passage=passage, cells=cells, seed=seed)
    result = any_engine.read(sketch, "terrain").astype(float)
    key = seed + salt("lessons/value_noise_curve")
    numbers = 2 * python_random(np.arange(cells + 1), np.zeros(cells + 1, int), key) - 1
    node, share = at_nodes(texels, cells)
    step = numbers[node + 1] - numbers[node]
    polynomial = np.polynomial.Polynomial(factors)
    bound = (4 * 6 * cells + 100) * 2.0**-24
    assert np.abs(result[0] - (numbers[node] + step * polynomial(share))).max() <= 2 * steepest * bound
    expected = 0.5 * step * polynomial.deriv()(share)
    inside = (share > 1e-4) & (share < 1 - 1e-4)  # which side of a node a texel on it takes is rounding
    assert np.abs(result[1] - expected)[inside].max() <= 6 * bound
    assert np.isclose(polynomial.deriv()(0.5), steepest)


# ── periodic noise ───────────────────────────────────────────────────────────

PERIODIC = "noise/periodic.glsl"
PERIOD = (5, 3)
SEED = 11
TILE = f"ivec2{PERIOD}, {SEED}u"


def number(x, y, seed=SEED):
    """Return two random numbers of lattice points, which are brought into the tile."""
    x, y = np.mod(x, PERIOD[0]), np.mod(y, PERIOD[1])
    return np.stack([python_random(x, y, seed, part) for part in (0, 1)], axis=-1)


@pytest.fixture
def places():
    # Sixty-fourths: exact in float32, so that a copy one period away has the same place in its cell.
    return RNG.integers(-1000, 1000, (400, 2)) / 64


def blend(array, corner):
    low = np.floor(array).astype(int)
    part = array - low
    weight = fade(part)
    total = 0.0
    for i in (0, 1):
        for j in (0, 1):
            share = np.where(i, weight[:, 0], 1 - weight[:, 0]) * np.where(j, weight[:, 1], 1 - weight[:, 1])
            total = total + share * corner(low[:, 0] + i, low[:, 1] + j, part - (i, j))
    return total


@pytest.mark.parametrize(
    ("name", "corner", "bound"),
    [
        ("value_noise", lambda x, y, _: number(x, y)[:, 0], 2e-6),
        ("gradient_noise", lambda x, y, d: ((number(x, y) * 2 - 1) * d).sum(axis=1), 3e-6),
    ],
)
def test_periodic_noise_interpolates_four_lattice_corners(on_gpu, places, name, corner, bound):
    result = on_gpu(PERIODIC, f"{name}_periodic(p, {TILE})", p=places)
    np.testing.assert_allclose(result, blend(places, corner), atol=bound)


def test_periodic_cells_find_two_nearest_points_with_wraparound(on_gpu, places):
    result = on_gpu(PERIODIC, f"cells_periodic(p, {TILE})", p=places)
    x, y = np.meshgrid(np.arange(-20, 21), np.arange(-20, 21))
    cells = np.stack([x.ravel(), y.ravel()], axis=1)
    far = np.linalg.norm(places[:, None] - (cells + number(*cells.T))[None], axis=2)
    order = np.argsort(far, axis=1)[:, :2]
    np.testing.assert_allclose(result[:, :2], np.take_along_axis(far, order, axis=1), atol=1e-5)
    np.testing.assert_allclose(result[:, 2], number(*cells[order[:, 0]].T, SEED + 1)[:, 0], atol=1e-6)


@pytest.mark.parametrize("name", ["value_noise", "gradient_noise", "gradient_fbm", "cells"])
@pytest.mark.parametrize("away", [(5, 0), (0, 3), (-5, 6)])
def test_a_copy_one_period_away_is_the_same(on_gpu, places, name, away):
    octaves = "4, 0.5, " if "fbm" in name else ""
    call = f"{name}_periodic(p, ivec2{PERIOD}, {octaves}{SEED}u){'.xyz' if name == 'cells' else ''}"
    here, there = on_gpu(PERIODIC, call, p=places), on_gpu(PERIODIC, call, p=places + away)
    # Distances are differences of larger numbers there.
    np.testing.assert_allclose(here, there, atol=1e-5 if name == "cells" else 0)


def test_gradient_noise_is_zero_on_lattice_and_within_one(on_gpu):
    x, y = np.meshgrid(np.arange(-3.0, 8.0), np.arange(-3.0, 8.0))
    lattice = np.stack([x.ravel(), y.ravel()], axis=1)
    assert not on_gpu(PERIODIC, "gradient_noise_periodic(p, ivec2(16), 2u)", p=lattice).any()
    dense = np.random.default_rng(1).uniform(0, 64, (20_000, 2))
    values = on_gpu(PERIODIC, "gradient_noise_periodic(p, ivec2(64), 2u)", p=dense).astype(float)
    assert np.abs(values).max() <= 1 and abs(values.mean()) < 0.02 and values.std() > 0.15


def test_wrapping_agrees_with_the_remainder_of_mathematics(on_gpu):
    points = RNG.integers(-50, 50, (200, 2)).astype(np.int32)
    result = on_gpu(PERIODIC, "lattice_wrapped(p, ivec2(7, 4))", p=points)
    np.testing.assert_array_equal(result, np.mod(points, (7, 4)))

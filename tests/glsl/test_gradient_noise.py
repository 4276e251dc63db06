"""Gradient noise and what is made of it, against noise made corner by corner in float64."""

from itertools import pairwise, product

import numpy as np
import pytest

from ..truth.noise import (
    NOISE,
    SHIFT,
    WHOLE,
    bits,
    fade,
    gradient,
    lattice_seed,
    perlin,
    places,
    salt,
    signed,
    sum_of_octaves,
)
from .conftest import BOTH_TEXTS

RNG = np.random.default_rng(3)
SHAPES = ("plain", "ridged", "billow", "warped")
BASES = ("Perlin", "simplex")
SUM, DERIVATIVES = "generation/gradient_noise/sum", "generation/gradient_noise/derivatives"


# ── the lattice ──────────────────────────────────────────────────────────────


def test_the_lattice_s_bits_are_python_s(on_gpu):
    points = RNG.integers(-(2**31), 2**31, (500, 2)).astype(np.int32)
    points[:4] = [[0, 0], [-1, -1], [2**31 - 1, 0], [0, -(2**31)]]
    corner = "lattice_columns(p.x, s).{} * lattice_rows(p.y, s).{}"
    for seed in (0, 7, 2**32 - 1):
        for (i, x), (j, y) in product(enumerate("xy"), repeat=2):
            result = on_gpu("noise/lattice.glsl", corner.format(x, y), p=points, s=np.uint32(seed))
            wide = points.astype(np.int64)
            np.testing.assert_array_equal(result, bits(wide[:, 0] + i, wide[:, 1] + j, seed))


def test_seeds_of_octaves_are_python_s_and_differ(on_gpu):
    seeds, octaves = (a.ravel() for a in np.mgrid[0:2000, 0:17])
    result = on_gpu("noise/lattice.glsl", "lattice_seed(s, k)", s=seeds.astype(np.uint32), k=octaves)
    np.testing.assert_array_equal(result, lattice_seed(seeds, octaves))
    assert len(np.unique(result)) == result.size


def test_no_two_seeds_share_a_part_of_the_lattice():
    """A seed moves columns by n and rows by m where n a = m b; both are never small."""
    n = np.arange(1, 29_000, dtype=np.uint64)
    m = n * np.uint64(0x9E3779B1) % WHOLE * np.uint64(pow(0x85EBCA77, -1, WHOLE)) % WHOLE
    assert np.minimum(m, WHOLE - m).min() > 29_000


SIDE = 256


def field(seed, side=SIDE):
    """Return the turns of a square of gradients, in radians."""
    along = np.arange(side) - 100
    return bits(along[None], along[:, None], seed).astype(float) / WHOLE * 2 * np.pi


@pytest.mark.parametrize("seed", [0, 7, 9999 * 0x2545F491])
def test_random_bits_are_uniform_and_uncorrelated(seed):
    turns = field(seed)
    counts = np.histogram(turns, 64, (0, 2 * np.pi))[0]
    chi = ((counts - SIDE**2 / 64) ** 2 / (SIDE**2 / 64)).sum()
    assert 63 - 4 * np.sqrt(126) < chi < 63 + 5 * np.sqrt(126)
    for of in (np.cos, np.sin, lambda t: np.cos(2 * t), lambda t: np.cos(4 * t)):
        power = np.abs(np.fft.fft2(of(turns))) ** 2
        correlation = np.fft.ifft2(power).real / power.mean()
        correlation[0, 0] = 0
        nearest = [correlation[0, 1], correlation[1, 0], correlation[1, 1], correlation[1, -1]]
        assert np.abs(nearest).max() < 4 / SIDE
        assert np.abs(correlation).max() < 6 / SIDE


def test_seeds_and_octaves_know_nothing_of_each_other():
    which = [lattice_seed(seed, k) for seed in (0, 1, 2, 3, 100, 9999) for k in range(4)]
    for of in (np.cos, np.sin):
        fields = np.stack([of(field(w, 128)).ravel() for w in which])
        assert np.abs(np.corrcoef(fields)[np.triu_indices(len(which), 1)]).max() < 5 / 128


def test_gradients_are_unit_vectors_in_eight_even_directions(on_gpu):
    numbers = RNG.integers(0, WHOLE, 4000, np.uint64).astype(np.uint32)
    result = on_gpu("noise/gradient.glsl", "gradient_of(b)", b=numbers).astype(float)
    np.testing.assert_allclose(result, np.transpose(gradient(numbers.astype(np.uint64))), atol=1e-7)
    degrees = np.degrees(np.arctan2(result[:, 1], result[:, 0])) % 360
    eighths, counts = np.unique(np.round((degrees - 22.5) / 45, 4), return_counts=True)
    np.testing.assert_array_equal(eighths, np.arange(8))
    assert np.abs(counts - 500).max() < 4 * np.sqrt(500)


# ── the noise ────────────────────────────────────────────────────────────────

CALL = {
    "Perlin": ("noise/gradient.glsl", "perlin(p, s)"),
    "simplex": ("noise/simplex.glsl", "simplex(p, s)"),
}


@pytest.mark.parametrize("basis", BASES)
def test_noise_is_the_sum_over_the_corners_and_its_slopes(on_gpu, basis):
    at = np.random.default_rng(8).uniform(-60, 60, (4000, 2)).astype(np.float32)
    result = on_gpu(*CALL[basis], p=at, s=np.uint32(5))
    x, y = at.astype(float).T
    of, step = NOISE[basis], 1e-5
    truth = of(x, y, 5)
    # Sixty cells from the origin, a skewed place is known to 2e-6 of a cell.
    np.testing.assert_allclose(result[:, 0], truth, atol=3e-5 if basis == "simplex" else 2e-6)
    assert truth.std() > 0.2 and abs(truth.mean()) < 0.03
    east = (of(x + step, y, 5) - of(x - step, y, 5)) / (2 * step)
    north = (of(x, y + step, 5) - of(x, y - step, 5)) / (2 * step)
    np.testing.assert_allclose(result[:, 1:], np.stack([east, north], axis=1), atol=3e-4)
    assert min(east.std(), north.std()) > 0.8


@pytest.mark.parametrize("basis", BASES)
def test_noise_reaches_far_and_never_past_1(basis):
    """The most that any gradients can give, from one place to the next of a fine grid of a cell."""
    directions = np.radians(22.5 + 45 * np.arange(8))
    x, y = (a.ravel() for a in np.mgrid[0:1:81j, 0:1:81j])
    back = (3 - np.sqrt(3)) / 6
    total = np.zeros(x.size)
    for i, j in product(range(-1, 3), repeat=2):
        dx, dy = x - i, y - j
        if basis == "simplex":
            dx, dy = dx - (x + y - i - j) * back, dy - (x + y - i - j) * back
            weight = 100 * np.maximum(0.5 - dx**2 - dy**2, 0) ** 4
        else:
            weight = 1.513 * fade(np.clip(1 - abs(dx), 0, 1)) * fade(np.clip(1 - abs(dy), 0, 1))
        total += weight * (np.cos(directions) * dx[:, None] + np.sin(directions) * dy[:, None]).max(axis=1)
    assert 0.99 < total.max() < 1


def test_at_a_lattice_point_only_its_own_plane_is_there(on_gpu):
    """Noise 0, and the slope of one gradient; simplex noise is on triangles of side 1."""
    side = np.array([np.cos(np.radians(15)), -np.sin(np.radians(15))])  # 60 degrees from the diagonal
    skewed = [i * side + j * side[::-1] for i, j in RNG.integers(-30, 30, (200, 2))]
    for basis, points, off, steep in (
        ("Perlin", RNG.integers(-100, 100, (200, 2)), 0, 1.513),
        ("simplex", np.array(skewed), 3e-5, 100 * 0.5**4 * np.sqrt(2 / 3)),
    ):
        result = on_gpu(*CALL[basis], p=points.astype(np.float32), s=np.uint32(3))
        np.testing.assert_allclose(result[:, 0], 0, atol=off)
        np.testing.assert_allclose(np.hypot(*result[:, 1:].T), steep, rtol=1e-6 if off == 0 else 1e-4)


def test_the_fade_and_its_slope(on_gpu):
    """Level at both ends, symmetric about the middle; the slope is that of differences."""
    t = np.linspace(0, 1, 513, dtype=np.float32)
    for vector in (False, True):
        position = np.stack([t, t[::-1]], axis=1) if vector else t
        result, slope = (
            on_gpu("noise/fade.glsl", f"{name}(t)", t=position) for name in ("quintic", "quintic_slope")
        )
        np.testing.assert_allclose(result, fade(position), atol=1e-6)
        assert np.abs(slope[[0, -1]]).max() == 0 and np.abs(result[[0, -1]]).max() == 1
        middle = (slope[1:] + slope[:-1]) / 2
        np.testing.assert_allclose(np.abs(np.diff(result, axis=0)) * 512, middle, atol=2e-4)


# ── the terrain ──────────────────────────────────────────────────────────────


@BOTH_TEXTS
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("basis", BASES)
def test_it_is_the_sum_of_its_octaves(engine, single, basis, shape):
    values = {"basis": basis, "shape": shape, "octaves": 4, "lacunarity": 1.9, "gain": 0.6, "seed": 11}
    result = engine.read(single(SUM, (65, 40), (900.0, 500.0), frequency=3.0, **values), "terrain")
    x, y, texels = places((65, 40), (900.0, 500.0), 3.0)
    np.testing.assert_allclose(result, sum_of_octaves(x, y, texels=texels, **values), atol=1e-4)
    assert result.std() > 0.1


@BOTH_TEXTS
@pytest.mark.parametrize("frequency", [0.25, 1.0, 7.3, 32.0, 1024.0])
@pytest.mark.parametrize("octaves", [1, 2, 3, 16])
def test_every_frequency_even_above_the_size(engine, single, frequency, octaves):
    result = engine.read(single(SUM, frequency=frequency, octaves=octaves, gain=0.9), "terrain")
    x, y, texels = places((33, 33), (1000.0, 1000.0), frequency)
    truth = sum_of_octaves(x, y, texels=texels, octaves=octaves, gain=0.9)
    np.testing.assert_allclose(result, truth, atol=3e-5)
    assert result.std() > 0.02


@pytest.mark.parametrize("size", [(1, 1), (2, 2), (1, 9), (9, 1), (2, 300)], ids=str)
def test_tiny_terrains(engine, single, size):
    extent = (1000.0, 1000.0 * max(size[1] - 1, 1) / max(size[0] - 1, 1))
    x, y, texels = places(size, extent, 4.0)
    result = engine.read(single(SUM, size, extent), "terrain")
    np.testing.assert_allclose(result, sum_of_octaves(x, y, texels=texels), atol=2e-4)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("basis", BASES)
def test_derivatives_are_finite_differences(engine, single, basis, shape):
    values = {"basis": basis, "shape": shape, "octaves": 4, "gain": 0.5, "seed": 4}
    result = engine.read(single(DERIVATIVES, (65, 40), (900.0, 500.0), **values), "terrain")
    x, y, texels = places((65, 40), (900.0, 500.0), 4.0)
    step, scale = 1e-6, 4.0 / 900.0
    for axis, (ex, ey) in enumerate(((step, 0.0), (0.0, step))):
        high, low = (sum_of_octaves(x + way * ex, y + way * ey, texels=texels, **values) for way in (1, -1))
        slope = (high - low) / (2 * step) * scale
        # A difference across a crease is not the slope on either side of it.
        assert (np.abs(result[..., axis] - slope) < 2e-3 * np.abs(slope).max()).mean() > 0.995
        assert slope.std() > 1e-3


@pytest.mark.parametrize(
    "size, extent", [((257, 130), 1000.0), ((70, 193), [300.0, 900.0]), ((130, 130), [900.0, 300.0])], ids=str
)
def test_walking_the_columns_gives_the_kernel_s_terrain(both_texts, single, size, extent):
    """Polynomials along columns, against the kernel that works out each texel by itself."""
    for octaves, lacunarity, gain in product((0, 1, 2, 3, 16), (1.1, 2.0, 2.7), (0.5, 1.0)):
        values = {"octaves": octaves, "lacunarity": lacunarity, "gain": gain}
        sketch = single(SUM, size, extent, **values)
        first, other = (e.read(sketch, "terrain") for e in both_texts)
        assert octaves == 0 or (first != other).any(), "the same way was gone twice"
        np.testing.assert_allclose(other, first, atol=1e-4 if gain == 1.0 else 1e-5, err_msg=str(values))


# ── fractional Brownian motion ───────────────────────────────────────────────

CURVES = "generation/fbm/curve"
HURST = pytest.mark.parametrize("hurst", [0.2, 0.4, 0.6, 0.8])


@BOTH_TEXTS
@pytest.mark.parametrize(
    ("hurst", "frequency", "lacunarity", "octaves"), [(0.8, 2.0, 2.0, 16), (0.3, 3.0, 2.5, 4)]
)
def test_octaves_are_added(engine, single, hurst, frequency, lacunarity, octaves):
    """Places are off by a rounding, 2^-24 of them an octave; noise rises by less than 4 a cell."""
    size, extent, gain = (129, 65), (1000.0, 500.0), lacunarity**-hurst
    x, y, texels = places(size, extent, frequency)
    given = {"lacunarity": lacunarity, "octaves": octaves}
    expected = sum_of_octaves(x, y, texels=texels, gain=gain, name="generation/fbm", **given)
    shown = [k for k in range(octaves) if texels > lacunarity**k]
    bound = sum(gain**k * (4 * (k + 4) * frequency * lacunarity**k + 16) * 2.0**-24 for k in shown)
    sketch = single("generation/fbm/sum", size, extent, hurst=hurst, frequency=frequency, **given)
    assert np.abs(engine.read(sketch, "terrain") - expected).max() <= bound


def slope_of_bins(frequency, power, low, high):
    """Return how power falls with frequency: the line through means over even steps of its logarithm."""
    edges = np.geomspace(low, high, 17)
    means = [power[(frequency >= a) & (frequency < b)].mean() for a, b in pairwise(edges)]
    return np.polyfit(np.log(np.sqrt(edges[1:] * edges[:-1])), np.log(means), 1)[0]


@HURST
@pytest.mark.parametrize("seed", [7, 3])
def test_power_falls_as_fractional_brownian_motion_s(any_engine, single, hurst, seed):
    """Radial power spectrum f^-(2H + 2): 1024 texels a side, 8 octaves from frequency 4, a Hann window."""
    n = 1024
    terrain = any_engine.read(single("generation/fbm", n, hurst=hurst, seed=seed), "terrain").astype(float)
    window = np.hanning(n)
    power = np.abs(np.fft.fft2((terrain - terrain.mean()) * np.outer(window, window))) ** 2
    along = np.fft.fftfreq(n, 1 / n)
    slope = slope_of_bins(np.hypot(along[None], along[:, None]), power, 8, 256)
    assert abs(slope + 2 * hurst + 2) < 0.2


def test_it_has_eight_octaves_from_four_on(any_engine, single):
    said = single("generation/fbm", 257, octaves=8, frequency=4.0, lacunarity=2.0, hurst=0.8)
    usual = any_engine.read(single("generation/fbm", 257), "terrain")
    np.testing.assert_array_equal(usual, any_engine.read(said, "terrain"))


def curve(n, line, hurst, octaves, frequency, seed):
    """Return one row of octaves of noise along a line."""
    nodes = max(n - 1, 1)
    row, squares = np.zeros(n), 0.0
    for k in range(octaves):
        cells = min(frequency, nodes / 2) * 2**k
        weight = 2.0 ** (-hurst * k) * min(max(nodes / cells - 1, 0), 1)
        squares += weight**2
        position = np.arange(n) * cells / nodes + SHIFT
        cell = np.floor(position)
        t = position - cell
        which = lattice_seed(seed + salt(CURVES), k)
        low, high = (signed(bits(cell + i, line, which)) * (t - i) for i in (0, 1))
        row += weight * (low * (1 - fade(t)) + high * fade(t))
    return row / (0.140695 * np.sqrt(squares)) if squares else row


@pytest.mark.parametrize("size", [(65, 6), (40, 2), (1, 3), (2, 5)], ids=str)
def test_curves_are_octaves_of_noise_along_a_line(engine, single, size):
    exponents = (0.9, 0.5, 0.4, 0.1)
    for octaves in (0, 5):
        given = {"hurst": exponents, "hurst_last": 0.7, "octaves": octaves, "frequency": 3.0, "seed": 9}
        result = engine.read(single(CURVES, size, **given), "terrain")
        truth = [curve(size[0], r, (*exponents, 0.7, 0.7)[r], octaves, 3.0, 9) for r in range(size[1])]
        np.testing.assert_allclose(result, truth, atol=3e-5 if octaves else 0)


@HURST
def test_curves_have_the_spectrum_and_deviation_of_the_motion(any_engine, single, hurst):
    """Power spectrum f^-(2H + 1), the mean over 48 curves; heights t apart differ by t^H; deviation 1."""
    sketch = single(CURVES, (4096, 48), hurst=(hurst,) * 4, hurst_last=hurst, octaves=12)
    rows = any_engine.read(sketch, "terrain").astype(float)
    windowed = (rows - rows.mean(axis=1, keepdims=True)) * np.hanning(4096)
    power = (np.abs(np.fft.rfft(windowed)) ** 2).mean(axis=0)
    assert abs(slope_of_bins(np.arange(power.size), power, 8, 512) + 2 * hurst + 1) < 0.1
    assert abs(rows.std() - 1) < 0.06


# ── ridges and warping, the lesson's kernels ─────────────────────────────────

RIDGES, WARPING = "generation/gradient_noise/ridges", "generation/gradient_noise/warping"
SIZE, EXTENT, CELLS = (65, 33), (1000.0, 500.0), 3.0


@pytest.fixture
def read(any_engine, single):
    """Give a texture of one pass, float64."""

    def of(use, output="", size=SIZE, extent=EXTENT, **values):
        return any_engine.read(single(use, size, extent, **values), f"terrain{output}").astype(np.float64)

    return of


def octaves(x, y, count, gain, more=0, fold=lambda noise: noise):
    seeds = [lattice_seed(7 + more + salt("generation/gradient_noise"), k) for k in range(count)]
    return sum(gain**k * fold(perlin(x * 2**k + SHIFT, y * 2**k, seed)) for k, seed in enumerate(seeds))


@pytest.mark.parametrize(
    "fold, truth",
    [
        ("none", lambda noise: noise),
        ("valleys", lambda noise: np.maximum(noise, -noise)),
        ("ridges", lambda noise: np.minimum(1 - noise, 1 + noise)),
        ("sharp ridges", lambda noise: 1 - 2 * abs(noise) + noise**2),
    ],
)
def test_each_octave_is_folded_and_added(read, fold, truth):
    value = {"fold": fold, "weighed": False, "octaves": 3, "frequency": CELLS, "gain": 0.6}
    expected = octaves(*places(SIZE, EXTENT, CELLS)[:2], 3, 0.6, fold=truth)
    np.testing.assert_allclose(read(RIDGES, **value), expected, atol=2e-5)
    assert expected.std() > 0.1


@pytest.mark.parametrize(
    ("shape", "use", "same", "other", "bound"),
    [
        ("ridged", (RIDGES, ""), {}, {"weighed": False}, 1e-5),
        ("warped", (WARPING, ":height"), {"bends": 4, "warp": 0.7}, {"bends": 1}, 3e-5),
    ],
)
def test_the_lesson_s_kernels_are_the_technique_s_shapes(read, shape, use, same, other, bound):
    """Four octaves of 3 cells on 65 texels: the last one's cells are wider than two texels."""
    value = {"octaves": 4, "frequency": CELLS, "gain": 0.45, "seed": 3}
    technique = read(SUM, shape=shape, **value, **{k: v for k, v in same.items() if k == "warp"})
    np.testing.assert_allclose(read(*use, **value, **same), technique, atol=bound)
    assert abs(read(*use, **value, **(same | other)) - technique).max() > 0.05


@pytest.mark.parametrize("warp", [0.0, 0.3, 1.5])
def test_the_stretch_is_the_area_of_a_small_square_that_is_moved(read, warp):
    """By differences of the moved places, and its sign by the way that their corners run round."""
    result = read(WARPING, ":stretch", warp=warp, bends=2, gain=0.5, frequency=CELLS)
    x, y, _ = places(SIZE, EXTENT, CELLS)
    step = 1e-5

    def moved(x, y):
        by = (octaves(x, y, 2, 0.5, more) for more in (0x51ED270B, 0xA3DA4E16))
        return np.stack([at + warp * way for at, way in zip((x, y), by, strict=True)])

    east = moved(x + step, y) - moved(x - step, y)
    north = moved(x, y + step) - moved(x, y - step)
    area = (east[0] * north[1] - east[1] * north[0]) / (2 * step) ** 2
    np.testing.assert_allclose(result, area, atol=2e-4 * max(abs(area).max(), 1))
    if warp == 1.5:
        assert (area < 0).any(), "a strong warp folds the map"


def test_the_board_shows_where_places_go(read):
    value = {"squares": True, "frequency": 4.0, "size": (65, 65), "extent": (1000.0, 1000.0)}
    board = read(WARPING, ":height", warp=0.0, **value)
    np.testing.assert_array_equal(np.unique(board), [0, 1])
    y, x = np.mgrid[0:65, 0:65] // 4  # sixteen squares a side
    np.testing.assert_array_equal(board[:-1, :-1], ((x + y) % 2)[:-1, :-1])
    assert (read(WARPING, ":height", warp=0.5, **value) != board).mean() > 0.2

"""Gradient noise against noise made corner by corner in float64, from the same random bits."""

from itertools import product

import numpy as np
import pytest

from playground.engine.engine import Engine

from .drawing import salt

RNG = np.random.default_rng(3)
WHOLE = 2**32
SHIFT = 0.618034  # of every octave, in its own cells, to the east
SHAPES = ("plain", "ridged", "billow", "warped")
BASES = ("Perlin", "simplex")


# ── the truth ────────────────────────────────────────────────────────────────


def mixed(key):
    """Return one round of mixing, made odd: Python's remainder in place of overflow."""
    key = key % WHOLE
    key = (key ^ (key // 2**15)) * 0x7FEB352D % WHOLE
    return key - key % 2 + 1


def bits(x, y, seed):
    """Return a lattice point's random bits, uint64 below 2^32."""
    x, y = (np.asarray(a).astype(np.int64) % WHOLE for a in np.broadcast_arrays(x, y))
    columns = mixed(x.astype(np.uint64) * np.uint64(0x9E3779B1) + np.uint64(seed % WHOLE))
    rows = mixed(y.astype(np.uint64) * np.uint64(0x85EBCA77) + np.uint64(seed % WHOLE))
    return columns * rows % WHOLE


def gradient(number):
    """Return the unit vector of some bits: 22.5 or 67.5 degrees, in the quarter that two more bits say."""
    eighth = number // 2**29
    angle = np.radians(np.where(eighth % 2 == 1, 67.5, 22.5))
    return (
        np.where(eighth >= 4, -1, 1) * np.cos(angle),
        np.where(eighth // 2 % 2 == 1, -1, 1) * np.sin(angle),
    )


def fade(t):
    return 6 * t**5 - 15 * t**4 + 10 * t**3


def perlin(x, y, seed):
    """Return Perlin noise as a sum over four corners of weight times plane."""
    total = 0.0
    for i, j in product((0, 1), repeat=2):
        cx, cy = np.floor(x) + i, np.floor(y) + j
        gx, gy = gradient(bits(cx, cy, seed))
        dx, dy = x - cx, y - cy
        total = total + fade(1 - abs(dx)) * fade(1 - abs(dy)) * (gx * dx + gy * dy)
    return 1.513 * total


def simplex(x, y, seed):
    """Return simplex noise as a sum over all lattice points near enough, not three that are picked."""
    skew, back = (np.sqrt(3) - 1) / 2, (3 - np.sqrt(3)) / 6
    x, y = x * np.sqrt(2 / 3), y * np.sqrt(2 / 3)  # triangles of side 1
    near_x, near_y = np.floor(x + (x + y) * skew), np.floor(y + (x + y) * skew)
    total = 0.0
    for i, j in product(range(-1, 3), repeat=2):
        cx, cy = near_x + i, near_y + j
        dx, dy = x - (cx - (cx + cy) * back), y - (cy - (cx + cy) * back)
        gx, gy = gradient(bits(cx, cy, seed))
        total = total + np.maximum(0.5 - dx**2 - dy**2, 0) ** 4 * (gx * dx + gy * dy)
    return 100.0 * total


NOISE = {"Perlin": perlin, "simplex": simplex}


def terrain(
    x, y, *, basis="Perlin", shape="plain", octaves=6, lacunarity=2.0, gain=0.5, seed=7, warp=0.4, texels
):
    """Return the sum of octaves at places in cells of the first octave."""
    value = {"basis": basis, "lacunarity": lacunarity, "gain": gain, "octaves": octaves, "texels": texels}
    if shape == "warped":
        east, north = (terrain(x, y, seed=seed + more, **value) for more in (0x51ED270B, 0xA3DA4E16))
        return terrain(x + warp * east, y + warp * north, seed=seed, **value)
    total, before = np.zeros(np.broadcast(x, y).shape), None
    for k in range(octaves):
        frequency = lacunarity**k
        visible = min(max(texels / frequency - 1, 0), 1)
        which = (seed + salt("generation/gradient_noise")) * 0x2545F491 + k * 0xC2B2AE3D
        noise = NOISE[basis](x * frequency + SHIFT, y * frequency, which)
        if shape == "billow":
            noise = 2 * abs(noise) - 1
        elif shape == "ridged":
            noise = (1 - abs(noise)) ** 2
            noise = noise if before is None else noise * np.minimum(2 * before, 1)
            before = noise
        total = total + visible * gain**k * noise
    return total


def places(size, extent, frequency):
    """Return each texel's place in cells, and the texels to a cell."""
    spacing = np.array(extent, float) / np.maximum(np.array(size) - 1, 1)
    cells = min(frequency / extent[0], 0.5 / spacing.max())
    y, x = np.mgrid[0 : size[1], 0 : size[0]]
    return x * spacing[0] * cells, y * spacing[1] * cells, 1 / (cells * spacing.max())


@pytest.fixture
def sketch_of(make_sketch):
    def make(size=(33, 33), extent=1000.0, use="generation/gradient_noise/sum", **values):
        text = "".join(f"{k} = {v!r}\n" for k, v in values.items())
        return make_sketch(
            f'[[pass]]\nname = "terrain"\nuse = "{use}"\n[pass.set]\n{text}', size=list(size), extent=extent
        )

    return make


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
    np.testing.assert_array_equal(result, (seeds * 0x2545F491 + octaves * 0xC2B2AE3D) % WHOLE)
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
    which = [seed * 0x2545F491 + k * 0xC2B2AE3D for seed in (0, 1, 2, 3, 100, 9999) for k in range(4)]
    for of in (np.cos, np.sin):
        fields = np.stack([of(field(w, 128)).ravel() for w in which])
        correlations = np.corrcoef(fields)[np.triu_indices(len(which), 1)]
        assert np.abs(correlations).max() < 5 / 128


def test_gradients_are_unit_vectors_in_eight_even_directions(on_gpu):
    numbers = RNG.integers(0, WHOLE, 4000, np.uint64).astype(np.uint32)
    result = on_gpu("noise/gradient.glsl", "gradient_of(b)", b=numbers).astype(float)
    np.testing.assert_allclose(result, np.transpose(gradient(numbers.astype(np.uint64))), atol=1e-7)
    degrees = np.degrees(np.arctan2(result[:, 1], result[:, 0])) % 360
    eighths, counts = np.unique(np.round((degrees - 22.5) / 45, 4), return_counts=True)
    np.testing.assert_array_equal(eighths, np.arange(8))
    assert np.abs(counts - 500).max() < 4 * np.sqrt(500)
    np.testing.assert_allclose(np.hypot(*result.T), 1, atol=1e-7)


# ── the noise ────────────────────────────────────────────────────────────────

FILES = {"Perlin": "noise/gradient.glsl", "simplex": "noise/simplex.glsl"}
FADES = ("quintic", "quintic_slope")
CALL = {"Perlin": "perlin(p, s)", "simplex": "simplex(p, s)"}


@pytest.fixture(scope="module")
def some_places():
    return np.random.default_rng(8).uniform(-60, 60, (4000, 2)).astype(np.float32)


@pytest.mark.parametrize("basis", BASES)
def test_noise_is_the_sum_over_the_corners(on_gpu, some_places, basis):
    result = on_gpu(FILES[basis], CALL[basis], p=some_places, s=np.uint32(5))
    x, y = some_places.astype(float).T
    truth = NOISE[basis](x, y, 5)
    # Sixty cells from the origin, a skewed place is known to 2e-6 of a cell.
    np.testing.assert_allclose(result[:, 0], truth, atol=3e-5 if basis == "simplex" else 2e-6)
    assert truth.std() > 0.2 and abs(truth.mean()) < 0.03


@pytest.mark.parametrize("basis", BASES)
def test_slopes_are_finite_differences(on_gpu, some_places, basis):
    result = on_gpu(FILES[basis], CALL[basis], p=some_places, s=np.uint32(5))
    x, y = some_places.astype(float).T
    step = 1e-5
    of = NOISE[basis]
    east = (of(x + step, y, 5) - of(x - step, y, 5)) / (2 * step)
    north = (of(x, y + step, 5) - of(x, y - step, 5)) / (2 * step)
    np.testing.assert_allclose(result[:, 1], east, atol=3e-4)
    np.testing.assert_allclose(result[:, 2], north, atol=3e-4)
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


def test_simplex_noise_is_on_triangles_of_side_1(on_gpu):
    """At a lattice point only its own plane is there: noise 0, and the slope of one gradient."""
    side = np.array([np.cos(np.radians(15)), -np.sin(np.radians(15))])  # 60 degrees from the diagonal
    points = [i * side + j * side[::-1] for i, j in RNG.integers(-30, 30, (200, 2))]
    result = on_gpu("noise/simplex.glsl", "simplex(p, 3u)", p=np.array(points, np.float32))
    np.testing.assert_allclose(result[:, 0], 0, atol=3e-5)
    np.testing.assert_allclose(np.hypot(result[:, 1], result[:, 2]), 100 * 0.5**4 * np.sqrt(2 / 3), rtol=1e-4)


def test_the_fade_and_its_slope(on_gpu):
    """Level at both ends, symmetric about the middle; the slope is that of differences."""
    t = np.linspace(0, 1, 513, dtype=np.float32)
    for vector in (False, True):
        position = np.stack([t, t[::-1]], axis=1) if vector else t
        fade, slope = (on_gpu("noise/fade.glsl", f"{name}(t)", t=position) for name in FADES)
        np.testing.assert_allclose(fade + fade[::-1], 1, atol=1e-6)
        assert np.abs(slope[[0, -1]]).max() == 0 and np.abs(fade[[0, -1]]).max() == 1
        middle = (slope[1:] + slope[:-1]) / 2
        np.testing.assert_allclose(np.abs(np.diff(fade, axis=0)) * 512, middle, atol=2e-4)


def test_perlin_noise_is_zero_where_the_lattice_is(on_gpu):
    points = RNG.integers(-100, 100, (200, 2)).astype(np.float32)
    result = on_gpu("noise/gradient.glsl", "perlin(p, 3u)", p=points)
    np.testing.assert_array_equal(result[:, 0], 0)
    np.testing.assert_allclose(np.hypot(result[:, 1], result[:, 2]), 1.513, rtol=1e-6)


def test_no_direction_is_drawn(any_engine, sketch_of):
    """Slopes are as steep along the axes as along the diagonals, and so are the steepest."""
    along = {0.0: [], 45.0: [], 90.0: [], 135.0: []}
    for seed in range(12):
        sketch = sketch_of((129, 129), use="generation/gradient_noise/derivatives", seed=seed, octaves=3)
        east, north = np.moveaxis(any_engine.read(sketch, "terrain").astype(float), -1, 0)
        for degrees, result in along.items():
            result.append(east * np.cos(np.radians(degrees)) + north * np.sin(np.radians(degrees)))
    for power, bound in ((2, 0.04), (4, 0.12)):
        moments = np.array([(np.array(v) ** power).mean() for v in along.values()])
        assert np.abs(moments / moments.mean() - 1).max() < bound


# ── the terrain ─────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("basis", BASES)
def test_it_is_the_sum_of_its_octaves(engine, sketch_of, basis, shape):
    values = {"basis": basis, "shape": shape, "octaves": 4, "lacunarity": 1.9, "gain": 0.6, "seed": 11}
    result = engine.read(sketch_of((65, 40), [900.0, 500.0], frequency=3.0, **values), "terrain")
    x, y, texels = places((65, 40), (900.0, 500.0), 3.0)
    np.testing.assert_allclose(result, terrain(x, y, texels=texels, **values), atol=1e-4)
    assert result.std() > 0.1


@pytest.mark.parametrize("frequency", [0.25, 1.0, 7.3, 32.0, 1024.0])
@pytest.mark.parametrize("octaves", [1, 2, 3, 16])
def test_every_frequency_even_above_the_size(engine, sketch_of, frequency, octaves):
    result = engine.read(sketch_of(frequency=frequency, octaves=octaves, gain=0.9), "terrain")
    x, y, texels = places((33, 33), (1000.0, 1000.0), frequency)
    np.testing.assert_allclose(result, terrain(x, y, texels=texels, octaves=octaves, gain=0.9), atol=3e-5)
    assert result.std() > 0.02


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("basis", BASES)
def test_derivatives_are_finite_differences(engine, sketch_of, basis, shape):
    values = {"basis": basis, "shape": shape, "octaves": 4, "gain": 0.5, "seed": 4}
    sketch = sketch_of((65, 40), [900.0, 500.0], use="generation/gradient_noise/derivatives", **values)
    result = engine.read(sketch, "terrain")
    x, y, texels = places((65, 40), (900.0, 500.0), 4.0)
    step, scale = 1e-6, 4.0 / 900.0
    for axis, (ex, ey) in enumerate(((step, 0.0), (0.0, step))):
        high, low = (terrain(x + way * ex, y + way * ey, texels=texels, **values) for way in (1, -1))
        slope = (high - low) / (2 * step) * scale
        # A difference across a crease is not the slope on either side of it.
        assert (np.abs(result[..., axis] - slope) < 2e-3 * np.abs(slope).max()).mean() > 0.995
        assert slope.std() > 1e-3


def test_derivatives_are_what_texels_of_the_sum_differ_by(any_engine, sketch_of):
    size, metres = 1025, 1000.0 / 1024
    heights = any_engine.read(sketch_of((size, size), octaves=3), "terrain").astype(float)
    sketch = sketch_of((size, size), use="generation/gradient_noise/derivatives", octaves=3)
    slopes = any_engine.read(sketch, "terrain").astype(float)
    north, east = np.gradient(heights, metres)
    inner = np.s_[1:-1, 1:-1]
    for result, truth in ((slopes[..., 0], east), (slopes[..., 1], north)):
        assert np.abs(result - truth)[inner].max() < 0.01 * np.abs(truth).max()


@pytest.mark.parametrize(
    "size, extent", [((257, 130), 1000.0), ((70, 193), [300.0, 900.0]), ((130, 130), [900.0, 300.0])], ids=str
)
def test_walking_the_columns_gives_the_kernel_s_terrain(ctx, sketch_of, size, extent):
    """Polynomials along columns, against the kernel that works out each texel by itself."""
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    with Engine(ctx, driver="fragment") as by_texels, Engine(ctx) as by_columns:
        for octaves, lacunarity, gain in product((0, 1, 2, 3, 16), (1.1, 2.0, 2.7), (0.5, 1.0)):
            values = {"octaves": octaves, "lacunarity": lacunarity, "gain": gain}
            sketch = sketch_of(size, extent, **values)
            first, other = (e.read(sketch, "terrain") for e in (by_texels, by_columns))
            assert octaves == 0 or (first != other).any(), "the same way was gone twice"
            np.testing.assert_allclose(other, first, atol=1e-4 if gain == 1.0 else 1e-5, err_msg=str(values))


def test_the_same_terrain_at_another_size_looks_the_same(engine, sketch_of):
    small, large = (engine.read(sketch_of((n, n), octaves=3), "terrain") for n in (65, 129))
    np.testing.assert_allclose(large[::2, ::2], small, atol=1e-5)


def test_a_smaller_size_lacks_detail_and_gains_no_noise(any_engine, sketch_of):
    """At 65 texels, five of eight octaves are visible: the others are smoothed away, not sampled."""
    large = any_engine.read(sketch_of((513, 513), octaves=8, gain=0.7), "terrain").astype(float)
    small = any_engine.read(sketch_of((65, 65), octaves=8, gain=0.7), "terrain").astype(float)
    sampled = large[::8, ::8]
    assert np.corrcoef(small.ravel(), sampled.ravel())[0, 1] > 0.97

    def finest(values):
        power = np.abs(np.fft.fft2(values[:-1, :-1] * np.outer(np.hanning(64), np.hanning(64)))) ** 2
        fy, fx = np.meshgrid(np.fft.fftfreq(64, 1 / 64), np.fft.fftfreq(64, 1 / 64), indexing="ij")
        return power[np.hypot(fx, fy) > 24].mean()

    assert finest(small) < 0.5 * finest(sampled)


def test_octaves_too_fine_for_the_texels_add_nothing(engine, sketch_of):
    terrains = [engine.read(sketch_of((33, 33), octaves=n, gain=1.0), "terrain") for n in (3, 4, 16)]
    np.testing.assert_array_equal(terrains[0], terrains[1])
    np.testing.assert_array_equal(terrains[0], terrains[2])


def test_hills_stay_round_on_terrain_that_is_not_square(engine, sketch_of):
    square = engine.read(sketch_of((65, 65), 1000.0), "terrain")
    half = engine.read(sketch_of((65, 33), [1000.0, 500.0]), "terrain")
    np.testing.assert_allclose(half, square[:33], atol=2e-6)
    # Texels twice as far apart to the north show the same hills too.
    coarse = engine.read(sketch_of((65, 33), [1000.0, 1000.0], octaves=2), "terrain")
    fine = engine.read(sketch_of((65, 65), [1000.0, 1000.0], octaves=2), "terrain")
    np.testing.assert_allclose(coarse, fine[::2], atol=2e-6)


def test_no_octaves_are_flat_terrain(engine, sketch_of):
    for basis, shape in product(BASES, SHAPES):
        sketch = sketch_of(octaves=0, basis=basis, shape=shape)
        np.testing.assert_array_equal(engine.read(sketch, "terrain"), 0)
    sketch = sketch_of(octaves=0, use="generation/gradient_noise")
    np.testing.assert_array_equal(engine.read(sketch, "terrain"), 0)


@pytest.mark.parametrize("size", [(1, 1), (2, 2), (1, 9), (9, 1), (2, 300)], ids=str)
def test_tiny_terrains_are_numbers(engine, sketch_of, size):
    extent = (1000.0, 1000.0 * max(size[1] - 1, 1) / max(size[0] - 1, 1))
    result = engine.read(sketch_of(size, list(extent)), "terrain")
    x, y, texels = places(size, extent, 4.0)
    np.testing.assert_allclose(result, terrain(x, y, texels=texels), atol=2e-4)


def test_it_is_normalised_by_default_and_not_where_that_is_off(engine, sketch_of):
    use = "generation/gradient_noise"
    heights = engine.read(sketch_of(use=use), "terrain")
    assert heights.min() == 0 and heights.max() == 1
    sketch = sketch_of(use=use, normalise="none")
    np.testing.assert_array_equal(engine.read(sketch, "terrain"), engine.read(sketch, "terrain.sum"))


def test_seeds_are_terrains_of_their_own(any_engine, sketch_of):
    terrains = np.stack(
        [
            any_engine.read(sketch_of((257, 257), frequency=64.0, octaves=1, seed=s), "terrain").ravel()
            for s in range(6)
        ]
    )
    np.testing.assert_array_equal(
        terrains[3],
        any_engine.read(sketch_of((257, 257), frequency=64.0, octaves=1, seed=3), "terrain").ravel(),
    )
    correlations = np.corrcoef(terrains.astype(float))[np.triu_indices(6, 1)]
    assert np.abs(correlations).max() < 4 / 64


def test_ridges_point_up_and_billows_down(any_engine, sketch_of):
    """Creases are where the terrain bends most: at ridges downwards, between billows upwards."""

    def bend(shape):
        h = any_engine.read(sketch_of((257, 257), shape=shape, octaves=2), "terrain").astype(float)
        laplacian = h[1:-1, 2:] + h[1:-1, :-2] + h[2:, 1:-1] + h[:-2, 1:-1] - 4 * h[1:-1, 1:-1]
        return ((laplacian - laplacian.mean()) ** 3).mean() / laplacian.std() ** 3

    assert bend("ridged") < -1.5
    assert bend("billow") > 1.5
    assert abs(bend("plain")) < 0.5


def test_warping_bends_the_plain_terrain(engine, sketch_of):
    plain = engine.read(sketch_of(octaves=3), "terrain")
    unbent = engine.read(sketch_of(octaves=3, shape="warped", warp=0.0), "terrain")
    np.testing.assert_allclose(unbent, plain, atol=1e-6)
    assert np.abs(engine.read(sketch_of(octaves=3, shape="warped", warp=1.0), "terrain") - plain).max() > 0.3

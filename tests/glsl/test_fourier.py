"""Fourier terrain against scipy.fft in float64 on the same random numbers, and against its own definition."""

from itertools import product

import moderngl
import numpy as np
import pytest
import scipy.fft

from playground.engine.engine import Engine
from playground.errors import SketchError
from playground.paths import GLSL
from playground.shader.source import read_source

from ..sketch_texts import kernel, passes, use
from ..truth.noise import python_random, salt
from .conftest import BOTH_TEXTS

NUMBERS = kernel("random_pair(texel, 5u) * 2.0 - 1.0", "numbers:rg32f")
TRANSFORM = "generation/fourier/transform"
TRANSFORMS = passes(
    numbers="./numbers",
    there=use(TRANSFORM, inputs={"initial": "numbers"}),
    back=use(TRANSFORM, inputs={"initial": "there"}, direction="backward"),
    backward=use(TRANSFORM, inputs={"initial": "numbers"}, direction="backward"),
)
SIDES = [*((n, n) for n in (1, 2, 4, 8, 128)), (16, 4), (2, 64), (1, 32), (64, 256), (4096, 2), (2, 4096)]
LANDS = [(2, 2), (4, 4), (5, 5), (8, 4), (16, 33), (64, 64), (65, 128), (129, 129), (512, 64), (257, 257)]


def frequencies(nx, ny):
    """Return f of each number of a spectrum, in waves along the longer side."""
    longer = max(nx, ny)
    return np.hypot(scipy.fft.fftfreq(nx, 1 / longer), scipy.fft.fftfreq(ny, 1 / longer)[:, None])


def filtered(grid, roughness):
    """Return the terrain of a grid of random numbers by the four steps of section 1.3.3."""
    spectrum = scipy.fft.rfft2(grid.astype(np.float64))  # half of it, as the numbers are real
    f = frequencies(*grid.shape[::-1])[:, : spectrum.shape[1]]
    f[0, 0] = 1.0
    return scipy.fft.irfft2(spectrum / f**roughness, grid.shape)


def as_complex(array):
    return array[..., 0].astype(np.float64) + 1j * array[..., 1]


def apart(result, expected):
    """Return the greatest difference, as a fraction of the greatest number there is."""
    return np.abs(result - expected).max() / np.abs(expected).max()


def even(size):
    return tuple(side - side % 2 for side in size)


def minmax(terrain):
    return (terrain - terrain.min()) / (terrain.max() - terrain.min())


@pytest.fixture
def transforms(make_sketch):
    def make(size):
        return make_sketch(TRANSFORMS, size=list(size), numbers=NUMBERS)

    return make


@pytest.fixture
def sketch_of(single):
    def make(size=(64, 64), **values):
        return single("generation/fourier", size, **values)

    return make


def waves_by_hash(nx, ny, seed):
    """Return the spectrum of the grid, each pair of opposite waves drawn once by its own frequency."""

    def signed(k, n):
        return k if 2 * k <= n else k - n

    spectrum = np.zeros((ny, nx), complex)
    key = seed + salt("generation/fourier")
    for y, x in product(range(ny), range(nx)):
        kx, ky = signed(x, nx), signed(y, ny)
        to = (-y % ny, -x % nx)
        mirrored = signed(to[1], nx), signed(to[0], ny)
        if (kx, ky) < mirrored:
            continue
        a, b = (2 * python_random(kx, ky, key, part) - 1 for part in (0, 1))
        own = (kx, ky) == mirrored
        spectrum[to] = a if own else (a - 1j * b) / np.sqrt(2)
        spectrum[y, x] = a if own else (a + 1j * b) / np.sqrt(2)
    return spectrum * np.sqrt(nx * ny)


def truth_of(engine, sketch, size, roughness):
    terrain = filtered(engine.read(sketch, "terrain.grid"), roughness)
    return np.pad(terrain, [(0, side % 2) for side in size[::-1]], mode="wrap")


# ── the transform, turn by turn ──────────────────────────────────────────────


@pytest.mark.parametrize("size", SIDES, ids=str)
def test_the_transform_is_scipys(engine, transforms, size):
    sketch = transforms(size)
    numbers = as_complex(engine.read(sketch, "numbers"))
    assert apart(as_complex(engine.read(sketch, "there")), scipy.fft.fft2(numbers)) < 6e-7
    assert apart(as_complex(engine.read(sketch, "backward")), scipy.fft.ifft2(numbers)) < 6e-7
    assert apart(as_complex(engine.read(sketch, "back")), numbers) < 1.5e-6


def test_every_iteration_is_a_level(engine, transforms):
    """After t turns numbers evenly apart are transformed, 2^t at a time: rows first, then columns."""
    nx, ny = 16, 8
    sketch = transforms((nx, ny))
    numbers = as_complex(engine.read(sketch, "numbers"))
    shown = [as_complex(values) for _, values in engine.steps(sketch, "there")]
    assert len(shown) == 4 + 3 + 1
    by_rows = np.fft.fft(numbers, axis=1)
    for turn, result in enumerate(shown):
        many = 2 ** min(turn, 4)
        parts = np.fft.fft(numbers.reshape(ny, many, nx // many), axis=1)
        expected = parts.transpose(0, 2, 1).reshape(ny, nx)
        if turn > 4:
            many = 2 ** (turn - 4)
            parts = np.fft.fft(by_rows.reshape(many, ny // many, nx), axis=0)
            expected = parts.transpose(1, 0, 2).reshape(ny, nx)
        assert apart(result, expected) < 5e-7, turn


@pytest.mark.parametrize("count", [1, 2, 8, 64, 4096, 16384])
def test_roots_of_one_are_good_to_float(on_gpu, count):
    k = np.arange(count + 1)
    result = as_complex(on_gpu("maths/complex.glsl", f"root_of_one(k, {count})", k=k))
    errors = result - np.exp(2j * np.pi * k / count)
    assert max(np.abs(errors.real).max(), np.abs(errors.imag).max()) < 1e-7
    if count >= 8:
        quarter = count // 4
        np.testing.assert_array_equal(result[::quarter], [1, 1j, -1, -1j, 1])
        np.testing.assert_array_equal(result[quarter : 2 * quarter], 1j * result[:quarter])
        np.testing.assert_array_equal(result[::-1], result.conj())


def test_complex_numbers(on_gpu):
    a, b = np.random.default_rng(0).uniform(-2, 2, (2, 50, 2)).astype(np.float32)
    expected = as_complex(a) * as_complex(b)
    result = as_complex(on_gpu("maths/complex.glsl", "complex_product(a, b)", a=a, b=b))
    np.testing.assert_allclose(result, expected, atol=1e-6)
    result = as_complex(on_gpu("maths/complex.glsl", "conjugate(a)", a=a))
    np.testing.assert_array_equal(result, as_complex(a).conj())


@pytest.mark.parametrize("y", [0.0, -0.005, -0.5, -0.85, -1.0, -1.25, -2.0, 0.5, 1.7])
def test_powers(on_gpu, y):
    draws = np.random.default_rng(1)
    x = np.concatenate([np.arange(1, 2000), draws.uniform(1e-3, 2**24, 5000), 2.0 ** np.arange(-20, 24)])
    x = x.astype(np.float32)
    result = on_gpu("maths/power.glsl", "power(x, y)", x=x, y=np.float32(y))
    np.testing.assert_allclose(result, x.astype(np.float64) ** np.float64(np.float32(y)), rtol=2e-6)
    assert result[0] == 1.0


# ── the terrain ─────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("size", [(2, 2), (65, 33), (4, 32), (33, 33)], ids=str)
def test_waves_are_drawn_by_their_frequency(engine, sketch_of, size):
    sketch = sketch_of(size, seed=11)
    expected = waves_by_hash(*even(size), 11)
    assert apart(as_complex(engine.read(sketch, "terrain.waves")), expected) < 1e-6
    assert apart(engine.read(sketch, "terrain.grid"), scipy.fft.ifft2(expected).real) < 2e-6
    assert np.abs(scipy.fft.ifft2(expected).imag).max() < 1e-12, "opposite waves are conjugates"
    assert apart(as_complex(engine.read(sketch, "terrain.spectrum")), expected) < 2e-6


@pytest.mark.parametrize("seed", [0, 7, 9999])
def test_the_grid_is_white_noise(any_engine, sketch_of, seed):
    """Mean square 1/3, as that of numbers from -1 to 1; no texel knows of another, whatever lies between."""
    n = 512
    grid = any_engine.read(sketch_of((n, n), seed=seed), "terrain.grid").astype(np.float64)
    # Four standard errors of the mean and of the mean square of n² numbers in a bell curve.
    assert abs(grid.mean()) < 4 / np.sqrt(3) / n
    assert abs((grid**2).mean() - 1 / 3) < 4 * np.sqrt(2) / 3 / n
    power = np.abs(np.fft.fft2(grid - grid.mean())) ** 2
    correlation = np.fft.ifft2(power).real / power.mean()
    correlation[0, 0] = 0
    nearest = [correlation[0, 1], correlation[1, 0], correlation[1, 1], correlation[1, -1]]
    assert np.abs(nearest).max() <= 4 / n
    assert np.abs(correlation).max() <= 6 / n
    shares = [(np.abs(grid) < k / np.sqrt(3)).mean() for k in (1, 2, 3)]
    np.testing.assert_allclose(shares, [0.6827, 0.9545, 0.9973], atol=4 * 0.5 / n)


@BOTH_TEXTS
@pytest.mark.parametrize(
    ("size", "roughness"),
    [(size, 2.0) for size in LANDS] + [((64, 64), r) for r in (0.0, 1.7, 2.5, 4.0)],
    ids=str,
)
def test_the_terrain_is_scipys(engine, sketch_of, size, roughness):
    sketch = sketch_of(size, roughness=roughness, seed=3, normalise="none")
    terrain = truth_of(engine, sketch, size, roughness)
    assert apart(engine.read(sketch, "terrain"), terrain) < 2e-6
    sketch = sketch.with_values({"terrain.normalise": "minmax"})
    np.testing.assert_allclose(engine.read(sketch, "terrain"), minmax(terrain), atol=4e-6)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("size", "bound"),
    [
        *((size, 5e-6) for size in ((512, 512), (1025, 257), (1024, 1024), (4096, 16), (17, 4097))),
        ((2048, 2048), 1e-5),
        ((4097, 4097), 1e-5),
    ],
    ids=str,
)
def test_larger_terrains_are_scipys(any_engine, sketch_of, size, bound):
    sketch = sketch_of(size, seed=4)
    terrain = minmax(truth_of(any_engine, sketch, size, 2.0))
    np.testing.assert_allclose(any_engine.read(sketch, "terrain"), terrain, atol=bound)


@BOTH_TEXTS
def test_a_terrain_all_below_0_stays_by_max(engine, sketch_of):
    sketch = sketch_of((2, 2), seed=11, roughness=4.0, normalise="max")
    terrain = engine.read(sketch, "terrain")
    assert terrain.max() < 0, "this seed's four numbers are below 0"
    np.testing.assert_allclose(terrain, truth_of(engine, sketch, (2, 2), 4.0), atol=1e-6)


@BOTH_TEXTS
@pytest.mark.parametrize("size", [(3, 3), (65, 65), (65, 64), (32, 33), (513, 129)], ids=str)
def test_one_texel_more_than_a_period_begins_again(engine, sketch_of, size):
    terrain = engine.read(sketch_of(size), "terrain")
    assert terrain.shape == size[::-1]
    period = even(size)
    if size[0] > period[0]:
        np.testing.assert_array_equal(terrain[:, -1], terrain[:, 0])
    if size[1] > period[1]:
        np.testing.assert_array_equal(terrain[-1], terrain[0])
    np.testing.assert_allclose(
        terrain[: period[1], : period[0]], engine.read(sketch_of(period), "terrain"), atol=1e-6
    )


@pytest.mark.parametrize("roughness", [1.0, 2.0, 2.5, 3.0])
def test_power_falls_as_the_frequency_to_minus_2_r(any_engine, sketch_of, roughness):
    terrain = any_engine.read(sketch_of((512, 512), roughness=roughness), "terrain").astype(np.float64)
    power = np.abs(scipy.fft.fft2(terrain)) ** 2
    f = frequencies(512, 512)
    rings = np.round(np.log2(np.where(f > 0, f, 1)) * 4)
    octaves = np.arange(8, 30)  # from 4 waves to 150
    means = [np.log2(power[rings == ring].mean()) for ring in octaves]
    slope = np.polyfit(octaves / 4, means, 1)[0]
    assert slope == pytest.approx(-2 * roughness, abs=0.12)


@pytest.mark.parametrize(
    ("size", "nearest"),
    [
        ((1000, 1000), "513 x 513 or 1024 x 1024"),
        ((1023, 1023), "513 x 513 or 1024 x 1024"),
        ((1026, 1026), "1025 x 1025 or 2048 x 2048"),
        ((100, 64), "65 x 64 or 128 x 64"),
        ((1, 1), "2 x 2"),
    ],
    ids=str,
)
def test_other_sizes_are_refused_with_those_nearest(engine, sketch_of, size, nearest):
    with pytest.raises(SketchError, match=f"not {size[0]} x {size[1]}; the nearest it takes: {nearest}$"):
        engine.read(sketch_of(size), "terrain")


def test_the_magnitude_of_a_spectrum(engine, make_sketch):
    magnitude = use("generation/fourier/magnitude", inputs={"spectrum": "there"}, decades=4.0)
    sketch = make_sketch(TRANSFORMS + passes(magnitude=magnitude), size=(64, 32), numbers=NUMBERS)
    spectrum = np.fft.fftshift(as_complex(engine.read(sketch, "there")))
    expected = 1 + np.log10(np.abs(spectrum) / np.sqrt(spectrum.size / 3)) / 4
    result = engine.read(sketch, "magnitude")
    np.testing.assert_allclose(result, expected, atol=1e-5)
    assert np.median(result) == pytest.approx(
        1 + np.log10(np.sqrt(2)) / 4, abs=0.05
    )  # of two numbers a texel


# ── the fast variant ────────────────────────────────────────────────────────────


def test_fourier_variant_makes_terrain_if_compute_exists(any_engine, sketch_of):
    sketch = sketch_of((64, 64))
    any_engine.read(sketch, "terrain")
    assert (any_engine.record.ran == ["terrain"]) == any_engine.info.compute
    any_engine.read(sketch, "terrain", steps={"terrain.spectrum": 3})
    assert "terrain.spectrum" in any_engine.record.ran, "iterations are not shown by the fast variant"


@pytest.mark.parametrize("side", [2**n + more for n in range(1, 10) for more in (0, 1)])
def test_the_fast_variant_is_the_passes_at_every_size(both_texts, sketch_of, side):
    """Sides of every number of bits, beside one that is longer and one that is shorter."""
    for size in ((side, side), (side, 128), (32, side)):
        for roughness in (0.0, 2.0):
            sketch = sketch_of(size, roughness=roughness, seed=side)
            slow, fast = (e.read(sketch, "terrain") for e in both_texts)
            np.testing.assert_allclose(fast, slow, atol=3e-6)


def test_sides_too_long_for_variant_run_canonical_form(compute, sketch_of):
    """Which says so once; the terrain is the plain form's, and that of the fast variant where it can run."""
    notices = []
    with Engine(compute, notice=notices.append) as engine:
        wide = sketch_of((16384, 2))
        result = engine.read(wide, "terrain")
        np.testing.assert_array_equal(result, engine.read(wide.plainly(), "terrain"))
        engine.read(wide.with_values({"terrain.seed": 8}), "terrain")
        assert notices == [
            "terrain: fourier.comp takes n up to 8193, m up to 8193 texels a side, not 16384 x 2; "
            "the plain form runs"
        ]
        engine.read(sketch_of((8193, 2)), "terrain")
        assert engine.record.ran == ["terrain"] and len(notices) == 1, "by the fast variant"


@pytest.mark.parametrize("seed", [3, 8])
@pytest.mark.parametrize(
    "size", [(2048, 16), (17, 2049), (8192, 4), (8193, 33), (2, 8193), (65, 8192), (2048, 2048)], ids=str
)
def test_long_sides_of_the_fast_variant_are_scipys(any_engine, compute, sketch_of, size, seed):
    """Sides whose places have three digits, along one axis and along both, of the waves that are drawn."""
    nx, ny = even(size)
    result = any_engine.read(sketch_of(size, seed=seed), "terrain")
    assert any_engine.record.ran == ["terrain"], "by the fast variant"
    waves = as_complex(any_engine.read(sketch_of(size, seed=seed), "terrain.waves"))
    f = frequencies(nx, ny)
    f[0, 0] = 1.0
    terrain = minmax(scipy.fft.ifft2(waves / f**2).real)
    terrain = np.pad(terrain, [(0, side % 2) for side in size[::-1]], mode="wrap")
    np.testing.assert_allclose(result, terrain, atol=2e-6)


@pytest.fixture
def of_32(compute):
    """Give ``of_32(call, numbers)``: maths/fourier.glsl's ``call`` on each row, as v[32]."""
    code = read_source(GLSL / "maths/fourier.glsl", (GLSL,)).code

    def run(call, numbers):
        text = (
            f"#version 430\nlayout(local_size_x = 1) in;\n{code}\n"
            "layout(std430, binding = 0) buffer k_numbers { vec4 numbers[]; };\n"
            "void main() { vec4 v[32]; int row = 32 * int(gl_WorkGroupID.x);\n"
            f"for (int i = 0; i < 32; i++) v[i] = numbers[row + i];\n{call};\n"
            "for (int i = 0; i < 32; i++) numbers[row + i] = v[i]; }\n"
        )
        pairs = np.stack([numbers.real, numbers.imag, -numbers.imag, numbers.real], axis=-1)  # z and i z
        buffer = compute.buffer(pairs.astype(np.float32).tobytes())
        shader: moderngl.ComputeShader = compute.compute_shader(text)
        buffer.bind_to_storage_buffer(0)
        shader.run(len(numbers))
        result = np.frombuffer(buffer.read(), np.float32).reshape(*numbers.shape, 4)
        buffer.release()
        shader.release()
        np.testing.assert_allclose(as_complex(result[..., 2:]), 1j * as_complex(result), atol=1e-5)
        return as_complex(result)

    return run


def reversed_bits(number, bits):
    return int(f"{number:0{bits}b}"[::-1], 2) if bits else 0


def test_32_numbers(of_32):
    numbers = np.random.default_rng(2).standard_normal((9, 32, 2)) @ [1, 1j]
    message = of_32("for (int i = 0; i < 32; i++) v[i] = vec4(place32(i)) * vec4(1, 0, 0, 1)", numbers)
    places = message[0].real.astype(int)
    assert sorted(places) == list(range(32))
    np.testing.assert_allclose(of_32("transform32(v)", numbers)[:, places], np.fft.fft(numbers), atol=3e-6)


@pytest.mark.parametrize("levels", range(6))
def test_blocks_of_numbers(of_32, levels):
    count = 2**levels
    numbers = np.random.default_rng(3).standard_normal((9, 32, 2)) @ [1, 1j]
    expected = np.fft.fft(numbers.reshape(9, -1, count)).reshape(9, 32)
    places = [index - index % count + reversed_bits(index % count, levels) for index in range(32)]
    result = of_32(f"transform_blocks(v, {levels})", numbers)
    np.testing.assert_allclose(result[:, places], expected, atol=3e-6)
    result = of_32(f"transform_blocks_back(v, {levels})", numbers[:, places])
    np.testing.assert_allclose(result, expected, atol=3e-6)
    message = of_32(
        f"for (int i = 0; i < 32; i++) v[i] = vec4(block_number(i, {levels})) * vec4(1, 0, 0, 1)",
        numbers,
    )
    np.testing.assert_array_equal(message[0].real, [reversed_bits(p % count, levels) for p in range(32)])

"""Filters of heights and of light: lowest, highest and means by NumPy, finer texels by parabolas."""

import numpy as np
import pytest

from ..sketch_texts import kernel, passes, use
from .conftest import BOTH_TEXTS

HALF = 2.0**-10
NOISE = kernel(
    "if (hole == 1 && texel.x == texel.y) return uintBitsToFloat(0x7fc00000u);"
    " return base + scale * random_signed(texel, 3u);",
    "height:r32f",
    "uniform float scale = 1.0;",
    "uniform float base = 0.0;",
    "uniform int hole = 0;",
)
SIZES = [(1, 1), (2, 2), (1, 40), (31, 33), (32, 32), (100, 7), (257, 300), (1025, 1025)]


# ── normalise ────────────────────────────────────────────────────────────────


@pytest.fixture
def sketch_of(make_sketch):
    def make(size=33, scale=1.0, base=0.0, mode="minmax", hole=0):
        height = {"height": "terrain"}
        text = passes(
            terrain=use("./noise", scale=scale, base=base, hole=hole),
            range=use("terrain/range", inputs=height),
            normal=use("generation/normalise", inputs=height, mode=mode),
        )
        return make_sketch(text, size=size, noise=NOISE)

    return make


@BOTH_TEXTS
@pytest.mark.parametrize("size", SIZES, ids=str)
def test_the_range_is_numpys(engine, sketch_of, size):
    sketch = sketch_of(size, scale=3.0, base=-0.7)
    terrain = engine.read(sketch, "terrain")
    np.testing.assert_array_equal(engine.read(sketch, "range"), [[[terrain.min(), terrain.max()]]])


@BOTH_TEXTS
def test_one_extreme_texel_is_found_wherever_it_is(engine, make_sketch):
    value = "texel == where ? 9.0 : texel == size - 1 - where ? -9.0 : 0.0"
    spike = kernel(value, "height:r32f", "uniform ivec2 where = ivec2(0);")
    sketch = make_sketch(passes(height="./spike", range="terrain/range"), size=(545, 530), spike=spike)
    every_row_of_two_blocks = [(k, k + 3) for k in range(36)]
    for where in [(0, 0), (544, 0), (0, 529), (544, 529), *every_row_of_two_blocks]:
        result = engine.read(sketch.with_values({"height.where": where}), "range")
        np.testing.assert_array_equal(result, [[[-9.0, 9.0]]])


@BOTH_TEXTS
@pytest.mark.parametrize("size", SIZES[2:], ids=str)
@pytest.mark.parametrize(("scale", "base"), [(0.01, 0.0), (300.0, 1000.0)])
def test_minmax_spans_0_to_1(engine, sketch_of, size, scale, base):
    sketch = sketch_of(size, scale, base)
    terrain = engine.read(sketch, "terrain").astype(np.float64)
    result = engine.read(sketch, "normal")
    assert result.min() == 0.0 and result.max() == 1.0
    np.testing.assert_allclose(result, np.interp(terrain, [terrain.min(), terrain.max()], [0, 1]), atol=1e-6)


@BOTH_TEXTS
def test_max_leaves_0_and_all_below_and_none_changes_nothing(engine, sketch_of):
    sketch = sketch_of(mode="max", scale=2.0)
    terrain = engine.read(sketch, "terrain").astype(np.float64)
    np.testing.assert_allclose(engine.read(sketch, "normal"), terrain / terrain.max(), rtol=1e-6, atol=1e-9)
    for sketch in (sketch_of(mode="max", base=-3.0), sketch_of(mode="none", scale=2.0)):
        np.testing.assert_array_equal(engine.read(sketch, "normal"), engine.read(sketch, "terrain"))
    np.testing.assert_array_equal(engine.read(sketch, "normal.range"), [[[0.0, 1.0]]])


@BOTH_TEXTS
@pytest.mark.parametrize(
    ("mode", "base", "expected"),
    [*(("minmax", base, 0) for base in (0.3, 0, -5)), ("max", 0.3, 1), ("max", 0, 0), ("max", -5, -5)],
)
def test_flat_terrain_is_a_number(engine, sketch_of, mode, base, expected):
    result = engine.read(sketch_of(scale=0.0, base=float(base), mode=mode), "normal")
    np.testing.assert_array_equal(result, np.float32(expected))


@BOTH_TEXTS
@pytest.mark.parametrize("base", [0.3, -700.0, 4e6])
def test_roundings_are_no_terrain_and_what_is_over_them_is(engine, sketch_of, base):
    """A step or two of a float is no terrain; 32 additions may leave sixteen."""
    rounded = sketch_of(scale=abs(base) * 3e-7, base=base)
    assert 0 < np.ptp(engine.read(rounded, "terrain")) < 16 * np.finfo(np.float32).eps * abs(base)
    np.testing.assert_array_equal(engine.read(rounded, "normal"), 0)
    result = engine.read(sketch_of(scale=abs(base) * 1e-5, base=base), "normal")
    assert result.min() == 0.0 and result.max() == 1.0


@BOTH_TEXTS
def test_a_texel_without_a_number_spoils_no_other(engine, sketch_of):
    sketch = sketch_of(hole=1)
    terrain = engine.read(sketch, "terrain")
    holes = np.isnan(terrain)
    assert holes.any()
    np.testing.assert_array_equal(engine.read(sketch, "range"), [[[np.nanmin(terrain), np.nanmax(terrain)]]])
    assert not np.isnan(engine.read(sketch, "normal")[~holes]).any()


# ── means ────────────────────────────────────────────────────────────────────


def mean(terrain, radius):
    """Return the mean of each square of texels, cut at the border, slice by slice."""
    terrain = terrain.astype(np.float64)
    result = np.empty_like(terrain)
    for y in range(terrain.shape[0]):
        strip = terrain[max(y - radius, 0) : y + radius + 1]
        for x in range(terrain.shape[1]):
            result[y, x] = strip[:, max(x - radius, 0) : x + radius + 1].mean(axis=(0, 1))
    return result


@pytest.fixture
def smooth_of(make_sketch):
    def make(size=(33, 33), base=0.0, **values):
        smooth = use("generation/smooth", inputs={"height": "terrain"}, **values)
        text = passes(terrain=use("./noise", base=base), smooth=smooth)
        return make_sketch(text, size=size, noise=NOISE)

    return make


@BOTH_TEXTS
@pytest.mark.parametrize(
    ("size", "radius"),
    [
        *((size, n) for size in ((33, 33), (70, 23), (23, 70), (150, 131)) for n in (1, 2, 5, 40, 63)),
        *((size, 5) for size in ((1, 1), (2, 2), (1, 100), (100, 1))),
        ((70, 41), 512),
    ],
    ids=str,
)
def test_it_is_the_mean_of_what_exists(engine, smooth_of, size, radius):
    sketch = smooth_of(size, radius=radius)
    truth = mean(engine.read(sketch, "terrain"), radius)
    np.testing.assert_allclose(engine.read(sketch, "smooth"), truth, atol=1e-6)


@BOTH_TEXTS
def test_the_thesis_radius_is_the_default_and_0_changes_no_bit(engine, smooth_of):
    thesis = engine.read(smooth_of(40, radius=5), "smooth")
    np.testing.assert_array_equal(engine.read(smooth_of(40), "smooth"), thesis)
    for base in (0.0, 300.0):
        sketch = smooth_of((90, 40), base, radius=0)
        np.testing.assert_array_equal(engine.read(sketch, "smooth"), engine.read(sketch, "terrain"))


@BOTH_TEXTS
@pytest.mark.parametrize("radius", [5, 100])
def test_roundings_do_not_gather_on_a_large_terrain(engine, smooth_of, radius):
    """Against sums of sums in float64; heights far from 0 leave a float few digits below them."""
    sketch = smooth_of((1025, 600), 8.0, radius=radius)
    terrain = engine.read(sketch, "terrain").astype(np.float64)

    def along(values):
        sums = np.cumsum(np.pad(values, ((1, 0), (0, 0))), axis=0)
        position = np.arange(len(values))
        low, high = np.maximum(position - radius, 0), np.minimum(position + radius, len(values) - 1) + 1
        return (sums[high] - sums[low]) / (high - low)[:, None]

    np.testing.assert_allclose(engine.read(sketch, "smooth"), along(along(terrain).T).T, atol=4e-6)


@pytest.fixture
def filtered(make_sketch):
    bright = kernel("vec4(2.0 * random_pair(texel, 1u), random_pair(texel, 2u))", "light:rgba16f")

    def make(n, area="window", size=(19, 13)):
        light = use("lighting/mean_filter", inputs={"light": "bright"}, n=n, area=area)
        return make_sketch(passes(bright="./bright", light=light), size=size, bright=bright)

    return make


@pytest.mark.parametrize("n", [0, 1, 4, 30])
def test_a_window_is_the_mean_of_the_light_around(engine, filtered, n):
    sketch = filtered(n)
    truth = mean(engine.read(sketch, "bright"), n)
    np.testing.assert_allclose(engine.read(sketch, "light"), truth, atol=2 * HALF)


@pytest.mark.parametrize("n", [0, 1, 2, 5, 40])
def test_a_patch_has_one_light_the_mean_of_its_own(engine, filtered, n):
    sketch = filtered(n, "patch")
    before = engine.read(sketch, "bright").astype(np.float64)
    result = engine.read(sketch, "light")
    side = max(n, 1)
    for y in range(0, before.shape[0], side):
        for x in range(0, before.shape[1], side):
            patch = (slice(y, y + side), slice(x, x + side))
            expected = np.broadcast_to(before[patch].mean(axis=(0, 1)), result[patch].shape)
            np.testing.assert_allclose(result[patch], expected, atol=2 * HALF)


# ── a coarse height at more texels: what cubic convolution keeps, it keeps ───

PARABOLA = kernel(
    "vec2 p = vec2(texel) / vec2(size - 1);"
    " return 0.2 + 0.5 * p.x - 0.3 * p.y + 0.4 * p.x * p.x - 0.6 * p.y * p.y + 0.3 * p.x * p.y;"
)


@pytest.fixture
def finer(engine, make_sketch):
    """Give ``finer(technique, size)``: a pass of 9 x 13 texels, and that at more, in float64."""

    def read(technique, size):
        fine = use("generation/finer", inputs={"coarse": "coarse"})
        made = passes(coarse=use(technique, size=(9, 13)), fine=fine)
        sketch = make_sketch(made, size=size, parabola=PARABOLA)
        return [engine.read(sketch, name).astype(np.float64) for name in ("coarse", "fine")]

    return read


def test_parabolas_are_kept_where_all_four_texels_are(finer):
    """41 x 38 texels: in one direction five times as fine, in the other no whole number of times."""
    _, result = finer("./parabola", (41, 38))
    y, x = np.meshgrid(np.linspace(0, 1, 38), np.linspace(0, 1, 41), indexing="ij")
    expected = 0.2 + 0.5 * x - 0.3 * y + 0.4 * x * x - 0.6 * y * y + 0.3 * x * y
    inner = (np.abs(x - 0.5) <= 0.5 - 1 / 8) & (np.abs(y - 0.5) <= 0.5 - 1 / 12)
    np.testing.assert_allclose(result[inner], expected[inner], atol=1e-6)


def test_it_goes_through_the_texels_given(finer):
    coarse, result = finer("generation/white_noise", (41, 37))
    np.testing.assert_allclose(result[::3, ::5], coarse, atol=1e-6)

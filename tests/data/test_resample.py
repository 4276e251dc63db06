"""Terrain at another size: splines, planes and symmetries; by parts, with gaps, and from overviews."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.interpolate import RectBivariateSpline

from playground.data.grid import ArrayRows
from playground.data.resample import decimate, resample
from playground.engine.frame import reduced
from playground.errors import DataError, ParameterError, SketchError
from playground.publish.large import strips
from playground.sketch.load import load

RNG = np.random.default_rng(13)
SIZES = [(65, 65), (33, 129), (17, 17), (200, 31), (2, 2), (64, 66), (5, 300), (1025, 2)]


@pytest.mark.parametrize("size", SIZES)
def test_a_constant_stays_exactly_constant(size):
    heights = resample(np.full((40, 65), 0.1, np.float32), size)
    assert heights.shape == size[::-1] and heights.dtype == np.float32 and heights.flags.c_contiguous
    assert (heights == np.float32(0.1)).all()


@pytest.mark.parametrize("size", SIZES)
def test_a_plane_stays_a_plane_with_its_corners(size):
    y, x = np.meshgrid(np.linspace(0, 1, 40), np.linspace(0, 1, 65), indexing="ij")
    v, u = np.meshgrid(np.linspace(0, 1, size[1]), np.linspace(0, 1, size[0]), indexing="ij")
    heights = resample(700.0 + 250.0 * x - 90.0 * y, size)
    np.testing.assert_allclose(heights, 700.0 + 250.0 * u - 90.0 * v, atol=2e-4)


@pytest.mark.parametrize("size", SIZES)
def test_corners_keep_their_heights(size):
    heightmap = RNG.random((40, 65), dtype=np.float32)
    corners = np.ix_([0, -1], [0, -1])
    np.testing.assert_allclose(resample(heightmap, size)[corners], heightmap[corners], atol=1e-6)


def test_the_same_size_is_the_same_terrain():
    heightmap = RNG.random((40, 65), dtype=np.float32)
    np.testing.assert_allclose(resample(heightmap, (65, 40)), heightmap, atol=1e-7)


@pytest.mark.parametrize("size", [(129, 129), (300, 77), (500, 500)])
def test_growing_smooth_terrain_follows_scipy_s_spline(size):
    x, y = np.linspace(0, 1, 65), np.linspace(0, 1, 49)
    heightmap = np.sin(5 * x)[None] * np.cos(4 * y)[:, None] + x[None] ** 2
    spline = RectBivariateSpline(y, x, heightmap)
    expected = spline(np.linspace(0, 1, size[1]), np.linspace(0, 1, size[0]))
    difference = np.abs(resample(heightmap, size) - expected)
    margin = math.ceil(2 * size[0] / 65), math.ceil(2 * size[1] / 49)
    assert difference[margin[1] : -margin[1], margin[0] : -margin[0]].max() < 6e-5
    # The edges have no neighbour beyond: there the terrain's curvature, f'' h^2 / 16, is not seen.
    assert difference.max() < (25 + 16 + 2) / 48**2 / 16


@pytest.mark.parametrize("size", [(65, 65), (100, 47), (33, 33)])
def test_shrinking_smooth_terrain_follows_scipy_s_spline(size):
    x, y = np.linspace(0, 1, 513), np.linspace(0, 1, 385)
    heightmap = np.sin(5 * x)[None] * np.cos(4 * y)[:, None] + x[None] ** 2
    expected = RectBivariateSpline(y, x, heightmap)(np.linspace(0, 1, size[1]), np.linspace(0, 1, size[0]))
    assert np.abs(resample(heightmap, size) - expected).max() < 2e-3


def test_shrinking_averages_and_does_not_alias():
    rows, cols = np.indices((257, 257))
    checked = ((rows + cols) % 2).astype(np.float32)  # taking every 4th texel would see only zeros
    inside = resample(checked, (65, 65))[4:-4, 4:-4]
    np.testing.assert_allclose(inside, 0.5, atol=0.01)
    waves = np.sin(2 * np.pi * cols * 0.23)  # would come back as a slow wave at 4 to 1
    assert np.abs(resample(waves, (65, 65))[:, 4:-4]).max() < 0.05
    noise = RNG.normal(size=(257, 257))
    assert resample(noise, (65, 65))[4:-4, 4:-4].std() < 0.35


def test_tiles_that_share_an_edge_share_it_afterwards():
    heightmap = RNG.random((65, 129))
    for size in ((17, 17), (129, 100)):
        west, east = resample(heightmap[:, :65], size), resample(heightmap[:, 64:], size)
        np.testing.assert_allclose(west[:, -1], east[:, 0], atol=1e-6)


def test_turning_the_terrain_turns_the_result():
    heightmap = RNG.random((40, 65))
    for size in ((31, 90), (100, 20)):
        heights = resample(heightmap, size)
        np.testing.assert_allclose(resample(heightmap[::-1, ::-1], size), heights[::-1, ::-1], atol=1e-6)
        np.testing.assert_allclose(resample(heightmap.T, size[::-1]), heights.T, atol=1e-6)


@pytest.mark.parametrize(
    ("heights", "size", "words"),
    [
        (np.zeros((4, 4)), (1, 4), "resampled heights: is 1 x 4 texels"),
        (np.zeros((4, 4)), (10**5, 10**5), r"the most is 2\*\*28"),
        (np.zeros(4), (4, 4), "has 1 dimensions"),
        (np.zeros((1, 4)), (4, 4), "is 4 x 1 texels"),
        (np.zeros((4, 4), complex), (4, 4), "holds complex128"),
        (np.array([[0, np.nan], [0, 0]]), (4, 4), "1 are not finite; expected gaps to be filled"),
    ],
)
def test_what_cannot_be_resampled_is_a_sentence(heights, size, words):
    with pytest.raises(DataError, match=words):
        resample(heights, size)


@pytest.mark.parametrize("size", [(200, 131), (33, 21), (65, 300)])
def test_a_cliff_overshoots_unless_it_is_limited(size):
    cliff = np.zeros((40, 65), np.float32)
    cliff[10:, 20:] = 1.0
    free, limited = resample(cliff, size), resample(cliff, size, within=(0.0, 1.0))
    assert free.max() > 1.02 and free.min() < -0.02
    assert (limited.min(), limited.max()) == (0.0, 1.0)
    inside = (free >= 0) & (free <= 1)
    np.testing.assert_array_equal(limited[inside], free[inside])
    assert limited.dtype == np.float32 and limited.flags.c_contiguous


def test_tiles_limited_to_the_same_range_share_their_edge():
    heightmap = (RNG.random((65, 129)) > 0.5).astype(np.float32)
    west, east = (
        resample(tile, (129, 100), within=(0, 1)) for tile in (heightmap[:, :65], heightmap[:, 64:])
    )
    np.testing.assert_allclose(west[:, -1], east[:, 0], atol=1e-6)


# ── Terrain brought to another size a part at a time: the same as in memory, with gaps, from overvie


HILLS = RNG.standard_normal((143, 211)).cumsum(0).cumsum(1).astype(np.float32)


def as_they_are(start, band):
    return band


class in_bands(ArrayRows):  # noqa: N801
    def __init__(self, values, count):
        super().__init__(values)
        object.__setattr__(self, "count", count)

    def bands(self):
        for start in range(0, len(self.values), self.count):
            yield start, self.values[start : start + self.count]


@pytest.mark.parametrize("size", [(64, 31), (211, 20), (17, 143), (300, 57), (400, 300), (2, 2)])
@pytest.mark.parametrize("count", [1, 7, 64, 500])
def test_it_is_what_resample_gives(size, count):
    made = decimate(in_bands(HILLS, count), size, as_they_are)
    low, high = float(HILLS.min()), float(HILLS.max())
    expected = resample(HILLS, size, within=(low, high))
    # Sums in float64 in another order, rounded to float32 once.
    np.testing.assert_allclose(made.heights, expected, rtol=0, atol=1e-6 * (high - low))
    assert (made.lowest, made.highest) == (low, high)


def test_a_constant_is_exact_and_a_plane_stays_one():
    constant = np.full((90, 70), 8848.86, np.float32)
    assert (decimate(in_bands(constant, 8), (9, 13), as_they_are).heights == constant[0, 0]).all()
    plane = np.add.outer(3.0 * np.arange(90.0), 0.25 * np.arange(70.0))
    made = decimate(in_bands(plane, 8), (24, 12), as_they_are).heights
    expected = np.add.outer(3.0 * np.linspace(0, 89, 12), 0.25 * np.linspace(0, 69, 24))
    np.testing.assert_allclose(made, expected, rtol=1e-6)


def test_around_gaps_only_what_is_known_counts():
    plane = np.add.outer(np.arange(120.0), 2.0 * np.arange(160.0)).astype(np.float32)
    holed = plane.copy()
    rows, cols = np.mgrid[:120, :160]
    holed[(rows - 60) ** 2 + (cols - 80) ** 2 < 900] = np.nan
    size = 32, 24
    made = decimate(in_bands(holed, 16), size, as_they_are).heights
    whole = decimate(in_bands(plane, 16), size, as_they_are).heights
    step = 159 / 31, 119 / 23
    east, south = np.meshgrid(np.arange(32) * step[0], np.arange(24) * step[1])
    away = np.hypot(south - 60, east - 80)
    # The smooth kernel looks at two steps and a texel along each axis: beyond that, nothing differs.
    beyond = 30 + np.hypot(2 * step[0] + 1, 2 * step[1] + 1)
    np.testing.assert_allclose(made[away > beyond], whole[away > beyond], atol=1e-3)
    assert np.isnan(made[away < 30 - max(step) * np.sqrt(2)]).all(), "nothing is known there"
    # What is averaged lies within a step along each axis, so the plane's slopes bound how far it may be off.
    existing = ~np.isnan(made)
    assert np.abs(made - whole)[existing].max() <= step[1] + 2.0 * step[0]
    assert existing.sum() > (away > 30).sum(), "texels on the rim are not lost"


def test_nothing_known_is_nothing():
    made = decimate(ArrayRows(np.full((40, 30), np.nan)), (5, 5), as_they_are)
    assert np.isnan(made.heights).all() and np.isnan(made.lowest)


@pytest.mark.parametrize("factor", [2, 4])
def test_an_overview_of_means_is_read_at_its_own_places(factor):
    # Waves of 40 texels and more: averaging over f texels scales them by sinc(f / 40), less than 2 % for 4.
    rows, cols = np.mgrid[:320, :400]
    waves = (np.sin(rows / 40 * 2 * np.pi) + np.cos(cols / 57 * 2 * np.pi)).astype(np.float32)
    means = waves.reshape(320 // factor, factor, 400 // factor, factor).mean(axis=(1, 3))
    size = 45, 37
    made = decimate(ArrayRows(means), size, as_they_are, whole=(400, 320)).heights
    expected = decimate(ArrayRows(waves), size, as_they_are).heights
    inner = np.s_[2:-2, 2:-2]
    bound = 2 * (1 - np.sinc(factor / 40)) + 1e-3
    assert np.abs(made - expected)[inner].max() < bound
    # Taken for nodes, they would be off by half a texel less one: that is seen.
    wrong = decimate(ArrayRows(means), size, as_they_are).heights
    assert np.abs(wrong - expected)[inner].max() > 2 * bound


def test_a_plane_from_an_overview_is_a_plane_to_its_corners():
    plane = np.add.outer(3.0 * np.arange(64.0), 0.5 * np.arange(96.0))
    means = plane.reshape(16, 4, 24, 4).mean(axis=(1, 3))
    made = decimate(ArrayRows(means), (11, 7), as_they_are, whole=(96, 64)).heights
    # Only the lowest and the highest mean bound it.
    expected = np.add.outer(3.0 * np.linspace(0, 63, 7), 0.5 * np.linspace(0, 95, 11))
    np.testing.assert_allclose(made, np.clip(expected, means.min(), means.max()), rtol=1e-6)


# ── Pictures that are drawn larger and reduced: the mean is that of light ────


NOISE = """#pragma kernel(output = "frame:rgba8")
vec4 kernel(ivec2 texel) {
    uint bits = uint(texel.x * 7919 + texel.y * 104729) * 2654435769u; bits ^= bits >> 13;
    return vec4(float(bits & 255u), float(bits >> 8 & 255u), float(bits >> 16 & 255u), 255.0) / 255.0;
}
"""


def byte_of_mean(bytes_, weights=None):
    """Return the byte of the mean light of some bytes, in plain float64."""
    share = [b / 255 for b in bytes_]
    light = [s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4 for s in share]
    weights = weights or [1.0] * len(light)
    mean = sum(v * w for v, w in zip(light, weights, strict=True)) / max(sum(weights), 1e-300)
    encoded = 12.92 * mean if mean <= 0.0031308 else 1.055 * mean ** (1 / 2.4) - 0.055
    return round(255 * encoded)


@pytest.mark.parametrize("times", [1, 2, 3, 8])
@pytest.mark.parametrize("opaque", [True, False])
def test_a_pixel_is_the_mean_light_of_its_square(times, opaque):
    random = np.random.default_rng(times)
    large = random.integers(0, 256, (5 * times, 7 * times, 4), dtype=np.uint8)
    if opaque:
        large[..., 3] = 255
    array = reduced(large, times)
    assert array.shape == (5, 7, 4)
    if times == 1:
        np.testing.assert_array_equal(array, large)
        return
    for row, column in ((0, 0), (4, 6), (2, 3)):
        square = large[times * row : times * (row + 1), times * column : times * (column + 1)].reshape(-1, 4)
        weights = None if opaque else [float(a) for a in square[:, 3]]
        expected = [byte_of_mean(square[:, c].tolist(), weights) for c in range(3)]
        np.testing.assert_array_equal(array[row, column, :3], expected)
        assert array[row, column, 3] == round(square[:, 3].mean())


def test_half_white_is_not_half_of_255():
    large = np.full((2, 2, 4), 255, np.uint8)
    large[0, :, :3] = 0
    assert reduced(large, 2)[0, 0].tolist() == [188, 188, 188, 255]


@pytest.fixture
def noise(tmp_path):
    """Give a function that loads a sketch of one noisy picture, with lines of its view and of a shot."""
    (tmp_path / "noise.glsl").write_text(NOISE)

    def make(view="", shot=""):
        file = tmp_path / "sketch.toml"
        shots = f'[[shot]]\nname = "a"\nsize = [31, 20]\n{shot}\n'
        file.write_text(f'format = 1\nsize = 33\n[view]\nuse = "./noise"\n{view}\n{shots}')
        return load(file)

    return make


def test_a_picture_is_reduced_from_one_that_is_drawn_larger(any_engine, noise):
    plain = noise()
    expected = reduced(any_engine.render(plain, size=(93, 60)).array, 3)
    thrice = noise("supersample = 3")
    np.testing.assert_array_equal(any_engine.render(thrice, size=(31, 20)).array, expected)
    shot = noise(shot="supersample = 3")
    assert (shot.picture.supersample, shot.for_shot(shot.shots[0]).picture.supersample) == (1, 3)
    assert noise("supersample = 3", "supersample = 1").for_shot(thrice.shots[0]).picture.supersample == 3
    parts = [*strips(any_engine, thrice, (31, 20), tile=(40, 26))]
    np.testing.assert_array_equal(np.concatenate(parts), expected)


def test_how_often_a_picture_is_drawn_is_in_its_fingerprint(any_engine, noise):
    sketch = noise()
    prints = {
        any_engine.fingerprint(sketch.with_picture(supersample=n), size=(60 // n, 60 // n)) for n in (1, 2, 3)
    }
    assert len(prints) == 3


def test_a_number_that_is_wrong_has_a_sentence(any_engine, noise):
    for text in ("0", "9"):
        with pytest.raises(SketchError, match=f"supersample = {text}: expected a whole number, 1 to 8"):
            noise(f"supersample = {text}")
    with pytest.raises(ParameterError, match="1 to 2048 a side"):
        any_engine.render(noise("supersample = 8"), size=(3000, 20))

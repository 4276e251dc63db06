"""Terrain at another size: SciPy's splines, planes, symmetries, the range that may not be left."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.interpolate import RectBivariateSpline

from playground.data.resample import resample
from playground.errors import DataError

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

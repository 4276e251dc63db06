"""Gaps: a plane is its own smooth sheet."""

from __future__ import annotations

import numpy as np
import pytest

from playground.data.elevation import Elevation, fill_no_data
from playground.errors import DataError

RNG = np.random.default_rng(12)


def plane(n: int) -> np.ndarray:
    y, x = np.mgrid[:n, :n] / (n - 1)
    return (1000.0 + 300.0 * x + 200.0 * y).astype(np.float32)


def test_gaps_are_refused_with_their_number_and_place():
    heights = plane(9)
    heights[3, 4] = heights[5, 1] = np.nan
    with pytest.raises(DataError, match=r"hill: 2 of 81 texels have no data, the first at \(4, 3\)"):
        fill_no_data(Elevation(heights, "hill"), "refuse")
    with pytest.raises(DataError, match="no such way with gaps: 'fil'; did you mean 'fill'"):
        fill_no_data(Elevation(heights, "hill"), "fil")  # type: ignore[arg-type]


@pytest.mark.parametrize("mode", ["refuse", "fill"])
def test_terrain_without_gaps_is_left_alone(mode):
    whole = Elevation(plane(9), "hill")
    assert fill_no_data(whole, mode) is whole


@pytest.mark.parametrize("n", [33, 100, 257])
def test_a_hole_in_a_plane_is_filled_by_the_plane(n):
    y, x = np.mgrid[:n, :n] / (n - 1)
    heights = plane(n)
    heights[(x - 0.5) ** 2 + (y - 0.45) ** 2 < 0.09] = np.nan
    elevation = fill_no_data(Elevation(heights, "hill", spacing=(2.0, 2.0), in_metres=True), "fill")
    assert np.abs(elevation.heights - plane(n)).max() < 0.005 * 500.0
    existing = ~np.isnan(heights)
    np.testing.assert_array_equal(elevation.heights[existing], heights[existing])
    assert elevation.missing == 0 and elevation.spacing == (2.0, 2.0) and elevation.in_metres
    assert "were filled" in elevation.notes[0]


def test_a_fill_is_smooth_within_range_and_the_same_each_time():
    y, x = np.mgrid[:129, :200] / 60.0
    heights = (100 * np.sin(3 * x) * np.cos(2 * y)).astype(np.float32)
    heightmap = heights.copy()
    heightmap[:40, :50] = heightmap[60:90, 100:160] = np.nan
    heightmap[RNG.random(heightmap.shape) < 0.2] = np.nan
    item, two = (fill_no_data(Elevation(heightmap, "hill"), "fill").heights for _ in range(2))
    np.testing.assert_array_equal(item, two)
    assert np.nanmin(heightmap) <= item.min() and item.max() <= np.nanmax(heightmap)
    steepest = np.abs(np.diff(heights, axis=1)).max()
    assert np.abs(np.diff(item, axis=1)).max() < 3 * steepest


def test_one_known_texel_fills_the_terrain():
    heights = np.full((37, 21), np.nan, np.float32)
    heights[30, 2] = 7.25
    assert (fill_no_data(Elevation(heights, "hill"), "fill").heights == np.float32(7.25)).all()


def test_a_fill_keeps_the_symmetry_of_the_terrain():
    heights = plane(65)
    heights[20:45, 20:45] = np.nan
    a = fill_no_data(Elevation(heights, "a"), "fill").heights
    b = fill_no_data(Elevation(np.ascontiguousarray(heights[:, ::-1]), "b"), "fill").heights
    np.testing.assert_allclose(a, b[:, ::-1], atol=1.0)

"""Terrain brought to another size a part at a time: the same as in memory, with gaps, from overviews."""

from __future__ import annotations

import numpy as np
import pytest

from playground.data.grid import ArrayRows
from playground.data.resample import decimate, resample

RNG = np.random.default_rng(5)
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

"""Ranks and sorted heights against SciPy's."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from scipy.special import ndtri
from scipy.stats import rankdata

from playground.data.by_example import normal_deviate
from playground.engine.source_kinds import Material
from playground.engine.sources import rank_heights

RNG = np.random.default_rng(4)


def test_normal_deviates_are_scipy_s():
    shares = np.concatenate([np.geomspace(1e-9, 0.5, 4000), 1 - np.geomspace(1e-9, 0.5, 4000)])
    np.testing.assert_allclose(normal_deviate(shares), ndtri(shares), atol=1e-8)


def test_ranks_become_normal_and_heights_are_sorted():
    heights = RNG.permutation(13 * 17).reshape(13, 17).astype(np.float32)
    arrays = rank_heights({"widest": 0.0}, (17, 13), Material({"example": heights}))
    np.testing.assert_array_equal(arrays["sorted"].ravel(), np.sort(heights, axis=None))
    heights = heights.astype(np.float64)  # SciPy 1.18 gives ranks in the dtype of what is ranked
    shares = (rankdata(heights) - 0.5) / heights.size
    np.testing.assert_allclose(arrays["normal"], ndtri(shares).reshape(13, 17), atol=1e-6)


def test_what_is_too_wide_is_left_out():
    heights = RNG.normal(size=(60, 80)).astype(np.float32)
    arrays = rank_heights({"widest": 0.2}, (80, 60), Material({"example": heights[..., None]}))
    expected = heights - gaussian_filter(heights.astype(np.float64), 4.0, mode="reflect", truncate=9)
    np.testing.assert_allclose(arrays["sorted"].ravel(), np.sort(expected, axis=None), atol=1e-5)


@pytest.mark.parametrize("value", [{}, {"example": np.full((1, 1), 3.0, np.float32)}], ids=["none", "texel"])
def test_no_example_is_flat(value):
    assert not rank_heights({"widest": 0.1}, (4, 3), Material(value))["sorted"].any()


def test_numbers_that_are_none_count_as_0():
    heights = np.array([[1, np.nan], [np.inf, -np.inf]], np.float32)
    arrays = rank_heights({"widest": 0.0}, (2, 2), Material({"example": heights}))
    np.testing.assert_array_equal(arrays["sorted"].ravel(), [0, 0, 0, 1])


def test_it_says_how_far_it_is_and_stops_where_it_is_told_to():
    heights, seen = RNG.normal(size=(20, 30)).astype(np.float32), []
    material = Material({"example": heights}, report=lambda *at: seen.append(at))
    rank_heights({"widest": 0.2}, (80, 60), material)
    assert seen == [(done, len(seen)) for done in range(len(seen))] and len(seen) >= 4

    class Stop(Exception):
        pass

    for last in range(len(seen)):

        def stop(done, wanted, last=last):
            if done == last:
                raise Stop

        with pytest.raises(Stop):
            rank_heights({"widest": 0.2}, (80, 60), Material({"example": heights}, report=stop))

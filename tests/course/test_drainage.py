"""What lessons measure of the ways of water, against a flood in a queue and against laws made on purpose."""

from __future__ import annotations

import numpy as np
import pytest

from playground.course import measures
from playground.course.measures import Grid

from ..truth.drainage import drained_areas, exponent_of

GRID = Grid((20.0, 30.0), 500.0)


def valley(ny, nx):
    """Return heights that all drain to one row, and along it westwards."""
    y, x = np.mgrid[:ny, :nx]
    return 0.1 * abs(y - ny // 2) + 0.001 * x


def test_areas_are_those_of_a_flood():
    """On a terrain whose every texel has a way down, so that a flood fills nothing."""
    heights = valley(41, 57) + 1e-5 * np.random.default_rng(2).random((41, 57))
    assert measures.pits(heights, GRID) == 0.0
    square = Grid((10.0, 10.0), 500.0)
    slopes, receivers = measures._ways(heights, square)
    np.testing.assert_array_equal(measures._areas(heights, receivers), drained_areas(heights))
    assert slopes[20, 30] == pytest.approx(0.001 * 500 / 10, rel=0.05)


def test_pits_are_counted():
    heights = valley(41, 57)
    heights[10, 10] = heights[30, 40] = -1.0
    assert measures.pits(heights, GRID) == pytest.approx(2 / (39 * 55))


def test_the_tail_of_areas():
    areas = drained_areas(np.random.default_rng(5).random((150, 150)).cumsum(0).cumsum(1)) * 1e4
    low, high = 20 * 0.01, areas.size / 50 * 0.01
    assert measures.tail_power(areas, GRID, low, high) == pytest.approx(exponent_of(areas / 1e4), rel=1e-9)
    with pytest.raises(ValueError, match="some texels exceed"):
        measures.tail_power(areas, GRID, 1e6, 2e6)


@pytest.mark.parametrize("power", [-0.5, -0.3])
def test_a_law_of_slopes_is_found_again(power):
    """A river in the middle row, of S = 2 A^p where A is what lies east of it, edges aside."""
    ny, nx = 21, 80
    area = np.arange(nx, 0, -1) * (ny - 2) * 600.0  # [m²]
    rise = 2.0 * area**power * 20.0 / 500.0
    river = np.cumsum(rise) - rise[0]
    heights = river + 10.0 * abs(np.arange(ny) - ny // 2)[:, None]
    heights[:, -1] += 1.0  # the eastern edge is an outlet: nothing may leave by it
    slope_area_power = measures.slope_area_power(heights, GRID, 0.05, 2.0)
    assert slope_area_power == pytest.approx(power, abs=0.03)
    middle = measures.slope_where_drained(heights, GRID, 0.3, 0.34)
    assert middle == pytest.approx(2.0 * 0.32e6**power, rel=0.1)
    with pytest.raises(ValueError, match="no texel drains"):
        measures.slope_where_drained(heights, GRID, 1e3, 2e3)

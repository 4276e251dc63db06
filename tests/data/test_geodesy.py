"""Lengths of a degree: published tables, and distances along the ellipsoid."""

from __future__ import annotations

import numpy as np
import pytest

from playground.data.place import degree_lengths


# National Geospatial-Intelligence Agency, "Length of a degree of latitude and longitude", WGS 84, km.
@pytest.mark.parametrize(
    ("latitude", "north", "east"),
    [
        (0, 110.574, 111.320),
        (15, 110.649, 107.550),
        (30, 110.852, 96.486),
        (45, 111.132, 78.847),
        (60, 111.412, 55.800),
        (75, 111.618, 28.902),
        (90, 111.694, 0.000),
    ],
)
def test_a_degree_is_as_long_as_the_tables_say(latitude, north, east):
    assert degree_lengths(latitude) == pytest.approx((1000 * east, 1000 * north), abs=0.6)
    assert degree_lengths(-latitude) == degree_lengths(latitude)


@pytest.mark.parametrize("latitude", [-63.2, 0.0, 12.5, 36.59, 80.0])
def test_short_steps_in_space_are_as_long_as_their_degrees(on_ellipsoid, latitude):
    step = 1 / 1200
    east, north = degree_lengths(latitude)
    over = np.linalg.norm(on_ellipsoid(latitude, step) - on_ellipsoid(latitude, 0.0))
    up = np.linalg.norm(on_ellipsoid(latitude + step / 2, 0.0) - on_ellipsoid(latitude - step / 2, 0.0))
    np.testing.assert_allclose([east * step, north * step], [over, up], rtol=1e-7)

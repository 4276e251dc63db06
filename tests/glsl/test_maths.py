"""The library's plain mathematics, against Python's own."""

import math

import numpy as np
import pytest

RNG = np.random.default_rng(3)


def test_cosine_and_sine_are_pythons(on_gpu):
    angles = RNG.uniform(-1000, 1000, 5000).astype(np.float32)
    result = on_gpu("maths/angle.glsl", "cos_sin_degrees(angle)", angle=angles)
    truth = [(math.cos(a), math.sin(a)) for a in np.radians(angles.astype(np.float64))]
    np.testing.assert_allclose(result, truth, atol=2e-6)


def test_quarter_turns_are_exact(on_gpu):
    turns = np.arange(-8, 9)
    result = on_gpu("maths/angle.glsl", "cos_sin_degrees(angle)", angle=turns * 90.0)
    truth = [((1, 0), (0, 1), (-1, 0), (0, -1))[t % 4] for t in turns]
    np.testing.assert_array_equal(result, truth)


def test_a_turned_angle_is_a_turned_vector_to_the_last_bit(on_gpu):
    angles = np.arange(-44, 45) + 0.25
    first = on_gpu("maths/angle.glsl", "cos_sin_degrees(angle)", angle=angles)
    turned = on_gpu("maths/angle.glsl", "cos_sin_degrees(angle)", angle=angles + 90.0)
    np.testing.assert_array_equal(turned, np.stack([-first[:, 1], first[:, 0]], axis=1))


def test_quotient_is_pythons(on_gpu):
    divisors = RNG.integers(1, 16385, 20000)
    quotients = np.minimum(RNG.integers(0, 2**21, 20000), (2**31 - 20000) // divisors - 1)
    for rest in (0, 1, -1):
        a = np.maximum(quotients * divisors + rest, 0)
        result = on_gpu("maths/whole.glsl", "quotient(a, b)", a=a, b=divisors)
        np.testing.assert_array_equal(result, [int(x) // int(y) for x, y in zip(a, divisors, strict=True)])


def test_small_quotients_are_pythons(on_gpu):
    a, b = (grid.ravel() for grid in np.meshgrid(np.arange(200), np.arange(1, 100)))
    np.testing.assert_array_equal(on_gpu("maths/whole.glsl", "quotient(a, b)", a=a, b=b), a // b)


@pytest.mark.parametrize(
    ("small", "large"), [((5, 9), (129, 65)), ((344, 403), (1025, 1025)), ((1, 1), (7, 3))]
)
def test_corners_stand_on_corners(on_gpu, small, large):
    corners = np.array([[x, y] for x in (0, small[0] - 1) for y in (0, small[1] - 1)])
    result = on_gpu("maths/land.glsl", "place_on(to, texel, grid)", to=large, texel=corners, grid=small)
    truth = [[(large[i] - 1 if c[i] else 0) for i in (0, 1)] for c in corners]
    np.testing.assert_array_equal(result, truth)


def test_grid_position_keeps_its_terrain_fraction_on_other_grid(on_gpu):
    texels = np.stack([np.arange(344), np.arange(344) % 403], axis=1)
    places = on_gpu(
        "maths/land.glsl", "place_on(to, texel, grid)", to=(1025, 77), texel=texels, grid=(344, 403)
    )
    shares = on_gpu("maths/land.glsl", "share_of_texel(texel, grid)", texel=texels, grid=(344, 403))
    np.testing.assert_allclose(places, texels / (343.0, 402.0) * (1024.0, 76.0), rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(shares, texels / (343.0, 402.0), rtol=1e-6, atol=1e-7)
    assert places.max(axis=0).tolist() <= [1024.0, 76.0]


def test_a_grid_on_itself_stays_where_it_is(on_gpu):
    texels = np.stack([np.arange(344), np.arange(344)], axis=1)
    places = on_gpu("maths/land.glsl", "place_on(grid, texel, grid)", texel=texels, grid=(344, 403))
    np.testing.assert_array_equal(places, texels)


def test_spacing_counts_the_gaps(on_gpu):
    result = on_gpu("maths/land.glsl", "spacing_of(grid, metres)", grid=(11, 1), metres=(50.0, 7.0))
    np.testing.assert_array_equal(result, [[5.0, 7.0]])


def test_bilinear_matches_two_lerps_and_keeps_level_ground(on_gpu):
    corners, part = RNG.uniform(-5, 5, (500, 4)), RNG.random((500, 2))
    result = on_gpu("maths/land.glsl", "bilinear(corner, part)", corner=corners, part=part)
    truth = [
        np.interp(v, [0, 1], [np.interp(u, [0, 1], c[:2]), np.interp(u, [0, 1], c[2:])])
        for c, (u, v) in zip(corners, part, strict=True)
    ]
    np.testing.assert_allclose(result, truth, atol=2e-6)
    level = np.repeat(corners[:, :1], 4, axis=1)
    result = on_gpu("maths/land.glsl", "bilinear(corner, part)", corner=level, part=part)
    np.testing.assert_array_equal(result, level[:, 0].astype(np.float32))


def test_node_weights_match_bilinear_interpolation(on_gpu):
    """A sum over the nodes is a bilinear function itself, whose value at a place is known."""
    places = np.concatenate([RNG.uniform(0, 50, (200, 2)), RNG.integers(0, 50, (50, 2))]).astype(np.float32)
    places[200:220, 0] += np.float32(0.25)  # between two nodes of a row
    places[220:230, 1] += np.float32(0.5)  # and of a column
    count = on_gpu("maths/nodes.glsl", "float(nodes_around(place).count)", place=places)
    fractions = places != np.floor(places)
    np.testing.assert_array_equal(count, 2.0 ** fractions.sum(axis=1))
    total, weights = np.zeros(len(places)), np.zeros(len(places))
    for k in range(4):
        weight = on_gpu("maths/nodes.glsl", f"weight_of(nodes_around(place), {k})", place=places)
        node = on_gpu("maths/nodes.glsl", f"vec2(node_at(nodes_around(place), {k}))", place=places)
        weight, node = np.where(k < count, weight, 0.0).astype(np.float64), node.astype(np.float64)
        weights += weight
        total += weight * (3.0 + node[:, 0]) * (7.0 - 2.0 * node[:, 1])
    np.testing.assert_allclose(weights, 1.0, rtol=1e-6)
    x, y = places.astype(np.float64).T
    np.testing.assert_allclose(total, (3.0 + x) * (7.0 - 2.0 * y), rtol=1e-4, atol=1e-3)


def test_segment_distance_is_to_its_nearest_point(on_gpu):
    position, start, end = (RNG.uniform(-5, 5, (200, 2)).astype(np.float32) for _ in range(3))
    end[:20] = start[:20]  # pieces without length
    result = on_gpu(
        "maths/segment.glsl", "distance_to_segment(place, start, end)", place=position, start=start, end=end
    )
    share = np.linspace(0, 1, 2001)[:, None, None]
    points = start + share * (end.astype(np.float64) - start)
    np.testing.assert_allclose(result, np.linalg.norm(points - position, axis=-1).min(axis=0), atol=3e-3)


@pytest.mark.slow
def test_ray_interval_in_rectangle_matches_points_inside(on_gpu):
    position, ahead = RNG.uniform(-8, 8, (300, 2)), RNG.uniform(-1, 1, (300, 2))
    ahead[:20, 0] = 0.0
    result = on_gpu(
        "maths/square.glsl",
        "span_through(place, ahead, vec2(5.0, 3.0))",
        place=position.astype(np.float32),
        ahead=ahead.astype(np.float32),
    )
    way = np.linspace(-100, 100, 40_001)
    x, y = (start[:, None] + way * step[:, None] for start, step in zip(position.T, ahead.T, strict=True))
    inside = (x > 0) & (x < 5) & (y > 0) & (y < 3)
    enters, leaves = result.T
    clear = inside.sum(axis=1) > 10
    assert clear.sum() > 50 and not inside[enters >= leaves].any()
    np.testing.assert_allclose(enters[clear], way[inside.argmax(axis=1)][clear], atol=0.006)
    last = way[len(way) - 1 - inside[:, ::-1].argmax(axis=1)]
    np.testing.assert_allclose(leaves[clear], last[clear], atol=0.006)


def test_what_is_not_a_number_is_recognised(on_gpu):
    value = np.array([0.0, -1e30, np.nan, np.inf, -np.inf], np.float32)
    result = on_gpu("maths/number.glsl", "is_number(value) ? 1 : 0", value=value)
    np.testing.assert_array_equal(result, [1, 1, 0, 0, 0])

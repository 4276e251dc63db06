"""The truth itself, against closed forms and against marches by small steps."""

from itertools import pairwise

import numpy as np
import pytest

from .bounce import bounced, exchange
from .horizon import crossings, horizon, marched
from .land import LANDS, Land, bowl, cone, towards, valley
from .sky import sky_light, sky_visibility
from .sun import SUN, strips, sunlight

RHO = np.radians(SUN / 2)


def rough(size=(17, 13), spacing=(10.0, 23.0), seed=4, high=60.0):
    random = np.random.default_rng(seed).uniform(0, high, size[::-1])
    return Land(random, spacing)


def plane(east, north, size=(17, 13), spacing=(10.0, 23.0)):
    x, y = np.meshgrid(np.arange(size[0]) * spacing[0], np.arange(size[1]) * spacing[1])
    return Land(east * x + north * y, spacing)


def wall(distance, high, thin, count=3):
    """A wall from south to north across even terrain, ``distance`` metres east of the western border."""
    n = int(distance / thin) + 3
    heights = np.zeros((count, n))
    heights[:, int(distance / thin)] = high
    return Land(heights, (thin, 1e5))


# The terrain


def test_heights_between_nodes_are_bilinear():
    terrain = Land(np.array([[1.0, 2.0, 4.0], [3.0, 8.0, 0.0]]), (2.0, 5.0))
    np.testing.assert_allclose(
        terrain.at([0, 0.5, 2, 1.25, 2], [0, 0, 0.5, 0.5, 1]), [1, 1.5, 2, (2.5 + 6) / 2, 0]
    )
    assert terrain.extent == (4.0, 5.0)


def test_a_plane_has_one_normal():
    terrain = plane(0.3, -0.7)
    truth = np.cross([1, 0, 0.3], [0, 1, -0.7])
    np.testing.assert_allclose(terrain.normals(), np.broadcast_to(truth / np.linalg.norm(truth), (13, 17, 3)))


def test_compass():
    np.testing.assert_allclose(
        towards([0, 90, 180, 77], [0, 0, 45, 90]),
        [[0, 1, 0], [1, 0, 0], [0, -(0.5**0.5), 0.5**0.5], [0, 0, 1]],
        atol=1e-15,
    )


@pytest.mark.parametrize("make", LANDS.values(), ids=LANDS)
def test_a_terrain_of_any_size_has_true_metres(make):
    for size in (33, 65, 129):
        terrain = make(size)
        assert terrain.heights.shape == (size, size) and terrain.heights.min() == pytest.approx(0, abs=1e-9)
        assert 100 < np.ptp(terrain.heights) < 900 and 10 < terrain.spacing[0] < 100


# The horizon


@pytest.mark.parametrize(
    "part",
    [(0.25, 0.7), *(pytest.param(p, marks=pytest.mark.slow) for p in ((0.0, 0.0), (0.4, 0.0)))],
    ids=str,
)
@pytest.mark.parametrize(
    "azimuth", [0.0, 90.0, 180.0, 270.0, 250.0, 17.3, 133.0, np.degrees(np.arctan2(10, 23))]
)
def test_the_exact_horizon_is_what_small_steps_tend_to(azimuth, part):
    terrain = rough()
    exact = horizon(terrain, azimuth, part)
    y, x = np.mgrid[0 : 13 - (part[1] > 0), 0 : 17 - (part[0] > 0)].astype(float)
    array = marched(terrain, azimuth, x + part[0], y + part[1], 1 / 128)
    exact = exact[: len(x), : x.shape[1]]
    assert not np.isnan(exact).any()
    seen = np.isfinite(array)
    assert seen.mean() > 0.7
    assert (array[seen] <= exact[seen] + 1e-9).all(), "no step sees above the exact horizon"
    np.testing.assert_allclose(np.arctan(array[seen]), np.arctan(exact[seen]), atol=0.02)
    assert np.median(np.abs(np.arctan(array[seen]) - np.arctan(exact[seen]))) < 1e-3


def test_smaller_steps_come_nearer():
    terrain = rough()
    exact = horizon(terrain, 250.0)
    y, x = np.mgrid[0:13, 0:17].astype(float)
    errors = []
    for step in (1.0, 1 / 4, 1 / 16, 1 / 64):
        array = marched(terrain, 250.0, x, y, step)
        seen = np.isfinite(array)
        errors.append(np.abs(np.arctan(array[seen]) - np.arctan(exact[seen])).mean())
    assert all(b < a / 2 for a, b in pairwise(errors)), errors


def test_rays_meet_every_line_of_the_grid_once():
    terrain = rough((9, 5))
    for azimuth in (30.0, 45.0, 222.0):
        met = crossings(terrain, azimuth, (0.3, 0.2))
        assert len(met) == 9 + 5
        assert all(c.place[0] == round(c.place[0]) or c.place[1] == round(c.place[1]) for c in met)
    assert len(crossings(Land(np.zeros((6, 6)), (3.0, 3.0)), 45.0)) == 6  # every line is met at a node


def test_a_planes_horizon_is_its_slope():
    terrain = plane(0.3, -0.7)
    for azimuth in (12.0, 90.0, 211.0):
        rise = 0.3 * np.sin(np.radians(azimuth)) - 0.7 * np.cos(np.radians(azimuth))
        array = horizon(terrain, azimuth)
        np.testing.assert_allclose(array[np.isfinite(array)], rise, atol=1e-12)


def test_beyond_the_border_there_is_no_terrain():
    array = horizon(rough(), 90.0)
    assert np.isneginf(array[:, -1]).all() and np.isfinite(array[:, :-1]).all()
    array = horizon(rough(), 225.0)
    assert np.isneginf(array[0]).all() and np.isneginf(array[:, 0]).all() and np.isfinite(array[1:, 1:]).all()


def test_turning_and_mirroring_turn_and_mirror():
    terrain = rough((15, 15), (10.0, 10.0))
    here = horizon(terrain, 250.0)
    turned = horizon(
        Land(np.rot90(terrain.heights, -1), terrain.spacing), 160.0
    )  # rows go north: a quarter turn left
    np.testing.assert_allclose(turned, np.rot90(here, -1), rtol=1e-9)
    mirrored = horizon(Land(terrain.heights[:, ::-1], terrain.spacing), -250.0)
    np.testing.assert_allclose(mirrored, here[:, ::-1], rtol=1e-9)


# The sun


@pytest.mark.parametrize("elevation", [0.1, 5.0, 25.0, 60.0, 89.0, 89.9, 90.0])
@pytest.mark.parametrize("diameter", [0.53, 5.0])
def test_the_strips_cover_the_disc(elevation, diameter):
    """Its area is that of a cap of the sphere; its middle is the sun's."""
    total, middle = 0.0, np.zeros(3)
    for azimuth, low, high, width in strips(250.0, elevation, diameter, 64):
        e = np.radians(np.linspace(low, high, 65))
        e = (e[1:] + e[:-1]) / 2
        area = width * np.cos(e) * np.radians(high - low) / 64
        total += area.sum()
        middle += (towards(azimuth, np.degrees(e)) * area[:, None]).sum(axis=0)
    assert total == pytest.approx(2 * np.pi * (1 - np.cos(np.radians(diameter / 2))), rel=2e-3)
    np.testing.assert_allclose(middle / np.linalg.norm(middle), towards(250.0, elevation), atol=2e-4)


@pytest.mark.parametrize("sun", [(250.0, 5.0), (10.0, 60.0), (77.0, 90.0)], ids=str)
def test_a_free_plane_has_the_whole_sun_at_its_cosine(sun):
    share, light = sunlight(plane(0.02, -0.03), *sun)
    np.testing.assert_allclose(share, 1, atol=1e-12)
    normal = np.cross([1, 0, 0.02], [0, 1, -0.03])
    np.testing.assert_allclose(light, normal @ towards(*sun) / np.linalg.norm(normal), rtol=2e-4)


def test_a_plane_turned_away_has_none_and_one_that_grazes_half():
    slope = np.tan(np.radians(5))
    share, light = sunlight(plane(slope * 2, 0.0), 90.0, 5.0)
    assert (share == 0).all() and (light == 0).all()
    share, light = sunlight(plane(slope, 0.0), 90.0, 5.0)
    np.testing.assert_allclose(share, 0.5, atol=1e-3)
    # The mean of a half disc's height over its straight edge: 4 rho / (3 pi), over half of it.
    np.testing.assert_allclose(light, np.sin(RHO) * 2 / (3 * np.pi), rtol=0.01)


def test_a_sun_half_behind_a_wall_is_half_seen():
    terrain = wall(1000.0, 100.0, 20.0)
    share, _ = sunlight(terrain, 90.0, np.degrees(np.arctan(0.1)))
    assert share[1, 0] == pytest.approx(0.5, abs=2e-4)


@pytest.mark.slow
@pytest.mark.parametrize(("elevation", "distance", "thin"), [(5.0, 1250.0, 5.0), (25.0, 222.0, 0.5)])
def test_wall_shadow_end_and_penumbra_match_sun_disc(elevation, distance, thin):
    """A straight edge x radii above the middle leaves (acos(x) - x sqrt(1 - x²)) / pi of a disc.

    Across the ray, the penumbra is the way from the wall's crest times 2 tan(0.265 degrees) wide.
    """
    terrain = wall(distance, 100.0, thin)
    share = sunlight(terrain, 90.0, elevation)[0][1, :-3]
    away = distance - np.arange(len(share)) * thin
    dark, lit = away[share == 0].max(), away[share == 1].min()
    high = np.radians(elevation)
    assert dark == pytest.approx(100 / np.tan(high + RHO), abs=thin)
    assert lit == pytest.approx(100 / np.tan(high - RHO), abs=thin)
    width = 100 / np.sin(high) * 2 * np.tan(RHO)
    assert (lit - dark) * np.sin(high) == pytest.approx(width, rel=0.02, abs=2 * thin * np.sin(high))
    partly = (share > 0) & (share < 1)
    x = (np.arctan2(100, away[partly]) - high) / RHO
    assert len(x) > 8 and np.abs(x).min() < 0.2
    np.testing.assert_allclose(share[partly], (np.arccos(x) - x * np.sqrt(1 - x * x)) / np.pi, atol=1e-3)


def test_a_point_sun_is_the_limit_of_small_discs():
    terrain = cone(33)
    point = sunlight(terrain, 250.0, 12.0, diameter=0)
    small = sunlight(terrain, 250.0, 12.0, diameter=0.01)
    for a, b in zip(point, small, strict=True):
        assert (np.abs(a - b) > 1e-3).mean() < 0.005
    assert 0.01 < (point[0] == 0).mean() < 0.5


@pytest.mark.slow
def test_few_strips_do():
    terrain = LANDS["real"](49)
    fine, coarse = (sunlight(terrain, 250.0, 5.0, count=c) for c in (64, 16))
    for a, b in zip(fine, coarse, strict=True):
        assert np.abs(a - b).max() < 0.03 and np.abs(a - b).mean() < 5e-4


# The sky


def test_flat_terrain_has_the_whole_sky():
    np.testing.assert_allclose(sky_visibility(plane(0, 0)), 1, atol=1e-12)


@pytest.mark.parametrize("angle", [10.0, 45.0, 70.0])
@pytest.mark.parametrize("way", [0.0, 33.0])
def test_an_inclined_plane_sees_its_share(angle, way):
    a, w = np.radians([angle, way])
    terrain = plane(np.tan(a) * np.sin(w), np.tan(a) * np.cos(w))
    np.testing.assert_allclose(sky_visibility(terrain), (1 + np.cos(a)) / 2, atol=2e-3)


@pytest.mark.slow
def test_a_valleys_walls_see_what_lies_between_the_rims():
    """Without an end, cos² a; with rims, (1 + cos(a + e)) / 2, e being the far rim's elevation."""
    a = np.radians(35)
    across = np.abs(np.arange(-20, 21)) * 10.0
    terrain = Land(np.tile(across * np.tan(a), (9, 1)), (10.0, 1e6))
    result = sky_visibility(terrain, count=128)[4]
    x = np.arange(1, 20)  # on the eastern wall, from the bed up
    rim = np.arctan((200 - x * 10) * np.tan(a) / (200 + x * 10))
    np.testing.assert_allclose(result[21:40], (1 + np.cos(a + rim)) / 2, atol=2e-3)
    np.testing.assert_allclose(result[19:0:-1], result[21:40], atol=1e-9)
    assert result[21] == pytest.approx(np.cos(a) ** 2, abs=0.03)


@pytest.mark.slow
def test_every_place_in_a_bowl_sees_as_much_sky():
    """Inside a sphere every piece counts alike: K is the missing cap's share, (1 + cos rim) / 2."""
    terrain = bowl(65, rim=45.0)
    array = sky_visibility(terrain, count=32)
    y, x = np.mgrid[-32:33, -32:33] / 32
    inner = np.hypot(x, y) < 0.85
    np.testing.assert_allclose(array[inner], (1 + np.cos(np.radians(45))) / 2, atol=6e-3)


def test_an_even_sky_is_what_the_closed_form_says():
    terrain = rough()
    np.testing.assert_allclose(
        sky_light(terrain, lambda azimuth, elevation: np.full_like(elevation, 3.0)),
        3 * sky_visibility(terrain),
        rtol=1e-9,
    )


@pytest.mark.slow
def test_a_sky_that_brightens_upwards():
    """L = sin(e) on flat terrain: 2 ∫ sin² e cos e de = 2/3; a hemisphere bright to the east only: half."""
    flat = plane(0, 0)
    np.testing.assert_allclose(sky_light(flat, lambda a, e: np.sin(e)), 2 / 3, rtol=1e-9)
    east = sky_light(flat, lambda a, e: np.where(np.sin(a) > 0, 1.0, 0.0))
    np.testing.assert_allclose(east, 0.5, rtol=1e-9)
    steep = plane(-1.0, 0.0)
    assert (sky_light(steep, lambda a, e: np.where(np.sin(a) > 0, 1.0, 0.0)) > 0.5).all(), (
        "it leans to the east"
    )


# Light between places


@pytest.mark.slow
def test_what_is_not_sky_is_terrain():
    for terrain in (bowl(17, rim=45.0), valley(17)):
        matrix = exchange(terrain)
        assert (matrix >= 0).all()
        whole = matrix.sum(axis=1).reshape(terrain.heights.shape) + sky_visibility(terrain)
        inner = whole[3:-3, 3:-3]
        assert (inner <= 1 + 1e-9).all()
        if terrain.name == "bowl":
            np.testing.assert_allclose(inner, 1, atol=1e-3)


@pytest.mark.slow
def test_views_are_mutual():
    """Equal faces see as much of each other: the share times the receiver's area is symmetric."""
    terrain = bowl(21, rim=50.0)
    area = 1 / terrain.normals()[..., 2].ravel()
    flow = exchange(terrain, count=128) * area[:, None]
    bed, wall = 10 * 21 + 10, 10 * 21 + 3
    blocks = [np.add.outer(np.add.outer([-21, 0, 21], [-1, 0, 1]).ravel(), [p]).ravel() for p in (bed, wall)]
    there, back = flow[np.ix_(*blocks)].sum(), flow[np.ix_(*blocks[::-1])].sum()
    assert there == pytest.approx(back, rel=0.1) and there > 0


@pytest.mark.slow
@pytest.mark.parametrize("colour", [0.3, 0.8])
def test_in_a_bowl_all_bounces_add_up_to_the_closed_form(colour):
    """Stewart and Langer's K / (1 - C (1 - K)) is exact inside a sphere: all its places are alike."""
    terrain = bowl(33, rim=50.0)
    array = bounced(terrain, sky_visibility(terrain), colour)
    k = (1 + np.cos(np.radians(50))) / 2
    y, x = np.mgrid[-16:17, -16:17] / 16
    np.testing.assert_allclose(array[np.hypot(x, y) < 0.8], k / (1 - colour * (1 - k)), atol=0.012)


@pytest.mark.slow
def test_a_valleys_walls_light_each_other():
    """Across an endless valley two faces exchange half the difference of the sines of their angles."""
    a, n, colour = np.radians(40), 25, 0.6
    across = np.abs(np.arange(-n, n + 1)) * 10.0
    terrain = Land(np.tile(across * np.tan(a), (5, 1)), (10.0, 1e6))
    result = bounced(terrain, sky_visibility(terrain, count=64), colour, count=64)[2]

    edges = np.linspace(0, n * 10.0, 8 * n + 1)  # pieces of the western wall, met from the eastern one
    middles = (edges[1:] + edges[:-1]) / 2
    position = np.stack([middles, middles * np.tan(a)], axis=1)
    far = np.stack([-edges, edges * np.tan(a)], axis=1)
    way = far[None] - position[:, None]
    along = way @ [np.cos(a), np.sin(a)] / np.linalg.norm(way, axis=2)  # sine of the angle with the normal
    share = np.diff(along, axis=1) / 2
    k = 1 - np.abs(share).sum(axis=1)
    truth = np.linalg.solve(np.eye(8 * n) - colour * np.abs(share), k)
    assert truth[0] == pytest.approx(np.cos(a) ** 2 / (1 - colour * np.sin(a) ** 2), abs=0.02)
    np.testing.assert_allclose(
        result[n + 2 : 2 * n], np.interp(across[n + 2 : 2 * n], middles, truth), atol=6e-3
    )


@pytest.mark.slow
def test_bounces_converge_and_add():
    terrain = bowl(9)
    direct = sky_visibility(terrain)
    lit = [bounced(terrain, direct, 0.5, times=t) for t in (0, 1, 2, 30)]
    np.testing.assert_array_equal(lit[0], direct)
    assert (lit[1] >= lit[0]).all() and (lit[2] >= lit[1]).all() and (lit[2] > lit[1]).any()
    np.testing.assert_allclose(lit[3], bounced(terrain, direct, 0.5), rtol=1e-6)
    np.testing.assert_array_equal(bounced(terrain, direct, 0.0), direct)

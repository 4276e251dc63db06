"""What holds for every method of lighting, each with the exemptions that its nature asks for.

Even light on flat terrain, the same light on lifted terrain, turned and mirrored light on turned
and mirrored terrain, no light where the exact shadow is dark, and sense at the ends: a sun
below the horizon, in the zenith or along an axis, spikes, walls, terrains of a texel or two.
The methods are those of ``tests/truth/methods.py``; the exact shadow is ``tests/truth``'s.
"""

from functools import cache

import numpy as np
import pytest
from scipy.ndimage import maximum_filter, minimum_filter

from ..truth.land import Land, real, towards, valley
from ..truth.methods import METHODS, SKY, SUN, Method, lit
from ..truth.sky import sky_visibility
from ..truth.sun import sunlight

HALF = 2.0**-11
OF_THE_SUN = [m for m in METHODS if m.gives == SUN]
OF_THE_SKY = pytest.mark.parametrize("method", [m for m in METHODS if m.gives == SKY], ids=lambda m: m.name)
EACH = pytest.mark.parametrize("method", OF_THE_SUN, ids=lambda m: m.name)
SLOW = pytest.mark.slow
SHADOWING = pytest.mark.parametrize("method", [m for m in OF_THE_SUN if m.shadows], ids=lambda m: m.name)


@pytest.fixture
def light(ctx, kept, tmp_path):
    """Give ``light(method, terrain, sun)``: (ny, nx, components), the visible part of the sun in alpha."""

    def make(method, terrain, sun, **more):
        result = lit(kept, tmp_path, method, terrain, sun, **more)
        assert result.shape[:2] == terrain.heights.shape and np.isfinite(result).all()
        assert result.min() >= 0 and result[..., -1].max() <= 1
        return result

    return make


def rough():
    """Real terrain, twice as high as it is, wider than deep."""
    terrain = real(49)
    return Land(terrain.heights[:37] * 2, terrain.spacing, "rough")


def flat(nx=17, ny=13):
    return Land(np.zeros((ny, nx)), (20.0, 30.0), "flat")


def spike():
    """One texel stands up."""
    heights = np.zeros((21, 25))
    heights[10, 12] = 60.0
    return Land(heights, (10.0, 15.0), "spike")


def cliff():
    """A wall, as upright as texels allow, from a plain to a plateau in the east."""
    heights = np.zeros((21, 25))
    heights[:, 12:] = 60.0
    return Land(heights, (10.0, 15.0), "cliff")


def pit():
    """One texel is a hole."""
    return Land(-spike().heights, spike().spacing, "pit")


@cache
def exact(make, sun, diameter):
    """Return a terrain and the visible share of the sun on it."""
    terrain = make()
    return terrain, sunlight(terrain, *sun, diameter=diameter, count=9)[0]


@cache
def exact_sky(make):
    """Return a terrain and how much of the sky it sees."""
    terrain = make()
    return terrain, sky_visibility(terrain, count=32)


def assert_alike(result, expected):
    """Allow the rounding of halves, soft shadows 1e-3, and one grazing ray in five hundred."""
    away = np.abs(result - expected).max(axis=-1)
    assert (away > 1e-3 + 2 * HALF).mean() <= 0.002, f"{(away > 1e-3 + 2 * HALF).sum()} of {away.size} differ"


def inner(method, result):
    """Leave out texels whose first step leaves the terrain, where the cone is wider than the sun is high."""
    return result[1:-1, 1:-1] if method.use == "night" else result


# Symmetry


@EACH
def test_flat_terrain_is_lit_evenly(light, method):
    for sun in ((250, 5), (0, 25), (135, 60), (77, 90)):
        result = inner(method, light(method, flat(), sun))
        np.testing.assert_array_equal(result, np.broadcast_to(result[0, 0], result.shape))


@EACH
def test_lifting_the_terrain_changes_nothing(light, method):
    here = light(method, rough(), (250, 20))
    for base in (2.0, -3.0):
        assert_alike(light(method, rough(), (250, 20), base=base), here)


@EACH
@pytest.mark.parametrize(
    "sun",
    [(250, 20), (90, 20), pytest.param((20, 12), marks=SLOW), pytest.param((225, 30), marks=SLOW)],
    ids=str,
)
def test_rotated_and_mirrored_terrain_rotates_and_mirrors_light(light, method, sun):
    terrain = rough()
    here = light(method, terrain, sun)
    turned = Land(np.rot90(terrain.heights, -1), terrain.spacing[::-1])  # rows go north: to the left
    assert_alike(light(method, turned, (sun[0] - 90, sun[1])), np.rot90(here, -1))
    mirrored = Land(terrain.heights[:, ::-1], terrain.spacing)
    assert_alike(light(method, mirrored, (-sun[0], sun[1])), here[:, ::-1])


@pytest.mark.parametrize(
    ("use", "values"),
    [("l_dot_n", {"normal": "one triangle"}), ("ray_cast", {"sampling": "cut down"})],
    ids=["one triangle", "cut down"],
)
def test_thesis_methods_are_exempt_from_symmetry_as_one_sided(light, use, values):
    method = Method("the thesis's", use, {"gain": 1.0, **values})
    terrain = rough()
    result = light(method, Land(terrain.heights[:, ::-1], terrain.spacing), (-20, 12))
    with pytest.raises(AssertionError, match="differ"):
        assert_alike(result, light(method, terrain, (20, 12))[:, ::-1])


# Shadows


@SHADOWING
@pytest.mark.parametrize("make", [rough, lambda: valley(33)], ids=["rough", "valley"])
def test_nothing_is_lit_that_the_exact_shadow_holds_dark(light, method, make):
    """Beyond one texel from its edge."""
    for sun in ((250, 5), (250, 20), (20, 12), (90, 10)):
        terrain, share = exact(make, sun, method.diameter)
        inside = minimum_filter(share == 0, 3)
        assert inside.mean() > 0.02
        assert light(method, terrain, sun)[inside, 3].max() <= 1e-3, sun


@EACH
@pytest.mark.parametrize("make", [spike, cliff, pit])
@pytest.mark.parametrize(
    "sun",
    [(90, 12), (250, 20), *(pytest.param(s, marks=SLOW) for s in ((0, 30), (270, 30), (45, 20)))],
    ids=str,
)
def test_sharp_terrain(light, method, make, sun):
    """The light is a number; where the exact shadow is whole, or none, for a texel around, so is this."""
    terrain, share = exact(make, sun, method.diameter)
    result = light(method, terrain, sun)[..., 3]
    # Horizons worked out beforehand are those of lines that pass up to half a texel beside the texel.
    around = 5 if method.use == "horizon_sun" else 3
    sure = (maximum_filter(share, around) == minimum_filter(share, around)) & ((share == 0) | (share == 1))
    assert sure.mean() > 0.3
    if method.shadows:
        np.testing.assert_allclose(result[sure], share[sure], atol=1e-3)


# The sun at its ends


@EACH
@pytest.mark.parametrize("elevation", [-0.01, -5.0, -90.0])
def test_a_sun_below_the_horizon_gives_no_light(light, method, elevation):
    if method.use in ("sun_disc", "horizon_sun"):
        elevation = max(elevation - 0.265, -90.0)  # a disc sets slowly
    np.testing.assert_array_equal(light(method, rough(), (135, elevation))[..., :3], 0)


@SHADOWING
@pytest.mark.parametrize("make", [rough, spike, cliff])
def test_under_the_zenith_nothing_is_hidden(light, method, make):
    terrain = make()
    result = light(method, terrain, (77, 90))
    np.testing.assert_allclose(result[..., 3], 1, atol=HALF)
    # A table of 256 x 256 normals rounds them.
    rounded = 0.012 if method.use == "horizon_sun" else 1e-4
    np.testing.assert_allclose(result[..., 0], terrain.normals()[..., 2], rtol=3 * HALF, atol=rounded)


@SHADOWING
def test_flat_terrain_sees_the_whole_sun(light, method):
    for sun in ((250, 5), (0, 25), (135, 60)):
        result = light(method, flat(), sun)
        np.testing.assert_allclose(result[..., 3], 1, atol=1e-3)
        np.testing.assert_allclose(result[..., 0], np.sin(np.radians(sun[1])), rtol=2e-3)


@SHADOWING
def test_a_sun_on_the_horizon_lights_what_faces_it(light, method):
    result = light(method, rough(), (90, 0))
    facing = (rough().normals() @ towards(90, 0)) > 0
    assert result[facing, 0].max() > 0.1 or method.diameter  # half of a disc is below the level
    np.testing.assert_array_equal(result[~maximum_filter(facing, 3), 0], 0)


@EACH
@pytest.mark.parametrize("size", [(1, 1), (2, 2), (1, 20), (20, 2), (3, 3)], ids=str)
def test_tiny_terrains_are_numbers(light, method, size):
    random = np.random.default_rng(3).uniform(0, 40, size[::-1])
    for sun in ((135, 25), (0, 10)):
        light(method, Land(random, (10.0, 15.0)), sun)
    even = light(method, flat(*size), (270, 89))
    if method.use == "night":
        return  # every texel is at the border
    np.testing.assert_array_equal(even, np.broadcast_to(even[0, 0], even.shape))
    if method.shadows:
        np.testing.assert_allclose(even[..., 3], 1, atol=HALF)


# The thesis's own soft shadows


@pytest.mark.parametrize("sun", [(250, 5), (20, 12), (90, 20)], ids=str)
def test_a_cone_tends_to_the_ray(light, sun):
    ray = light(Method("ray", "ray_cast", {"gain": 1.0}), rough(), sun)[..., 3]
    away = []
    for delta_r in (0.1, 0.01, 0.001, 0.0):
        method = Method("cone", "soft_cone", {"gain": 1.0, "delta_r": delta_r})
        cone = light(method, rough(), sun)[..., 3]
        away.append(np.abs(cone - ray).mean())
        # On the same march more than half is free exactly where the ray is.
        half = np.abs(cone - 0.5) < 2 * HALF
        np.testing.assert_array_equal((cone > 0.5)[~half], (ray == 1)[~half])
    assert away[0] > away[1] > away[2] and away[3] == 0


# The sky


@OF_THE_SKY
def test_flat_terrain_sees_the_whole_sky(light, method):
    """Exactly, but for what a half float makes of a number just below 1."""
    for terrain in (flat(), flat(1, 1), flat(2, 2), flat(1, 20), flat(20, 2)):
        result = light(method, terrain, None)[..., 0]
        np.testing.assert_allclose(result, 1, atol=1e-6 if method.output else HALF)


@OF_THE_SKY
@pytest.mark.parametrize("angle", [10.0, 45.0])
@pytest.mark.parametrize("way", [0.0, 90.0, 45.0, 20.0])
def test_an_inclined_plane_sees_its_share_of_the_sky(light, method, angle, way):
    """(1 + cos a) / 2, away from the border; eight sectors are off by 0.0065 at 45 degrees."""
    a, w = np.radians([angle, way])
    y, x = np.mgrid[0:31, 0:41]
    terrain = Land((x * 20.0 * np.sin(w) + y * 30.0 * np.cos(w)) * np.tan(a), (20.0, 30.0))
    away = light(method, terrain, None)[..., 0] - (1 + np.cos(a)) / 2
    np.testing.assert_allclose(away[8:-8, 8:-8], 0, atol=0.009)
    np.testing.assert_allclose(away, 0, atol=0.03)


@OF_THE_SKY
@pytest.mark.parametrize("angle", [20.0, 45.0])
def test_a_valleys_walls_see_what_lies_between_the_rims(light, method, angle):
    """(1 + cos(a + e)) / 2 under a far rim at elevation e, which without an end is cos² a."""
    a = np.radians(angle)
    across = np.abs(np.arange(-20, 21)) * 10.0
    terrain = Land(np.tile(across * np.tan(a), (9, 1)), (10.0, 5e4))
    result = light(method, terrain, None)[4, 21:40, 0]
    x = np.arange(1, 20) * 10.0
    rim = np.arctan((200 - x) * np.tan(a) / (200 + x))
    np.testing.assert_allclose(result, (1 + np.cos(a + rim)) / 2, atol=0.01)


@OF_THE_SKY
def test_lifting_turning_and_mirroring_the_terrain_under_the_sky(light, method):
    terrain = rough()

    def sky(terrain, **more):
        return light(method, terrain, None, **more)[..., :1]

    here = sky(terrain)
    assert_alike(sky(terrain, base=2.0), here)
    assert_alike(sky(Land(terrain.heights[:, ::-1], terrain.spacing)), here[:, ::-1])
    assert_alike(sky(Land(np.rot90(terrain.heights, -1), terrain.spacing[::-1])), np.rot90(here, -1))


@OF_THE_SKY
@pytest.mark.parametrize("size", [(2, 2), (1, 20), (20, 2), (3, 3)], ids=str)
def test_the_sky_over_tiny_terrains_is_numbers(light, method, size):
    random = np.random.default_rng(3).uniform(0, 40, size[::-1])
    light(method, Land(random, (10.0, 15.0)), None)


@OF_THE_SKY
@pytest.mark.parametrize("make", [spike, cliff, pit])
def test_the_sky_over_sharp_terrains(light, method, make):
    terrain, seen = exact_sky(make)
    assert np.abs(light(method, terrain, None)[..., 0] - seen).mean() < 0.01

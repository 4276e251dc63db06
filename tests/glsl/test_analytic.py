"""The sun by horizon angles, and sun, sky and terrain together: eqs 3.3 to 3.8 against float64.

``light`` is rgba16f and angles have 16 bits: comparisons allow for what they cut off.
"""

import numpy as np
import pytest

from ..truth.land import Land, real, towards
from ..truth.sun import sunlight
from .terrains import lit_by

HALF = 2.0**-10
ARC = "lighting/horizon_sun/arc.glsl"
SHARE = 90 / 65535  # [degrees] of a 16-bit share of a quarter circle


@pytest.fixture
def sketch(ctx, tmp_path):
    """Give ``sketch(terrain, use, **values)``: a technique of lighting/ as the pass ``light``."""

    def make(terrain, use, **more):
        return lit_by(tmp_path, terrain, "light", use, **more)

    return make


@pytest.fixture
def read(kept, sketch):
    """Give ``read(terrain, use, *outputs, **values)``: a technique's outputs, float64."""

    def make(terrain, use, *outputs, **values):
        made = sketch(terrain, use, **values)
        result = [kept.read(made, f"light:{output}").astype(np.float64) for output in outputs]
        assert all(np.isfinite(f).all() for f in result)
        return result[0] if len(result) == 1 else result

    return make


def steep(n=49):
    return Land(real(n).heights * 2, (74.0, 93.0), "steep")


def horizons(ahead, behind, terrain, arc=0.0):
    """Return effective horizons [degrees] in eight directions from tangents: over the slope, over level."""
    east, north = terrain.slopes()
    tangents = np.concatenate([ahead, behind], axis=-1)
    way = np.radians(arc - 45.0 * np.arange(8))
    own = east[..., None] * np.sin(way) + north[..., None] * np.cos(way)
    return np.degrees(np.arctan(np.maximum(np.maximum(tangents, own), 0)))


def visible(elevation, horizon, diameter=0.53):
    """Eq. 3.8, with the angles of eqs 3.5 and 3.6."""
    low, high = elevation - diameter / 2, elevation + diameter / 2
    return np.clip((high - horizon) / (high - low), 0, 1)


# The sun's disc and arc


def test_visibility_falls_evenly_over_the_disc(on_gpu):
    horizon = np.linspace(20, 26, 61).astype(np.float32)
    result = on_gpu(ARC, "disc_seen(in_diameters(24.0, 2.0), in_diameters(horizon, 2.0))", horizon=horizon)
    np.testing.assert_allclose(result, visible(23.0, horizon.astype(np.float64), 2.0), atol=1e-5)
    assert result[0] == 1 and result[-1] == 0 and result[30] == pytest.approx(0.5)


def test_it_differs_from_the_discs_area_by_0_058(on_gpu):
    """The area of a disc over a line at x radii over its middle, by sums over its rows."""
    x = np.linspace(-1, 1, 401)
    result = on_gpu(
        ARC, "disc_seen(in_diameters(1.0, 2.0), in_diameters(horizon, 2.0))", horizon=x.astype(np.float32)
    )
    rows = np.linspace(-1, 1, 200_001)
    width = np.sqrt(np.maximum(1 - rows**2, 0))
    area = 1 - np.interp(x, rows, np.cumsum(width) / width.sum())
    difference = np.abs(result - area).max()
    assert 0.056 < difference < 0.0585


def test_a_sun_of_no_width_is_there_or_not(on_gpu):
    horizon = np.array([9.9, 10.1], np.float32)
    result = on_gpu(ARC, "disc_seen(in_diameters(10.0, 0.0), in_diameters(horizon, 0.0))", horizon=horizon)
    np.testing.assert_array_equal(result, [1, 0])


@pytest.mark.parametrize("arc", [90.0, 135.0, 10.0, -70.0])
def test_a_sun_off_its_arc_takes_eight_horizons(on_gpu, arc):
    away, elevation = (v.ravel() for v in np.meshgrid(np.arange(0, 360, 10.0), [5.0, 40.0, 85.0, 90.0]))
    sun = towards(arc + away, elevation).astype(np.float32)
    eight = on_gpu(ARC, f"int(directions_for(sun, {arc}, ARC, false) == EIGHT)", sun=sun)
    np.testing.assert_array_equal(eight == 1, (away % 180 != 0) & (elevation < 90))


@pytest.mark.parametrize("arc", [0.0, 135.0])
def test_between_eight_horizons(on_gpu, arc):
    azimuth = np.arange(0, 360, 9.0)
    sun = towards(azimuth, 30.0).astype(np.float32)
    which, weights = (
        on_gpu(ARC, f"vec2(between_horizons(sun, {arc}, EIGHT).{part})", sun=sun)
        for part in ("which", "weights")
    )
    np.testing.assert_allclose(weights.sum(axis=-1), 1, atol=1e-5)
    assert weights.min() >= 0
    # A horizon that rises evenly from direction to direction is met everywhere but where it falls back.
    places = which.astype(int)
    around = np.stack([np.array([0, 4, 2, 6])[places[:, 0]], np.array([1, 5, 3, 7])[places[:, 1]]], axis=-1)
    turn = ((arc - azimuth) / 45) % 8
    inner = turn <= 7
    np.testing.assert_allclose((weights * around).sum(axis=-1)[inner], turn[inner], atol=1e-4)
    steps = np.abs(around[:, 0] - around[:, 1])
    assert set(steps) <= {1, 7}, "neighbours, also where the last is beside the first"
    assert np.isfinite(
        on_gpu(ARC, "between_horizons(vec3(0.0, 0.0, 1.0), 0.0, EIGHT).weights.x + z", z=np.float32(0))
    )


@pytest.mark.parametrize("azimuth", [30.0, 200.0])
def test_of_two_horizons_a_sun_on_its_arc_has_one(on_gpu, azimuth):
    sun = towards(np.array([azimuth, azimuth + 180.0]), 30.0).astype(np.float32)
    which, weights = (
        on_gpu(ARC, f"vec2(between_horizons(sun, {azimuth}, ARC).{part})", sun=sun)
        for part in ("which", "weights")
    )
    np.testing.assert_array_equal(which, [[0, 0], [1, 0]])
    np.testing.assert_array_equal(weights, [[1, 0], [1, 0]])


# Angles


def test_angles_are_shares_of_a_quarter_circle_over_the_slope(kept, sketch):
    terrain = steep()
    made = sketch(terrain, "horizon_sun", arc=20.0)
    parts = [kept.read(made, f"light.angles:{which}") for which in ("upright", "slanting")]
    maps = [kept.read(made, f"light:{side}").astype(np.float64) for side in ("ahead", "behind")]
    result = 90 * np.concatenate(parts, axis=-1)[..., [0, 4, 2, 6, 1, 5, 3, 7]].astype(np.float64)
    np.testing.assert_allclose(result, horizons(*maps, terrain, 20.0), atol=SHARE + 2e-3)
    assert result.min() == 0 and result.max() > 25


def test_the_table_holds_every_normal(kept, sketch):
    sun = (200.0, 35.0)
    made = sketch(steep(17), "horizon_sun", sun=sun, arc=200.0, gain=1.5, sun_colour=(1.0, 0.5, 0.2))
    table = kept.read(made, "light.table").astype(np.float64)
    x, y = np.meshgrid(np.arange(256), np.arange(256))
    level = (np.stack([x, y], axis=-1) - 128) / 127
    up = np.sqrt(np.maximum(1 - (level**2).sum(axis=-1), 0))
    received = np.maximum(np.concatenate([level, up[..., None]], axis=-1) @ towards(*sun), 0)
    truth = 1.5 * received[..., None] * [1.0, 0.5, 0.2]
    np.testing.assert_allclose(table[..., :3], truth, rtol=2 * HALF, atol=1e-4)


# The sun


@pytest.mark.parametrize("sun", [(135, 12), (315, 12), (135, 40), (315, 2), (135, 90)], ids=str)
def test_the_sun_on_its_arc(read, sun):
    terrain = steep()
    values = {"sun": sun, "arc": 135.0, "gain": 1.0, "sun_term": "each texel"}
    light, seen, ahead, behind = read(
        terrain, "horizon_sun", "light", "visibility", "ahead", "behind", **values
    )
    channel = 0 if sun[0] == 135 else 4
    horizon = horizons(ahead, behind, terrain, 135.0)[..., channel]
    # What 16 bits of an angle and a half float of a tangent leave open, over the sun's width.
    np.testing.assert_allclose(seen, visible(sun[1], horizon), atol=0.02)
    received = np.maximum(terrain.normals() @ towards(*sun), 0)
    np.testing.assert_allclose(light[..., 0], seen * received, rtol=2 * HALF, atol=2e-3)
    np.testing.assert_allclose(light[..., 3], np.where(light[..., 0] > 0, seen, 0), atol=2e-3)


def test_a_table_of_normals_is_close(read):
    terrain = steep()
    values = {"sun": (135, 30), "gain": 1.0}
    table, each = (
        read(terrain, "horizon_sun", "light", sun_term=way, **values) for way in ("table", "each texel")
    )
    np.testing.assert_allclose(table[..., :3], each[..., :3], atol=0.008)
    # Alpha is 0 where a surface is turned away: which of two normals of the table that is, is
    # uncertain where light only grazes it.
    clear = (each[..., 0] == 0) == (table[..., 0] == 0)
    assert clear.mean() > 0.99
    np.testing.assert_allclose(table[clear], each[clear], atol=0.008)
    flat = Land(np.zeros((9, 9)), (10.0, 10.0))
    level = read(flat, "horizon_sun", "light", **values)
    np.testing.assert_allclose(level, np.broadcast_to([0.5, 0.5, 0.5, 1.0], level.shape), rtol=2 * HALF)


def test_eight_directions_at_one_of_them_are_the_arc(read):
    terrain = steep()
    for azimuth in (0.0, 45.0, 225.0, 270.0):
        ways = [
            read(
                terrain,
                "horizon_sun",
                "visibility",
                sun=(azimuth, 14.0),
                arc=0.0,
                measured="eight directions",
            ),
            read(terrain, "horizon_sun", "visibility", sun=(azimuth, 14.0), arc=azimuth),
        ]
        # Measured from elsewhere, a direction is another pair's, whose lines lie a little beside.
        assert (np.abs(ways[0] - ways[1]) > 0.1).mean() < 0.01


def test_two_directions_are_enough_for_the_arc(read):
    terrain = steep()
    two, eight = (read(terrain, "horizon_sun", "light", sun=(135, 15), directions=n) for n in (2, 8))
    np.testing.assert_allclose(two, eight, atol=2e-3)


def ran(kept):
    """Return what ran for the last picture, but for what only a software renderer knows to be the same."""
    return sorted(set(kept.record.ran) - (set() if kept.info.software else {"light.between"}))


@pytest.mark.parametrize("use", ["horizon_sun", "analytic"])
def test_moving_the_sun_looks_at_no_terrain(kept, sketch, use):
    # Of the same gain, the tables of both are the same, and cached.
    own = {"arc": 135.0, "gain": 1.1} if use == "horizon_sun" else {"gain": 1.2}
    made = sketch(steep(33), use, sun=(138, 20), **own)
    kept.read(made, "light")
    for sun in ((140, 20), (140, 60)):
        kept.read(made.with_values({"light.sun": sun}), "light")
        assert ran(kept) == ["light.light", "light.stand", "light.table"]
    kept.read(made.with_values({"light.sun": (140, 60), "light.sun_colour": (1.0, 0.8, 0.5)}), "light")
    assert ran(kept) == ["light.light", "light.table"]


def test_sun_between_two_other_horizons_reads_those_two(kept, sketch):
    made = sketch(steep(33), "horizon_sun", measured="eight directions", arc=0.0)
    for azimuth, taken in (
        (100, True),
        (91, False),
        (88, True),
        (46, False),
        (44, True),
        (1, False),
        (359, True),
    ):
        moved = made.with_values({"light.sun": (azimuth, 15)})
        result = kept.read(moved, "light:visibility")
        if kept.info.software:
            assert ("light.between" in kept.record.ran) == taken, azimuth
        angles = [kept.read(moved, f"light.angles:{name}") for name in ("upright", "slanting")]
        around = 90 * np.concatenate(angles, axis=-1)[..., [0, 4, 2, 6, 1, 5, 3, 7]].astype(np.float64)
        sector = (-azimuth / 45) % 8
        first, beyond = int(sector), sector % 1
        horizon = (1 - beyond) * around[..., first] + beyond * around[..., (first + 1) % 8]
        # An arc tangent's 1e-5, as a fraction of 45 degrees between two horizons, over the sun's width; and
        # three roundings of floats near 60 diameters.
        steepest = np.abs(np.diff(around, axis=-1, append=around[..., :1])).max()
        bound = np.degrees(1e-5) / 45 * steepest / 0.53 + 4 * 2**-18
        np.testing.assert_allclose(result, visible(15.0, horizon), atol=bound)


@pytest.mark.parametrize("azimuth", [30.0, 225.0, 300.0])
def test_unless_set_the_arc_is_under_the_sun(read, azimuth):
    """The light of a sun of any azimuth is what the truth says, and not that of a sun in the zenith."""
    terrain = steep(33)
    light = read(terrain, "horizon_sun", "light", sun=(azimuth, 18.0), gain=1.0)
    np.testing.assert_array_equal(
        light, read(terrain, "horizon_sun", "light", sun=(azimuth, 18.0), arc=azimuth, gain=1.0)
    )
    _, truth = sunlight(terrain, azimuth, 18.0)
    assert light[..., 0].mean() == pytest.approx(truth.mean(), abs=0.02)
    assert np.abs(light[..., 0] - truth).mean() < 0.03


@pytest.mark.parametrize("directions", [2, 8])
@pytest.mark.parametrize("way", [{"arc": 70.0}, {"arc": 205.0}, {"measured": "eight directions"}], ids=str)
def test_a_sun_off_its_arc_is_lit_from_its_own_azimuth(read, way, directions):
    """As much light as the truth has, but for the horizon that is rounded off between two of eight."""
    terrain = Land(real(65).heights * 2, (90.0, 90.0), "real")
    values = {"sun": (110.0, 15.0), "gain": 1.0, "directions": directions}
    light = read(terrain, "horizon_sun", "light", **way, **values)[..., 0]
    _, truth = sunlight(terrain, 110.0, 15.0)
    assert light.mean() == pytest.approx(truth.mean(), rel=0.05)
    # Where the sun is over the horizon in all eight directions, it shines in full.
    open_to_sun = read(terrain, "horizon_sun", "visibility", **way, **values) == 1
    normals = np.maximum(terrain.normals() @ towards(110.0, 15.0), 0)
    np.testing.assert_allclose(light[open_to_sun], normals[open_to_sun], atol=0.01)


def test_free_arc_sun_is_remeasured_when_azimuth_changes(kept, sketch):
    made = sketch(steep(33), "horizon_sun")
    kept.read(made, "light")
    kept.read(made.with_values({"light.sun": (135, 60)}), "light")
    assert ran(kept) == ["light.light", "light.stand", "light.table"]
    kept.read(made.with_values({"light.sun": (140, 60)}), "light")
    assert any("horizons" in path for path in kept.record.ran)
    eight = made.with_values({"light.measured": "eight directions", "light.sun": (140, 60)})
    kept.read(eight, "light")
    kept.read(eight.with_values({"light.sun": (150, 60)}), "light")
    assert ran(kept) == ["light.light", "light.stand", "light.table"]


def test_a_daylights_sun_keeps_to_no_arc(kept, sketch):
    """Its azimuth is in no parameter: it takes eight horizons, whatever is set for the sun."""
    passes = (
        '[[pass]]\nname = "daylight"\nuse = "lighting/daylight"\nset = { hour = 16.0, latitude = 40.0 }\n'
    )
    terrain = steep(33)
    arc, eight = (
        kept.read(sketch(terrain, "horizon_sun", passes=passes, arc=0.0, measured=way), "light")
        for way in ("on its arc", "eight directions")
    )
    np.testing.assert_array_equal(arc, eight)


# Sun, sky and terrain together


def test_analytic_is_the_sum_of_its_parts(read):
    terrain = steep()
    sun = {"sun": (100, 25), "sun_colour": (1.0, 0.9, 0.7), "gain": 1.4}
    sky = {"sky_colour": (0.4, 0.6, 1.0), "ambient": 0.5}
    ground = {"ground": (0.3, 0.2, 0.1)}
    whole, factor = read(terrain, "analytic", "light", "factor", arc=0.0, **sun, **sky, **ground)
    alone = read(terrain, "horizon_sun", "light", arc=0.0, measured="eight directions", **sun)
    of_sky = read(terrain, "horizon_sky", "light", **sky, **ground)
    np.testing.assert_allclose(whole[..., :3], alone[..., :3] + of_sky[..., :3], atol=4e-3)
    np.testing.assert_allclose(of_sky[..., :3], 0.5 * factor[..., :3] * [0.4, 0.6, 1.0], atol=2e-3)
    np.testing.assert_array_equal(whole[..., 3], alone[..., 3])


def test_clouds_dim_the_sun_and_leave_the_sky(read):
    terrain = steep(33)
    lights = [read(terrain, "analytic", "light", clouds=c)[..., :3] for c in (0.0, 0.5, 1.0)]
    np.testing.assert_allclose(lights[1], (lights[0] + lights[2]) / 2, atol=2e-3)
    sky = read(terrain, "analytic", "light", gain=0.0)[..., :3]
    np.testing.assert_allclose(lights[2], sky, atol=1e-3)
    each = read(terrain, "analytic", "light", clouds=0.5, sun_term="each texel")[..., :3]
    np.testing.assert_allclose(each, lights[1], atol=0.012)


def test_daylight_takes_the_place_of_sun_and_sky(kept, sketch):
    """A daylight that is wired says where the sun is, whatever the sun's own parameters."""
    passes = '[[pass]]\nname = "daylight"\nuse = "lighting/daylight"\nset = { hour = 9.0, latitude = 40.0 }\n'
    terrain = steep(33)
    first, second = (
        kept.read(sketch(terrain, "analytic", passes=passes, sun=sun), "light")
        for sun in ((10, 5), (200, 70))
    )
    np.testing.assert_array_equal(first, second)
    assert first[..., 3].max() == 1


FACTOR = """#include "noise/hash.glsl"
#pragma kernel(output = "factor:rgba16f")
vec4 kernel(ivec2 texel) {
    ivec2 node = texel * 32 / (size - 1);
    return vec4(random(node, 1u), random(node, 2u), random(node, 3u), 1.0);
}
"""


def test_equal_size_sky_factor_matches_finer_one_at_same_texels(any_engine, make_sketch):
    """Of one as large as the light a texel is fetched, of another what is between its texels."""
    text = '[[pass]]\nname = "height"\nuse = "generation/diamond_square"\n'
    for name, size in (("same", 33), ("finer", 65)):
        text += f'[[pass]]\nname = "{name}"\nuse = "./factor"\nsize = {size}\n'
        text += f'[[pass]]\nname = "{name}_light"\nuse = "lighting/horizon_sun"\n'
        text += f'inputs = {{ sky_factor = "{name}:factor" }}\nset = {{ sun = [120, 20], ambient = 0.7 }}\n'
    sketch = make_sketch(text, size=33, factor=FACTOR)
    result = any_engine.read(sketch, "same_light:light")
    assert result.std() > 0.05
    np.testing.assert_array_equal(result, any_engine.read(sketch, "finer_light:light"))

"""Horizons: the march against brute force in float64, the sweep (lighting/horizons.comp) against the march.

Horizons are compared as elevations in degrees. They are kept as tangents in half floats, which
is 0.03 degrees at most. The sweep finds rows on which a texel may see its horizon from a line that
runs beside it, and looks at these rows from the texel itself: so it is never over the march, and
under it only where the line saw other rows. By how much is bounded on any terrain (the derivation is
in lighting/horizons/sweep.glsl); on terrains from real to white noise it is much less.
"""

import numpy as np
import pytest

from playground.engine.engine import Engine

from ..sketch_texts import passes, use
from ..truth.land import Land, cone, real, valley
from ..truth.marches import Views
from ..truth.methods import sketch_of

SUN = 0.53  # [degrees] across: a horizon that is off by as much makes day of night
ROUNDING = 0.03  # [degrees] of a half float's tangent, wherever it is cut off
BOUND = float(np.degrees(np.arctan(0.05)))  # that the sweep may be under, on any terrain
CHIEF = np.array([0, -45, -90, -135, 180, 135, 90, 45])


@pytest.fixture(scope="module")
def kept(shared_context):
    """Give two engines for the file, so that programs are compiled once: one marches, one sweeps."""
    if shared_context.version_code < 430:
        pytest.skip("this context has no compute shaders")
    shared_context.__enter__()
    with (
        Engine(shared_context, driver="fragment") as march,
        Engine(shared_context, driver="compute") as sweep,
    ):
        yield march, sweep


@pytest.fixture
def engines(ctx, kept):
    return kept


@pytest.fixture
def marcher(engines):
    return engines[0]


@pytest.fixture
def measured(tmp_path):
    """Give ``measured(engine, terrain, **values)``: elevations [degrees] (ny, nx, 8), K, heights [m]."""

    def measure(engine, terrain, *, size=None, base=0.0, **values):
        text = passes(horizons=use("lighting/horizons", size=size, **values))
        sketch = sketch_of(tmp_path, terrain, text, base=base)
        maps = [engine.read(sketch, f"horizons:{name}") for name in ("ahead", "behind")]
        tangents = np.concatenate(maps, axis=-1).astype(np.float64)
        assert np.isfinite(tangents).all() and tangents.min() >= 0 and tangents.max() <= 60000
        k, heights = engine.read(sketch, "horizons:sky"), engine.read(sketch, "horizons:land")
        assert np.isfinite(k).all() and k.min() >= 0 and k.max() <= 1
        return np.degrees(np.arctan(tangents)), k.astype(np.float64), heights

    return measure


def brute(terrain, azimuth, rows=None, beyond=0.5):
    """Return the horizon's elevation [degrees], every row looked at, all texels at a time, float64.

    Rays leave the terrain half a texel beyond its edge, where its heights go on as at the edge.
    """
    views = Views(terrain.heights, azimuth, terrain.spacing, beyond=beyond)
    return np.degrees(np.arctan(views.tangents(rows)))


def brute_from(terrain, y, x, azimuth):
    """Return the horizon's elevation [degrees] from one texel, every row looked at, float64."""
    ny, nx = terrain.heights.shape
    way = np.array([np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))]) / terrain.spacing
    row = 1 / np.abs(way).max()  # [m]
    k = np.arange(1, max(nx, ny))
    px, py = x + k * row * way[0], y + k * row * way[1]
    on = (px >= -0.5) & (py >= -0.5) & (px <= nx - 0.5) & (py <= ny - 0.5)
    there = terrain.at(np.clip(px[on], 0, nx - 1), np.clip(py[on], 0, ny - 1))
    rises = (there - terrain.heights[y, x]) / (k[on] * row)
    return np.degrees(np.arctan(max(rises.max(initial=0.0), 0.0)))


def ragged(nx=61, ny=45, seed=3):
    """Rough terrain on oblong texels, steep, with walls and needles on it."""
    rng = np.random.default_rng(seed)
    terrain = real(97).heights[:ny, :nx] * 2.0
    terrain[:, nx // 2 :] += 200.0
    terrain[ny // 3, nx // 4] += 900.0
    return Land(terrain + rng.random((ny, nx)), (40.0, 75.0), "ragged")


def off(result, expected):
    return np.abs(result - expected)


def rough(exponent, spacing, shape=(97, 97), seed=1):
    """Terrain whose spectrum falls by that exponent: 0 is white noise, 1.8 mountains."""
    fy, fx = np.meshgrid(np.fft.fftfreq(shape[0]), np.fft.fftfreq(shape[1]), indexing="ij")
    far = np.hypot(fx, fy)
    far[0, 0] = 1
    grid = np.random.default_rng(seed).standard_normal(shape)
    terrain = np.fft.ifft2(np.fft.fft2(grid) / far**exponent).real
    terrain = (terrain - terrain.min()) / np.ptp(terrain)
    return Land(terrain * (60 if exponent == 0 else 300), spacing, f"spectrum {exponent} on {spacing}")


def real_times(times):
    """Return real terrain made steeper: half of its slopes are over 20, 35 and 55 degrees at 1, 3 and 6."""
    return Land(real(97).heights * times, real(97).spacing, f"real x {times}")


def rms(values):
    return float(np.sqrt((values**2).mean()))


# Courses


@pytest.mark.parametrize("metres", [(1.0, 1.0), (74.0, 93.0), (10.0, 35.0)], ids=str)
def test_a_course_keeps_its_direction(on_gpu, metres):
    azimuth = np.arange(0, 360, 7.5)
    way = np.stack([np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))], axis=-1)
    call = "course_towards(towards, ivec2(65, 49), metres)"
    arrays = {"towards": way.astype(np.float32), "metres": tuple(np.float32(metres))}
    drift = on_gpu("lighting/horizons/course.glsl", f"float({call}.drift)", **arrays) / 65536.0
    along_x = on_gpu("lighting/horizons/course.glsl", f"int({call}.along_x)", **arrays) == 1
    up = np.where(on_gpu("lighting/horizons/course.glsl", f"int({call}.upwards)", **arrays) == 1, 1.0, -1.0)
    steep = on_gpu("lighting/horizons/course.glsl", f"{call}.steep", **arrays)
    row = np.where(along_x[:, None], np.stack([up, drift], -1), np.stack([drift, up], -1)) * metres
    length = np.hypot(*row.T)
    np.testing.assert_allclose(row / length[:, None], way, atol=2e-5)
    np.testing.assert_allclose(1 / length, steep, rtol=2e-5)


def test_opposite_courses_have_the_same_lines(on_gpu):
    azimuth = np.repeat(np.arange(0, 360, 11.25), 33)
    way = np.stack([np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))], axis=-1).astype(np.float32)
    row = np.tile(np.arange(33), 32).astype(np.int32)
    for grid in ("ivec2(33)", "ivec2(33, 33)", "ivec2(40, 36)"):
        there = f"course_towards(way, {grid}, vec2(20.0, 31.0))"
        back = f"course_towards(-way, {grid}, vec2(20.0, 31.0))"
        arrays = {"way": way, "row": row}
        ahead = on_gpu("lighting/horizons/course.glsl", f"drifted({there}, row)", **arrays)
        behind = on_gpu("lighting/horizons/course.glsl", f"drifted({back}, {back}.rows - 1 - row)", **arrays)
        np.testing.assert_array_equal(ahead, behind)
        beside = on_gpu("lighting/horizons/course.glsl", f"offset_of({there}, row)", **arrays)
        assert np.abs(beside).max() <= 0.5


@pytest.mark.parametrize("asked", range(2, 66, 2))
def test_pairs_are_all_directions_once(on_gpu, asked):
    directions = max(asked // 8 * 8, 2)
    pairs = on_gpu("lighting/horizons/course.glsl", f"pairs_of({asked})")
    assert pairs == directions // 2
    pair = np.arange(directions // 2).astype(np.int32)
    call = f"pair_towards(pair, pairs_of({asked}), 10.0)"
    way = on_gpu("lighting/horizons/course.glsl", call, pair=pair)
    azimuth = np.degrees(np.arctan2(way[:, 0], way[:, 1])) - 10
    both = np.sort(np.concatenate([azimuth, azimuth + 180]) % 360)
    apart = 360 / directions
    gaps = np.round(both / apart, 3) % directions
    np.testing.assert_allclose(np.sort(gaps), np.arange(directions), atol=2e-3)
    if directions > 2:
        np.testing.assert_allclose(azimuth[:4] % 360, [0, 315, 270, 225], atol=1e-3)


# The march


@pytest.mark.parametrize("terrain", [ragged(), cone(49), valley(49)], ids=lambda terrain: terrain.name)
def test_the_march_is_brute_force(marcher, measured, terrain):
    result, _, heights = measured(marcher, terrain)
    low, relief = terrain.heights.min(), np.ptp(terrain.heights)
    seen = Land(heights.astype(np.float64) * relief, terrain.spacing)
    np.testing.assert_allclose(seen.heights, terrain.heights - low, atol=1e-6 * relief)
    for channel, azimuth in enumerate(CHIEF):
        assert off(result[..., channel], brute(seen, azimuth)).max() < ROUNDING


def test_first_turns_the_directions(engines, measured):
    terrain = ragged(33, 29)
    for engine in engines:
        turned, _, _ = measured(engine, terrain, first=30.0)
        assert rms(off(turned[..., 1], brute(terrain, -15.0))) < (0.03 if engine is engines[0] else 0.1)


# The sweep against the march


def test_along_axes_and_diagonals_the_sweep_is_the_march(engines, measured):
    for terrain in (real(49), ragged(41, 53)):
        square = Land(terrain.heights, (50.0, 50.0), terrain.name)
        march, sweep = (measured(engine, square) for engine in engines)
        for channel in range(8):
            assert off(sweep[0][..., channel], march[0][..., channel]).max() < ROUNDING
        np.testing.assert_allclose(sweep[1], march[1], atol=2e-4)
        np.testing.assert_array_equal(sweep[2], march[2])


LANDS = [
    *(real_times(times) for times in (1, 3, 6)),
    cone(97),
    valley(97),
    rough(0, (20.0, 50.0)),
    rough(1.5, (20.0, 50.0)),
    rough(1.5, (50.0, 20.0), (60, 97)),
    rough(1.8, (30.0, 30.0)),
]


@pytest.mark.parametrize("terrain", LANDS, ids=lambda terrain: terrain.name)
def test_in_any_direction_the_sweep_is_close_to_the_march(engines, measured, terrain):
    """Never over it; at the border as inside; a tenth of the sun's diameter, and few by a whole one."""
    wrong = []
    for first in (0.0, 11.25, 17.0):
        march, sweep = (measured(engine, terrain, first=first) for engine in engines)
        assert (sweep[0] - march[0]).max() < ROUNDING
        np.testing.assert_allclose(sweep[1], march[1], atol=0.01)
        wrong.append(off(sweep[0], march[0]))
    assert rms(np.array(wrong)) < SUN / 10
    assert (np.array(wrong) > SUN).mean() < 0.002
    assert np.max(wrong) < BOUND + ROUNDING


def needles(shape, n, seed):
    """Texels that stand up to 900 m over rough ground."""
    rng = np.random.default_rng(seed)
    heights = 20 * rng.random(shape)
    heights[rng.integers(0, shape[0], n), rng.integers(0, shape[1], n)] += 900 * rng.random(n)
    return heights


def one_needle(seed):
    """Return a plain with one needle, not at the same texel for each seed."""
    heights = np.zeros((65, 65))
    heights[21 + 7 * seed, 32 + 5 * seed] = 900
    return heights


def cliffs(seed, shape=(67, 90)):
    """Steps of up to 300 m along straight lines in any direction."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[: shape[0], : shape[1]]
    heights = np.zeros(shape)
    for turn, at, step in rng.random((6, 3)):
        heights += 300 * step * (x * np.cos(np.pi * turn) + y * np.sin(np.pi * turn) > 60 * at)
    return heights


def walls(seed, shape=(66, 91)):
    """Ridges one texel wide, along rows and columns."""
    rng = np.random.default_rng(seed)
    heights = np.zeros(shape)
    heights[:, rng.integers(0, shape[1], 3)] += 400 * rng.random(3)
    heights[rng.integers(0, shape[0], 3)] += 400 * rng.random((3, 1))
    return heights


ROUGH = {
    "one needle": one_needle,
    "few needles": lambda seed: needles((61, 83), 6, seed),
    "many needles": lambda seed: needles((80, 57), 800, seed),
    "cliffs": cliffs,
    "walls": walls,
    "real x 3": lambda seed: 3 * real(65 + seed).heights,
}


@pytest.mark.parametrize("spacing", [(74.0, 93.0), (120.0, 60.0), (50.0, 200.0), (10.0, 70.0)], ids=str)
@pytest.mark.parametrize("kind", ROUGH)
def test_no_terrain_breaks_the_bound_of_the_sweep(engines, measured, kind, spacing):
    """Needles, cliffs and walls, which lines between texels miss, against brute force in float64."""
    for seed, first in ((0, 0.0), (1, 17.0)):
        terrain = Land(ROUGH[kind](seed), spacing)
        result, k, heights = measured(engines[1], terrain, first=first)
        seen = Land(heights.astype(np.float64) * np.ptp(terrain.heights), spacing)
        # A ray that meets the border within rounding is on the terrain or not.
        least, most = (
            np.stack([brute(seen, first + azimuth, beyond=beyond) for azimuth in CHIEF], axis=-1)
            for beyond in (0.499, 0.501)
        )
        assert (result - most).max() < ROUNDING and (result - least).min() > -BOUND - ROUNDING
        assert off(k, measured(engines[0], terrain, first=first)[1]).max() < 0.65 * 0.05


def test_wide_terrain_has_the_horizons_of_brute_force(engines, measured):
    """A thousand rows, seen from texels here and there: most horizons are hundreds of rows away."""
    terrain = rough(1.8, (30.0, 30.0), (640, 1025))
    result, _, heights = measured(engines[1], terrain, first=7.0)
    seen = Land(heights.astype(np.float64) * np.ptp(terrain.heights), terrain.spacing)
    rng = np.random.default_rng(0)
    wrong = []
    for y, x in zip(rng.integers(0, 640, 60), rng.integers(0, 1025, 60), strict=True):
        exact = [brute_from(seen, int(y), int(x), 7.0 + azimuth) for azimuth in CHIEF]
        wrong.append(result[y, x] - exact)
    assert np.max(wrong) < ROUNDING
    assert rms(np.array(wrong)) < SUN / 10 and np.abs(wrong).max() < BOUND + ROUNDING


def test_a_horizon_near_by_is_exact(engines, measured):
    """The sixteen rows next to a texel are looked at from the texel itself."""
    terrain = ragged(97, 80)
    result, _, heights = measured(engines[1], terrain, first=20.0)
    seen = Land(heights.astype(np.float64) * np.ptp(terrain.heights), terrain.spacing)
    for channel, azimuth in enumerate(CHIEF):
        whole, near = brute(seen, 20.0 + azimuth), brute(seen, 20.0 + azimuth, rows=16)
        close = whole == near
        assert close.mean() > 0.3
        assert off(result[..., channel], whole)[close].max() < ROUNDING


@pytest.mark.parametrize("directions", [2, 16, 64])
def test_k_of_more_directions(engines, measured, directions):
    terrain = real(49)
    march, sweep = (measured(engine, terrain, directions=directions) for engine in engines)
    assert rms(sweep[1] - march[1]) < 0.0015
    for engine, maps in zip(engines, (march[0], sweep[0]), strict=True):
        np.testing.assert_array_equal(maps, measured(engine, terrain, directions=8)[0])


def test_direction_count_rounds_down_to_supported_value(engines, measured):
    terrain = real(33)
    for engine in engines:
        for asked, taken in ((6, 2), (12, 8), (30, 24)):
            first, other = (measured(engine, terrain, directions=n) for n in (asked, taken))
            for result, expected in zip(first, other, strict=True):
                np.testing.assert_array_equal(result, expected)


@pytest.mark.parametrize("directions", [2, 16])
def test_without_the_maps_k_is_the_same(engines, measured, directions):
    terrain = real(49)
    for engine in engines:
        both, alone = (measured(engine, terrain, directions=directions, keep=keep) for keep in (True, False))
        np.testing.assert_array_equal(alone[1], both[1])
        assert both[0].max() > 1 and (alone[0] == 0).all()


@pytest.mark.parametrize("shape", [(9, 200), (200, 9), (3, 64), (37, 130)], ids=str)
def test_long_terrains(engines, measured, shape):
    """A line leaves such a terrain after a few rows, and the room for lines is used again and again."""
    rng = np.random.default_rng(1)
    heights = np.cumsum(rng.standard_normal(shape), axis=int(shape[1] > shape[0])) * 8
    terrain = Land(heights, (30.0, 30.0))
    march, sweep = (measured(engine, terrain) for engine in engines)
    for channel in range(8):
        assert off(sweep[0][..., channel], march[0][..., channel]).max() < ROUNDING


@pytest.mark.parametrize(
    "shape", [(1, 1), (1, 2), (2, 1), (2, 2), (1, 30), (30, 1), (8, 8), (17, 16)], ids=str
)
def test_the_smallest_terrains(engines, measured, shape):
    terrain = Land(np.random.default_rng(2).random(shape) * 50, (20.0, 20.0))
    march, sweep = (measured(engine, terrain, directions=16) for engine in engines)
    np.testing.assert_allclose(sweep[0], march[0], atol=ROUNDING)
    for channel, azimuth in enumerate(CHIEF):
        assert off(march[0][..., channel], brute(terrain, azimuth)).max() < ROUNDING


def test_a_wall_without_end_and_a_needle(engines, measured):
    heights = np.zeros((33, 33))
    heights[:, 16] = 1e6
    heights[5, 5] = 1e7
    for engine in engines:
        result, k, _ = measured(engine, Land(heights, (1.0, 1.0)))
        assert result[20, 15, 6] > 89.99 and result[20, 17, 2] > 89.99
        assert k[20, 15] < 0.6 and k[5, 5] > 0


def test_flat_terrain_has_no_horizon(engines, measured):
    for engine in engines:
        result, k, _ = measured(engine, Land(np.zeros((21, 34)), (5.0, 9.0)), directions=16)
        assert (result == 0).all() and (k == 1).all()


def test_a_dome_is_all_hull(engines, measured):
    """On it no point of a line is covered by another, and nobody sees more than the next."""
    y, x = np.mgrid[0:65, 0:65] - 32.0
    terrain = Land(400 - (x**2 + y**2) / 8, (10.0, 10.0))
    march, sweep = (measured(engine, terrain) for engine in engines)
    np.testing.assert_allclose(sweep[0], march[0], atol=ROUNDING)
    bowl = Land(-terrain.heights, terrain.spacing)
    march, sweep = (measured(engine, bowl) for engine in engines)
    np.testing.assert_allclose(sweep[0], march[0], atol=ROUNDING)


def test_a_finer_pass_agrees_where_they_meet(engines, measured):
    terrain = real(33)
    for engine in engines:
        same = measured(engine, terrain)
        fine = measured(engine, terrain, size=("2 * size.x - 1", "2 * size.y - 1"))
        np.testing.assert_allclose(fine[2][::2, ::2], same[2], atol=1e-6)
        # Looked at twice as closely, horizons are higher, by little; but what rays see beyond the
        # terrain's edge, half a texel of it, is less.
        for channel in range(8):
            higher = (fine[0][::2, ::2, channel] - same[0][..., channel])[4:-4, 4:-4]
            assert rms(higher) < 1.0 and (higher < -0.5).mean() < 0.05

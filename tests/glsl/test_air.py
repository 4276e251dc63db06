"""sky/…: ways through a round shell of air, what is left of light on them, and what the sky sends down.

The truth adds up over heights, not along ways: with p the way's nearest distance to the
Earth's middle, a column is the integral of density · r / sqrt(r² - p²) over r, in float64. What
a stretch between two heights holds is a difference of columns.
"""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import RegularGridInterpolator
from scipy.ndimage import map_coordinates

RADIUS, TOP = 6360.0, 100.0
WAVES = np.array([0.627, 0.539, 0.440])
OZONE = np.array([0.095, 0.067, 0.0])
GAUSS = np.polynomial.legendre.leggauss(160)
SKETCH = '[[pass]]\nname = "daylight"\nuse = "lighting/daylight"\n'


def profile(height):
    """Return how dense molecules, aerosol and ozone are."""
    return np.stack(
        [
            np.exp(-height / 8),
            np.exp(-np.minimum(height, 60) / 1.2),
            np.clip(1 - np.abs(height - 25) / 15, 0, None),
        ]
    )


def coefficients(turbidity):
    """Return extinction per kilometre: (molecules, aerosol, ozone) by wavelength."""
    aerosol = (0.04608 * turbidity - 0.04586) * WAVES**-1.3
    return np.stack([0.008735 * WAVES**-4.08 / 8, aerosol / 1.2, 0.35 * OZONE / 15])


def column(height, rise):
    """Return the three columns [km] from a height to the top of the air, for arrays; NaN into the ground."""
    height, rise = np.broadcast_arrays(np.asarray(height, np.float64), np.asarray(rise, np.float64))
    up = _upwards(height, np.abs(rise))
    nearest = (RADIUS + height) * np.sqrt(1 - rise**2)
    lowest = np.maximum(nearest - RADIUS, 0)
    down = 2 * _upwards(lowest, np.zeros_like(lowest)) - up
    array = np.where(rise < 0, down, up)
    with np.errstate(invalid="ignore"):
        return np.where((rise < 0) & (nearest < RADIUS), np.nan, array)


def _upwards(height, rise):
    # r² - p² is (r₀ rise)² + (r - r₀)(r + r₀); with r = r₀ + s² the level way's infinity is gone.
    most = np.sqrt(np.maximum(TOP - height, 0))[..., None]
    s = 0.5 * most * (GAUSS[0] + 1)
    r0 = (RADIUS + height)[..., None]
    r = r0 + s**2
    across = np.sqrt((r0 * rise[..., None]) ** 2 + s**2 * (r + r0))
    weight = GAUSS[1] * 0.5 * most * 2 * s * r / np.maximum(across, 1e-9)
    return (profile(r - RADIUS) * weight).sum(axis=-1)


def left(height, rise, turbidity):
    """Return what is left of the sun's light at a height, its disc's part over the horizon included."""
    horizon = -np.sqrt(height * (2 * RADIUS + height)) / (RADIUS + height)
    part = np.clip(0.5 + 0.5 * (rise - horizon) / np.radians(0.265), 0, 1)
    depth = np.moveaxis(column(height, np.maximum(rise, horizon + 1e-9)), 0, -1) @ coefficients(turbidity)
    return part[..., None] * np.exp(-depth)


# ── the shell ────────────────────────────────────────────────────────────────


def test_heights_along_a_way_are_those_of_plane_geometry(on_gpu):
    rng = np.random.default_rng(1)
    height, rise = rng.uniform(0, 100, 2000), rng.uniform(-1, 1, 2000)
    height[:400] = 10 ** rng.uniform(-4, 0, 400)
    way = 10 ** rng.uniform(-3, 3, 2000)
    result = on_gpu("sky/shell.glsl", "height_along(h, u, w)", h=height, u=rise, w=way).astype(np.float64)
    value = [np.asarray(v, np.float32).astype(np.longdouble) for v in (height, rise, way)]
    across = value[2] * np.sqrt(1 - value[1] ** 2)
    truth = np.hypot(across, RADIUS + value[0] + value[2] * value[1]) - RADIUS
    inside = truth > -100
    np.testing.assert_allclose(result[inside], truth[inside].astype(float), rtol=2e-6, atol=2e-4)


def test_ways_end_at_the_top_at_the_ground_and_at_the_horizon(on_gpu):
    rng = np.random.default_rng(2)
    height, rise = rng.uniform(0, 99.9, 2000), rng.uniform(-1, 1, 2000)
    height[:300] = 10 ** rng.uniform(-3, 0, 300)
    arrays = {"h": height, "u": rise}
    far, ground, horizon = on_gpu(
        "sky/shell.glsl", "vec3(distance_to_top(h, u), distance_to_ground(h, u), horizon_rise(h))", **arrays
    ).T.astype(np.float64)
    h, u = height.astype(np.float32).astype(float), rise.astype(np.float32).astype(float)

    def reached(way):
        return np.hypot(way * np.sqrt(1 - u**2), RADIUS + h + way * u) - RADIUS

    np.testing.assert_allclose(reached(far), TOP, atol=0.01)
    hits = (RADIUS + h) * np.sqrt(1 - u**2) < RADIUS
    grazing = np.abs((RADIUS + h) * np.sqrt(1 - u**2) - RADIUS) < 0.01
    sure = ~grazing
    np.testing.assert_array_equal((ground >= 0)[sure], (hits & (u < 0))[sure])
    np.testing.assert_allclose(reached(ground)[sure & (ground >= 0)], 0, atol=0.01)
    np.testing.assert_allclose(horizon, -np.sqrt(1 - (RADIUS / (RADIUS + h)) ** 2), atol=2e-6)


# ── the air ──────────────────────────────────────────────────────────────────


def test_phases_send_light_once_round_the_sphere(on_gpu):
    together, weight = np.polynomial.legendre.leggauss(400)
    for name, forward in (("phase_molecules", 0.0), ("phase_aerosol", 0.8 * 3 * 4.64 / (5 * 2.64))):
        result = on_gpu("sky/air.glsl", f"{name}(c)", c=together).astype(np.float64)
        assert 2 * np.pi * result @ weight == pytest.approx(1, abs=1e-5)
        # Cornette and Shanks 1992, eq. 9: the mean cosine is g 3 (4 + g²) / (5 (2 + g²)).
        assert 2 * np.pi * (result * together) @ weight == pytest.approx(forward, abs=1e-5)


def test_the_air_is_as_deep_as_preetham_shirley_and_smits_say(on_gpu):
    """Straight up, the optical depths are the published ones, at the three wavelengths."""
    for turbidity in (2.0, 3.0, 6.0):
        result = on_gpu("sky/air.glsl", f"extinction(air_of({turbidity}), vec3(8.0, 1.2, 15.0))").astype(
            np.float64
        )[0]
        molecules = 0.008735 * WAVES**-4.08
        aerosol = (0.04608 * turbidity - 0.04586) * WAVES**-1.3
        np.testing.assert_allclose(result, molecules + aerosol + 0.35 * OZONE, rtol=1e-5)
    heights = np.concatenate([np.linspace(0, 100, 300), [10.0, 25.0, 40.0]])
    result = on_gpu("sky/air.glsl", "densities(h)", h=heights)
    np.testing.assert_allclose(result, profile(heights).T, rtol=2e-5, atol=1e-6)


def test_three_wavelengths_stand_for_the_spectrum(on_gpu):
    """The sun's colour in linear sRGB, white outside the air, from 81 wavelengths and the eye's response.

    The response is Wyman, Sloan and Shirley 2013, "Simple Analytic Approximations to the CIE XYZ
    Color Matching Functions" (multi-lobe); ozone's absorption is that of Preetham et al., table 2.
    """
    wave = np.arange(380.0, 781.0, 5.0)

    def lobe(middle, below, above):
        return np.exp(-0.5 * ((wave - middle) * np.where(wave < middle, below, above)) ** 2)

    x = 0.362 * lobe(442, 0.0624, 0.0374) + 1.056 * lobe(599.8, 0.0264, 0.0323)
    x -= 0.065 * lobe(501.1, 0.0490, 0.0382)
    y = 0.821 * lobe(568.8, 0.0213, 0.0247) + 0.286 * lobe(530.9, 0.0613, 0.0322)
    z = 1.217 * lobe(437.0, 0.0845, 0.0278) + 0.681 * lobe(459.0, 0.0385, 0.0725)
    rgb = [[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560]]
    rgb = np.array([*rgb, [0.0556434, -0.2040259, 1.0572252]]) @ np.stack([x, y, z])
    sun = wave**-5 / np.expm1(14387.77e3 / (wave * 5772))
    existing = [449, *range(450, 770, 10)]
    absorbs = [0, 3, 6, 9, 14, 21, 30, 40, 48, 63, 75, 85, 103, 120, 120, 115, 125]
    absorbs += [120, 105, 90, 79, 67, 57, 48, 36, 28, 23, 18, 14, 11, 10, 9, 7]
    ozone = 1e-3 * np.interp(wave, existing, absorbs)
    white = rgb @ sun
    for turbidity in (2.0, 3.0, 6.0):
        for masses in (1.0, 2.0, 5.0, 10.0, 20.0):
            amounts = f"vec3(8.0, 1.2, {15 * min(masses, 12.0) / masses}) * {masses}"
            result = on_gpu("sky/air.glsl", f"exp(-extinction(air_of({turbidity}), {amounts}))")[0]
            micro = wave / 1000
            depth = masses * (0.008735 * micro**-4.08 + (0.04608 * turbidity - 0.04586) * micro**-1.3)
            with np.errstate(under="ignore"):
                truth = rgb @ (sun * np.exp(-depth - 0.35 * ozone * min(masses, 12.0))) / white
            np.testing.assert_allclose(result, truth, atol=0.035 * truth.max())


# ── columns ──────────────────────────────────────────────────────────────────


def test_the_truth_s_own_columns():
    """Straight up they are the layers' thickness; level, those of a plain sum along the way."""
    np.testing.assert_allclose(column(0.0, 1.0), [8 * (1 - np.exp(-12.5)), 1.2, 15], rtol=5e-4)
    far = np.sqrt((RADIUS + TOP) ** 2 - RADIUS**2)
    for part in range(3):
        plain = quad(lambda w, part=part: profile(np.hypot(w, RADIUS) - RADIUS)[part], 0, far, limit=400)[0]
        assert column(0.0, 0.0)[part] == pytest.approx(plain, rel=1e-3)


def test_the_table_holds_the_columns(engine, make_sketch):
    result = engine.read(make_sketch(SKETCH), "daylight.columns").astype(np.float64)
    ny, nx = result.shape[:2]
    far = np.arange(ny) / (ny - 1) * np.sqrt(TOP * (2 * RADIUS + TOP))
    height = (np.hypot(far, RADIUS) - RADIUS)[:, None] * np.ones(nx)
    most = far[:, None] + far[-1]
    way = (TOP - height) + np.arange(nx) / (nx - 1) * (most - (TOP - height))
    with np.errstate(invalid="ignore", divide="ignore"):
        rise = (far[-1] ** 2 - far[:, None] ** 2 - way**2) / (2 * (RADIUS + height) * way)
    rise = np.clip(np.nan_to_num(rise, nan=1.0), -1, 1)
    horizon = -np.sqrt(1 - (RADIUS / (RADIUS + height)) ** 2)
    truth = np.moveaxis(column(height, np.maximum(rise, horizon + 1e-12)), 0, -1)
    inner = slice(None, -1)  # at the top there is no way left
    np.testing.assert_allclose(result[inner, ..., :3], truth[inner], rtol=0.015, atol=0.02)


READ = """
#include "sky/columns.glsl"
#pragma kernel(output = "left:rgba32f")
uniform sampler2D columns;  //! input
uniform vec2 start = vec2(0.0, 1.0);
vec4 kernel(ivec2 texel) {
    vec2 at = start + vec2(texel) * vec2(0.31, 0.0);
    float height = at.x + 0.4 * float(texel.x);
    float rise = -0.1 + 1.1 * pow(float(texel.y) / float(size.y - 1), 2.0);
    return vec4(left_of_sunlight(columns, air_of(2.5), height, rise), 1.0);
}
"""


def test_sunlight_through_the_air(engine, make_sketch):
    sketch = make_sketch(
        SKETCH + '[[pass]]\nname = "left"\nuse = "./read"\ninputs = { columns = "daylight.columns" }\n'
        "size = [48, 64]\n",
        read=READ,
    )
    result = engine.read(sketch, "left").astype(np.float64)[..., :3]
    height = (0.31 + 0.4) * np.arange(48)[None, :] * np.ones((64, 1))
    rise = -0.1 + 1.1 * (np.arange(64)[:, None] / 63) ** 2 * np.ones((1, 48))
    np.testing.assert_allclose(result, left(height, rise, 2.5), atol=0.006)


def test_the_sun_sets_in_its_own_width(on_gpu):
    for height in (0.0, 3.0, 80.0):
        horizon = -np.degrees(np.arccos(RADIUS / (RADIUS + height)))
        over = np.linspace(-0.6, 0.6, 49)
        rise = np.sin(np.radians(horizon + over))
        result = on_gpu("sky/columns.glsl", f"risen({height}, u)", u=rise)
        np.testing.assert_allclose(result, np.clip(0.5 + over / 0.53, 0, 1), atol=0.012)


# ── many bounces ─────────────────────────────────────────────────────────────


def bounced(height, sun_rise, turbidity, ground):
    """Return light scattered twice and more at a height: Hillaire's eqs 5 to 10 over many directions."""
    extinct = coefficients(turbidity)
    scatters = extinct * np.array([[1], [0.9], [0]])
    rises, weights = np.polynomial.legendre.leggauss(48)
    # Both sides of the horizon by themselves: light jumps there.
    edge = -np.sqrt(1 - (RADIUS / (RADIUS + height)) ** 2)
    rises = np.concatenate([edge + (rises + 1) / 2 * (1 - edge), -1 + (rises + 1) / 2 * (edge + 1)])
    weights = np.concatenate([weights * (1 - edge), weights * (edge + 1)]) / 4
    sides = (np.arange(12) + 0.5) / 12 * np.pi
    rise, side = np.meshgrid(rises, sides, indexing="ij")
    together = rise * sun_rise + np.sqrt((1 - rise**2) * (1 - sun_rise**2)) * np.cos(side)
    r0 = RADIUS + height
    nearest = r0 * np.sqrt(1 - rise**2)
    below = (rise < 0) & (nearest < RADIUS)
    reach = np.where(below, np.sqrt(np.maximum(RADIUS**2 - nearest**2, 0)), 0)
    out = np.sqrt((RADIUS + TOP) ** 2 - nearest**2)
    whole = np.where(below, -r0 * rise - reach, out - r0 * rise)
    steps, step_weights = np.polynomial.legendre.leggauss(64)
    share = (steps + 1) / 2
    way = whole[..., None] * share**2
    long = whole[..., None] * step_weights * share
    there = np.hypot(r0 * rise[..., None] + way, nearest[..., None]) - RADIUS
    there = np.clip(there, 0, TOP)
    sun_there = np.clip((r0 * sun_rise + way * together[..., None]) / (RADIUS + there), -1, 1)
    amounts = np.moveaxis(profile(there), 0, -1)
    taken = amounts @ extinct
    depth = np.cumsum(taken * long[..., None], axis=-2) - 0.5 * taken * long[..., None]
    lit = np.exp(-depth) * long[..., None] * (amounts @ scatters)
    with np.errstate(under="ignore"):
        once = (lit * _left_fast(there, sun_there, turbidity)).sum(axis=-2) / (4 * np.pi)
        sun_down = np.clip((r0 * sun_rise + whole * together) / RADIUS, -1, 1)
        through = np.exp(-(taken * long[..., None]).sum(axis=-2))
        bright = _left_fast(np.zeros_like(sun_down), sun_down, turbidity) * np.maximum(sun_down, 0)[..., None]
    once += np.where(below[..., None], through * bright * ground / np.pi, 0)
    mean = weights[:, None, None] / len(sides)
    second, again = (once * mean).sum(axis=(0, 1)), (lit.sum(axis=-2) * mean).sum(axis=(0, 1))
    return second / (1 - again)


def _left_fast(height, rise, turbidity, cells=(60, 400)):
    """Return what ``left`` does, from a fine table: integrals for every step would take minutes."""
    if turbidity not in _TABLES:
        up = np.linspace(0, 1, cells[0]) ** 2 * TOP
        along = np.linspace(0, 1, cells[1]) ** 2
        edge = -np.sqrt(1 - (RADIUS / (RADIUS + up)) ** 2)
        rises = edge[:, None] + along * (1 - edge[:, None])
        depth = np.moveaxis(column(up[:, None] * np.ones(cells[1]), np.minimum(rises + 1e-12, 1)), 0, -1)
        depth = depth @ coefficients(turbidity)
        _TABLES[turbidity] = RegularGridInterpolator(
            (np.linspace(0, 1, cells[0]), np.linspace(0, 1, cells[1])), depth
        )
    horizon = -np.sqrt(1 - (RADIUS / (RADIUS + height)) ** 2)
    part = np.clip(0.5 + 0.5 * (rise - horizon) / np.radians(0.265), 0, 1)
    along = np.sqrt(np.clip((rise - horizon) / (1 - horizon), 0, 1))
    position = np.stack([np.sqrt(np.clip(height / TOP, 0, 1)), along], axis=-1)
    return part[..., None] * np.exp(-_TABLES[turbidity](position))


_TABLES: dict[float, object] = {}


@pytest.mark.slow
def test_light_scattered_often_is_that_of_a_finer_sum(engine, make_sketch):
    turbidity, ground = 3.0, 0.3
    sketch = make_sketch(f"{SKETCH}set = {{ turbidity = {turbidity}, ground = {ground} }}\n")
    result = np.exp(engine.read(sketch, "daylight.bounced").astype(np.float64)[..., :3])
    ny, nx = result.shape[:2]
    # Below 20 km, where all but a twentieth of the air is; above, the shader's few directions show.
    for column_, row in ((47, 0), (40, 3), (25, 0), (16, 2), (14, 5), (13, 1), (11, 6), (9, 4), (30, 6)):
        sun_rise = -0.36 + 1.36 * column_ / (nx - 1)
        height = TOP * (row / (ny - 1)) ** 2
        truth = bounced(height, sun_rise, turbidity, ground)
        np.testing.assert_allclose(result[row, column_], truth, rtol=0.06, atol=2e-10)


def test_all_of_it_is_dark_long_after_sunset(engine, make_sketch):
    result = np.exp(engine.read(make_sketch(SKETCH), "daylight.bounced").astype(np.float64)[..., :3])
    assert result[:, 0].max() < 1e-6 * result[:, -1].max()
    assert (np.diff(result[0, :, 1]) > -1e-3 * result[0, :-1, 1]).all()  # brighter as the sun rises


# ── the sky ──────────────────────────────────────────────────────────────────


def sky(rise, aside, elevation, turbidity, table, height=0.0):
    """Return the light from one direction, times pi, from a height [km]: the aerosol's, and all the rest.

    The way is followed by Gauss's rule; what is left of light on it is a difference of
    columns. ``table`` is the shader's own of light scattered often, which was held against
    another sum above.
    """
    extinct = coefficients(turbidity)
    sun = np.sin(np.radians(elevation))
    together = rise * sun + np.sqrt((1 - rise**2) * (1 - sun**2)) * aside
    start = RADIUS + height
    nearest = start * np.sqrt(1 - rise**2)
    whole = np.sqrt((RADIUS + TOP) ** 2 - nearest**2) - start * rise
    share = (GAUSS[0] + 1) / 2
    way, long = whole * share**2, whole * GAUSS[1] * share
    there = np.clip(np.hypot(start * rise + way, nearest) - RADIUS, 0, TOP)
    rise_there = np.clip((start * rise + way) / (RADIUS + there), -1, 1)
    sun_there = np.clip((start * sun + way * together) / (RADIUS + there), -1, 1)
    passed = column(height, rise)[:, None] - column(there, rise_there)
    amounts = profile(there)
    with np.errstate(under="ignore"):
        seen = np.exp(-np.clip(passed.T, 0, None) @ extinct) * long[:, None]
        lit = seen * left(there, sun_there, turbidity)
        molecules = (lit * amounts[0][:, None]).sum(axis=0) * extinct[0]
        aerosol = (lit * amounts[1][:, None]).sum(axis=0) * extinct[1] * 0.9
        both = amounts[0][:, None] * extinct[0] + amounts[1][:, None] * extinct[1] * 0.9
        often = (seen * both * _often(table, there, sun_there)).sum(axis=0)
    phase = 3 / (16 * np.pi) * (1 + together**2)
    return np.pi * aerosol, np.pi * (molecules * phase + often), together


def _often(table, height, sun_rise):
    ny, nx = table.shape[:2]
    x = np.clip((sun_rise + 0.36) / 1.36, 0, 1) * (nx - 1)
    y = np.clip(np.sqrt(height / TOP), 0, 1) * (ny - 1)
    return np.exp(np.stack([map_coordinates(table[..., c], [y, x], order=1) for c in range(3)], axis=-1))


@pytest.mark.parametrize("elevation", [70.0, 15.0, 1.0, -3.0, -8.0])
def test_the_sky_is_what_its_air_scatters(engine, make_sketch, elevation):
    text = f'position = "free", sun = [90.0, {elevation}], turbidity = 3.0'
    sketch = make_sketch(f"{SKETCH}set = {{ {text} }}\n")
    result = engine.read(sketch, "daylight.dome").astype(np.float64)[..., :3]
    table = engine.read(sketch, "daylight.bounced").astype(np.float64)[..., :3]
    ny, nx = result.shape[0] // 9, result.shape[1] // 2  # the eye by the sea
    for x, y in ((0, 0), (0, 5), (31, 2), (12, 12), (20, 8), (5, 25), (16, 31)):
        rise, aside = (y / (ny - 1)) ** 2, 1 - 2 * (x / (nx - 1)) ** 2
        aerosol, rest, _ = sky(rise, aside, elevation, 3.0, table)
        np.testing.assert_allclose(result[y, x], rest + 5.1e-9, rtol=0.04, atol=1e-8)
        np.testing.assert_allclose(result[y, nx + x], aerosol, rtol=0.06, atol=1e-8 + 0.01 * aerosol.max())


LOOK = """
#include "lighting/daylight_sky.glsl"
#pragma kernel(output = "seen:rgba32f")
uniform sampler2D daylight;  //! input
vec4 kernel(ivec2 texel) {
    float azimuth = radians(float(texel.x) * 7.3);
    float rise = 0.01 + 0.98 * float(texel.y) / float(size.y);
    vec2 level = sqrt(1.0 - rise * rise) * vec2(sin(azimuth), cos(azimuth));
    return vec4(sky_towards(daylight, vec3(level, rise), 0.0), 1.0);
}
"""
FROM_ABOVE = """
#include "lighting/daylight_sky.glsl"
#pragma kernel(output = "seen:rgba32f")
uniform sampler2D daylight;  //! input
uniform float height = 0.0;
vec4 kernel(ivec2 texel) {
    float azimuth = radians(float(texel.x) * 7.3);
    float lowest = horizon_rise(height) + 2e-4;
    float rise = mix(lowest, 1.0, pow(float(texel.y) / float(size.y), 2.0));
    vec2 level = sqrt(1.0 - rise * rise) * vec2(sin(azimuth), cos(azimuth));
    return vec4(sky_towards(daylight, vec3(level, rise), height), 1.0);
}
"""


@pytest.mark.parametrize("elevation", [40.0, 4.0, -2.0])
def test_the_sky_may_be_read_in_any_direction(engine, make_sketch, elevation):
    text = f'position = "free", sun = [150.0, {elevation}], turbidity = 3.0, adaptation = 0.0'
    seen = '[[pass]]\nname = "seen"\nuse = "./look"\nsize = [50, 9]\n'
    sketch = make_sketch(f"{SKETCH}set = {{ {text} }}\n{seen}", look=LOOK)
    result = engine.read(sketch, "seen").astype(np.float64)[..., :3]
    table = engine.read(sketch, "daylight.bounced").astype(np.float64)[..., :3]
    g = 0.8
    for x, y in ((3, 0), (20, 1), (21, 4), (44, 0), (33, 7), (0, 3)):
        rise, aside = 0.01 + 0.98 * y / 9, np.cos(np.radians(x * 7.3 - 150))
        aerosol, rest, together = sky(rise, aside, elevation, 3.0, table)
        phase = 3 / (8 * np.pi) * (1 - g**2) * (1 + together**2)
        phase /= (2 + g**2) * (1 + g**2 - 2 * g * together) ** 1.5
        np.testing.assert_allclose(result[y, x], rest + phase * aerosol, rtol=0.06)


@pytest.mark.parametrize("elevation", [40.0, 4.0])
@pytest.mark.parametrize("height", [0.1, 0.606, 1.5, 4.0, 9.0])
def test_from_a_height_it_is_the_sky_of_that_height(engine, make_sketch, height, elevation):
    """From the eye's own horizon, below the level, to the zenith; between the tables as on them."""
    text = f'position = "free", sun = [150.0, {elevation}], turbidity = 3.0, adaptation = 0.0'
    seen = f'[[pass]]\nname = "seen"\nuse = "./from_above"\nsize = [50, 9]\nset = {{ height = {height} }}\n'
    sketch = make_sketch(f"{SKETCH}set = {{ {text} }}\n{seen}", from_above=FROM_ABOVE)
    result = engine.read(sketch, "seen").astype(np.float64)[..., :3]
    table = engine.read(sketch, "daylight.bounced").astype(np.float64)[..., :3]
    lowest = -np.sqrt(1 - (RADIUS / (RADIUS + height)) ** 2) + 2e-4
    for x, y in ((3, 0), (30, 0), (20, 1), (21, 2), (44, 1), (33, 7), (0, 3)):
        rise, aside = lowest + (1 - lowest) * (y / 9) ** 2, np.cos(np.radians(x * 7.3 - 150))
        aerosol, rest, together = sky(rise, aside, elevation, 3.0, table, height)
        phase = 3 / (8 * np.pi) * 0.36 / 2.64 * (1 + together**2) / (1.64 - 1.6 * together) ** 1.5
        truth = rest + phase * aerosol
        np.testing.assert_allclose(
            result[y, x], truth, rtol=0.05, atol=0.1 * truth.max(), err_msg=f"{x}, {y}"
        )

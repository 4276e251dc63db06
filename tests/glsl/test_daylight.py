"""lighting/daylight: sun and sky for every place of the sun, and how other techniques take them."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from playground.paths import GLSL
from playground.sketch.model import Camera, kernels_of
from playground.sketch.techniques import read_technique, shipped_techniques
from playground.sketch.wiring import input_names

from ..loading import library
from ..sketch_texts import passes, use, view
from ..truth.eyes import rays
from ..truth.land import towards

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
HEIGHTS = (90.0, 70.0, 45.0, 20.0, 10.0, 5.0, 2.0, 0.5, 0.0, -0.2, -0.5, -1.0, -3.0, -6.0, -9.0, -12.0)
HEIGHTS += (-18.0, -30.0, -90.0)


@pytest.fixture
def day(make_sketch):
    """Give a sketch of daylight alone: the sun free and the eye not adapted, unless given."""

    def make(rest="", files=None, **value):
        values = {"position": "free", "adaptation": 0.0, **value}
        return make_sketch(passes(daylight=use("lighting/daylight", **values)) + rest, **(files or {}))

    return make


def under(sketch, elevation, azimuth=135.0):
    return sketch.with_values({"daylight.sun": [azimuth, float(elevation)]})


def row_of(engine, sketch):
    """Return what daylight comes to: a row of texels, red, green, blue, alpha."""
    return engine.read(sketch, "daylight")[0].astype(np.float64)


# ── the sun's place ──────────────────────────────────────────────────────────


def test_the_sun_follows_place_date_and_hour(any_engine, day, on_gpu):
    sketch = day(position="date and hour", latitude=36.3, longitude=-84.2, year=2031, day=120)

    def place(**values):
        changed = sketch.with_values({f"daylight.{k}": v for k, v in values.items()})
        return any_engine.read(changed, "daylight.place")[0, 0]

    def asked(expression):
        return on_gpu("lighting/sun_position.glsl", expression)[0]

    by_sun = asked("sun_position_solar(vec2(36.3, -84.2), 2031, 120, 7.5)")
    np.testing.assert_allclose(place(hour=7.5), by_sun, atol=1e-3)
    zone = asked("sun_position(vec2(36.3, -84.2), 2031, 120, 12.5)")
    np.testing.assert_allclose(place(hour=7.5, clock="zone", zone=-5.0), zone, atol=1e-3)
    late = asked("sun_position(vec2(36.3, -84.2), 2031, 121, 1.0)")  # past midnight, by universal time
    np.testing.assert_allclose(place(hour=20.0, clock="zone", zone=-5.0), late, atol=1e-3)
    np.testing.assert_array_equal(place(position="free", sun=[12.0, -3.0]), [12.0, -3.0])


def still(hour, day):
    return passes(daylight=use("lighting/daylight", hour=hour, day=day))


def test_with_a_clock_the_sun_moves_and_without_one_nothing_runs(any_engine, make_sketch):
    clock = passes(clock=use("lighting/daylight_clock", size=1, pace=0.5))
    moving = make_sketch(clock + still(22.0, 100))
    for time, hour, date in ((0.0, 22.0, 100), (2.0, 23.0, 100), (12.0, 4.0, 101), (100.0, 0.0, 103)):
        result = any_engine.read(moving, "daylight.place", time=time)
        expected = any_engine.read(make_sketch(still(hour, date)), "daylight.place")
        np.testing.assert_allclose(result, expected, atol=1e-3)
    sketch = make_sketch(still(9.0, 100))
    any_engine.read(sketch, "daylight", time=0.0)
    any_engine.read(sketch, "daylight", time=5.0)
    assert any_engine.record.ran == []


# ── its light, and the sky's ─────────────────────────────────────────────────


def almanac(elevation):
    """Return sun and sky on level ground [lux]: Explanatory Supplement to the Almanac, 1992, chapter 9."""
    pieces = [(20, 3.74, 3.97, -4.07, 1.47), (5, 3.05, 13.28, -45.98, 64.33)]
    pieces += [(-0.8, 2.88, 22.26, -207.64, 1034.30), (-5, 2.88, 21.81, -258.11, -858.36)]
    pieces += [(-12, 2.70, 12.17, -431.69, -1899.83), (-18, 13.84, 262.72, 1447.42, 2797.93)]
    x = elevation / 90
    return next(10 ** (a + x * (b + x * (c + x * d))) for low, a, b, c, d in pieces if elevation >= low)


@pytest.mark.slow
def test_it_is_as_bright_as_the_almanac_says_from_noon_to_night(any_engine, day):
    """Over eight powers of ten, within the 1.6 that one clear day is from another."""
    sketch = day(turbidity=2.5)
    for elevation in (90, 75, 60, 45, 30, 20, 15, 10, 5, 2, 0, -1, -2, -4, -6, -8, -10, -12, -18):
        row = 127_500 * (row_of(any_engine, under(sketch, elevation))[5, :3] @ LUMINANCE)
        assert 0.85 < row / almanac(elevation) < 1.6, elevation


def test_the_row_adds_up(any_engine, day):
    for elevation in (60.0, 8.0, -2.0):
        row = row_of(any_engine, under(day(), elevation, 222.0))
        np.testing.assert_allclose(row[0], [*towards(222.0, elevation), elevation], atol=2e-6 + 1e-6 * 222)
        assert row[1, 3] == pytest.approx(222.0)
        level = row[1, :3] * max(np.sin(np.radians(elevation)), 0) + row[2, :3]
        np.testing.assert_allclose(row[5, :3], level, rtol=1e-5)


def seen_from(height, dome, rise, turned, together):
    """Read the dome as seen from a height [km], between two of nine tables, by what is over the horizon."""
    lowest = -np.sqrt(1 - (6360 / (6360 + height)) ** 2)
    over = np.clip((rise - lowest) / (1 - lowest), 0, 1)
    position = 8 * np.sqrt(height / 16)
    tables = dome.reshape(9, -1, *dome.shape[1:])
    low, high = (looked_up(tables[int(position) + k], over, turned, together, 1) for k in (0, 1))
    return low + (position - int(position)) * (high - low)


def looked_up(dome, rise, turned, together, tables=9):
    """Read the dome's two tables in NumPy; directions by their sine, and azimuth from the sun's."""
    dome = dome[: dome.shape[0] // tables]  # as seen from the sea
    ny, nx = dome.shape[0], dome.shape[1] // 2
    position = [np.sqrt(rise) * (ny - 1), np.sin(turned / 2) * (nx - 1)]
    halves = [
        np.stack([map_coordinates(part[..., c], position, order=1) for c in range(3)], axis=-1)
        for part in (dome[:, :nx], dome[:, nx:])
    ]
    phase = 3 / (8 * np.pi) * 0.36 / 2.64 * (1 + together**2) / (1.64 - 1.6 * together) ** 1.5
    return halves[0] + phase[..., None] * halves[1]


@pytest.mark.parametrize("elevation", [85.0, 40.0, 12.0, 1.0, -4.0])
def test_the_sky_s_light_is_the_sum_of_all_its_directions(any_engine, day, elevation):
    sketch = under(day(), elevation)
    dome = any_engine.read(sketch, "daylight.dome").astype(np.float64)[..., :3]
    row = row_of(any_engine, sketch)
    squared, weight = np.polynomial.legendre.leggauss(80)
    rise = np.sqrt((squared + 1) / 2)[:, None] * np.ones(160)
    turned = (np.arange(160) + 0.5) / 160 * np.pi * np.ones((80, 1))
    sun = np.radians(elevation)
    together = rise * np.sin(sun) + np.sqrt(1 - rise**2) * np.cos(sun) * np.cos(turned)
    seen = looked_up(dome, rise, turned, together)
    truth = (seen * weight[:, None, None] / 2).sum(axis=0).mean(axis=0)
    np.testing.assert_allclose(row[2, :3], truth, rtol=0.02)
    rise, turned = np.full(200, 0.03), (np.arange(200) + 0.5) / 200 * np.pi
    together = rise * np.sin(sun) + np.sqrt(1 - rise**2) * np.cos(sun) * np.cos(turned)
    np.testing.assert_allclose(row[4, :3], looked_up(dome, rise, turned, together).mean(axis=0), rtol=0.02)
    overhead = looked_up(dome, np.ones(1), np.ones(1), np.full(1, np.sin(sun)))[0]
    np.testing.assert_allclose(row[3, :3], overhead, rtol=1e-4)


@pytest.mark.slow
def test_it_fades_to_night_and_is_a_number_everywhere(any_engine, day):
    for turbidity in (1.5, 2.5, 10.0):
        for clouds in (0.0, 0.4, 1.0):
            sketch = day(turbidity=turbidity, clouds=clouds)
            bright = []
            for elevation in HEIGHTS:
                whole = any_engine.read(under(sketch, elevation), "daylight")
                assert np.isfinite(whole).all() and (whole[1:] >= 0).all() and (whole[0, 1:, :3] >= 0).all()
                bright.append(whole[0, 5, :3].astype(np.float64) @ LUMINANCE)
            down = HEIGHTS.index(5.0)
            assert (np.diff(bright[down:]) <= 1e-6 * np.array(bright[down:-1])).all()
            assert bright[-1] > 0 and bright[-1] == pytest.approx(bright[-2], rel=1e-3)
            assert bright[down] > 1e4 * bright[-1]
    fine = [row_of(any_engine, under(day(), e))[5, :3] @ LUMINANCE for e in np.arange(3, -8, -0.25)]
    assert np.abs(np.diff(np.log10(fine))).max() < 0.2  # nowhere a step: at most a third in a quarter degree


# ── clouds, and the eye ──────────────────────────────────────────────────────


def test_clouds_dim_the_sun_and_whiten_the_sky(any_engine, day):
    for elevation in (50.0, 6.0, -3.0):
        clear = row_of(any_engine, under(day(), elevation))
        for cover in (0.25, 0.5, 0.8, 1.0):
            row = row_of(any_engine, under(day(clouds=cover), elevation))
            kept = 1 - 0.75 * cover**3.4  # Kasten and Czeplak 1980
            np.testing.assert_allclose(row[5, :3], kept * clear[5, :3], rtol=1e-4)
            np.testing.assert_allclose(row[1, :3], kept * (1 - cover**2) * clear[1, :3], rtol=1e-4)
            level = row[1, :3] * max(np.sin(np.radians(elevation)), 0) + row[2, :3]
            np.testing.assert_allclose(level, row[5, :3], rtol=1e-4)  # nothing is lost
    row = row_of(any_engine, under(day(clouds=1.0), 50.0))
    assert row[1, :3].max() == 0
    np.testing.assert_allclose(row[3, :3] / row[4, :3], 3 / 1.06, rtol=1e-4)  # Moon and Spencer's 3 to 1
    np.testing.assert_allclose(row[2, :3] / (row[2, :3] @ LUMINANCE), 1.0, atol=0.07)


def test_an_overcast_sky_lights_level_ground_by_one(on_gpu):
    squared, weight = np.polynomial.legendre.leggauss(50)
    seen = on_gpu("sky/clouds.glsl", "overcast(r)", r=np.sqrt((squared + 1) / 2)).astype(np.float64)
    assert seen @ weight / 2 == pytest.approx(1, abs=1e-5)
    ends = on_gpu("sky/clouds.glsl", "vec2(under_clouds(n), beam_through_clouds(n))", n=np.array([0.0, 1.0]))
    np.testing.assert_allclose(ends, [[1, 1], [0.25, 0]], atol=1e-6)


@pytest.mark.parametrize("adaptation", [0.5, 1.0])
def test_the_eye_makes_up_for_the_light_that_is_lost(any_engine, day, adaptation):
    for elevation in (60.0, 5.0, -5.0):
        nature = any_engine.read(under(day(clouds=0.3), elevation), "daylight").astype(np.float64)
        sketch = under(day(clouds=0.3, adaptation=adaptation), elevation)
        seen = any_engine.read(sketch, "daylight").astype(np.float64)
        eye = (nature[0, 5, :3] @ LUMINANCE) ** -adaptation
        assert seen[0, 3, 3] == pytest.approx(eye, rel=1e-4)
        np.testing.assert_allclose(seen[0, 1:6, :3], eye * nature[0, 1:6, :3], rtol=1e-3)
        np.testing.assert_allclose(seen[1:, :, :3], eye * nature[1:, :, :3], rtol=1e-3)
        np.testing.assert_allclose(seen[0, 0], nature[0, 0])


# ── how others take it ───────────────────────────────────────────────────────

TAKE = """
#include "lighting/daylight_reading.glsl"
#pragma kernel(output = "taken:rgba32f")
uniform sampler2D daylight;  //! input("black")
uniform vec2 sun = vec2(200.0, 33.0);  //! direction
vec4 kernel(ivec2 texel) {
    vec3 own = vec3(0.5, 0.25, 0.125);
    Sunlight from = sunlight(wired_daylight, daylight, towards_sun, sun, own, vec3(0.0625, 0.125, 0.75));
    if (texel.x == 0) return vec4(from.direction, wired_daylight ? 1.0 : 0.0);
    if (texel.x == 1) return vec4(from.place, 0.0, 0.0);
    if (texel.x == 2) return vec4(from.sun, 0.0);
    if (texel.x == 3) return vec4(from.sky, 0.0);
    vec3 direction = sun_direction(wired_daylight, daylight, towards_sun);
    return vec4(direction, sun_elevation(wired_daylight, daylight, sun));
}
"""


def test_unwired_it_is_the_parameters_and_wired_it_is_daylight(engine, make_sketch, day, on_gpu):
    taken = passes(taken=use("./take", size=[5, 1]))
    plain = engine.read(make_sketch(taken, take=TAKE), "taken")[0]
    here = on_gpu("lighting/sun.glsl", "to_sun(vec2(200.0, 33.0))")[0]
    np.testing.assert_allclose(plain[0, :3], here, atol=1e-6)
    np.testing.assert_array_equal(plain[4], [*plain[0, :3], 33])
    assert plain[0, 3] == 0
    np.testing.assert_array_equal(plain[1:4, :3], [[200, 33, 0], [0.5, 0.25, 0.125], [0.0625, 0.125, 0.75]])
    # A pass of that name, or an output of it, is taken without being wired.
    text = passes(hours=use("lighting/daylight", position="free", sun=[70, 5]))
    sketch = make_sketch(text + taken, take=TAKE)
    result, row = engine.read(sketch, "taken")[0], engine.read(sketch, "hours")[0]
    np.testing.assert_array_equal(result[0, :3], row[0, :3])
    np.testing.assert_array_equal(result[4], row[0])
    assert result[0, 3] == 1
    np.testing.assert_array_equal(result[1, :2], [row[1, 3], row[0, 3]])
    np.testing.assert_array_equal(result[2:4, :3], row[1:3, :3])


SAY = """
#include "lighting/daylight_weather.glsl"
#pragma kernel(output = "told:rgba32f")
uniform sampler2D daylight;  //! input
vec4 kernel(ivec2 texel) {
    Weather now = weather(daylight);
    return texel.x == 0 ? vec4(now.turbidity, now.open, now.adapted, 1.0)
            : vec4(texel.x == 1 ? now.overcast : now.level, 1.0);
}
"""


def test_daylight_says_how_hazy_and_how_cloudy_it_is(engine, day):
    """Turbidity and cover, set once, are read by all that draws air or clouds, which get its tables too."""
    message = passes(told=use("./say", size=[3, 1]))
    sketch = day(message, {"say": SAY}, turbidity=3.5, clouds=0.25, adaptation=0.5, ground=0.4)
    result, row = engine.read(sketch, "told")[0].astype(np.float64), row_of(engine, sketch)
    np.testing.assert_allclose(result[0, :3], [3.5, 0.75, row[3, 3]], rtol=1e-6)
    np.testing.assert_array_equal(result[2, :3], row[5, :3])
    level = row[1, :3] * row[0, 2] + row[2, :3]
    np.testing.assert_allclose(result[2, :3], level, rtol=1e-4)
    clear = row_of(engine, day(turbidity=3.5, ground=0.4))
    held = 0.75 * clear[2, :3]  # of the open sky
    held += (1 - 0.75 * 0.25**3.4) * (1 - 0.25**2) * clear[1, :3] * clear[0, 2]  # and of the sun
    np.testing.assert_allclose(result[1, :3], level - row[3, 3] * held, rtol=2e-3)
    assert engine.read(sketch, "daylight:cover")[0, 0] == pytest.approx(0.25)
    assert engine.read(sketch, "daylight:bounced")[3, 3, 3] == pytest.approx(0.4)
    for name in ("columns", "bounced", "dome"):
        np.testing.assert_array_equal(
            engine.read(sketch, f"daylight:{name}"), engine.read(sketch, f"daylight.{name}")
        )


HILLS = """
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) {
    vec2 p = vec2(texel) * 0.21;
    return 0.5 + 0.25 * sin(p.x) * cos(1.3 * p.y) + 0.2 * sin(0.4 * p.x + 0.9 * p.y);
}
"""


def takers():
    """Return the light techniques that have an input for daylight."""
    names = [name for name in shipped_techniques() if re.fullmatch("lighting/[^/]+", name)]
    techniques = {name: read_technique(name, GLSL, GLSL) for name in names}
    return [
        name
        for name, technique in techniques.items()
        if "daylight" in input_names(technique)
        and {"sun_colour", "sky_colour", "ambient"} <= {p.name for p in technique.parameters}
    ]


@pytest.mark.parametrize("name", takers())
@pytest.mark.parametrize("elevation", [35.0, 6.0])
def test_a_light_technique_takes_the_sun_and_the_sky_from_it(any_engine, make_sketch, name, elevation):
    light, terrain = passes(light=use(name, ambient=1.0)), passes(height="./hills")
    day = passes(daylight=use("lighting/daylight", position="free", sun=[250.0, elevation]))
    wired = make_sketch(terrain + day + light, relief=200.0, hills=HILLS)
    row = row_of(any_engine, wired)
    result = any_engine.read(wired, "light")
    values = {"sun": [250.0, elevation], "sun_colour": list(row[1, :3]), "sky_colour": list(row[2, :3])}
    if name == "lighting/horizon_sun":  # no arc is under a daylight's sun: it takes eight directions
        values |= {"measured": "eight directions", "arc": 135.0}
    plain = make_sketch(terrain + light, relief=200.0, hills=HILLS)
    expected = any_engine.read(plain.with_values({f"light.{k}": v for k, v in values.items()}), "light")
    assert np.ptp(result[..., 0]) > 0.05
    same = np.abs(result - expected) <= 2e-3 * np.abs(expected) + 1e-4
    assert same.mean() > 0.995  # a grazing ray may fall to either side


def test_turbidity_is_set_once():
    """One kernel has it and all others read that: nothing can be set to another air."""
    graph = library()["lighting/daylight"]
    having = [path for path, kernel in kernels_of(graph) if kernel.parameter("turbidity")]
    views = {name: result for name, result in library().items() if name.startswith("view/")}
    having += [n for n, view in views.items() for _, k in kernels_of(view) if k.parameter("turbidity")]
    assert having == ["air"]


# ── seen behind the terrain ─────────────────────────────────────────────────────

FLAT = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) { return 0.0; }\n'
TERRAIN = passes(height="./flat")
SEEN = (160, 120)


@pytest.fixture
def outdoors(make_sketch):
    def make(sun=(180.0, 10.0), sky="daylight", daylight=True):
        light = passes(daylight=use("lighting/daylight", position="free", sun=sun, turbidity=2.0))
        shown = view("view/terrain", **({"sky": sky} if sky else {}))
        return make_sketch(TERRAIN + (light if daylight else "") + shown, flat=FLAT)

    return make


def looking(sketch, azimuth, elevation=0.0, field=20.0):
    """Look level, or upwards, in the direction of an azimuth."""
    camera = Camera(
        azimuth=azimuth + 180,
        elevation=elevation,
        distance=3000.0,
        target=(500.0, 500.0, 800.0),
        field_of_view=field,
    )
    return sketch.with_camera(camera)


def test_the_colours_stay_what_they_were(any_engine, outdoors):
    for azimuth, elevation in ((180, 0), (40, -20)):
        frames = [
            any_engine.read(looking(sketch, azimuth, elevation), "view.sky", size=SEEN)
            for sketch in (
                outdoors(sky="", daylight=False),
                outdoors(sky=""),
                outdoors(daylight=False),  # nothing to take it from
            )
        ]
        for other in frames[1:]:
            np.testing.assert_array_equal(frames[0], other)


@pytest.mark.parametrize("sun", [(180.0, 2.0), (95.0, 5.0), (300.0, 0.6)])
def test_sun_disc_is_at_sun_direction_and_half_a_degree_wide(any_engine, outdoors, sun):
    sketch = looking(outdoors(sun), sun[0] + 1.0, field=12.0)
    size = (320, 240)
    result = any_engine.read(sketch, "view.sky", size=size)[..., 0].astype(np.float64)
    plan = any_engine.record.plan
    assert plan is not None
    far = np.asarray(plan.eye.position, np.float64) + 1e7 * towards(*sun)
    clip = plan.eye.clip_from_world.astype(np.float64) @ [*far, 1.0]
    column, row = (clip[:2] / clip[3] + 1) / 2 * size
    y, x = np.mgrid[0 : size[1], 0 : size[0]] + 0.5
    near = np.hypot(x - column, y - row)
    pixel = 12.0 / size[1]
    disc = near < 0.2 / pixel
    around = (near > 0.4 / pixel) & (near < 1.0 / pixel)
    assert disc.sum() > 20 and result[disc].min() > 1.5 * result[around].max()


def test_the_sky_behind_the_terrain_is_daylight_s(any_engine, outdoors):
    sketch = looking(outdoors((180.0, 8.0)), 90.0, field=40.0)
    result = any_engine.read(sketch, "view.sky", size=SEEN).astype(np.float64)[..., :3]
    dome = any_engine.read(sketch, "daylight", size=SEEN).astype(np.float64)[..., :3]
    row, dome = dome[0], dome[1:]
    any_engine.render(sketch, size=SEEN)
    eye = any_engine.record.plan.eye
    ahead = rays(eye, SEEN)
    above = ahead[..., 2] > 0.02
    sun = row[0]
    aside = ahead[..., :2] @ sun[:2] / np.linalg.norm(ahead[..., :2], axis=-1) / np.linalg.norm(sun[:2])
    turned = np.arccos(np.clip(aside, -1, 1))
    seen = seen_from(eye.position[2] / 1000, dome, ahead[..., 2], turned, ahead @ sun)
    np.testing.assert_allclose(result[above], seen[above], rtol=0.02)
    # Far underfoot it is the ground's colour in all the light there is.
    down = looking(outdoors((180.0, 40.0)), 90.0, 85.0)
    ground = any_engine.read(down, "view.sky", size=SEEN).astype(np.float64)[..., :3]
    level = any_engine.read(down, "daylight", size=SEEN).astype(np.float64)[0, 5, :3]
    nadir = np.array([0.125, 0.19, 0.27])
    np.testing.assert_allclose(ground[60, 80], nadir * level, rtol=0.12)


def test_there_is_no_sun_at_night(any_engine, outdoors):
    sketch = looking(outdoors((180.0, -2.0)), 180.0)
    result = any_engine.read(sketch, "view.sky", size=SEEN)
    assert np.isfinite(result).all()
    rows = result[SEEN[1] // 2 :, :, 0]
    assert rows.max() < 8 * np.median(rows)


def test_a_camera_that_moves_lights_nothing_anew(any_engine, outdoors):
    """A name that the engine gives, as `eye`, makes a pass follow it: even one that is a local variable."""
    sketch = outdoors((180.0, 40.0))
    any_engine.draw(looking(sketch, 180.0), size=(32, 24))
    any_engine.draw(looking(sketch, 190.0), size=(32, 24))
    assert any_engine.record.ran and all(path.startswith("view.") for path in any_engine.record.ran), (
        any_engine.record.ran
    )


@pytest.mark.parametrize("columns", [1, 2, 3, 5, 16])
def test_a_dome_of_any_width_has_the_same_bits_by_its_halves(any_engine, make_sketch, columns):
    """Of an odd number, the middle column is in the right half, whose last two columns have one place."""
    wires = {"place": "daylight.place:place", "columns": "daylight:columns"}
    wires |= {"bounced": "daylight:bounced", "air": "daylight.air:air"}
    dome = use("lighting/daylight/dome", size=[columns, 27], inputs=wires)
    sketch = make_sketch(passes(daylight=use("lighting/daylight", hour=8.3), dome=dome))
    result = any_engine.read(sketch, "dome")
    assert "dome.fast.dome" in any_engine.record.ran
    np.testing.assert_array_equal(result, any_engine.read(sketch.plainly(), "dome"))

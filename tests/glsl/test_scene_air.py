"""scene/air: what is left of colours and what is added, by direction and distance, with mist and without.

The truth follows each ray in float64 through the same air: straight ways around a round Earth.
"""

import numpy as np
import pytest

from playground.sketch.model import Camera

from ..sketch_texts import toml_value
from ..truth.eyes import rays
from .test_air import RADIUS, _often, coefficients, left, profile, sky

FLAT = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) { return 0.0; }\n'
SEEN = (160, 100)
REACH, SLICES = 100.0, 16


@pytest.fixture
def outdoors(make_sketch):
    """Give a sketch of air over flat ground, with passes ``first`` before the air and ``rest`` after it.

    ``air`` is what is set of scene/air, ``day`` of daylight.
    """

    def make(air=None, rest="", files=None, target=(500.0, 500.0, 300.0), look=(40.0, 3.0), first="", **day):
        value = {"position": "free", "sun": [150.0, 40.0], "adaptation": 0.0, **day}
        sets = [", ".join(f"{k} = {toml_value(v)}" for k, v in d.items()) for d in (value, air or {})]
        sketch = make_sketch(
            '[[pass]]\nname = "height"\nuse = "./flat"\n'
            f'[[pass]]\nname = "daylight"\nuse = "lighting/daylight"\nset = {{ {sets[0]} }}\n'
            f"{first}"
            f'[[pass]]\nname = "air"\nuse = "scene/air"\nsize = [128, 80]\nset = {{ {sets[1]} }}\n{rest}',
            flat=FLAT,
            **(files or {}),
        )
        camera = Camera(
            azimuth=look[0] + 180, elevation=look[1], distance=100.0, target=target, field_of_view=40.0
        )
        return sketch.with_camera(camera)

    return make


def slices(engine, sketch, output):
    """Read one output as (slice, row from the south, column, channel), and each column's and row's ray."""
    result = engine.read(sketch, f"air:{output}", size=SEEN).astype(np.float64)[..., :3]
    result = result.reshape(4, 20, 4, 32, 3).transpose(0, 2, 1, 3, 4).reshape(SLICES, 20, 32, 3)
    eye = engine.record.plan.eye
    return result, rays(eye, (32, 20)), eye.position[2] / 1000


def heights(start, rise, way):
    return np.maximum(np.hypot(way * np.sqrt(1 - rise**2), RADIUS + start + way * rise) - RADIUS, 0)


def depth(start, rise, far, turbidity, mist=0.0, top=0.06, level=0.0):
    """Return Beer and Lambert's integral over a ray, kilometres."""
    share = (np.arange(20_000) + 0.5) / 20_000
    h = heights(start, rise, far * share**2)  # closest near the eye
    thin = profile(h).T @ coefficients(turbidity)
    drops = mist * np.exp(-np.maximum(h - level, 0) / top)
    return ((thin + drops[:, None]) * share[:, None]).sum(axis=0) * 2 * far / len(share)


RAYS = [(0, 0), (3, 31), (8, 15), (10, 2), (11, 28), (13, 16), (19, 5)]


@pytest.mark.parametrize(
    "mist",
    [{}, {"mist": 2.0, "mist_top": 60.0}, {"mist": 0.6, "mist_top": 400.0, "mist_level": 150.0}],
    ids=["clear", "low mist", "high mist"],
)
def test_what_is_left_is_beer_and_lambert_s_integral(any_engine, outdoors, mist):
    """Within one level of eight bits: in clear air and in mist, up, level and down to the sea."""
    sketch = outdoors(air=mist, turbidity=3.0)
    result, towards, start = slices(any_engine, sketch, "left")
    own = (mist.get("mist", 0.0), mist.get("mist_top", 60) / 1e3, mist.get("mist_level", 0) / 1e3)
    worst = 0.0
    for k in (2, 4, 6, 8, 11, 15):
        far = REACH * ((k + 1) / SLICES) ** 4
        for y, x in RAYS:
            truth = np.exp(-depth(start, towards[y, x, 2], far, 3.0, *own))
            worst = max(worst, np.abs(result[k, y, x] - truth).max())
    assert worst < 1 / 255


READ = """
#include "scene/air_reading.glsl"
#pragma kernel(output = "read:rgba32f")
uniform sampler2D scattered;  //! input("linear")
uniform sampler2D left;       //! input("linear")
uniform float far = 1000.0;
vec4 kernel(ivec2 texel) {
    Aerial air = aerial(scattered, left, (vec2(texel) + 0.5) / vec2(size), far);
    return vec4(air.left.g, air.left.b, air.scattered.g, air.scattered.b);
}
"""


def test_between_slices_it_is_read_as_even_air(any_engine, outdoors):
    """At any distance what is left is the integral's, in mist as well, and what is added grows from zero."""
    rest = '[[pass]]\nname = "read"\nuse = "./read_it"\nsize = [32, 20]\n'
    sketch = outdoors({"mist": 2.0, "mist_top": 100.0}, rest, {"read_it": READ}, turbidity=3.0)
    _, towards, start = slices(any_engine, sketch, "left")
    added = []
    for far in (0.0, 30.0, 120.0, 700.0, 2500.0, 9000.0, 61000.0):
        result = any_engine.read(sketch.with_values({"read.far": far}), "read", size=SEEN).astype(np.float64)
        for y, x in RAYS:
            if RADIUS + start + far / 1000 * towards[y, x, 2] < RADIUS:
                continue  # under the sea
            truth = np.exp(-depth(start, towards[y, x, 2], far / 1000, 3.0, 2.0, 0.1))
            np.testing.assert_allclose(result[y, x, :2], truth[1:], atol=4 / 255, err_msg=f"{far} {y} {x}")
        added.append(result[10, 16, 3])
    assert added[0] == 0 and (np.diff(added) > 0).all()
    assert added[1] / added[2] == pytest.approx(0.25, rel=0.1)  # near the eye in proportion to the distance


# ── what it adds ─────────────────────────────────────────────────────────────


def scattered(start, ray, far, sun, turbidity, table, sunny=None):
    """Return the light that clear air adds over a ray, times pi; ``table`` as in test_air.

    ``sunny`` gives the fraction of the sun that clouds leave after each distance [km], by default all.
    """
    share = (np.arange(1500) + 0.5) / 1500
    way, long = far * share**2, 2 * far * share / 1500
    there = heights(start, ray[2], way)
    together = ray @ sun
    sun_there = np.clip(((RADIUS + start) * sun[2] + way * together) / (RADIUS + there), -1, 1)
    extinct = coefficients(turbidity)
    amounts = profile(there)
    each = amounts.T @ extinct * long[:, None]
    passed = np.cumsum(each, axis=0) - each / 2
    seen = np.exp(-passed) * long[:, None]
    lit = seen * left(there, sun_there, turbidity)
    molecules = amounts[0][:, None] * extinct[0]
    aerosol = amounts[1][:, None] * extinct[1] * 0.9
    phase = 3 / (8 * np.pi) * 0.36 / 2.64 * (1 + together**2) / (1.64 - 1.6 * together) ** 1.5
    once = lit * (molecules * (3 / (16 * np.pi) * (1 + together**2)) + aerosol * phase)
    if sunny is not None:
        once = once * sunny(way)[:, None]
    often = seen * (molecules + aerosol) * _often(table, there, sun_there)
    return np.pi * (once + often).sum(axis=0)


@pytest.mark.parametrize("elevation", [40.0, 4.0, -3.0])
def test_what_is_added_is_what_the_air_on_the_way_scatters(any_engine, outdoors, elevation):
    sketch = outdoors(turbidity=3.0, sun=[70.0, elevation])
    result, towards, start = slices(any_engine, sketch, "scattered")
    table = any_engine.read(sketch, "daylight.bounced").astype(np.float64)[..., :3]
    sun = any_engine.read(sketch, "daylight")[0, 0, :3].astype(np.float64)
    for k in (6, 10, 13):
        for y, x in ((10, 2), (11, 28), (13, 16), (19, 5)):
            truth = scattered(start, towards[y, x], REACH * ((k + 1) / SLICES) ** 4, sun, 3.0, table)
            np.testing.assert_allclose(result[k, y, x], truth, rtol=0.06, atol=1e-7)


HALF = """
#pragma kernel(output = "cloud:rgba16f")
// Opaque up to half of the tile eastwards, or from there on.
uniform float opaque = 0.0;
vec4 kernel(ivec2 texel) {
    return vec4(1.0, 0.5, 0.5, (2 * texel.x < size.x) == (opaque < 0.5) ? 0.0 : 1.0);
}
"""


@pytest.mark.parametrize("opaque", [0.0, 1.0], ids=["cloud first", "cloud behind"])
@pytest.mark.parametrize("elevation", [50.0, 20.0])
def test_air_in_the_shadow_of_clouds_scatters_no_beam(any_engine, outdoors, opaque, elevation):
    """The shadow's edge is across the ray, where a slice ends; the sun is at right angles to the ray."""
    first = f'[[pass]]\nname = "cloud"\nuse = "./half"\nsize = [512, 4]\nset = {{ opaque = {opaque} }}\n'
    first += '[[pass]]\nname = "drift"\nuse = "clouds/drift"\nsize = 1\n'
    first += "set = { base = 2000.0, wide = 50000.0 }\n"
    edge = REACH * (8 / SLICES) ** 4  # km from the eye
    eye = (25000.0 - 1000 * edge, 500.0, 300.0)
    sketch = outdoors(files={"half": HALF}, target=eye, look=(90.0, 0.0), first=first, sun=[0.0, elevation])
    result, towards, start = slices(any_engine, sketch, "scattered")
    table = any_engine.read(sketch, "daylight.bounced").astype(np.float64)[..., :3]
    sun = any_engine.read(sketch, "daylight")[0, 0, :3].astype(np.float64)
    for k in (5, 7, 8, 9, 10):
        far = REACH * ((k + 1) / SLICES) ** 4
        for y, x in ((10, 15), (12, 16)):
            ray = towards[y, x]
            truth = scattered(start, ray, far, sun, 2.5, table, lambda way: (way > edge) == (opaque < 0.5))
            np.testing.assert_allclose(result[k, y, x], truth, rtol=0.06, err_msg=f"{k} {y} {x}")


LOOK = """
#include "lighting/daylight_sky.glsl"
#pragma kernel(output = "seen:rgba32f")
uniform sampler2D daylight;  //! input
vec4 kernel(ivec2 texel) {
    vec2 place = (vec2(texel) + 0.5) / vec2(size) * 2.0 - 1.0;
    vec4 away = world_from_clip * vec4(place, 1.0, 1.0);
    return vec4(sky_towards(daylight, normalize(away.xyz / away.w - eye), 0.001 * eye.z), 1.0);
}
"""


@pytest.mark.parametrize("height", [20.0, 606.0, 2500.0])
def test_the_farthest_slice_and_the_sky_behind_it_are_the_sky(any_engine, outdoors, height):
    """From any height of the eye: the air in front, and what comes through it from the sky beyond."""
    rest = '[[pass]]\nname = "seen"\nuse = "./look"\nsize = [32, 20]\n'
    for elevation in (50.0, 5.0):
        sketch = outdoors(
            None, rest, {"look": LOOK}, (500.0, 500.0, height), (40.0, -12.0), sun=[100.0, elevation]
        )
        result, towards, start = slices(any_engine, sketch, "scattered")
        through, _, _ = slices(any_engine, sketch, "left")
        whole = any_engine.read(sketch, "seen", size=SEEN).astype(np.float64)[..., :3]
        table = any_engine.read(sketch, "daylight.bounced").astype(np.float64)[..., :3]
        sun = any_engine.read(sketch, "daylight")[0, 0, :3].astype(np.float64)
        for y, x in ((10, 3), (11, 16), (12, 30), (14, 9)):
            ray = towards[y, x]
            there = heights(start, ray[2], REACH)
            rise = ((RADIUS + start) * ray[2] + REACH) / (RADIUS + there)
            sun_there = ((RADIUS + start) * sun[2] + REACH * (ray @ sun)) / (RADIUS + there)
            aside = (ray @ sun - rise * sun_there) / np.sqrt((1 - rise**2) * (1 - sun_there**2))
            turned = np.degrees(np.arcsin(sun_there))
            aerosol, others, together = sky(rise, np.clip(aside, -1, 1), turned, 2.5, table, there)
            phase = 3 / (8 * np.pi) * 0.36 / 2.64 * (1 + together**2) / (1.64 - 1.6 * together) ** 1.5
            sum_of = result[15, y, x] + through[15, y, x] * (others + phase * aerosol)
            np.testing.assert_allclose(sum_of, whole[y, x], rtol=0.06, err_msg=f"{elevation} {y} {x}")


def test_nothing_lights_up_at_night_and_all_are_numbers(any_engine, outdoors):
    """Mist and air under a sun that sets: what is added goes down with it, to nothing."""
    bright = []
    for elevation in (30.0, 5.0, 0.5, -0.5, -3.0, -9.0, -20.0, -60.0):
        sketch = outdoors({"mist": 2.0}, sun=[220.0, elevation], turbidity=6.0, clouds=0.5)
        result, _, _ = slices(any_engine, sketch, "scattered")
        assert np.isfinite(result).all() and (result >= 0).all()
        bright.append(result.max())
    assert (np.diff(bright) <= 0).all() and bright[-2] < 1e-6 * bright[0]


def test_mist_is_no_brighter_than_white_surface_in_same_light(any_engine, outdoors):
    """It scatters what comes to it and adds none: away from the sun no mist outshines paper that faces it."""
    for elevation in (60.0, 20.0, 3.0):
        sketch = outdoors({"mist": 8.0, "mist_top": 800.0}, look=(150.0, 3.0), sun=[330.0, elevation])
        result, _, _ = slices(any_engine, sketch, "scattered")
        row = any_engine.read(sketch, "daylight", size=SEEN)[0].astype(np.float64)
        most = row[1, :3] + row[2, :3] + 0.2 * row[5, :3]
        assert (result.max(axis=(0, 1, 2)) < most).all() and result[12:, :, :, 1].min() > 0.15 * most[1]

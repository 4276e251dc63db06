"""scene/water: where water is seen, what it mirrors, and that it makes no light, against float64."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from playground.engine.plan import Window
from playground.engine.textures import read_picture
from playground.paths import GLSL
from playground.shader.source import read_source
from playground.sketch.model import Camera

from ..sketch_texts import passes
from ..truth.surfaces import reflected
from .test_scene import EXTENT, LOOK, PASSES, PLANE, RELIEF, SIZE, all_pixels, on_plane, rays

LEVEL = 90.0
HEIGHT = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) {{ return {}; }}\n'
COLOUR = '#pragma kernel(output = "colour:rgba16f")\nvec4 kernel(ivec2 texel) {{ return {}; }}\n'
GREY = COLOUR.format("vec4(0.5)").replace("colour", "grey")
WHITE = "zenith = [1.0, 1.0, 1.0], horizon = [1.0, 1.0, 1.0], nadir = [1.0, 1.0, 1.0]"
BLACK = WHITE.replace("1.0", "0.0")
INDEX = 1.333
CALM = "wind = 0.0, foam = 0.0, gain = 0.0, ambient = 1.0"
PEAK = """0.9 * max(0.0, 1.0 - 6.0 * distance(vec2(texel) / vec2(size - 1), vec2(0.5, 0.72)))
    + 0.1 * step(0.6, float(texel.y) / float(size.y - 1))"""
NEAR_PEAK = PEAK.replace("0.72", "0.3")


@pytest.fixture
def scene(make_sketch):
    """Give a function that makes a scene with a sea at LEVEL."""

    def make(
        height=PLANE,
        colour="vec4(0.5)",
        given=CALM,
        level=LEVEL,
        water="water/sea",
        size=(65, 41),
        body="",
        wired="",
    ):
        sea = f'[[pass]]\nname = "water"\nuse = "{water}"\nsize = 1\nset = {{ sea_level = {level} }}\n'
        set_ = f"set = {{ antialias = false, grid = 65, {given} }}"
        inputs = f"inputs = {{ {wired} }}\n" if wired else ""
        text = f'{PASSES}{sea}{body}[view]\nuse = "scene/terrain"\nsamples = 1\n{inputs}{set_}\n'
        files = {"terrain": HEIGHT.format(height), "cover": COLOUR.format(colour), "grey": GREY}
        sketch = make_sketch(text, size=list(size), extent=list(EXTENT), relief=RELIEF, **files)
        return sketch.with_camera(LOOK)

    return make


def read(engine, sketch, name, size=SIZE):
    return engine.read(sketch, f"view.{name}", size=size).astype(float)


# ── where ───────────────────────────────────────────────────────────────────────


def test_water_appears_where_rays_meet_its_level_before_ground(any_engine, scene):
    result = read(any_engine, scene(), "watered.where:seen_water")
    eye, ahead = rays(any_engine.record.plan, all_pixels())
    ground = on_plane(eye, ahead)
    surface = eye + ahead * ((LEVEL - eye[2]) / ahead[..., 2:])
    below = ground[..., 2] < LEVEL
    on = np.all((ground[..., :2] > 2) & (ground[..., :2] < np.array(EXTENT) - 2), axis=-1)
    water = result[..., 3] == 3
    assert (on & below).sum() > 500 and (on & ~below).sum() > 500
    # Within a pixel of the shore either is right.
    shore = np.abs(ground[..., 2] - LEVEL) < 0.6 * np.abs(np.gradient(ground[..., 2], axis=0)) + 0.1
    np.testing.assert_array_equal(water[on & ~shore], below[on & ~shore])
    wet = water & on & ~shore
    np.testing.assert_allclose(result[wet][:, :3], surface[wet], atol=0.05)
    depth = read(any_engine, scene(), "watered.where:state")[..., 0]
    np.testing.assert_allclose(depth[on & ~shore], LEVEL - ground[on & ~shore][:, 2], atol=0.05)


def test_the_sea_goes_on_to_the_horizon_and_ends_there(any_engine, scene):
    """From 60 m over it the horizon is 0.25 degrees below level, 27.7 km away."""
    low = Camera(azimuth=180, elevation=0.0, distance=300, target=(450, 350, LEVEL + 60.0), field_of_view=20)
    sketch = scene(height="0.05 + 0.0 * float(texel.x)").with_camera(low)
    result = read(any_engine, sketch, "watered.where:seen_water", (60, 800))
    eye, ahead = rays(any_engine.record.plan, np.stack(np.indices((60, 800)), axis=-1)[30][:, ::1])
    rise = ahead[:, 2] / np.linalg.norm(ahead[:, :2], axis=1)
    column = result[:, 30]
    water = column[:, 3] == 3
    sea = eye[2] - LEVEL
    edge = np.sqrt(2 * sea / 6360e3)
    assert water[rise < -edge - 5e-4].all() and not water[rise > -edge + 5e-4].any()
    far = np.linalg.norm(column[water][:, :3] - eye, axis=1)
    assert np.all(np.diff(far) > 0) and 15_000 < far[-1] < 30_000  # of rows 0.025 degrees apart


@pytest.mark.parametrize("level", [-50.0, 5000.0])
def test_pictures_without_water_in_sight_stay_as_they_are(any_engine, scene, level):
    """Far below the ground, or with the eye under it."""
    sketch = scene(level=level)
    before, after = (read(any_engine, sketch, name) for name in ("shaded", "watered.surface"))
    where = read(any_engine, sketch, "where")
    land = where[..., 3] > 0
    np.testing.assert_array_equal(after[land], before[land])


@pytest.mark.slow
def test_clouds_that_no_drift_places_are_none(any_engine, scene):
    value = "wind = 2.0, gain = 1.0, ambient = 0.5, clouds = 1"
    grey = '[[pass]]\nname = "grey"\nuse = "./grey"\n'
    sketch, clear = scene(given=value, body=grey, wired='cloud = "grey"'), scene(given=value)
    result, expected = (read(any_engine, sketch, "watered.surface") for sketch in (sketch, clear))
    np.testing.assert_array_equal(result, expected)


# ── what is mirrored ────────────────────────────────────────────────────────────


@pytest.mark.parametrize(("peak", "away", "at_sea"), [(PEAK, 330, False), (NEAR_PEAK, 900, True)])
def test_calm_water_mirrors_a_peak_within_a_pixel(any_engine, scene, peak, away, at_sea):
    """A dark peak before a white sky: its image is where that of the peak below the surface would be.

    From at sea all of the image is on water beyond the terrain's edge.
    """
    text = (
        f"{CALM}, zenith = [1.0, 1.0, 1.0], horizon = [1.0, 1.0, 1.0], deep = [0.0, 0.0, 0.0], clarity = 0.05"
    )
    look = Camera(azimuth=180, elevation=9, distance=away, target=(450, 330, 10), field_of_view=62)
    size = (241, 240)
    dark = scene(peak, "vec4(0.0, 0.0, 0.0, 1.0)", text, level=15.0, size=(181, 141)).with_camera(look)
    result = read(any_engine, dark, "watered.surface", size)[..., 0]
    places = read(any_engine, dark, "watered.where:seen_water", size)
    water = places[..., 3] == 3
    plan = any_engine.record.plan
    heights = any_engine.read(dark, "height").astype(float)
    row, column = np.unravel_index(heights.argmax(), heights.shape)
    top = np.array([column / 180 * EXTENT[0], row / 140 * EXTENT[1], 2 * 15.0 - heights.max() * RELIEF, 1.0])
    clip = plan.eye.clip_from_world.astype(float) @ top
    x, y = (clip[:2] / clip[3] * 0.5 + 0.5) * np.array(size) - 0.5
    line = result[:, round(x)]
    lit = water[:, round(x)] & (line > 1e-3)
    first_dark = np.flatnonzero(lit)[-1] + 0.5  # the sky is mirrored below, the peak above
    assert first_dark == pytest.approx(y, abs=1.0)
    assert (places[round(y) + 1, round(x), 1] < 0) == at_sea
    # And to the sides: the image ends where the mirrored slopes do, as wide as the peak itself.
    across = water[round(y) + 6] & (result[round(y) + 6] < 1e-3)
    middle = np.flatnonzero(across).mean()
    assert middle == pytest.approx(x, abs=1.0)


def test_what_is_mirrored_is_lit_as_it_is_seen(any_engine, scene):
    """The image of each point that the eye sees is Fresnel's share of its light, where still water has it."""
    value = "wind = 0.0, foam = 0.0, gain = 0.7, ambient = 0.4, haze = 0.0, sun = [200.0, 35.0]"
    value += ", deep = [0.0, 0.0, 0.0], clarity = 0.05"
    look = Camera(azimuth=180, elevation=9, distance=330, target=(450, 330, 10), field_of_view=62)
    size = (241, 240)
    lit = scene(PEAK, "vec4(0.8, 0.5, 0.2, 1.0)", value, level=15.0, size=(181, 141)).with_camera(look)
    shown, mirrored, seen, water = (
        read(any_engine, lit, name, size)
        for name in ("shaded", "watered.surface", "where", "watered.where:seen_water")
    )
    eye = any_engine.record.plan.eye
    high = (seen[..., 3] == 1) & (seen[..., 2] > 25.0)
    points, light = seen[high][:, :3], shown[high][:, :3]
    image = np.column_stack([points[:, :2], 30.0 - points[:, 2], np.ones(len(points))])
    clip = image @ eye.clip_from_world.astype(float).T
    x, y = ((clip[:, :2] / clip[:, 3:] * 0.5 + 0.5) * size).astype(int).T
    inside = (x >= 0) & (x < size[0]) & (y >= 0) & (y < size[1])
    x, y, light, points = x[inside], y[inside], light[inside], points[inside]
    wet = water[y, x, 3] == 3
    to_eye = np.array(eye.position) - water[y, x][wet][:, :3]
    cosine = to_eye[:, 2] / np.linalg.norm(to_eye, axis=1)
    expected = light[wet] * reflected(cosine)[:, None]
    assert wet.sum() > 200
    share = mirrored[y, x][wet][:, :3] / expected
    assert np.median(share, axis=0) == pytest.approx(1.0, abs=0.1)  # rock is lumpy there


def test_the_table_of_the_sky_knows_its_directions(on_gpu):
    file = "scene/water/heaven_reading.glsl"
    texel = np.stack(np.meshgrid(np.arange(96), np.arange(48)), axis=-1).reshape(-1, 2).astype(np.int32)
    to = on_gpu(file, "heaven_direction(t, ivec2(96, 48))", t=texel)
    np.testing.assert_allclose(np.linalg.norm(to, axis=1), 1.0, atol=1e-6)
    back = on_gpu(file, "heaven_place(to, THIN_SKY, ivec2(96, 144))", to=to) % 1.0
    np.testing.assert_allclose(back, (texel + np.array([0.5, 48.5])) / [96, 144], atol=1e-5)


@pytest.mark.slow
def test_a_picture_in_parts_is_the_whole_picture(any_engine, scene):
    sketch = scene(given="wind = 5.0, foam = 1.0")
    whole = any_engine.render(sketch, size=SIZE).array
    part = Window((40, 20), (80, 47), SIZE)
    picture = read_picture(any_engine.draw_window(sketch, part))
    (x, y), (width, height) = part.origin, part.size
    there = whole[SIZE[1] - y - height : SIZE[1] - y, x : x + width]
    # A corner of the mesh is rounded otherwise from another corner of the picture.
    off = np.abs(picture.astype(int) - there)
    assert off.max() <= 2 and (off > 0).mean() < 0.001


def test_no_shader_takes_more_textures_than_every_device_has():
    for path in sorted((GLSL / "scene" / "water").glob("*.glsl")):
        code = read_source(path, (GLSL,)).code
        assert len(set(re.findall(r"^uniform sampler2D (\w+)", code, re.MULTILINE))) <= 16, path.name


OUTDOORS = (
    passes(
        height="./flat",
        daylight=(
            "lighting/daylight",
            'set = { position = "free", sun = [150.0, 40.0], adaptation = 0.0, clouds = COVER }',
        ),
        cloud=("clouds/field", "size = 256"),
        drift=("clouds/drift", "size = 1"),
        water=("water/sea", "size = 1", "set = { sea_level = 50.0 }"),
    )
    + """[view]
use = "scene/terrain"
samples = 1
inputs = { dome = "daylight:dome" }
set = { wind = 0.0, gain = 1.0, ambient = 1.0, foam = 0.0, deep = [0.0, 0.0, 0.0], clarity = 0.05 }
"""
)


def mirrored_and_above(engine, make_sketch, cover):
    """Return what a still sea mirrors over Fresnel's share, and the sky, of the same strips of sky."""
    text = OUTDOORS.replace("COVER", str(cover))
    sketch = make_sketch(text, extent=[4000.0, 4000.0], flat=HEIGHT.format("0.0"))
    size = (96, 64)
    pairs = []
    for azimuth in range(0, 360, 60):
        look = Camera(azimuth=azimuth, distance=50.0, target=(2000.0, 2000.0, 80.0), field_of_view=24)
        below = read(engine, sketch.with_camera(replace(look, elevation=18.0)), "watered.surface", size)
        _, ahead = rays(engine.record.plan, all_pixels(size))
        rise = ahead[..., 2] / np.linalg.norm(ahead, axis=-1)
        below = below[..., :3] / reflected(-rise)[..., None]
        up = replace(look, elevation=-18.0)
        pairs.append((below, read(engine, sketch.with_camera(up), "heaven", size)[::-1, :, :3]))
    return (np.stack(each) for each in zip(*pairs, strict=True))


@pytest.mark.slow
@pytest.mark.parametrize("cover", [0.4, 0.7])
def test_reflected_clouds_match_light_and_colour_of_real_ones(any_engine, make_sketch, cover):
    """On the mean to a tenth of the light; the air before the water makes it a little bluer."""
    below, above = mirrored_and_above(any_engine, make_sketch, cover)
    below, above = below.mean(axis=(0, 1, 2)), above.mean(axis=(0, 1, 2))
    luminance = np.array([0.2126, 0.7152, 0.0722])
    assert below @ luminance == pytest.approx(above @ luminance, rel=0.1)
    np.testing.assert_allclose(below, above, rtol=0.17)


# ── light ───────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("wind", [0.0, 6.0, 20.0])
def test_water_in_an_even_light_adds_none(any_engine, scene, wind):
    """White ground, white sky, white foam and clear water: no pixel is brighter than white."""
    text = f"{WHITE}, wind = {wind}, foam = 1.0, gain = 0.0, ambient = 1.0, deep = [1.0, 1.0, 1.0]"
    sketch = scene(colour="vec4(1.0)", given=text)
    water = read(any_engine, sketch, "watered.where:seen_water")[..., 3] == 3
    result = read(any_engine, sketch, "watered.surface")[..., :3]
    assert water.sum() > 1000
    assert result[water].max() <= 1.002
    assert result[water].min() > 0.4  # and little is lost: what foam and what goes in and does not return


def test_nothing_lights_up_at_night(any_engine, scene):
    text = f"{BLACK}, wind = 8.0, gain = 2.0, ambient = 0.0, sun = [200.0, -12.0]"
    sketch = scene(given=text)
    result = read(any_engine, sketch, "watered.surface")[..., :3]
    shown = read(any_engine, sketch, "where")[..., 3]
    np.testing.assert_array_equal(result[shown < 2], 0.0)  # the cut is in a light of its own


def test_deep_water_is_darker_and_less_red(any_engine, scene):
    text = (
        f"{CALM}, clarity = 2.0, zenith = [0.0, 0.0, 0.0], horizon = [0.0, 0.0, 0.0], deep = [0.0, 0.0, 0.0]"
    )
    sketch = scene(given=text)
    depth = read(any_engine, sketch, "watered.where:state")[..., 0]
    position = read(any_engine, sketch, "watered.where:seen_water")
    water = position[..., 3] == 3
    result = read(any_engine, sketch, "watered.surface")[..., :3]
    land = read(any_engine, sketch, "where")[..., 3] == 1
    mask = water & land & (depth > 0.3) & (depth < 3.0)
    assert mask.sum() > 20
    to_eye = np.array(any_engine.record.plan.eye.position) - position[mask][:, :3]
    up = to_eye[:, 2] / np.linalg.norm(to_eye, axis=1)
    # Snell: a path of a metre's depth, from the sun, of which CALM has the place only, and to the eye.
    path = sum(1 / np.sqrt(1 - (1 - c**2) / INDEX**2) for c in (np.sin(np.radians(25.0)), up))
    pure = np.array([0.2755, 0.0565, 0.00922])  # Pope and Fry, at 620, 550 and 450 nm
    lost = pure + np.array([0.95, 1.0, 1.35]) * (1 / 2.0 - pure[1])
    log = np.log(result[mask])
    for first, other in [(0, 1), (2, 1)]:
        each_metre = (log[:, first] - log[:, other]) / (depth[mask] * path)
        np.testing.assert_allclose(each_metre, lost[other] - lost[first], rtol=0.05)

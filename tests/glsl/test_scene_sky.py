"""The scene under a daylight's sky, through air and under clouds: against float64 and the clouds' shade."""

from dataclasses import replace

import numpy as np
import pytest

from playground.sketch.model import Camera

from ..sketch_texts import passes
from .test_scene_air import FLAT, depth

SIZE = (96, 64)
COLOUR = """
#pragma kernel(output = "colour:rgba16f")
uniform float grey = 0.5;
vec4 kernel(ivec2 texel) { return vec4(vec3(grey), 1.0); }
"""
VIEW = (
    passes(
        height="./flat",
        colour="./grey",
        daylight=(
            "lighting/daylight",
            'set = { position = "free", sun = [140, 50], adaptation = 0.0, turbidity = 3.0, clouds = 0.5 }',
        ),
        cloud=("clouds/field", "size = 128"),
        drift=("clouds/drift", "size = 1"),
        shade=("clouds/shade", "size = 401"),
    )
    + """[view]
use = "scene/terrain"
set = { gain = 1.0, ambient = 1.0 }
samples = 1
inputs = { columns = "daylight:columns", bounced = "daylight:bounced", dome = "daylight:dome" }
"""
)


@pytest.fixture
def scene(make_sketch):
    sketch = make_sketch(VIEW, extent=20000.0, flat=FLAT, grey=COLOUR)
    camera = Camera(
        azimuth=200.0, elevation=9.0, distance=9000.0, target=(10000.0, 11000.0, 0.0), field_of_view=40.0
    )
    return sketch.with_camera(camera)


def read(engine, sketch, grey, name="view.shaded"):
    return engine.read(sketch.with_values({"colour.grey": grey}), name, size=SIZE).astype(np.float64)


@pytest.mark.slow
def test_colours_fade_by_the_air_in_front_of_them(any_engine, scene):
    """What brighter ground adds has gone through air and mist; black ground shows what they add."""
    scene = scene.with_values({"view.mist": 0.3, "view.mist_top": 200.0})
    seen = read(any_engine, scene, 0.5, "view.where")
    eye = np.asarray(any_engine.record.plan.eye.position, np.float64)
    black, grey = read(any_engine, scene, 0.0), read(any_engine, scene, 0.5)
    row = any_engine.read(scene, "daylight", size=SIZE)[0].astype(np.float64)
    shade = any_engine.read(scene, "shade", size=SIZE).astype(np.float64)
    checked = 0
    for y in range(2, 64, 6):
        for x in range(3, 96, 9):
            if seen[y, x, 3] != 1.0:
                continue
            way = seen[y, x, :3] - eye
            far = np.linalg.norm(way) / 1000
            column, line = np.round(seen[y, x, :2] / 50.0).astype(int)
            near = shade[line - 1 : line + 2, column - 1 : column + 2]
            if near.size < 9 or np.ptp(near) > 0.02:
                continue  # the edge of a shadow
            light = row[1, :3] * row[0, 2] * near.mean() + row[2, :3]
            left = np.exp(-depth(eye[2] / 1000, way[2] / 1000 / far, far, 3.0, 0.3, 0.2))
            np.testing.assert_allclose((grey - black)[y, x, :3] / (0.5 * light), left, atol=0.03)
            assert (black[y, x, :3] > 0).all()
            checked += 1
    assert checked > 25


@pytest.mark.slow
def test_where_no_clouds_are_drawn_they_throw_no_shadows(any_engine, scene):
    """All ground is in the light of daylight's even cover, and so is the air in front of it."""
    scene = scene.with_values({"view.clouds": "none"})
    seen = read(any_engine, scene, 0.5, "view.where")
    eye = np.asarray(any_engine.record.plan.eye.position, np.float64)
    added = read(any_engine, scene, 0.5) - read(any_engine, scene, 0.0)
    row = any_engine.read(scene, "daylight", size=SIZE)[0].astype(np.float64)
    shade = any_engine.read(scene, "shade", size=SIZE).astype(np.float64)
    assert shade.min() < 0.1 and shade.max() > 1.3  # of the clouds that are not drawn
    places = np.argwhere(seen[..., 3] == 1.0)[::150]
    assert len(places) > 15
    for y, x in places:
        way = (seen[y, x, :3] - eye) / 1000
        far = np.linalg.norm(way)
        left = np.exp(-depth(eye[2] / 1000, way[2] / far, far, 3.0))
        light = row[1, :3] * row[0, 2] + row[2, :3]
        np.testing.assert_allclose(added[y, x, :3] / (0.5 * light), left, atol=0.03)
    # The air is lit alike on both sides of the sun's plane, which the clouds' shadows are not.
    towards_sun = scene.with_camera(replace(scene.camera, azimuth=320.0))
    air = any_engine.read(towards_sun, "view.heaven.air:scattered", size=SIZE).astype(np.float64)[..., :3]
    air = air.reshape(4, 20, 4, 32, 3)
    np.testing.assert_allclose(air, air[:, :, :, ::-1], rtol=0.01)


def test_behind_the_terrain_is_the_picture_of_the_sky(any_engine, scene):
    seen = read(any_engine, scene, 0.5, "view.where")
    shaded, heaven = read(any_engine, scene, 0.5), read(any_engine, scene, 0.5, "view.heaven")
    sky = seen[..., 3] == 0.0
    assert sky.any() and not sky.all()
    np.testing.assert_array_equal(shaded[sky][:, :3], heaven[sky][:, :3])


@pytest.mark.parametrize("drawn", ["flat", "heaped"])
def test_sky_computed_where_visible_matches_full_sky(any_engine, make_sketch, scene, drawn):
    whole = '[[pass]]\nname = "air"\nuse = "scene/air"\nsize = [128, 80]\n'
    whole += f'[[pass]]\nname = "whole"\nuse = "scene/sky"\nsize = [96, 64]\nset = {{ clouds = "{drawn}" }}\n'
    whole += 'inputs = { scattered = "air:scattered", left = "air:left", columns = "daylight:columns", '
    whole += 'bounced = "daylight:bounced", dome = "daylight:dome" }\n'
    sketch = make_sketch(VIEW.replace("[view]", whole + "[view]"), extent=20000.0, flat=FLAT, grey=COLOUR)
    sketch = sketch.with_camera(scene.camera).with_values({"view.clouds": drawn})
    sky = read(any_engine, sketch, 0.5, "view.where")[..., 3] == 0.0
    parts, whole = (read(any_engine, sketch, 0.5, name) for name in ("view.heaven", "whole"))
    assert sky.any() and not sky.all()
    np.testing.assert_array_equal(parts[sky], whole[sky])
    assert (parts[~sky][:, :3] == 0).all()

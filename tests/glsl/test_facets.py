"""Facets of the mesh in view/terrain: each lit by its own normal, worked out here from its three corners."""

import numpy as np
import pytest

from playground.sketch.model import Camera

from ..truth.eyes import pixels_of
from ..truth.land import towards

SIDE, RELIEF = 1000.0, 300.0
PASSES = (
    '[[pass]]\nname = "height"\nuse = "generation/white_noise"\nset = { seed = 3 }\n'
    '[view]\nuse = "view/terrain"\nsamples = 1\nset = { grid = 5, facets = true, facet_ambient = 0.25'
)


@pytest.fixture
def sketch_of(make_sketch):
    def make(given=""):
        sketch = make_sketch(PASSES + given + " }\n", size=5, extent=SIDE, relief=RELIEF)
        return sketch.with_camera(Camera(azimuth=160.0, elevation=75.0))

    return make


def triangles(heights):
    """Yield each face's corners: cells are cut from their south-west to their north-east."""
    n = len(heights)
    points = [[np.array([i, j, 0]) * SIDE / (n - 1) for i in range(n)] for j in range(n)]
    for j in range(n):
        for i in range(n):
            points[j][i][2] = heights[j, i] * RELIEF
    for j in range(n - 1):
        for i in range(n - 1):
            corner, opposite = points[j][i], points[j + 1][i + 1]
            yield np.array([corner, points[j][i + 1], opposite])
            yield np.array([corner, opposite, points[j + 1][i]])


@pytest.mark.parametrize("azimuth, elevation", [(135.0, 30.0), (20.0, 60.0), (270.0, 5.0), (0.0, -10.0)])
def test_every_facet_has_the_light_of_its_own_normal(any_engine, sketch_of, azimuth, elevation):
    sketch = sketch_of(f", facet_sun = [{azimuth}, {elevation}]")
    heights = any_engine.read(sketch, "height").astype(float)
    any_engine.render(sketch, size=(400, 300))
    frame = any_engine.read(sketch, "view.land", size=(400, 300)).astype(float)
    plan, sun = any_engine.record.plan, towards(azimuth, elevation)
    shades = []
    for face in triangles(heights):
        normal = np.cross(face[1] - face[0], face[2] - face[0])
        normal /= np.linalg.norm(normal)
        direct = max(normal @ sun, 0) if elevation >= 0 else 0
        shades.append(direct + 0.25 * (1 + normal[2]) / 2)
        inside = np.array([face.mean(axis=0), face.T @ [0.6, 0.2, 0.2], face.T @ [0.2, 0.2, 0.6]])
        for column, row in pixels_of(plan.eye, inside, plan.frame_size).astype(int):
            np.testing.assert_allclose(frame[row, column, :3], shades[-1], atol=4e-3)
    assert np.std(shades) > 0.01


def test_facets_take_the_colour_and_leave_the_light_map(any_engine, make_sketch):
    red = '#pragma kernel(output = "{0}:rgba16f")\nvec4 kernel(ivec2 texel) {{ return vec4({1}, 1.0); }}\n'
    passes = '[[pass]]\nname = "height"\nuse = "./flat"\n[[pass]]\nname = "colour"\nuse = "./red"\n'
    passes += '[[pass]]\nname = "light"\nuse = "./dark"\n[view]\nuse = "view/terrain"\nsamples = 1\n'
    passes += "set = { facets = true, facet_sun = [0.0, 90.0], facet_ambient = 0.0 }\n"
    sketch = make_sketch(
        passes,
        flat='#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) { return 0.0; }\n',
        red=red.format("colour", "0.8, 0.2, 0.1"),
        dark=red.format("light", "0.0, 0.0, 0.0"),
    ).with_camera(Camera(azimuth=180.0, elevation=60.0))
    any_engine.render(sketch, size=(64, 64))
    shown = any_engine.read(sketch, "view.land", size=(64, 64))[32, 32, :3]
    np.testing.assert_allclose(shown, [0.8, 0.2, 0.1], rtol=2e-3)


def test_the_sun_on_facets_changes_nothing_where_there_are_none(any_engine, sketch_of):
    pictures = []
    for name in ("", ", facet_sun = [20.0, 70.0]"):
        sketch = sketch_of(name).with_values({"view.facets": False})
        pictures.append(any_engine.render(sketch, size=(120, 90)).array)
    np.testing.assert_array_equal(*pictures)

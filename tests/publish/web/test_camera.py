"""A page's cameras and directions are the engine's, to the last bit of every number."""

from __future__ import annotations

import math
from dataclasses import asdict

import numpy as np
import pytest

from playground.engine import camera as cameras
from playground.engine.camera import cos_sin, unit_vector
from playground.sketch.model import Camera

from .node import Node

Scene = tuple[Camera, tuple[float, float], float, tuple[int, int]]


def random_scene(rng: np.random.Generator) -> Scene:
    extent = tuple(10 ** rng.uniform(0, 5, 2))
    relief = float(rng.choice([0.0, *(rng.choice([-1, 1]) * 10 ** rng.uniform(0, 4, 4))]))
    target = (
        (*(rng.uniform(-0.5, 1.5, 2) * extent), rng.uniform(-1, 1) * relief) if rng.random() < 0.5 else None
    )
    distance = 0.0 if rng.random() < 0.5 else 10 ** rng.uniform(-2, 6)
    # Often angles at which a sine, a cosine or their difference is 0.
    azimuth = rng.choice([rng.uniform(-720, 720), rng.integers(-16, 17) * 45.0])
    elevation = rng.choice([rng.uniform(-89, 89), *(-90.0, 0.0, 45.0, 89.0, 90.0)])
    camera = Camera(azimuth, elevation, distance, target, rng.uniform(1, 170))
    return camera, extent, relief, (int(rng.integers(1, 3000)), int(rng.integers(1, 3000)))


def bits(array: np.ndarray) -> list[int]:
    return array.astype(np.float32).view(np.uint32).ravel().tolist()


@pytest.mark.slow
def test_matrices_are_the_same_to_the_last_bit(node: Node):
    rng = np.random.default_rng(0)
    scenes = [random_scene(rng) for _ in range(2_000)]
    result = node.each("camera.js", "look", [(asdict(camera), *rest) for camera, *rest in scenes])
    for scene, eye in zip(scenes, result, strict=True):
        expected = cameras.look(*scene)
        assert bits(eye["clipFromWorld"]) == bits(expected.clip_from_world.T), scene
        assert bits(eye["worldFromClip"]) == bits(expected.world_from_clip.T), scene
        assert (*eye["eye"], *eye["target"]) == (*expected.position, *expected.target), scene
        assert eye["distance"] == expected.distance, scene


def test_a_camera_is_moved_as_the_windows_is(node: Node):
    rng = np.random.default_rng(1)
    script = """async (cases, load) => {
      const { look, orbit, zoom, pan } = await load("camera.js");
      return cases.map(([scene, a, b]) =>
        [orbit(scene[0], a, b), zoom(scene[0], a, b), pan(scene[0], look(...scene), a, b)]);
    }"""
    cases = [(random_scene(rng), *rng.uniform(-800, 800, 2)) for _ in range(200)]
    cases += [(random_scene(rng), *pair) for pair in ((0.0, 0.0), (360.0, 1.0), (-720.0, 1e9), (1e-9, 0.0))]
    result = node.run(script, [((asdict(scene[0]), *scene[1:]), a, b) for scene, a, b in cases])
    for (scene, a, b), moved in zip(cases, result, strict=True):
        camera, eye = scene[0], cameras.look(*scene)
        expected = cameras.orbit(camera, a, b), cameras.zoom(camera, a, b), cameras.pan(camera, eye, a, b)
        for first, other in zip(moved, expected, strict=True):
            target = asdict(other)
            target["target"] = target["target"] and list(target["target"])
            assert first == target


def test_directions_are_the_same_to_the_last_bit(node: Node):
    rng = np.random.default_rng(2)
    directions = [*rng.uniform(-1000, 1000, (1000, 2)).tolist()]
    directions += [[a, e] for a in range(-720, 721, 45) for e in range(-90, 91, 45)]
    result = node.each("camera.js", "unitVector", [[each] for each in directions])
    assert result == [list(unit_vector(each)) for each in directions]


def test_sine_and_cosine_match_libm_within_two_ulp():
    rng = np.random.default_rng(3)
    for degrees in [*rng.uniform(-400, 400, 20_000), *np.arange(-720, 721, 15.0), 1e300, -1e300, 1e-300]:
        radians = math.radians(math.fmod(degrees, 360.0))
        for result, expected in zip(cos_sin(degrees), (math.cos(radians), math.sin(radians)), strict=True):
            # Radians are rounded to half an ulp of their own, which moves a small sine further.
            assert abs(result - expected) <= 2 * math.ulp(expected) + math.ulp(radians)


def test_quarter_turns_are_exact():
    assert [cos_sin(90.0 * n) for n in range(-4, 5)] == [
        *((1, 0), (0, 1), (-1, 0), (0, -1)),
        *((1, 0), (0, 1), (-1, 0), (0, -1), (1, 0)),
    ]

"""The ground under a pixel: what is projected into the picture is found again from there."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine.camera import ground_under, look
from playground.sketch.model import Camera

EXTENT, RELIEF, SIZE = (2000.0, 1200.0), 300.0, (640, 360)


def hills(ny=41, nx=61):
    y, x = np.mgrid[0 : 1 : ny * 1j, 0 : 1 : nx * 1j]
    return (0.5 + 0.3 * np.sin(7 * x) * np.cos(5 * y)).astype(np.float32)


def height_at(heights, x, y):
    ny, nx = heights.shape
    fx, fy = x * (nx - 1), y * (ny - 1)
    i, j = min(int(fx), nx - 2), min(int(fy), ny - 2)
    u, v = fx - i, fy - j
    return (
        heights[j, i] * (1 - u) * (1 - v)
        + heights[j, i + 1] * u * (1 - v)
        + heights[j + 1, i] * (1 - u) * v
        + heights[j + 1, i + 1] * u * v
    )


def projected(eye, heights, x, y):
    world = [x * EXTENT[0], y * EXTENT[1], height_at(heights, x, y) * RELIEF, 1]
    clip = eye.clip_from_world.astype(np.float64) @ world
    return tuple((clip[:2] / clip[3] + 1) / 2)


@pytest.mark.parametrize(
    "camera", [Camera(20, 55), Camera(200, 89), Camera(123, 90), Camera(300, 40)], ids=str
)
def test_what_is_projected_is_found_again(camera):
    heights = hills()
    eye = look(camera, EXTENT, RELIEF, SIZE)
    for x, y in np.random.default_rng(1).random((40, 2)):
        ground = ground_under(eye, projected(eye, heights, x, y), heights, EXTENT, RELIEF)
        np.testing.assert_allclose(ground, (x, y), atol=2e-4)


def test_the_nearer_of_two_slopes_is_taken():
    """A wall across the terrain hides what is behind it."""
    heights = np.zeros((21, 21), np.float32)
    heights[10] = 1.0
    eye = look(Camera(180, 8), EXTENT, RELIEF, SIZE)  # from the south
    behind = projected(eye, heights, 0.5, 0.7)
    x, y = ground_under(eye, behind, heights, EXTENT, RELIEF)
    assert abs(x - 0.5) < 0.02 and 0.45 <= y <= 0.5


def test_in_the_sky_and_outside_the_terrain_there_is_none():
    eye = look(Camera(20, 20), EXTENT, RELIEF, SIZE)
    assert ground_under(eye, (0.5, 0.99), hills(), EXTENT, RELIEF) is None
    assert ground_under(eye, (0.01, 0.02), hills(), EXTENT, RELIEF) is None


def test_the_smallest_terrain():
    eye = look(Camera(45, 60), EXTENT, RELIEF, SIZE)
    flat = np.full((2, 2), 0.5, np.float32)
    ground = ground_under(eye, projected(eye, flat, 0.3, 0.6), flat, EXTENT, RELIEF)
    np.testing.assert_allclose(ground, (0.3, 0.6), atol=2e-4)

"""Where known points of the terrain are in the picture, by slow trigonometry of its own."""

from __future__ import annotations

import math

import numpy as np
import pytest

from playground.engine.camera import look, orbit, pan, zoom
from playground.sketch.model import Camera

from ..cases import each

EXTENT, RELIEF = (12_000.0, 8_000.0), 1_500.0
WIDE, TALL = (1280, 720), (360, 720)


def place(camera: Camera, point, size=WIDE, extent=EXTENT, relief=RELIEF) -> np.ndarray:
    """Return where a point is: shares of half the picture, right and up of its middle; and its depth."""
    return places(camera, [point], size, extent, relief)[0]


def places(camera: Camera, points, size=WIDE, extent=EXTENT, relief=RELIEF) -> np.ndarray:
    """Return where each point is, as ``place`` does."""
    matrix = look(camera, extent, relief, size).clip_from_world.astype(np.float64)
    clip = np.array([[*point, 1.0] for point in points]) @ matrix.T
    return clip[:, :3] / clip[:, 3:]


def by_hand(camera: Camera, point, target, distance, size=WIDE) -> tuple[float, float]:
    """Project by angles: how far the point is along the eye's axis, right of it and above it."""
    a, e = np.deg2rad(camera.azimuth), np.deg2rad(camera.elevation)
    away = np.array([math.sin(a) * math.cos(e), math.cos(a) * math.cos(e), math.sin(e)])  # target to eye
    right = np.array([-math.cos(a), math.sin(a), 0.0])  # a quarter turn from the eye's azimuth, level
    above = np.array([-math.sin(a) * math.sin(e), -math.cos(a) * math.sin(e), math.cos(e)])
    offset = np.asarray(point, np.float64) - np.asarray(target)
    depth = distance - offset @ away
    half = math.tan(math.radians(camera.field_of_view) / 2) * depth
    return float(offset @ right / (half * size[0] / size[1])), float(offset @ above / half)


@each("elevation", [-89.0, -20.0, 0.0, 32.0, 85.0, 89.0])
@each("azimuth", [0.0, 45.0, 135.0, 200.0, 315.0])
@each("size", [WIDE, TALL])
def test_points_are_where_angles_put_them(azimuth, elevation, size):
    camera = Camera(azimuth, elevation, 30_000.0, (6_000.0, 4_000.0, 700.0), 40.0)
    for point in [(0, 0, 0), (12_000, 0, 0), (12_000, 8_000, 1_500), (0, 8_000, 300), (6_000, 4_000, 700)]:
        result = place(camera, point, size)[:2]
        expected = by_hand(camera, point, camera.target, camera.distance, size)
        np.testing.assert_allclose(result, expected, atol=2e-6)


@pytest.mark.parametrize(
    ("azimuth", "right", "up"),
    [(180.0, "east", "north"), (0.0, "west", "south"), (90.0, "north", "west"), (270.0, "south", "east")],
)
def test_the_eye_is_where_its_azimuth_says(azimuth, right, up):
    """From the south, east is on the right and north is further up."""
    steps = {"east": (1, 0, 0), "west": (-1, 0, 0), "north": (0, 1, 0), "south": (0, -1, 0)}
    middle = np.array([6_000.0, 4_000.0, 750.0])
    camera = Camera(azimuth, 40.0)
    assert place(camera, middle + 1_000 * np.array(steps[right]))[0] > 0.02
    assert place(camera, middle + 1_000 * np.array(steps[up]))[1] > 0.02
    assert place(camera, middle + np.array([0, 0, 500.0]))[1] > 0.02, "up is up"
    eye = np.array(look(camera, EXTENT, RELIEF, WIDE).position) - middle
    towards = np.rad2deg(np.arctan2(eye[0], eye[1])) % 360
    assert abs((towards - azimuth + 180) % 360 - 180) < 1e-6


@each("size", [(1280, 720), (640, 640), (360, 720), (2000, 400), (300, 1500)])
@each("elevation", [-40.0, 0.0, 10.0, 32.0, 60.0, 89.0])
@each("heightmap", [((12_000.0, 8_000.0), 1_500.0), ((1_000.0, 9_000.0), 100.0), ((500.0, 500.0), 3_000.0)])
def test_all_of_the_terrain_is_in_the_picture_and_fills_it(size, elevation, heightmap):
    (east, north), relief = heightmap
    corners = [(x, y, z) for x in (0, east) for y in (0, north) for z in (0, relief)]
    reach = []
    for azimuth in range(0, 360, 15):
        for field in (20.0, 35.0, 70.0):
            camera = Camera(float(azimuth), elevation, field_of_view=field)
            result = places(camera, corners, size, (east, north), relief)
            assert np.abs(result).max() < 1.0, f"azimuth {azimuth}, field of view {field}"
            reach.append(np.abs(result[:, :2]).max())
    assert max(reach) > 0.8, "and not lost in the middle of it"


def test_orbiting_does_not_zoom():
    distances = {round(look(Camera(a), EXTENT, RELIEF, WIDE).distance, 6) for a in (0.0, 30.0, 90.0, 211.0)}
    assert len(distances) == 1


def test_near_things_hide_far_ones():
    camera = Camera(180.0, 20.0)
    near, far = place(camera, (6_000, 500, 700))[2], place(camera, (6_000, 7_500, 700))[2]
    assert -1.0 < near < far < 1.0


def test_the_inverse_takes_the_picture_back_to_the_terrain():
    eye = look(Camera(77.0, 25.0), EXTENT, RELIEF, WIDE)
    product = eye.world_from_clip.astype(np.float64) @ eye.clip_from_world.astype(np.float64)
    np.testing.assert_allclose(product, np.eye(4), atol=2e-3)


@pytest.mark.parametrize("elevation", [89.0, 88.5, -89.0])
def test_straight_down_keeps_north_where_the_azimuth_puts_it(elevation):
    camera = Camera(180.0, elevation)
    middle = np.array([6_000.0, 4_000.0, 750.0])
    assert np.isfinite(look(camera, EXTENT, RELIEF, WIDE).clip_from_world).all()
    assert place(camera, middle + np.array([1_000, 0, 0]))[0] > 0.02
    sign = 1 if elevation > 0 else -1
    assert sign * place(camera, middle + np.array([0, 1_000, 0]))[1] > 0.02


# ── moving it ────────────────────────────────────────────────────────────────


def test_orbit_turns_and_stops_short_of_overhead():
    camera = orbit(Camera(350.0, 80.0), 20.0, 30.0)
    assert (camera.azimuth, camera.elevation) == (10.0, 89.0)
    assert orbit(camera, -30.0, -400.0).azimuth == 340.0
    assert orbit(camera, 0.0, -400.0).elevation == -89.0


@pytest.mark.parametrize("azimuth", [0.0, 60.0, 200.0])
def test_pan_carries_what_was_to_the_right_to_the_middle(azimuth):
    """After a pan by half the picture's width, what was at its right edge is in its middle."""
    camera = Camera(azimuth, 30.0, 20_000.0, (6_000.0, 4_000.0, 0.0))
    eye = look(camera, EXTENT, RELIEF, WIDE)
    a = math.radians(azimuth)
    across = 2 * 20_000.0 * math.tan(math.radians(35.0) / 2)  # the picture's height, in metres at the target
    edge = np.array(camera.target) + 0.5 * WIDE[0] / WIDE[1] * across * np.array(
        [-math.cos(a), math.sin(a), 0]
    )
    np.testing.assert_allclose(place(camera, edge)[:2], (1.0, 0.0), atol=1e-6)
    moved = pan(camera, eye, 0.5 * WIDE[0] / WIDE[1], 0.0)
    np.testing.assert_allclose(place(moved, edge)[:2], (0.0, 0.0), atol=1e-6)
    further = pan(camera, eye, 0.0, 0.25)
    away = np.array(further.target) - np.array(camera.target)
    assert place(camera, further.target)[1] > 0
    assert away[2] == 0, "along the ground"
    assert math.isclose(np.linalg.norm(away), 0.25 * across)


def test_zoom_keeps_the_target_and_its_limits():
    camera = Camera(target=(1.0, 2.0, 3.0))
    assert zoom(camera, 0.5, 1_000.0).distance == 500.0
    assert zoom(camera, 0.5, 1_000.0).target == camera.target
    assert zoom(camera, 1e-9, 1.0).distance == 1e-2
    assert zoom(camera, 1e9, 1e6).distance == 1e8


def test_a_flat_and_a_tiny_terrain_have_eyes_too():
    for extent, relief in (((1.0, 1.0), 0.0), ((1e-3, 1e-3), 1e-4), ((1e7, 1e7), 9_000.0)):
        eye = look(Camera(), extent, relief, WIDE)
        assert np.isfinite(eye.clip_from_world).all()
        assert (
            abs(place(Camera(), (extent[0] / 2, extent[1] / 2, relief / 2), WIDE, extent, relief)[0]) < 1e-3
        )

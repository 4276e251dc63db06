"""Where points of the terrain are in the picture, the ground under a pixel, and the eye over the terrain."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import playground
from playground import cli
from playground.engine.camera import ground_under, look, orbit, pan, zoom
from playground.sketch.model import Camera

from ..cases import each
from ..loading import load

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


# ── The ground under a pixel: what is projected into the picture is found again from there


PICK_EXTENT, PICK_RELIEF, SIZE = (2000.0, 1200.0), 300.0, (640, 360)


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
    world = [x * PICK_EXTENT[0], y * PICK_EXTENT[1], height_at(heights, x, y) * PICK_RELIEF, 1]
    clip = eye.clip_from_world.astype(np.float64) @ world
    return tuple((clip[:2] / clip[3] + 1) / 2)


@pytest.mark.parametrize(
    "camera", [Camera(20, 55), Camera(200, 89), Camera(123, 90), Camera(300, 40)], ids=str
)
def test_what_is_projected_is_found_again(camera):
    heights = hills()
    eye = look(camera, PICK_EXTENT, PICK_RELIEF, SIZE)
    for x, y in np.random.default_rng(1).random((40, 2)):
        ground = ground_under(eye, projected(eye, heights, x, y), heights, PICK_EXTENT, PICK_RELIEF)
        np.testing.assert_allclose(ground, (x, y), atol=2e-4)


def test_the_nearer_of_two_slopes_is_taken():
    """A wall across the terrain hides what is behind it."""
    heights = np.zeros((21, 21), np.float32)
    heights[10] = 1.0
    eye = look(Camera(180, 8), PICK_EXTENT, PICK_RELIEF, SIZE)  # from the south
    behind = projected(eye, heights, 0.5, 0.7)
    x, y = ground_under(eye, behind, heights, PICK_EXTENT, PICK_RELIEF)
    assert abs(x - 0.5) < 0.02 and 0.45 <= y <= 0.5


def test_in_the_sky_and_outside_the_terrain_there_is_none():
    eye = look(Camera(20, 20), PICK_EXTENT, PICK_RELIEF, SIZE)
    assert ground_under(eye, (0.5, 0.99), hills(), PICK_EXTENT, PICK_RELIEF) is None
    assert ground_under(eye, (0.01, 0.02), hills(), PICK_EXTENT, PICK_RELIEF) is None


def test_the_smallest_terrain():
    eye = look(Camera(45, 60), PICK_EXTENT, PICK_RELIEF, SIZE)
    flat = np.full((2, 2), 0.5, np.float32)
    ground = ground_under(eye, projected(eye, flat, 0.3, 0.6), flat, PICK_EXTENT, PICK_RELIEF)
    np.testing.assert_allclose(ground, (0.3, 0.6), atol=2e-4)


# ── The eye stays over the terrain: one that is under it is raised, with a warning


HILL = """
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) {
    vec2 p = vec2(texel) / vec2(size - 1) - 0.5;
    return exp(-10.0 * dot(p, p));
}
"""
SKETCH = """format = 1
size = [65, 33]
extent = [1000.0, 1500.0]
relief = 400.0
[[pass]]
name = "height"
use = "./hill"
[view]
use = "view/terrain"
samples = 1
"""


@pytest.fixture
def sketch(tmp_path):
    (tmp_path / "hill.glsl").write_text(HILL)
    (tmp_path / "sketch.toml").write_text(SKETCH)
    return load(tmp_path / "sketch.toml")


def ground(x, y):
    """The hill between its texels, in metres, in float64."""
    i, j = np.meshgrid(np.arange(65) / 64 - 0.5, np.arange(33) / 32 - 0.5)
    heights = 400 * np.exp(-10 * (i**2 + j**2))
    column, row = x / 1000 * 64, y / 1500 * 32
    k, m = int(column), int(row)
    p, q = column - k, row - m
    return np.array([1 - q, q]) @ heights[m : m + 2, k : k + 2] @ np.array([1 - p, p])


UNDER = Camera(azimuth=200, elevation=5, distance=300, target=(450, 800, 60))


def test_an_eye_under_the_terrain_is_raised_just_over_it(any_engine, sketch):
    x, y, z = any_engine.plan(sketch.with_camera(UNDER), (64, 36)).eye.position
    assert z < ground(x, y) - 50
    any_engine.render(sketch.with_camera(UNDER), size=(64, 36))
    eye = any_engine.record.plan.eye
    assert eye.position[:2] == pytest.approx((x, y), abs=0.01)
    assert eye.position[2] == pytest.approx(ground(x, y) + 0.002 * 300, abs=0.05)
    assert eye.target == pytest.approx(UNDER.target)
    assert any_engine.eye_height.raised_by == pytest.approx(eye.position[2] - z, abs=0.01)
    assert f"{any_engine.eye_height.raised_by:.0f} m" in any_engine.eye_height.message


@pytest.mark.parametrize(
    "camera",
    [
        Camera(azimuth=200, elevation=70, distance=600, target=(450, 800, 60)),
        Camera(azimuth=200, elevation=5, distance=3000, target=(450, 800, 60)),  # beside the terrain
        Camera(),
    ],
    ids=["above", "beside", "default"],
)
def test_any_other_eye_stays(any_engine, sketch, camera):
    expected = any_engine.plan(sketch.with_camera(camera), (64, 36)).eye
    any_engine.render(sketch.with_camera(camera), size=(64, 36))
    assert any_engine.record.plan.eye.position == expected.position and any_engine.eye_height.message == ""


def test_an_eye_straight_over_its_target_may_be_raised_too(any_engine, sketch):
    down = Camera(azimuth=30, elevation=89, distance=20, target=(500, 750, 100))
    frame = any_engine.render(sketch.with_camera(down), size=(64, 36))
    assert any_engine.eye_height.raised_by > 200 and math.isfinite(any_engine.record.plan.eye.distance)
    assert frame.array[..., :3].max() > 0


def test_the_terrain_is_read_once_for_a_place_and_made_once(any_engine, sketch, monkeypatch):
    from playground.engine import eye_height as module

    reads = []
    real = module.height_at
    monkeypatch.setattr(module, "height_at", lambda *value: reads.append(1) or real(*value))
    for _ in range(3):
        any_engine.render(sketch.with_camera(UNDER), size=(64, 36))
    assert len(reads) == 1 and any_engine.runs["height"] == 1
    any_engine.render(sketch.with_values({"relief": 500.0}).with_camera(UNDER), size=(64, 36))
    assert len(reads) <= 2


def test_an_eye_that_stays_under_the_terrain_costs_one_drawing(any_engine, sketch):
    """The first frame draws twice, and reports both; the next ones know how high the ground is."""
    seen = sketch.with_camera(UNDER)
    first = any_engine.render(seen, size=(64, 36)).array
    (land,) = {path for path in any_engine.record.ran if path in ("view.land", "view.fast.land")}
    assert "height" in any_engine.record.ran
    before = any_engine.runs[land]
    other = any_engine.render(sketch.with_values({"view.exposure": 0.5}).with_camera(UNDER), size=(64, 36))
    assert any_engine.runs[land] - before <= 1 and any_engine.eye_height.raised_by > 0
    assert (other.array != first).any()


def test_resized_or_edited_terrain_rechecks_eye_height(any_engine, sketch):
    any_engine.render(sketch.with_camera(UNDER), size=(64, 36))
    raised = any_engine.eye_height.raised_by
    x, y, _ = any_engine.record.plan.eye.position
    any_engine.render(sketch.with_values({"extent": "1100,1650"}).with_camera(UNDER), size=(64, 36))
    assert any_engine.eye_height.raised_by == pytest.approx(
        raised - ground(x, y) + ground(x / 1.1, y / 1.1), abs=0.1
    )
    text = HILL.replace("exp(", "0.95 * exp(")
    Path(sketch.folder, "hill.glsl").write_text(text)
    any_engine.render(load(Path(sketch.file)).with_camera(UNDER), size=(64, 36))
    assert any_engine.eye_height.raised_by == pytest.approx(raised - 0.05 * ground(x, y), abs=0.1)


def test_a_window_of_a_large_picture_has_the_raised_eye_too(any_engine, sketch):
    from playground.engine.plan import Window

    seen = sketch.with_camera(UNDER)
    whole = any_engine.render(seen, size=(64, 36)).array
    texture = any_engine.draw_window(seen, Window((0, 0), (32, 36), (64, 36)))
    part = np.frombuffer(texture.read(), np.uint8).reshape(36, 32, 4)[::-1]
    assert (np.abs(part.astype(int) - whole[:, :32]) > 8).mean() < 0.02


@pytest.mark.parametrize(
    "ways, written",
    [
        (["-o", "out.png"], "out.png"),
        (["-o", "%02d.png", "--frames", "0..2"], "02.png"),
        (["-o", "sheet.png", "--sweep", "view.exposure=0,1"], "sheet.png"),
    ],
    ids=["picture", "frames", "sweep"],
)
def test_render_says_it_once(sketch, tmp_path, monkeypatch, capsys, ways, written):
    monkeypatch.chdir(tmp_path)
    text = (
        SKETCH
        + "camera = { azimuth = 200.0, elevation = 5.0, distance = 300.0, target = [450.0, 800.0, 60.0] }\n"
    )
    (tmp_path / "sketch.toml").write_text(text)
    assert cli.main(["render", "sketch.toml", "--size", "64x36", *ways]) == 0
    message = capsys.readouterr().err
    assert message.count("the eye was under the terrain") == 1
    assert (tmp_path / written).exists()


def test_a_program_is_warned_once_of_all_frames(sketch):
    with playground.headless() as engine:
        with pytest.warns(playground.PlaygroundWarning, match="the eye was under the terrain") as reports:
            for seconds in range(3):
                engine.render(sketch.with_camera(UNDER), size=(64, 36), time=seconds)
        assert len(reports) == 1


def test_a_sketch_may_let_the_eye_be_under_the_ground(any_engine, sketch):
    text = Path(sketch.file).read_text() + "above_ground = false\n"
    Path(sketch.file).write_text(text)
    below = load(Path(sketch.file)).with_camera(UNDER)
    any_engine.render(below, size=(64, 36))
    assert any_engine.eye_height.raised_by == 0
    assert any_engine.record.plan.eye.position == any_engine.plan(below, (64, 36)).eye.position

"""The eye stays over the terrain: one that is under it is raised, with a warning."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import playground
from playground import cli
from playground.sketch.model import Camera

from ..loading import load

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
    real = module._height_at
    monkeypatch.setattr(module, "_height_at", lambda *value: reads.append(1) or real(*value))
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

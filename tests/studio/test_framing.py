"""A picture narrower than the one a sketch was framed for shows the same from side to side."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from playground.engine.camera import look
from playground.engine.engine import Engine
from playground.sketch.find import find
from playground.sketch.model import DEFAULT_PICTURE, Camera
from playground.studio.picture.gestures import Gesture, steered_through
from playground.studio.picture.view import MAX_FIELD_OF_VIEW, field_for, framed
from playground.studio.session import Session

from ..loading import load

EXTENT, RELIEF = (10_240.0, 8_000.0), 1_800.0
NARROW = (950, 720)


def across(camera: Camera, size: tuple[int, int], places: np.ndarray) -> np.ndarray:
    """Return where places of the terrain are in a picture, from -1 at its left side to 1 at its right one."""
    matrix = look(camera, EXTENT, RELIEF, size).clip_from_world.astype(float)
    clip = np.concatenate([places, np.ones((len(places), 1))], axis=1) @ matrix.T
    return clip[:, 0] / clip[:, 3]


@pytest.mark.parametrize("distance", [15_000.0, 40_000.0])
def test_places_keep_their_distance_from_the_sides(distance: float) -> None:
    sketch = load(find("mixed")).with_camera(Camera(azimuth=205.0, elevation=28.0, distance=distance))
    places = np.random.default_rng(3).uniform((0, 0, 0), (*EXTENT, RELIEF), (50, 3))
    seen = framed(sketch, 0.0, DEFAULT_PICTURE, NARROW)
    np.testing.assert_allclose(
        across(seen.camera, NARROW, places), across(sketch.camera, DEFAULT_PICTURE, places), atol=1e-5
    )
    cut = across(sketch.camera, NARROW, places)
    assert np.abs(cut).max() > np.abs(across(seen.camera, NARROW, places)).max()


@pytest.mark.parametrize("size", [DEFAULT_PICTURE, (640, 360), (1920, 800)])
def test_a_wide_picture_is_the_sketch_s_own(size: tuple[int, int]) -> None:
    sketch = load(find("mixed"))
    assert framed(sketch, 0.0, DEFAULT_PICTURE, size) is sketch


def test_a_view_is_never_opened_out_of_shape() -> None:
    assert field_for(35.0, DEFAULT_PICTURE, (40, 720)) == MAX_FIELD_OF_VIEW
    assert field_for(110.0, DEFAULT_PICTURE, (400, 720)) == 110.0, "a wider one of the sketch's own stays"


def test_gesture_moves_camera_as_seen_and_keeps_field_of_view() -> None:
    camera = Camera(distance=15_000.0)
    wide = replace(camera, field_of_view=field_for(camera.field_of_view, DEFAULT_PICTURE, NARROW))
    gesture = Gesture(height=720.0, across=100.0, panning=True)
    target = np.array([[EXTENT[0] / 2, EXTENT[1] / 2, RELIEF / 2]])  # it goes with the mouse
    after = steered_through(camera, look(wide, EXTENT, RELIEF, NARROW), gesture, wide)
    assert after.field_of_view == camera.field_of_view
    seen = replace(after, field_of_view=wide.field_of_view)
    assert across(seen, NARROW, target)[0] * NARROW[0] / 2 == pytest.approx(100.0, rel=1e-3)


@pytest.mark.slow
def test_the_window_opens_a_view_and_a_render_does_not(any_engine: Engine, tmp_path: Path) -> None:
    session = Session(any_engine, find("low_detail"))
    session.frame((48, 48))
    assert session.plan is not None and session.sketch is not None
    assert session.plan.sketch.camera.field_of_view > session.sketch.camera.field_of_view
    session.frame((64, 36))
    assert session.plan.sketch.camera == session.sketch.camera
    session.release()
    any_engine.render(load(find("low_detail")), size=(48, 48))
    assert any_engine.record.plan is not None
    assert any_engine.record.plan.sketch.camera.field_of_view == 35.0

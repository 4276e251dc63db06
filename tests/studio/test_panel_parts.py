"""The window's pure parts: numbers, the sky's disc, gestures, names of pictures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from playground.engine.camera import look
from playground.shader.parameter import Widget
from playground.shader.widgets import WIDGETS
from playground.sketch.model import Camera, Parameter
from playground.studio.panel.values import decimals, format_of, snapped
from playground.studio.picture.gestures import Gesture, steered
from playground.studio.problems.panel import numbered, short_place
from playground.studio.widgets import CONTROLS, direction_at, dot_of


def test_every_widget_of_an_annotation_has_a_control():
    assert CONTROLS.keys() == {kind.control for kind in WIDGETS.values()}


@pytest.mark.parametrize(
    ("parameter", "form"),
    [
        (Parameter("a", "float", 0.0, Widget("slider", 0, 1), step=0.01), "%.2f"),
        (Parameter("a", "float", 0.0, Widget("slider", 0, 1), step=0.125, unit="m"), "%.3f m"),
        (Parameter("a", "float", 0.0, Widget("slider", 0, 1)), "%.3f"),
        (Parameter("a", "float", 0.0, Widget("slider", 0, 5000), unit="%"), "%.0f%%"),
        (Parameter("a", "float", 0.0, Widget("angle", -360, 360)), "%.1f°"),
        (Parameter("a", "float", 0.0, Widget("log_slider", 0.01, 1000), unit="1/m"), "%.4g 1/m"),
        (Parameter("a", "int", 0, Widget("slider", 0, 9), unit="m"), "%d m"),
    ],
)
def test_a_number_is_written_as_finely_as_it_can_be_set(parameter: Parameter, form: str) -> None:
    assert format_of(parameter) == form


def test_a_number_keeps_to_its_steps_and_its_range() -> None:
    parameter = Parameter("a", "float", 0.0, Widget("slider", 0.05, 1.0), step=0.1)
    assert snapped(parameter, 0.312) == pytest.approx(0.35)
    assert snapped(parameter, 0.999) == 0.95 or snapped(parameter, 0.999) == 1.0
    assert snapped(parameter, -4.0) == 0.05
    assert decimals(parameter) == 1


def test_sky_disc_middle_is_zenith_and_rim_is_horizon() -> None:
    assert dot_of(123.0, 90.0) == pytest.approx((0.0, 0.0))
    assert dot_of(90.0, 0.0) == pytest.approx((1.0, 0.0))
    assert dot_of(0.0, 0.0) == pytest.approx((0.0, 1.0))
    assert dot_of(180.0, -40.0) == pytest.approx((0.0, -1.0), abs=1e-12)


@pytest.mark.parametrize("azimuth", [0.0, 45.0, 135.0, 250.0, 359.0])
@pytest.mark.parametrize("elevation", [0.0, 10.0, 60.0])
def test_a_dot_gives_back_its_direction(azimuth: float, elevation: float) -> None:
    assert direction_at(*dot_of(azimuth, elevation)) == pytest.approx((azimuth, elevation), abs=1e-9)


def test_a_dot_outside_the_disc_is_on_the_horizon() -> None:
    assert direction_at(7.0, 0.0) == pytest.approx((90.0, 0.0))


def test_excerpt_lines_are_numbered_dedented_with_column_mark() -> None:
    lines = [(9, "    float a;"), (10, "\tfloat x = foo;"), (11, "")]
    rows, wrong = numbered(lines, 10, 12, 60)
    assert rows == [" 9 | float a;", "10 | float x = foo;", "   |           ^", "11 |"]
    assert wrong == 1
    assert numbered(lines, 10, 0, 60)[0] == [" 9 | float a;", "10 | float x = foo;", "11 |"]


@pytest.mark.parametrize("column", [1, 40, 120, 200])
def test_a_long_line_is_cut_around_its_column(column: int) -> None:
    line = "".join(chr(97 + n % 26) for n in range(200))
    rows, wrong = numbered([(4, "short"), (5, line), (6, "")], 5, column, 44)
    assert all(len(row) <= 44 for row in rows)
    assert rows[wrong][rows[wrong + 1].index("^")] == line[column - 1]


def test_places_are_named_from_the_sketchs_folder(tmp_path: Path) -> None:
    inside = tmp_path / "inc" / "wave.glsl"
    assert short_place(f"{inside}:2:7", str(tmp_path)) == "inc/wave.glsl:2:7"
    assert short_place("glsl/noise/hash.glsl:3", str(tmp_path)) == "glsl/noise/hash.glsl:3"


CAMERA = Camera(azimuth=200.0, elevation=30.0, distance=1000.0)
EYE = look(CAMERA, (1000.0, 1000.0), 100.0, (640, 480))


def project(camera: Camera, point: tuple[float, float, float]) -> np.ndarray:
    """Return where a point of the terrain is in the picture: right and up, -1..1."""
    clip = look(camera, (1000.0, 1000.0), 100.0, (640, 480)).clip_from_world @ np.array([*point, 1.0])
    return clip[:2] / clip[3]


@pytest.mark.parametrize("panning", [False, True])
def test_the_terrain_follows_the_mouse(panning: bool) -> None:
    # A point between the eye and the middle: it is on the near side of the rotation.
    near = tuple(0.7 * t + 0.3 * p for t, p in zip(EYE.target, EYE.position, strict=True))
    point = (near[0], near[1], 50.0)
    gesture = Gesture(480, across=30, down=12, orbiting=not panning, panning=panning)
    moved = project(steered(CAMERA, EYE, gesture), point) - project(CAMERA, point)
    assert moved[0] > 0, "to the right"
    assert moved[1] < 0, "downwards"


def test_the_wheel_brings_the_terrain_nearer_and_back() -> None:
    near = steered(CAMERA, EYE, Gesture(480, wheel=1.0))
    assert near.distance < CAMERA.distance
    eye = look(near, (1000.0, 1000.0), 100.0, (640, 480))
    assert steered(near, eye, Gesture(480, wheel=-1.0)).distance == pytest.approx(CAMERA.distance)


def test_the_eye_never_goes_over_the_top() -> None:
    camera = steered(CAMERA, EYE, Gesture(480, down=5000, orbiting=True))
    assert camera.elevation == 89.0


def test_a_mouse_that_only_passes_does_nothing() -> None:
    assert not Gesture(480, across=10, down=3).acts
    assert steered(CAMERA, EYE, Gesture(480, across=10)) == CAMERA

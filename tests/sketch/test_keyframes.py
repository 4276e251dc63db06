"""Keyframes: values and camera at a time, against curves worked out another way; mistakes by line."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest

from playground.errors import SketchError
from playground.sketch.keyframes import EASES, Track
from playground.sketch.load import load
from playground.sketch.model import Camera, Sketch

from ..sketch_texts import passes

TERRAIN = (
    'format = 1\ntitle = "Keyframes"\nsize = 33\n'
    + passes(height="generation/diamond_square", light="lighting/ray_cast")
    + """[view]
use = "view/terrain"
camera = { azimuth = 100.0, elevation = 30.0, distance = 9000.0 }
"""
)
KEYS = """
[[keyframe]]
time = 1.0
camera = { azimuth = 350.0, elevation = 20.0 }
set = { "light.sun" = [350, 10], "light.sun_colour" = "#ff0000", "height.seed" = 3 }
[[keyframe]]
time = 3.0
set = { "light.sun" = [10, 50] }
ease = "linear"
[[keyframe]]
time = 5.0
camera = { azimuth = 30.0 }
set = { "light.sun" = [100, 30], "light.sun_colour" = "#ffffff", "height.seed" = 9, "view.sea" = true }
"""


@pytest.fixture
def write(tmp_path: Path):
    def made(keys: str) -> Path:
        path = tmp_path / "sketch.toml"
        path.write_text(TERRAIN + keys, encoding="utf-8")
        return path

    return made


@pytest.fixture
def sketch(write) -> Sketch:
    return load(write(KEYS))


def values(sketch: Sketch, time: float) -> dict[str, object]:
    return dict(sketch.at(time).overrides)


# ── curves ───────────────────────────────────────────────────────────────────


def curve(track: Track, many: np.ndarray) -> np.ndarray:
    return np.array([track.at(float(t)) for t in many])


def test_track_passes_its_keyframes_and_holds_at_ends():
    for ease in EASES:
        track = Track((1.0, 2.0, 4.5), (3.0, -1.0, 8.0), (ease,) * 3)
        assert [track.at(t) for t in (1.0, 2.0, 4.5)] == [3.0, -1.0, 8.0]
        assert track.at(-5.0) == track.at(0.999) == 3.0
        assert track.at(4.6) == track.at(1e5) == 8.0


def test_linear_is_linear_and_hold_holds():
    track = Track((1.0, 2.0, 4.5, 5.0), (3.0, -1.0, 8.0, 0.0), ("linear", "linear", "hold", "linear"))
    many = np.linspace(1.0, 4.499, 50)
    np.testing.assert_allclose(curve(track, many), np.interp(many, track.times, track.values), atol=1e-12)
    assert track.at(4.9999) == 8.0 and track.at(5.0) == 0.0


def test_smooth_track_is_continuous_and_never_overshoots():
    random = np.random.default_rng(5)
    for _ in range(40):
        times = np.cumsum(random.uniform(0.05, 3.0, 7))
        value = random.choice([0.0, 0.2, 1.0, 1.0001, 5.0, -3.0], 7)
        track = Track(tuple(times), tuple(value), ("smooth",) * 7)
        for (t0, t1), (v0, v1) in zip(itertools.pairwise(times), itertools.pairwise(value), strict=True):
            array = curve(track, np.linspace(t0, t1, 40))
            assert array.min() >= min(v0, v1) and array.max() <= max(v0, v1)
            assert (np.diff(array) * np.sign(v1 - v0) >= -1e-12).all(), "it goes one way"
        for t in times[1:-1]:
            step = 1e-6
            before = (track.at(t) - track.at(t - step)) / step
            after = (track.at(t + step) - track.at(t)) / step
            assert abs(before - after) < 1e-2, "its slope has no jump"


def test_smooth_track_rests_at_ends_and_not_at_inner_keyframes():
    track = Track((0.0, 1.0, 2.0), (0.0, 1.0, 2.0), ("smooth",) * 3)
    step = 1e-5
    assert abs(track.at(step)) < 1e-8
    assert abs(2.0 - track.at(2.0 - step)) < 1e-8
    assert (track.at(1 + step) - track.at(1 - step)) / (2 * step) == pytest.approx(1.0, abs=1e-4)
    halfway = Track((0.0, 1.0), (0.0, 1.0), ("smooth",) * 2)
    np.testing.assert_allclose(  # between two at rest, the cubic is 3 x^2 - 2 x^3
        curve(halfway, np.linspace(0, 1, 11)),
        [x * x * (3 - 2 * x) for x in np.linspace(0, 1, 11)],
        atol=1e-12,
    )


def test_monotone_slopes_are_those_of_scipy():
    """An independent implementation of the same authors' interpolant, but for the ends, which rest here."""
    scipy = pytest.importorskip("scipy.interpolate")
    times, value = (0.0, 1.0, 2.5, 3.0, 7.0), (0.0, 1.0, 1.5, 4.0, 4.5)
    track = Track(times, value, ("smooth",) * 5)
    many = np.linspace(1.0, 3.0, 101)  # the segments that touch no end
    truth = scipy.PchipInterpolator(times, value)(many)
    np.testing.assert_allclose(curve(track, many), truth, atol=1e-12)


def test_azimuths_go_the_short_way_round():
    track = Track((0.0, 1.0, 2.0), (350.0, 20.0, 340.0), ("linear",) * 3, angles=(0,))
    assert track.at(0.5) == pytest.approx(5.0)
    assert track.at(1.5) == pytest.approx(0.0)
    assert track.at(1.75) == pytest.approx(350.0)
    plain = Track((0.0, 1.0), (350.0, 20.0), ("linear",) * 2)
    assert plain.at(0.5) == pytest.approx(185.0)


# ── of a sketch ──────────────────────────────────────────────────────────────


def test_a_sketch_at_a_time_is_a_sketch_without_keyframes(sketch: Sketch):
    assert sketch.duration == 5.0 and len(sketch.keyframes) == 3
    assert sketch.at(2.0) == sketch.at(2.0) and hash(sketch.at(2.0))
    assert sketch.at(2.0).keyframes == () and sketch.at(2.0).at(9.0) == sketch.at(2.0)
    plain = load("jacksboro")
    assert plain.at(3.0) is plain


def test_values_at_times(sketch: Sketch):
    assert values(sketch, 1.0)["light.sun"] == (350.0, 10.0)
    assert values(sketch, 3.0)["light.sun"] == (10.0, 50.0)
    assert values(sketch, 2.0)["light.sun"] == pytest.approx((0.0, 30.0))  # half of each, the short way
    assert values(sketch, 4.0)["light.sun"] == pytest.approx((55.0, 40.0))
    # Red to white, halfway in linear light: a curve through sRGB would give 0.21.
    assert values(sketch, 3.0)["light.sun_colour"] == pytest.approx((1.0, 0.5, 0.5))


def test_whole_numbers_and_checkboxes_hold(sketch: Sketch):
    assert [values(sketch, t)["height.seed"] for t in (0.0, 1.0, 4.99, 5.0)] == [3, 3, 3, 9]
    assert values(sketch, 0.0)["view.sea"] is True  # its only keyframe


def test_camera_keyframes_animate_named_fields_alone(sketch: Sketch):
    assert sketch.at(0.0).camera == Camera(350.0, 20.0, 9000.0)
    assert sketch.at(5.0).camera == Camera(30.0, 20.0, 9000.0)
    assert sketch.at(3.0).camera.azimuth == pytest.approx(10.0)


def test_what_is_set_by_user_stays(sketch: Sketch):
    by_user = sketch.with_values({"light.sun": (45.0, 45.0)})
    for time in (0.0, 2.2, 9.0):
        result = by_user.at(time)
        assert result.overrides[-1] == ("light.sun", (45.0, 45.0))
        assert result.camera == sketch.at(time).camera
    turned = sketch.with_camera(Camera(azimuth=7.0))
    assert turned.at(2.0).camera == Camera(azimuth=7.0)
    assert dict(turned.at(2.0).overrides) == values(sketch, 2.0)


def test_one_parameter_may_not_have_two_names(write):
    keys = "[[keyframe]]\ntime = 1\nset = { 'view.haze' = 0.1 }\n"
    keys += "[[keyframe]]\ntime = 2\nset = { 'view.land.haze' = 0.2 }"
    with pytest.raises(SketchError, match=r"'view.land.haze' is what 'view.haze' sets") as caught:
        load(write(keys))
    assert caught.value.diagnostics[0].line == 18

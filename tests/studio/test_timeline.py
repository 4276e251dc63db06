"""Time under a hand: play, scrub, step, speed, loop; a drag begins where keyframes left the camera."""

from __future__ import annotations

from pathlib import Path

import pytest
from imgui_bundle import imgui

from playground.engine.engine import Engine
from playground.studio.clock import Clock, marks_of, span_of, stepped, toggle_loop
from playground.studio.mouse import PictureMouse

from ..loading import load
from ..sketch_texts import passes
from .panel_desk import Bare

TERRAIN = """// terrain.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high
float kernel(ivec2 texel) { return level; }
"""
SKETCH = "format = 1\nsize = 17\n" + passes(height="./terrain") + '[view]\nuse = "view/terrain"\n'
KEYFRAMES = """
[[keyframe]]
time = 1.0
camera = { azimuth = 100.0 }
set = { "height.level" = 0.0 }
ease = "linear"
[[keyframe]]
time = 3.0
camera = { azimuth = 200.0 }
set = { "height.level" = 1.0 }
"""


FILES = {"terrain.glsl": TERRAIN, "sketch.toml": SKETCH + KEYFRAMES}


def test_a_loop_goes_round_and_keeps_what_is_over() -> None:
    clock = Clock(time=2.9, loop=(1.0, 3.0))
    clock.advance(0.25)
    assert clock.time == pytest.approx(1.15)
    clock.advance(4.0)  # twice round
    assert clock.time == pytest.approx(1.15)
    clock.time = 7.0  # beyond it time goes on, as after a scrub
    clock.advance(0.5)
    assert clock.time == 7.5
    clock.set_loop(5.0, 2.0)
    assert clock.loop == (2.0, 5.0)
    clock.set_loop(2.0, 2.01)
    assert clock.loop is None


@pytest.mark.parametrize(
    ("time", "frames", "then"),
    [
        (0.0, 1, 1 / 30),
        (0.0, -1, 0.0),
        (0.5, 1, 16 / 30),
        (0.51, 1, 16 / 30),
        (0.51, -1, 0.5),
        (1 / 3, -1, 0.3),
    ],
)
def test_a_step_ends_on_a_picture_of_the_film(time: float, frames: int, then: float) -> None:
    assert stepped(time, frames) == pytest.approx(then, abs=1e-12)


def test_many_steps_on_and_back_end_where_they_began() -> None:
    time = 0.0
    for n in range(1, 400):
        time = stepped(time, 1)
        assert time == n / 30
    for _ in range(399):
        time = stepped(time, -1)
    assert time == 0.0


def test_the_bar_shows_the_keyframes_and_the_current_time(folder: Path) -> None:
    sketch, clock = load(folder), Clock()
    assert marks_of(sketch) == (1.0, 3.0) and span_of(sketch, clock) == 3.0
    clock.time = 12.0
    assert span_of(sketch, clock) == 20.0
    clock.time, clock.loop = 0.0, (2.0, 8.0)
    assert span_of(sketch, clock) == 8.0
    toggle_loop(sketch, clock)
    assert clock.loop is None
    toggle_loop(sketch, clock)
    assert clock.loop == (1.0, 3.0)


def test_keyframes_move_the_picture_as_time_goes(bare: Bare) -> None:
    session = bare.session
    assert session.animated and session.plan is not None
    session.clock.playing = False
    for time, azimuth in ((0.0, 100.0), (2.0, 150.0), (3.0, 200.0), (9.0, 200.0)):
        bare.bench.undo.seek(time)
        bare.run_frames(2)
        assert session.plan.sketch.camera.azimuth == pytest.approx(azimuth)


def test_buttons_and_keys(bare: Bare) -> None:
    clock = bare.session.clock
    bare.click("Pause")
    assert not clock.playing
    bare.click("Loop")
    assert clock.loop == (1.0, 3.0)
    bare.click(">")
    assert clock.time == pytest.approx(1 / 30)
    bare.click("<")
    assert clock.time == 0.0
    bare.type("..,")
    assert clock.time == pytest.approx(1 / 30)
    bare.key(imgui.Key.l)
    assert clock.loop is None
    bare.click("To 0")
    assert clock.time == 0.0
    bare.click("##speed")
    bare.click("4 x")
    assert clock.speed == 4.0
    bare.click("Play")
    assert clock.playing


def test_a_scrub_is_one_step_and_keeps_to_a_mark(bare: Bare) -> None:
    bare.session.clock.playing = False
    bare.drag("##timeline", 0.2, 0.5)
    assert bare.session.clock.time == pytest.approx(1.5, abs=0.01)
    assert len(bare.bench.undo.history.steps) == 1
    bare.click("##timeline", 1.0 / 3.0 + 0.004)
    assert bare.session.clock.time == 1.0  # the keyframe's very time
    bare.bench.undo.undo()
    bare.bench.undo.undo()
    assert bare.session.clock.time == 0.0


def test_shift_and_a_drag_choose_the_loop(bare: Bare) -> None:
    bare.run_frames()
    imgui.get_io().add_key_event(imgui.Key.mod_shift, True)
    bare.drag("##timeline", 0.5, 0.9)
    imgui.get_io().add_key_event(imgui.Key.mod_shift, False)
    bare.run_frames()
    loop = bare.session.clock.loop
    assert loop is not None and loop == pytest.approx((1.5, 2.7), abs=0.01)


def test_a_sketch_that_rests_has_no_bar(folder: Path, any_engine: Engine) -> None:
    (folder / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    bare = Bare(any_engine, folder)
    try:
        bare.run_frames(3)
        assert "##timeline" not in bare.places and not bare.session.animated
        bare.key(imgui.Key.l)
        bare.type(".")
        assert bare.session.clock.loop is None and bare.session.clock.time == 0.0
    finally:
        bare.close()


def test_a_drag_begins_where_the_keyframes_left_the_camera(bare: Bare) -> None:
    session, io = bare.session, imgui.get_io()
    session.clock.playing = False
    bare.bench.undo.seek(2.0)
    bare.run_frames(2)
    assert session.plan is not None and session.plan.sketch.camera.azimuth == pytest.approx(150.0)
    hand = PictureMouse(session, bare.bench.painting)

    def drag_frame(x: float, y: float, down: bool) -> None:
        io.add_mouse_pos_event(x, y)
        io.add_mouse_button_event(0, down)
        imgui.new_frame()
        hand.act((0.0, 0.0, 1280.0, 720.0), 1.0)
        imgui.render()
        for texture in imgui.get_platform_io().textures:
            texture.set_status(imgui.ImTextureStatus.ok)
        session.frame((48, 32))

    drag_frame(900, 300, False)
    drag_frame(900, 300, True)
    drag_frame(904, 300, True)  # 1 degree of 180 a height
    assert session.plan.sketch.camera.azimuth == pytest.approx(150.0, abs=1.5)
    assert session.plan.sketch.camera.azimuth != pytest.approx(150.0, abs=0.1)
    drag_frame(908, 300, True)
    assert session.plan.sketch.camera.azimuth == pytest.approx(150.0, abs=2.5)
    drag_frame(908, 300, False)
    session.clock.time = 3.0
    session.frame((48, 32))
    assert session.plan.sketch.camera.azimuth == pytest.approx(150.0, abs=2.5)  # the hand's stays

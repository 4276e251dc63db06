"""The keyboard as a channel: what is down, what was pressed, what is toggled."""

from __future__ import annotations

import numpy as np
import pytest

from playground.media.live_inputs import Keyboard, KeysNow
from playground.sketch.load import load

SPACE, A, LEFT = 32, 65, 37
SKETCH = """format = 1
size = 8
[[pass]]
name = "a"
use = "foreign/keys"
[view]
use = "./shown"
inputs = { iChannel0 = "a" }
"""
SHOWN = """void mainImage(out vec4 colour, vec2 place) {
    colour = vec4(texelFetch(iChannel0, ivec2(65, 0), 0).x, texelFetch(iChannel0, ivec2(65, 1), 0).x,
                  texelFetch(iChannel0, ivec2(65, 2), 0).x, 1.0);
}
"""
COUNTS = """#pragma kernel(output = "sums:rgba32f")
uniform sampler2D before;  //! input("zero")
uniform sampler2D keys;    //! input
vec4 kernel(ivec2 texel) {
    return texelFetch(before, texel, 0) + vec4(texelFetch(keys, ivec2(65, 1), 0).r, 1.0, 0.0, 0.0);
}
"""
STATE = """format = 1
size = 2
[[pass]]
name = "keys"
use = "foreign/keys"
[[pass]]
name = "sums"
use = "./counts"
repeat = "frames"
feedback = { before = "sums" }
[view]
use = "view/map"
inputs = { shown = "sums" }
"""


@pytest.fixture
def sketch(tmp_path):
    (tmp_path / "shown.glsl").write_text(SHOWN)
    (tmp_path / "s.toml").write_text(SKETCH)
    return load(tmp_path / "s.toml")


def test_a_key_is_down_pressed_once_and_toggled():
    keyboard = Keyboard()
    assert keyboard.hold([A]) and keyboard.now == KeysNow((A,), (A,), (A,))
    assert keyboard.hold([A]) and keyboard.now == KeysNow((A,), (), (A,))
    assert not keyboard.hold([A]), "nothing changes while it is held"
    assert keyboard.hold([A, SPACE]) and keyboard.now == KeysNow((SPACE, A), (SPACE,), (SPACE, A))
    assert keyboard.hold([]) and keyboard.now == KeysNow((), (), (SPACE, A))
    assert keyboard.hold([A]) and keyboard.now == KeysNow((A,), (A,), (SPACE,))
    keyboard.hold([300, -1])
    assert keyboard.now.down == (), "no column"


def test_the_texture_is_shadertoy_s(any_engine, sketch):
    assert any_engine.read(sketch, "a").shape == (3, 256)
    assert (any_engine.read(sketch, "a") == 0).all(), "a shot has no keys"
    any_engine.runner.inputs.keyboard.hold([LEFT, A])
    any_engine.runner.inputs.keyboard.hold([A])
    found = any_engine.read(sketch, "a")
    assert [np.flatnonzero(row).tolist() for row in found] == [[A], [], [LEFT, A]]
    assert found.max() == 1.0
    np.testing.assert_array_equal(any_engine.render(sketch, size=(2, 2)).array[0, 0], [255, 0, 255, 255])


def test_its_pass_runs_only_when_a_key_changes(any_engine, sketch):
    keyboard = any_engine.runner.inputs.keyboard
    for codes in ([], [A], [A], [A], [A, LEFT], [A, LEFT]):
        keyboard.hold(codes)
        any_engine.draw(sketch, size=(4, 4), time=keyboard.now.down.count(A))
    assert any_engine.runs["a"] == 5, "none; A pressed, held; both pressed, held"


def test_a_loop_over_frames_goes_on_when_a_key_changes(any_engine, tmp_path):
    (tmp_path / "counts.glsl").write_text(COUNTS)
    (tmp_path / "s.toml").write_text(STATE)
    sketch, keyboard = load(tmp_path / "s.toml"), any_engine.runner.inputs.keyboard
    for frame in range(30):
        keyboard.hold([A] if frame in (5, 6, 20) else [])
        found = any_engine.read(sketch, "sums", time=frame / 60)[0, 0]
    assert found[:2].tolist() == [2.0, 30.0], "two presses in thirty frames"
    assert any_engine.runs["sums"] == 30, "each frame once"

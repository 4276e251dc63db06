"""The keyboard, a microphone and a camera as channels, and what there is without them."""

from __future__ import annotations

import json
import sys
import threading
import time

import numpy as np
import pytest

from playground.data.live_inputs import Keyboard, KeysNow, camera, microphone
from playground.engine.plan_warnings import source_warnings
from playground.extras import install_command
from playground.sketch.traits import traits_of

from ..loading import load

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


@pytest.mark.room("dialects")
def test_the_texture_is_shadertoy_s(any_engine, sketch):
    assert any_engine.read(sketch, "a").shape == (3, 256)
    assert (any_engine.read(sketch, "a") == 0).all(), "a shot has no keys"
    any_engine.runner.inputs.keyboard.hold([LEFT, A])
    any_engine.runner.inputs.keyboard.hold([A])
    result = any_engine.read(sketch, "a")
    assert [np.flatnonzero(row).tolist() for row in result] == [[A], [], [LEFT, A]]
    assert result.max() == 1.0
    np.testing.assert_array_equal(any_engine.render(sketch, size=(2, 2)).array[0, 0], [255, 0, 255, 255])


@pytest.mark.room("dialects")
def test_a_picture_s_hash_goes_by_its_keys(any_engine, sketch):
    hashes = []
    for codes in ([], [A], [A]):
        any_engine.runner.inputs.keyboard.hold(codes)
        any_engine.draw(sketch, size=(4, 4))
        hashes.append((any_engine.drawn(), any_engine.fingerprint(sketch, size=(4, 4))))
    assert len({*hashes}) == 3, "none; pressed; held"


@pytest.mark.room("dialects")
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
        result = any_engine.read(sketch, "sums", time=frame / 60)[0, 0]
    assert result[:2].tolist() == [2.0, 30.0], "two presses in thirty frames"
    assert any_engine.runs["sums"] == 30, "each frame once"


# ── microphones and cameras ──────────────────────────────────────────────────


class FakeSounds:
    """What sounddevice has of a microphone: blocks come in a thread of its own."""

    def __init__(self, tone: np.ndarray, fails: Exception | None = None) -> None:
        self.tone, self.fails, self.asked, self.closed = tone, fails, {}, False

    def InputStream(self, **asked):  # noqa: N802  # its name there
        if self.fails:
            raise self.fails
        self.asked = asked
        return self

    def __enter__(self):
        def deliver():
            for start in range(0, len(self.tone), 512):
                block = self.tone[start : start + 512, None].astype(np.float32)
                self.asked["callback"](block, len(block), None, None)

        self.thread = threading.Thread(target=deliver)
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.thread.join()
        self.closed = True


def wait_for(condition, seconds: float = 10.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it does not come"
        time.sleep(0.005)


def live_sketch(tmp_path, source: str, setting: str = ""):
    (tmp_path / "shown.glsl").write_text(SHOWN)
    (tmp_path / "s.toml").write_text(
        SKETCH.replace("foreign/keys", f"foreign/{source}").replace("[view]", f"{setting}\n[view]")
    )
    return load(tmp_path / "s.toml")


@pytest.fixture
def inputs(any_engine):
    result = any_engine.runner.inputs
    result.is_live = True
    yield result
    result.close()


@pytest.mark.room("dialects")
def test_a_microphone_s_tone_stands_in_its_texture(any_engine, inputs, tmp_path):
    sounds = FakeSounds(0.02 * np.sin(2 * np.pi * 120 / 2048 * np.arange(60_000)))
    inputs.makers["microphone"] = lambda number: microphone(number, lambda: sounds)
    sketch = live_sketch(tmp_path, "microphone")
    silent = any_engine.read(sketch, "a")
    assert silent.shape == (2, 512) and (silent[0] == 0).all(), "before the first frame that takes something"
    wait_for(lambda: inputs.begin_frame() and inputs.device("microphone").now.number == 60_000)
    heard = any_engine.read(sketch, "a")
    assert heard[0].argmax() == 120 and heard[1].std() > 0
    assert (sounds.asked["samplerate"], sounds.asked["channels"]) == (44_100, 1)
    runs = any_engine.runs["a"]
    any_engine.read(sketch, "a", time=3.0)
    assert any_engine.runs["a"] == runs, "nothing new was heard"
    assert not inputs.begin_frame()
    inputs.close()
    assert sounds.closed


def test_a_device_is_closed_when_no_picture_asks_for_it(inputs):
    sounds = FakeSounds(np.zeros(512))
    inputs.makers["microphone"] = lambda number: microphone(number, lambda: sounds)
    wait_for(lambda: inputs.device("microphone").latch())
    for _ in range(121):
        inputs.begin_frame()
        inputs.device("microphone")
    assert not sounds.closed
    for _ in range(121):
        inputs.begin_frame()
    assert sounds.closed


@pytest.mark.room("dialects")
def test_a_camera_s_pictures_are_shown(any_engine, inputs, tmp_path):
    """A camera of FFmpeg's own making: bars, which it draws at 30 pictures a second."""
    made = "smptebars=size=320x240:rate=200"
    inputs.makers["camera"] = lambda number: camera(number, lambda av, n: av.open(made, format="lavfi"))
    sketch = live_sketch(tmp_path, "camera")
    assert any_engine.read(sketch, "a").shape == (480, 640, 4)
    wait_for(lambda: any_engine.read(sketch, "a")[..., :3].max() > 0 or inputs.begin_frame() is None)
    result = any_engine.read(sketch, "a")
    np.testing.assert_allclose(result[400, 40, :3], 0.75, atol=0.05, err_msg="grey is first, from the west")
    np.testing.assert_allclose(result[400, 600, :3], (0, 0, 0.75), atol=0.05, err_msg="blue is last")
    mirrored = any_engine.read(live_sketch(tmp_path, "camera", "set = { mirror = true }"), "a")
    np.testing.assert_allclose(mirrored[400, 40, :3], (0, 0, 0.75), atol=0.05)


@pytest.mark.parametrize("source", ["microphone", "camera"])
@pytest.mark.room("dialects")
def test_without_a_window_nothing_is_opened_and_it_is_said_once(any_engine, tmp_path, source):
    opened, reported = [], []
    any_engine.runner.inputs.makers[source] = opened.append
    any_engine.warnings.report = reported.append
    sketch = live_sketch(tmp_path, source)
    for moment in (0.0, 1.0):
        picture = any_engine.read(sketch, "a", time=moment)
        any_engine.draw(sketch, size=(4, 4), time=moment)
    assert opened == []
    assert (picture[0] == (0 if source == "microphone" else [0, 0, 0, 1])).all()
    assert [warning.message.partition(";")[0] for warning in reported] == [
        f"iChannel0: a {source} is for the window only"
    ]


@pytest.mark.room("dialects")
def test_a_device_that_is_not_there_is_said_with_its_channel(any_engine, inputs, tmp_path):
    reported = []
    any_engine.warnings.report = reported.append
    sounds = FakeSounds(np.zeros(1), fails=OSError("PortAudio library not found"))
    inputs.makers["microphone"] = lambda number: microphone(number, lambda: sounds)
    sketch = live_sketch(tmp_path, "microphone")
    any_engine.draw(sketch, size=(4, 4))
    wait_for(lambda: inputs.problem("microphone"))
    for moment in (0.1, 0.2):
        any_engine.draw(sketch, size=(4, 4), time=moment)
    (warning,) = reported
    assert warning.message == (
        "iChannel0: the microphone gives nothing: PortAudio library not found; it is silent here"
    )
    wait_for(lambda: inputs.device("camera", 9).problem)
    assert "No such" in inputs.problem("camera", 9) or "cannot" in inputs.problem("camera", 9).lower()


def test_without_sounddevice_the_extra_is_named(inputs, monkeypatch):
    monkeypatch.setitem(sys.modules, "sounddevice", None)
    wait_for(lambda: inputs.device("microphone").problem)
    assert inputs.problem("microphone").endswith(install_command("microphone"))


# ── keys of Shadertoy ────────────────────────────────────────────────────────

DOWN = "void mainImage(out vec4 c, vec2 p) {{ c = vec4({}, 0.0, 0.0, 1.0); }}\n"


def exported(code: str) -> str:
    channel = {"channel": 0, "ctype": "keyboard", "src": "/presets/tex00.jpg", "id": "33"}
    image = {"name": "Image", "type": "image", "code": code, "inputs": [channel], "outputs": []}
    return json.dumps({"Shader": {"ver": "0.1", "info": {"name": "keys"}, "renderpass": [image]}})


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("vscode.frag", "#iKeyboard\n" + DOWN.format("isKeyToggled(Key_A) ? 1.0 : 0.0")),
        ("export.json", exported(DOWN.format("texelFetch(iChannel0, ivec2(65, 2), 0).x"))),
    ],
)
@pytest.mark.room("dialects")
def test_a_shadertoy_that_reads_the_keyboard_gets_it(any_engine, tmp_path, name, text):
    (tmp_path / name).write_text(text)
    sketch, keyboard = load(tmp_path / name), any_engine.runner.inputs.keyboard
    assert traits_of(sketch).keys
    red = []
    for codes in ([], [A], [], [A]):
        keyboard.hold(codes)
        red.append(int(any_engine.render(sketch, size=(2, 2)).array[0, 0, 0]))
    assert red == [0, 255, 255, 0]
    assert source_warnings(any_engine.plan(sketch, (2, 2))) == (), "it is fed"

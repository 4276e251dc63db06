"""A picture gets the keys that no shortcut takes, and all of them after a click on it."""

from __future__ import annotations

import pytest
from imgui_bundle import imgui

from playground.studio.keys import CODES, PictureKeys, act_on_keys
from tests.studio import panel_desk as desk

from .panel_desk import Bare

FILES = {
    "sketch.toml": """format = 1
[[pass]]
name = "keys"
use = "foreign/keys"
[view]
use = "./shown"
inputs = { iChannel0 = "keys" }
""",
    "shown.glsl": """void mainImage(out vec4 colour, vec2 place) {
    colour = vec4(vec3(texelFetch(iChannel0, ivec2(place.x < 24.0 ? 37 : 77, 0), 0).x), 1.0);
}
""",
}
_K = imgui.Key
M, LEFT = 77, 37


@pytest.fixture
def keys(bare: Bare, monkeypatch) -> PictureKeys:
    picture_keys = PictureKeys(bare.bench)
    bare.session.clock.playing = False

    def act(bench):
        if not picture_keys.act():
            act_on_keys(bench)

    monkeypatch.setattr(desk, "act_on_keys", act)
    picture_keys.frames = bare.run_frames
    picture_keys.frames(2)
    return picture_keys


def down(bare: Bare) -> tuple[int, ...]:
    return bare.session.engine.runner.inputs.keyboard.now.down


def hold(key: imgui.Key, is_down: bool) -> None:
    imgui.get_io().add_key_event(key, is_down)


def test_codes_are_javascript_s():
    for key, code in {
        _K.a: 65, _K.z: 90, _K._0: 48, _K.space: 32, _K.left_arrow: 37, _K.down_arrow: 40, _K.enter: 13,
        _K.left_shift: 16, _K.escape: None, _K.f1: 112, _K.f12: 123, _K.keypad9: 105, _K.semicolon: 186,
    }.items():  # fmt: skip
        assert CODES.get(key) == code
    assert all(0 < code < 256 for code in CODES.values())


@pytest.mark.room("dialects")
def test_a_key_that_is_no_shortcut_reaches_the_picture_at_once(bare, keys):
    hold(_K.left_arrow, True)
    hold(_K.m, True)
    keys.frames(2)
    assert down(bare) == (LEFT,), "M shows the map"
    keys.frames(2)
    hold(_K.left_arrow, False)
    hold(_K.m, False)
    keys.frames(2)
    assert down(bare) == ()


@pytest.mark.room("dialects")
def test_clicked_picture_takes_all_keys_until_esc(bare, keys):
    imgui.get_io().add_mouse_pos_event(1000, 400)
    keys.frames()
    imgui.get_io().add_mouse_button_event(0, True)
    keys.frames()
    imgui.get_io().add_mouse_button_event(0, False)
    keys.frames()
    assert keys.has_keyboard and "Esc gives it back" in bare.bench.notices.items[-1].text
    hold(_K.m, True)
    keys.frames(2)
    assert down(bare) == (M,) and bare.session.view.map is None, "no map is shown"
    assert bare.session.read().array[16, 40, 0] == 255
    hold(_K.mod_ctrl, True)
    keys.frames(2)
    assert M not in down(bare), "with Ctrl it is the window's"
    for key in (_K.mod_ctrl, _K.m):
        hold(key, False)
    keys.frames(2)
    hold(_K.escape, True)
    keys.frames(2)
    hold(_K.escape, False)
    keys.frames(2)
    assert not keys.has_keyboard
    hold(_K.m, True)
    keys.frames(2)
    assert down(bare) == () and bare.session.view.map is not None


def test_a_sketch_that_reads_no_keys_gets_none(bare, keys, folder):
    (folder / "sketch.toml").write_text(FILES["sketch.toml"].replace("keys", "noise"))
    bare.session.drafts.reload()
    keys.frames(3)
    hold(_K.left_arrow, True)
    keys.frames(2)
    assert down(bare) == () and not keys.has_keyboard

"""Keys and mouse: each key means one thing, Esc closes one layer at a time, a drag ends at its release."""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
from imgui_bundle import ImVec2, imgui

from playground.studio.addition import Addition, Layer
from playground.studio.code.panel import ask_to_close
from playground.studio.guard import Guard
from playground.studio.interface import SIZES, Preferences, remembered_preferences
from playground.studio.keys import all_keys, open_layers
from playground.studio.session import Session
from playground.studio.window import DOUBLE_CLICK_TIME, Clicks, after_events, before_release

from ..cases import each
from ..sketch_texts import map_of_height
from .panel_desk import Bare, OpenBare

TERRAIN = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) { return 0.5; }\n'


FILES = {"terrain.glsl": TERRAIN, "sketch.toml": "format = 1\nsize = 17\n" + map_of_height()}


@each(
    ("keys", "size"),
    [
        ((imgui.Key.equal,), 1.1),
        ((imgui.Key.mod_shift, imgui.Key.equal), 1.1),
        ((imgui.Key.keypad_add,), 1.1),
        ((imgui.Key.minus,), 0.9),
        ((imgui.Key.keypad_subtract,), 0.9),
        ((imgui.Key.right_bracket,), 1.0),
    ],
)
def test_ctrl_plus_and_minus_change_the_size(bare: Bare, keys: tuple[imgui.Key, ...], size: float) -> None:
    bare.key(imgui.Key.mod_ctrl, *keys)
    assert bare.bench.interface.preferences.size == size
    bare.key(imgui.Key.mod_ctrl, imgui.Key._0)
    assert bare.bench.interface.preferences.size == 1.0
    bare.key(*keys)
    assert bare.bench.interface.preferences.size == 1.0, "without Ctrl they are no such keys"


def test_a_keyboard_whose_plus_is_elsewhere_has_it_there(bare: Bare) -> None:
    bare.bench.window.sign_held = lambda: "+"
    bare.key(imgui.Key.mod_ctrl, imgui.Key.right_bracket)  # as on a German keyboard
    assert bare.bench.interface.preferences.size == 1.1
    bare.key(imgui.Key.mod_ctrl, imgui.Key.minus)  # as on a Swedish one
    assert bare.bench.interface.preferences.size == 1.25


def test_it_ends_at_the_smallest_and_at_the_largest() -> None:
    size = Preferences()
    for _ in range(20):
        size.step(1)
    assert size.size == SIZES[-1]
    for _ in range(20):
        size.step(-1)
    assert size.size == SIZES[0]


def test_interface_size_persists_and_invalid_file_uses_default(tmp_path: Path) -> None:
    assert remembered_preferences(tmp_path).size == 1.0
    remembered_preferences(tmp_path).step(1)
    assert remembered_preferences(tmp_path).size == 1.1
    for text in (
        "",
        "{",
        "[]",
        '{"format": 1, "size": "nan"}',
        '{"format": 2, "size": 2.0}',
        '{"format": 1}',
    ):
        (tmp_path / "interface.json").write_text(text, encoding="utf-8")
        assert remembered_preferences(tmp_path).size == 1.0, text


# ── keys ──────────────────────────────────────────────────────────────────────


def test_no_two_meanings_share_a_key() -> None:
    struck = Counter((key.key, key.letter, key.sign, key.ctrl, key.shift) for key in all_keys())
    assert [keys for keys, count in struck.items() if count > 1] == []


# ── escape layers ─────────────────────────────────────────────────────────────


LAYERS_TERRAIN = """// terrain.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high the hills are
float kernel(ivec2 texel) { return level; }
"""
SKETCH = (
    "format = 1\nsize = 17\n"
    + map_of_height()
    + '[[preset]]\nname = "high"\nset = { "height.level" = 1.0 }\n'
)


@pytest.fixture
def layers_bare(tmp_path: Path, open_bare: OpenBare, monkeypatch: pytest.MonkeyPatch) -> Bare:
    (tmp_path / "terrain.glsl").write_text(LAYERS_TERRAIN)
    (tmp_path / "sketch.toml").write_text(SKETCH)
    made = open_bare(tmp_path)
    draw = made.draw

    def both() -> None:
        draw()
        made.draw_pane()

    monkeypatch.setattr(made, "draw", both)
    return made


class Guest(Addition):
    """What a room adds: a window of its own and a layer, which are open."""

    def __init__(self) -> None:
        self.open = {"dialog", "guest"}

    def layers(self) -> list[Layer]:
        return [("guest", lambda: self.open.remove("guest"))] if "guest" in self.open else []

    def popups(self) -> list[Layer]:
        name = "dialog"
        return [(name, lambda: self.open.remove(name))] if name in self.open else []


def escape(layers_bare: Bare) -> None:
    layers_bare.key(imgui.Key.escape)
    layers_bare.run_frames(2)
    assert not layers_bare.quits


def test_one_layer_at_a_time_and_then_none(layers_bare: Bare, tmp_path: Path) -> None:
    bench = layers_bare.bench
    full = [True]
    bench.window.is_full = lambda: full[0]
    bench.window.toggle_full = lambda: full.__setitem__(0, not full[0])
    bench.additions = [Guest()]
    bench.inspection.compare.keep()
    bench.inspection.inspector.toggle()
    bench.files.open(tmp_path / "terrain.glsl", here=True)
    bench.interface.toggle_keymap()
    layers_bare.run_frames(3)
    names = ["keys", "dialog", "editor terrain.glsl", "inspector", "A/B", "full screen", "guest"]
    for n in range(len(names)):
        assert open_layers(bench) == names[n:]
        escape(layers_bare)
    assert open_layers(bench) == []
    bench.notices.items.clear()
    escape(layers_bare)
    assert [n.text for n in bench.notices.items] == ["nothing is open that Esc could close; Ctrl+Q quits"]


def test_popups_and_the_lists_in_them_close_before_all_else(layers_bare: Bare) -> None:
    layers_bare.bench.inspection.inspector.toggle()
    for label in ("History", "Random", "Reset", "##preset", "##shown"):
        layers_bare.click(label)
        assert "popup" in open_layers(layers_bare.bench), label
        escape(layers_bare)
        assert open_layers(layers_bare.bench) == ["inspector"], label
    layers_bare.click("##height.level", button=1)
    assert open_layers(layers_bare.bench) == ["popup", "inspector"]
    escape(layers_bare)
    escape(layers_bare)
    assert open_layers(layers_bare.bench) == []


def test_a_field_in_a_popup_is_left_before_the_popup(layers_bare: Bare) -> None:
    layers_bare.click("Save")
    layers_bare.click("##name")
    layers_bare.type("mine")
    escape(layers_bare)
    assert open_layers(layers_bare.bench) == ["popup"]
    escape(layers_bare)
    assert open_layers(layers_bare.bench) == []


def test_esc_gives_the_keys_back_and_closes_no_tab(layers_bare: Bare, tmp_path: Path) -> None:
    files = layers_bare.bench.files
    files.open(tmp_path / "terrain.glsl", here=True)
    layers_bare.run_frames(3)
    layers_bare.type("// more")
    assert open_layers(layers_bare.bench) == ["editor terrain.glsl"]
    escape(layers_bare)
    assert open_layers(layers_bare.bench) == [] and len(files.editing) == 1
    layers_bare.key(imgui.Key.m)
    assert layers_bare.session.view.map is not None, "a key of the picture"


def test_esc_dismisses_the_question_on_closing(layers_bare: Bare, tmp_path: Path) -> None:
    files = layers_bare.bench.files
    files.open(tmp_path / "terrain.glsl", here=True)
    layers_bare.run_frames(3)
    layers_bare.type("// more")
    ask_to_close(files.editing[0], files)
    layers_bare.run_frames(3)
    assert open_layers(layers_bare.bench)[0] == "popup", "it asks whether to save"
    escape(layers_bare)
    assert len(files.editing) == 1 and "popup" not in open_layers(layers_bare.bench)
    assert "// more" not in (tmp_path / "terrain.glsl").read_text()


def test_ctrl_q_quits_also_out_of_a_field(layers_bare: Bare) -> None:
    layers_bare.type("/")
    layers_bare.run_frames(4)
    layers_bare.type("lev")
    layers_bare.key(imgui.Key.mod_ctrl, imgui.Key.q)
    assert layers_bare.quits


def test_keys_typed_before_field_gets_focus_go_to_field(layers_bare: Bare) -> None:
    """On a slow renderer some frames pass between a double click and the field that it opens."""
    session, io = layers_bare.session, imgui.get_io()
    layers_bare.point("##height.level", 0.2)
    for down in (True, False, True):
        layers_bare.press(down)
    keys = imgui.Key._0, imgui.Key.period, imgui.Key._2, imgui.Key._5
    for letter, key in zip("0.25", keys, strict=True):
        for down in (True, False):
            io.add_key_event(key, down)
            if down:
                io.add_input_character(ord(letter))
            layers_bare.run_frames()
    layers_bare.press(False)
    layers_bare.run_frames(3)
    layers_bare.key(imgui.Key.enter)
    assert dict(session.shown.edits.values)["height.level"] == 0.25  # type: ignore[union-attr]


def test_letters_typed_right_behind_the_search_are_no_shortcuts(layers_bare: Bare) -> None:
    io = imgui.get_io()
    shown, saved = layers_bare.session.view.map, layers_bare.bench.actions.saved_picture
    for letter, key in (("/", imgui.Key.slash), ("m", imgui.Key.m), ("s", imgui.Key.s), ("a", imgui.Key.a)):
        io.add_key_event(key, True)
        io.add_input_character(ord(letter))
        layers_bare.run_frames()
        io.add_key_event(key, False)
    layers_bare.run_frames(4)
    assert layers_bare.session.view.map is shown and layers_bare.bench.actions.saved_picture is saved
    assert not layers_bare.bench.inspection.compare.on
    assert layers_bare.panel.memory.filter.search == "msa"


# ── double click ──────────────────────────────────────────────────────────────


SLOW = 0.4
"""[s] that a frame takes where a picture is drawn slowly."""


class PictureMouse:
    """Presses at moments; a window that asks for events between pictures of a given length."""

    def __init__(self, picture: float, presses: list[float], *, sleeps: bool = False) -> None:
        self.time = 0.0
        self.clicks = Clicks(lambda: self.time)
        self.doubles: list[bool] = []
        left = sorted(presses)
        while left:
            self.clicks.before_poll()
            if sleeps and left[0] > self.time:  # an event wakes it
                self.time = min(left[0], self.time + 1.0)
            while left and left[0] <= self.time:
                left.pop(0)
                self.clicks.press()
            self.clicks.after_poll()
            self.draw()
            self.time += picture
        for _ in presses:
            self.draw()

    def draw(self) -> None:
        """Have imgui come to one press, if there is one: as it does, one a frame."""
        longest = self.clicks.double_click_time()
        if longest != DOUBLE_CLICK_TIME:
            self.doubles.append(longest > 1.0)
            self.clicks.handled()


@pytest.mark.parametrize("picture", [1 / 60, 0.1, SLOW, 1.5])
@pytest.mark.parametrize("first", [0.001, 0.05, 0.3, 0.39, 0.6])
def test_two_clicks_a_tenth_of_a_second_apart_are_a_double_click(picture: float, first: float) -> None:
    assert PictureMouse(picture, [first, first + 0.1]).doubles == [False, True]


@pytest.mark.parametrize("picture", [1 / 60, 0.1])
def test_two_clicks_a_second_apart_are_two(picture: float) -> None:
    assert PictureMouse(picture, [0.05, 1.05]).doubles == [False, False]


def test_in_slow_frames_clicks_that_cannot_have_been_one_are_two() -> None:
    assert PictureMouse(SLOW, [0.05, 1.5]).doubles == [False, False]


@pytest.mark.parametrize(("apart", "double"), [(0.1, True), (0.29, True), (0.5, False), (0.99, False)])
def test_while_the_window_sleeps_the_moment_is_known(apart: float, double: bool) -> None:
    assert PictureMouse(0.02, [0.5, 0.5 + apart], sleeps=True).doubles == [False, double]


def test_without_a_press_imgui_keeps_its_own_time() -> None:
    assert Clicks().double_click_time() == DOUBLE_CLICK_TIME


# ── releases ──────────────────────────────────────────────────────────────────


WIDE, PAD = 400.0, 10.0


class Slider:
    """A slider from 0 to 1 over a window without a screen."""

    def __init__(self) -> None:
        self.value = 0.0
        self.frames()

    def frame(self) -> None:
        imgui.new_frame()
        imgui.set_next_window_pos(ImVec2(0, 0))
        imgui.set_next_window_size(ImVec2(500, 100))
        imgui.begin("w")
        imgui.set_cursor_screen_pos(ImVec2(PAD, 40))
        imgui.set_next_item_width(WIDE)
        _, self.value = imgui.slider_float("##s", self.value, 0.0, 1.0)
        imgui.end()
        imgui.render()
        for texture in imgui.get_platform_io().textures:
            texture.set_status(imgui.ImTextureStatus.ok)

    def frames(self) -> float:
        for _ in range(5):
            self.frame()
        return self.value


@pytest.fixture
def slider() -> Iterator[Slider]:
    context = imgui.create_context()
    io = imgui.get_io()
    io.set_ini_filename("")
    io.display_size = ImVec2(500, 100)
    io.backend_flags |= imgui.BackendFlags_.renderer_has_textures
    yield Slider()
    imgui.destroy_context(context)


def move(share: float) -> tuple[float, float]:
    position = PAD + share * WIDE, 48.0
    imgui.get_io().add_mouse_pos_event(*position)
    return position


def test_drag_ends_at_release_position_at_any_frame_rate(slider: Slider) -> None:
    io = imgui.get_io()
    move(0.2)
    slider.frames()
    io.add_mouse_button_event(0, True)
    slider.frames()
    move(0.4)
    position = move(0.75)
    before_release(position)
    io.add_mouse_button_event(0, False)
    move(0.3)  # what comes later is no part of it
    after_events()
    # A knob's middle stays away from the ends, so the share is not quite the mouse's.
    assert slider.frames() == pytest.approx(0.75, abs=0.02)
    assert not imgui.is_mouse_down(0) and io.mouse_pos.x == pytest.approx(PAD + 0.3 * WIDE)
    move(0.9)
    assert slider.frames() == pytest.approx(0.75, abs=0.02)
    assert io.mouse_source == imgui.MouseSource.mouse


def test_a_release_at_rest_is_the_mouses_own(slider: Slider) -> None:
    io = imgui.get_io()
    position = move(0.5)
    slider.frames()
    io.add_mouse_button_event(0, True)
    slider.frames()
    before_release(position)
    io.add_mouse_button_event(0, False)
    after_events()
    slider.frame()
    assert not imgui.is_mouse_down(0) and io.mouse_source == imgui.MouseSource.mouse


# ── hover ─────────────────────────────────────────────────────────────────────


def test_a_press_has_four_numbers_whose_signs_are_its_state():
    runner = SimpleNamespace(hover=(0.0, 0.0), drag=(0.0, 0.0, 0.0, 0.0))
    session = SimpleNamespace(engine=SimpleNamespace(runner=runner), sketch=None)

    def after(x: float, y: float, *, pressed: bool = False, clicked: bool = False) -> tuple[float, ...]:
        Session.hover(session, (x, y), pressed=pressed, clicked=clicked)
        assert runner.hover == (x, y)
        return runner.drag

    assert after(3.0, 4.0) == (0.0, 0.0, 0.0, 0.0), "it only hovers"
    assert after(5.0, 6.0, pressed=True, clicked=True) == (5.0, 6.0, 5.0, 6.0), "pressed in this frame"
    assert after(7.0, 8.0, pressed=True) == (7.0, 8.0, 5.0, -6.0), "and dragged"
    assert after(9.0, 9.0) == (7.0, 8.0, -5.0, -6.0), "released: where it was last"
    assert after(1.0, 2.0, pressed=True, clicked=True) == (1.0, 2.0, 1.0, 2.0), "pressed again"


# ── guard ─────────────────────────────────────────────────────────────────────


def ended_too_soon() -> None:
    imgui.begin("left open")
    imgui.push_id("an id")
    imgui.push_style_color(imgui.Col_.text, (1.0, 0.0, 0.0, 1.0))
    imgui.push_style_var(imgui.StyleVar_.alpha, 0.5)
    imgui.begin_child("a child")
    imgui.begin_group()
    imgui.begin_disabled()
    raise ValueError("this cannot be drawn")


def empty_id() -> None:
    imgui.begin("left open")
    imgui.tree_node_ex("###")


def table() -> None:
    imgui.begin("left open")
    if imgui.begin_table("table", 2):
        imgui.table_next_column()
    raise IndexError("no such row")


def popup() -> None:
    imgui.begin("left open")
    imgui.open_popup("popup")
    if imgui.begin_popup("popup"):
        imgui.push_item_width(20)
        imgui.push_text_wrap_pos(4)
    raise KeyError("gone")


def font() -> None:
    imgui.begin("left open")
    imgui.push_font(imgui.get_font(), 20)
    imgui.begin_tooltip()
    raise RuntimeError("no glyph")


def ended_twice() -> None:
    imgui.end()


BUGS = (ended_too_soon, empty_id, table, popup, font, ended_twice)


@pytest.fixture
def interface() -> Iterator[None]:
    context = imgui.create_context()
    io = imgui.get_io()
    io.set_ini_filename("")
    io.display_size = ImVec2(640, 480)
    io.backend_flags |= imgui.BackendFlags_.renderer_has_textures
    yield
    imgui.destroy_context(context)


def draw_frame(draw: Callable[[], None]) -> tuple[float, int]:
    """Draw one frame; return where a button after it is, and how wide it is."""
    imgui.get_io().delta_time = 1 / 60
    imgui.new_frame()
    draw()
    imgui.set_next_window_pos(ImVec2(10, 10))
    imgui.begin("the next part")
    imgui.button("as always")
    result = imgui.get_item_rect_min().y, imgui.get_item_rect_size().x
    imgui.end()
    imgui.render()
    for texture in imgui.get_platform_io().textures:
        texture.set_status(imgui.ImTextureStatus.ok)
    return result


@pytest.mark.parametrize("bug", BUGS, ids=lambda bug: bug.__name__)
def test_panel_bug_becomes_notice_and_next_part_is_drawn(
    interface: None, bug: Callable[[], None], caplog: pytest.LogCaptureFixture
) -> None:
    notices: list[str] = []
    guard = Guard(notices.append)
    draw_frame(lambda: None)
    usual = draw_frame(lambda: None)
    with caplog.at_level(logging.ERROR):
        for _ in range(3):
            assert draw_frame(lambda: guard.draw("the part", bug, None)) == usual
    assert len(notices) == 3 and all("the part failed" in notice for notice in notices)
    assert len(caplog.records) == 1, "reported once in the terminal"
    assert caplog.records[0].exc_info is not None


def test_what_is_left_open_without_a_bug_is_ended(interface: None) -> None:
    notices: list[str] = []
    guard = Guard(notices.append)
    draw_frame(lambda: None)
    usual = draw_frame(lambda: None)

    def draw() -> int:
        imgui.begin("left open")
        imgui.push_id("an id")
        return 7

    numbers: list[int] = []
    assert draw_frame(lambda: numbers.append(guard.draw("the part", draw, 0))) == usual
    assert numbers == [7]


def test_interrupting_is_no_bug(interface: None) -> None:
    def stop() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        Guard(print).run("the part", stop, None)


def test_a_part_that_draws_nothing_returns_its_default(tmp_path: Path) -> None:
    notices: list[str] = []
    assert Guard(notices.append).run("reading", lambda: len((tmp_path / "gone").read_bytes()), -1) == -1
    assert notices and "reading failed" in notices[0]

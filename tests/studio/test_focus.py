"""The keyboard alone: where Tab goes, what Space, Enter and arrows do there, how Esc gives the keys back.

And the picture's cursor, which keys move and press in the mouse's place.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing
from itertools import pairwise
from pathlib import Path

import pytest
from imgui_bundle import imgui

from playground.engine.engine import Engine
from playground.sketch.assign import values_of
from playground.sketch.model import Camera
from playground.studio import focus, keys
from playground.studio.code.panel import draw_code, draw_questions, typing
from playground.studio.compare.compare import Mode
from playground.studio.graph.panel import passes_tab
from playground.studio.interface import Tab
from playground.studio.panes import draw_pane
from playground.studio.theme import Theme

from ..sketch_texts import map_of, passes
from .panel_desk import Bare, OpenBare, PictureDesk
from .screen import HILLS

K = imgui.Key
TERRAIN = """// terrain.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform float level = 0.5;  //! slider(0, 1) How high
uniform vec3 tint = vec3(0.5);  //! color
uniform bool flat_ = false;  //! checkbox
uniform int kind = 0;  //! menu("round", "sharp")
float kernel(ivec2 texel) { return flat_ ? 0.5 : level; }
"""
FILES = {
    "terrain.glsl": TERRAIN,
    "sketch.toml": "format = 1\nsize = 33\n" + passes(height="./terrain") + map_of("height"),
}


class Desk(Bare):
    """The panel, the code pane and the strip."""

    def draw(self) -> None:
        files, problems = self.bench.files, self.bench.problems
        self.bench.follow_files()
        super().draw()
        area = (780.0, 0.0, 500.0, 470.0)
        draw_pane("code pane", area, lambda: draw_code(files, problems, self.theme, self.bench.tracing))
        draw_questions(files)

    def focused(self) -> str:
        nav = imgui.get_current_context().nav_id if focus.is_shown() else 0
        label: str = self.labels.get(nav, "?" if nav else "")
        return label

    def tab(self, count: int = 1, *, back: bool = False) -> list[str]:
        """Press Tab so many times; return what has the focus after each."""
        seen = []
        for _ in range(count):
            self.key(*((K.mod_shift,) if back else ()), K.tab)
            self.run_frames(2)
            seen.append(self.focused())
        return seen

    def walk(self, to: str) -> None:
        """Press Tab until a control has the focus."""
        for _ in range(80):
            if self.focused() == to:
                return
            self.tab()
        raise AssertionError(f"Tab never comes to {to}")

    def value(self, name: str) -> object:
        assert self.session.sketch is not None
        return values_of(self.session.sketch)[f"height.{name}"]


@pytest.fixture
def desk(any_engine: Engine, folder: Path) -> Iterator[Desk]:
    made = Desk(any_engine, folder)

    def draw(_: Theme) -> None:
        imgui.button("in strip")

    made.bench.tabs.append(Tab("one", "One", draw))
    made.bench.interface.preferences.choose(panes={"strip": 1.0, "terrain": 0.0})
    made.run_frames(5)
    yield made
    made.close()


def test_tab_goes_through_the_panel_the_code_and_the_strip(desk: Desk) -> None:
    assert desk.focused() == "", "nothing shows it at first"
    seen = desk.tab(12)
    while not typing(desk.bench.files) and len(seen) < 70:
        seen += desk.tab()
    wanted = ["EN  Aa###settings", "History", "Save", "##shown", "##search", "Changed##only"]
    wanted += ["Terrain###terrain", "Height###pass", "##height.level", "##height.flat_", "View###pass"]
    wanted += ["Find###find code"]
    places = [next(n for n, label in enumerate(seen) if wish in label) for wish in wanted]
    assert places == sorted(places), seen
    assert seen[-1] == "" and focus.current_pane() == "code pane", "behind its buttons comes the text"
    desk.type("x")
    desk.key(K.tab)
    desk.run_frames(2)
    assert typing(desk.bench.files), "in the text Tab indents"
    desk.key(K.mod_ctrl, K.tab)
    desk.run_frames(2)
    assert focus.current_pane() == "strip" and focus.is_shown()
    desk.walk("in strip")
    assert desk.tab() == ["EN  Aa###settings"], "from the end back to the beginning"
    assert desk.tab(back=True) == ["in strip"]
    desk.key(K.mod_ctrl, K.tab)
    desk.run_frames(2)
    assert focus.current_pane() == "panel"
    desk.key(K.mod_ctrl, K.mod_shift, K.tab)
    desk.run_frames(2)
    assert focus.current_pane() == "strip"


def test_a_slider_is_moved_and_typed_by_keys(desk: Desk) -> None:
    desk.walk("##height.level")
    desk.key(K.space)
    for _ in range(5):
        desk.key(K.right_arrow)
    desk.key(K.space)
    moved = desk.value("level")
    assert isinstance(moved, float) and moved > 0.5
    assert not desk.session.clock.playing or not desk.session.animated
    desk.key(K.enter)
    desk.run_frames(6)
    assert imgui.get_io().want_text_input
    desk.type("1/4")
    desk.key(K.enter)
    desk.run_frames(3)
    assert desk.value("level") == 0.25


def test_boxes_lists_and_menus_take_keys(desk: Desk) -> None:
    desk.walk("##height.flat_")
    desk.key(K.space)
    assert desk.value("flat_") is True
    desk.walk("##height.kind")
    desk.key(K.space)
    desk.run_frames(2)
    desk.key(K.down_arrow)
    desk.key(K.enter)
    desk.run_frames(2)
    assert desk.value("kind") == 1
    desk.key(K.menu)
    desk.run_frames(3)
    desk.key(K.down_arrow)  # from "Type a value" to "Reset"
    desk.key(K.enter)
    desk.run_frames(2)
    assert desk.value("kind") == 0


def test_escape_ends_one_thing_at_a_time(desk: Desk) -> None:
    desk.walk("Save")
    desk.key(K.space)
    desk.run_frames(3)
    assert imgui.is_popup_open("", imgui.PopupFlags_.any_popup)
    desk.key(K.escape)
    assert not imgui.is_popup_open("", imgui.PopupFlags_.any_popup) and desk.focused() == "Save"
    playing = desk.session.clock.playing
    desk.key(K.space)
    desk.key(K.escape)
    assert desk.session.clock.playing == playing, "Space is the control's"
    desk.key(K.escape)
    assert desk.focused() == "" and not desk.bench.notices.items
    desk.key(K.space)
    assert desk.session.clock.playing != playing, "now it is the picture's"
    desk.tab()
    imgui.get_io().add_mouse_pos_event(600, 600)
    desk.press(True)
    desk.press(False)
    assert desk.focused() == "", "a click ends it"


def test_the_graph_and_the_focus_share_no_keys(desk: Desk) -> None:
    desk.bench.tabs[:] = [passes_tab(desk.bench)]
    desk.run_frames(3)
    for pane in ("panel", "code pane", "strip"):
        desk.key(K.mod_ctrl, K.tab)
        desk.run_frames(2)
        assert focus.current_pane() == pane
    desk.walk("canvas")
    desk.key(K.space)
    desk.run_frames(3)
    assert desk.bench.inspection.graph.has_keys and desk.focused() == ""
    chosen = desk.bench.inspection.graph.chosen
    desk.key(K.right_arrow)
    assert desk.bench.inspection.graph.chosen != chosen and desk.focused() == ""
    desk.key(K.escape)
    assert not desk.bench.inspection.graph.has_keys
    assert desk.tab() != [""]


def test_arrows_steer_the_picture(open_bare: OpenBare, tmp_path: Path) -> None:
    (tmp_path / "sketch.toml").write_text(HILLS, encoding="utf-8")
    (tmp_path / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
    bare = open_bare(tmp_path)

    def camera() -> Camera:
        assert bare.session.sketch is not None
        return bare.session.sketch.camera

    first = camera()
    bare.key(K.right_arrow)
    turned = camera()
    assert turned.azimuth != first.azimuth and turned.elevation == first.elevation
    bare.key(K.left_arrow)
    assert camera().azimuth == pytest.approx(first.azimuth)
    bare.key(K.mod_shift, K.up_arrow)
    assert camera().azimuth == pytest.approx(first.azimuth) and camera() != first
    bare.key(K.r)
    bare.type("+")
    nearer = camera().distance
    bare.type("--")
    assert nearer is not None and camera().distance is not None and nearer < camera().distance  # type: ignore[operator]
    bare.key(K.r)
    bare.key(K.tab)
    bare.run_frames(2)
    bare.key(K.down_arrow)
    assert camera() == first and focus.is_shown(), "while a control has the focus they are the pane's"


def test_arrows_walk_where_one_walks(
    open_bare: OpenBare, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "sketch.toml").write_text(HILLS, encoding="utf-8")
    (tmp_path / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
    bare = open_bare(tmp_path)
    steered: list[object] = []
    monkeypatch.setattr(keys, "steer", lambda _, gesture: steered.append(gesture))
    bare.key(K.right_arrow)
    assert len(steered) == 1
    bare.bench.walk.toggle()
    assert bare.bench.walk.on
    bare.key(K.right_arrow)
    assert len(steered) == 1, "they do not turn the terrain as well"


def test_a_step_of_the_history_is_chosen_by_keys(desk: Desk) -> None:
    desk.session.drafts.set("height.level", 0.75)
    desk.run_frames(3)
    desk.walk("History")
    desk.key(K.space)
    desk.run_frames(3)
    desk.key(K.home)
    desk.key(K.enter)
    desk.run_frames(3)
    assert desk.value("level") == 0.5


# ── the picture's cursor ──────────────────────────────────────────────────────

COLUMNS = """// terrain.glsl -- each texel by its place
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) {
    float row = 100.0 * float(texel.y);
    return row + float(texel.x);
}
"""
MAP = "format = 1\nsize = 33\n" + passes(height="./terrain") + map_of("height")


DeskOn = Callable[[str], PictureDesk]


@pytest.fixture
def desk_on(any_engine: Engine, tmp_path: Path) -> Iterator[DeskOn]:
    """Give what opens a desk on a sketch's text."""
    with ExitStack() as stack:

        def opened(sketch: str) -> PictureDesk:
            (tmp_path / "sketch.toml").write_text(sketch, encoding="utf-8")
            (tmp_path / "terrain.glsl").write_text(COLUMNS, encoding="utf-8")
            return stack.enter_context(closing(PictureDesk(any_engine, tmp_path)))

        yield opened


def texel(desk: PictureDesk) -> tuple[int, int]:
    """Return the texel that the box of values reads: its number says the same place."""
    mouse, inspector = imgui.get_io().mouse_pos, desk.bench.inspection.inspector
    pixel = int(mouse.x - desk.area[0]), int(desk.area[3] - 1 - mouse.y)
    reads, report = inspector.reads, inspector.at(pixel, desk.picture)
    assert report is not None and report.shown is not None and inspector.reads == reads
    assert report.shown.values[0] == 100 * report.shown.texel[1] + report.shown.texel[0]
    return report.shown.texel


def test_keys_read_pin_and_trace_a_texel(desk_on: DeskOn) -> None:
    desk = desk_on(MAP)
    desk.session.show("height:height")
    tracing, inspector = desk.bench.tracing, desk.bench.inspection.inspector
    desk.key(K.i)
    desk.key(K.x)
    desk.run_frames(3)
    assert inspector.reads and texel(desk) == (16, 16), "it begins in the middle"
    desk.key(K.right_arrow)
    desk.key(K.right_arrow)
    desk.key(K.up_arrow)
    desk.run_frames(2)
    assert texel(desk) == (18, 17)
    desk.key(K.mod_shift, K.left_arrow)
    desk.run_frames(2)
    assert texel(desk) == (8, 17)
    desk.key(K.mod_ctrl, K.down_arrow)
    desk.run_frames(2)
    assert texel(desk) == (8, 0), "it stays on the land"
    tracing.now = lambda: 10 * desk.time  # two traces are some time apart
    desk.key(K.t)
    desk.run_frames(3)
    assert tracing.on and tracing.view is not None and tracing.view.trace.texel == (8, 0)
    playing = desk.session.clock.playing
    desk.key(K.space)
    desk.run_frames(3)
    assert tracing.is_pinned and desk.session.clock.playing == playing
    desk.key(K.up_arrow)
    desk.run_frames(3)
    assert tracing.view.trace.texel == (8, 0) and texel(desk) == (8, 1)
    desk.key(K.mod_shift, K.space)
    desk.run_frames(3)
    assert tracing.view.trace.texel == (8, 1)
    assert tracing.compared.kept is not None and tracing.compared.kept.texel == (8, 0)
    desk.key(K.escape)
    desk.run_frames(2)
    assert not desk.bench.interface.cursor.on and tracing.on
    assert tuple(imgui.get_io().mouse_pos) == desk.mouse_at


def test_keys_drag_the_line_between_two_pictures(desk_on: DeskOn) -> None:
    desk = desk_on(MAP)
    compare = desk.bench.inspection.compare
    desk.key(K.a)
    desk.key(K.x)
    desk.run_frames(2)
    assert compare.mode is Mode.DIVIDER and compare.split == 0.5
    desk.key(K.enter)
    desk.key(K.mod_shift, K.right_arrow)
    desk.key(K.enter)
    desk.run_frames(2)
    moved = compare.split
    assert moved == pytest.approx(0.5 + 10 / desk.area[2], abs=1 / desk.area[2])
    desk.key(K.right_arrow)
    desk.run_frames(2)
    assert compare.split == moved and compare.on


def test_a_mouse_that_moves_ends_the_cursor(desk_on: DeskOn) -> None:
    desk = desk_on(MAP)
    desk.key(K.x)
    desk.key(K.enter)
    assert imgui.is_mouse_down(0)
    desk.mouse_at = 3.0, 4.0  # only touched
    desk.run_frames(2)
    assert desk.bench.interface.cursor.on
    desk.mouse_at = 40.0, 50.0
    desk.run_frames(3)
    assert not desk.bench.interface.cursor.on and not imgui.is_mouse_down(0)
    assert tuple(imgui.get_io().mouse_pos) == desk.mouse_at


def test_an_arrow_that_is_held_grows_faster(desk_on: DeskOn) -> None:
    desk = desk_on(HILLS)
    desk.key(K.x)
    imgui.get_io().add_key_event(K.right_arrow, True)
    places = [desk.bench.interface.cursor.position[0]]
    for _ in range(3):
        desk.run_frames(30)
        places.append(desk.bench.interface.cursor.position[0])
    steps = [b - a for a, b in pairwise(places)]
    assert 0 < steps[0] < steps[1] < steps[2]
    assert places[-1] < desk.area[0] + desk.area[2]


def test_keys_move_the_edge_of_each_pane(desk: Desk) -> None:
    desk.bench.panes.show_code()

    def size(name: str) -> tuple[float, float]:
        window = imgui.internal.find_window_by_name(name)
        assert window is not None
        return window.size.x, window.size.y

    desk.key(K.mod_ctrl, K.tab)
    desk.run_frames(2)
    first = size("panel")[0]
    desk.key(K.mod_alt, K.keypad_add)
    desk.run_frames(2)
    assert size("panel")[0] == first + 20 == desk.bench.panes.fraction("panel width", 0.0)
    for _ in range(40):
        desk.key(K.mod_alt, K.keypad_subtract)
    assert size("panel")[0] == 240, "no narrower than the mouse makes it"
    chosen, high = desk.bench.interface.preferences.panes, size("strip")[1]
    desk.key(K.mod_ctrl, K.tab)
    desk.key(K.mod_alt, K.keypad_add)
    desk.run_frames(2)
    assert desk.bench.interface.preferences.panes == {**chosen, "code width": pytest.approx(0.47)}
    desk.key(K.mod_ctrl, K.tab)
    desk.key(K.mod_alt, K.keypad_subtract)
    desk.run_frames(2)
    assert size("strip")[1] == pytest.approx(high - 0.02 * 720, abs=1)
    assert desk.bench.interface.preferences.panes["strip height"] == pytest.approx(0.32)
    imgui.get_io().add_mouse_pos_event(600, 100)  # the picture
    desk.press(True)
    desk.press(False)
    desk.key(K.mod_alt, K.keypad_subtract)
    assert any("Ctrl+Tab" in notice.text for notice in desk.bench.notices.items)

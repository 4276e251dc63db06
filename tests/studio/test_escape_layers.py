"""Esc closes one layer at a time, topmost first, and never quits."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from imgui_bundle import imgui

from playground.engine.engine import Engine
from playground.studio.addition import Addition, Layer
from playground.studio.code.panel import draw_code
from playground.studio.keys import open_layers

from ..sketch_texts import map_of_height
from .panel_desk import Bare

TERRAIN = """// terrain.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high the hills are
uniform sampler2D mask; //! file() paint
float kernel(ivec2 texel) { return level; }
"""
SKETCH = (
    "format = 1\nsize = 17\n"
    + map_of_height()
    + '[[preset]]\nname = "high"\nset = { "height.level" = 1.0 }\n'
)


@pytest.fixture
def bare(tmp_path: Path, any_engine: Engine, monkeypatch: pytest.MonkeyPatch) -> Iterator[Bare]:
    (tmp_path / "terrain.glsl").write_text(TERRAIN.replace("uniform sampler2D mask; //! file() paint\n", ""))
    (tmp_path / "sketch.toml").write_text(SKETCH)
    made = Bare(any_engine, tmp_path)
    draw = made.draw

    def both() -> None:
        draw()
        bench, area = made.bench, (330.0, 0.0, 900.0, 720.0)
        draw_code(bench.files, bench.problems, bench.window.quit, made.theme, area)

    monkeypatch.setattr(made, "draw", both)
    yield made
    made.close()


class Guest(Addition):
    """What a room adds: a window of its own and a layer, which are open."""

    def __init__(self) -> None:
        self.open = {"dialog", "guest"}

    def layers(self) -> list[Layer]:
        return [("guest", lambda: self.open.remove("guest"))] if "guest" in self.open else []

    def popups(self) -> list[Layer]:
        name = "dialog"
        return [(name, lambda: self.open.remove(name))] if name in self.open else []


def escape(bare: Bare) -> None:
    bare.key(imgui.Key.escape)
    bare.run_frames(2)
    assert not bare.quits


def test_one_layer_at_a_time_and_then_none(bare: Bare, tmp_path: Path) -> None:
    bench = bare.bench
    full = [True]
    bench.window.is_full = lambda: full[0]
    bench.window.toggle_full = lambda: full.__setitem__(0, not full[0])
    bench.additions = [Guest()]
    bench.inspection.compare.keep()
    bench.inspection.inspector.toggle()
    bench.inspection.graph.toggle()
    bench.files.open(tmp_path / "terrain.glsl", here=True)
    bench.interface.toggle_keymap()
    bare.run_frames(3)
    names = ["keys", "dialog", "editor terrain.glsl", "graph", "inspector", "A/B", "full screen", "guest"]
    for n in range(len(names)):
        assert open_layers(bench) == names[n:]
        escape(bare)
    assert open_layers(bench) == []
    bench.notices.items.clear()
    escape(bare)
    assert [n.text for n in bench.notices.items] == ["nothing is open that Esc could close; Ctrl+Q quits"]


def test_popups_and_the_lists_in_them_close_before_all_else(bare: Bare) -> None:
    bare.bench.inspection.graph.toggle()
    for label in ("History", "Random", "Reset", "##preset", "##shown"):
        bare.click(label)
        assert "popup" in open_layers(bare.bench), label
        escape(bare)
        assert open_layers(bare.bench) == ["graph"], label
    bare.click("##height.level", button=1)
    assert open_layers(bare.bench) == ["popup", "graph"]
    escape(bare)
    escape(bare)
    assert open_layers(bare.bench) == []


def test_a_field_in_a_popup_is_left_before_the_popup(bare: Bare) -> None:
    bare.click("Save")
    bare.click("##name")
    bare.type("mine")
    escape(bare)
    assert open_layers(bare.bench) == ["popup"]
    escape(bare)
    assert open_layers(bare.bench) == []


def test_esc_on_unsaved_editor_prompt_keeps_editor_open(bare: Bare, tmp_path: Path) -> None:
    bare.bench.files.open(tmp_path / "terrain.glsl", here=True)
    bare.run_frames(3)
    bare.type("// more")
    bare.run_frames(3)
    escape(bare)
    assert open_layers(bare.bench) == ["popup", "editor terrain.glsl"], "it asks whether to save"
    escape(bare)
    assert open_layers(bare.bench) == ["editor terrain.glsl"], "and stays"
    assert "// more" not in (tmp_path / "terrain.glsl").read_text()


def test_the_question_on_quitting_is_answered_by_esc_too(bare: Bare, tmp_path: Path) -> None:
    bare.bench.files.open(tmp_path / "terrain.glsl", here=True)
    bare.run_frames(3)
    bare.type("// more")
    bare.run_frames(3)
    bare.bench.files.leaving = True
    bare.run_frames(3)
    assert open_layers(bare.bench)[0] == "popup"
    escape(bare)
    assert not bare.bench.files.leaving and open_layers(bare.bench) == ["editor terrain.glsl"]


def test_ctrl_q_quits_also_out_of_a_field(bare: Bare) -> None:
    bare.type("/")
    bare.run_frames(4)
    bare.type("lev")
    bare.key(imgui.Key.mod_ctrl, imgui.Key.q)
    assert bare.quits


def test_keys_typed_before_field_gets_focus_go_to_field(bare: Bare) -> None:
    """On a slow renderer some frames pass between a double click and the field that it opens."""
    session, io = bare.session, imgui.get_io()
    bare.point("##height.level", 0.2)
    for down in (True, False, True):
        bare.press(down)
    keys = imgui.Key._0, imgui.Key.period, imgui.Key._2, imgui.Key._5
    for letter, key in zip("0.25", keys, strict=True):
        for down in (True, False):
            io.add_key_event(key, down)
            if down:
                io.add_input_character(ord(letter))
            bare.run_frames()
    bare.press(False)
    bare.run_frames(3)
    bare.key(imgui.Key.enter)
    assert dict(session.shown.edits.values)["height.level"] == 0.25  # type: ignore[union-attr]


def test_letters_typed_right_behind_the_search_are_no_shortcuts(bare: Bare) -> None:
    io = imgui.get_io()
    shown, saved = bare.session.view.map, bare.bench.commands.saved_picture
    for letter, key in (("/", imgui.Key.slash), ("m", imgui.Key.m), ("s", imgui.Key.s), ("a", imgui.Key.a)):
        io.add_key_event(key, True)
        io.add_input_character(ord(letter))
        bare.run_frames()
        io.add_key_event(key, False)
    bare.run_frames(4)
    assert bare.session.view.map is shown and bare.bench.commands.saved_picture is saved
    assert not bare.bench.inspection.compare.on
    assert bare.panel.memory.filter.search == "msa"

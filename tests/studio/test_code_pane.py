"""The code pane: what is typed is drawn without being saved, kept until it is, and there again."""

from __future__ import annotations

import os
import random
import re
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from imgui_bundle import imgui
from imgui_bundle import imgui_color_text_edit as text_edit

from playground.engine.engine import Engine
from playground.paths import GLSL
from playground.sketch.shader_names import library_declared
from playground.studio.code.open_files import Editing, is_changed, unsaved
from playground.studio.code.panel import typing
from playground.studio.code.unsaved_texts import KeptTexts

from ..sketch_texts import map_of_height
from .panel_desk import Bare

TERRAIN = """// terrain.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high the hills are
float kernel(ivec2 texel) {
    return level;
}
"""
FILES = {"terrain.glsl": TERRAIN, "sketch.toml": "format = 1\nsize = 17\n" + map_of_height()}
WAITS = 20  # frames after which what is typed is drawn


class Pane(Bare):
    """The code pane on a sketch, whose state folder is the test's own."""

    def __init__(self, engine: Engine, folder: Path) -> None:
        super().__init__(engine, folder / "sketch.toml", kept=KeptTexts(folder / "state"))
        self.watch(imgui, "begin_tab_item")
        self.run_frames(4)

    def draw(self) -> None:
        self.bench.follow_files()
        self.bench.problems.take(self.session.error, (), self.session.sketch)
        self.draw_pane()
        super().draw()

    def height(self) -> float:
        """Return the height of the terrain that is drawn, the same at each texel."""
        values = self.session.read_values("height:height")
        assert values is not None
        return float(values[8, 8])

    def tab(self, name: str) -> Editing:
        return next(e for e in self.bench.files.editing if e.text.path.name == name)

    def editor(self, name: str = "terrain.glsl") -> Any:
        return self.tab(name).view.editor  # type: ignore[union-attr]

    def place(self, line: int, column: int) -> None:
        """Give the kernel's text the keys, at a place from 1."""
        self.bench.files.open(self.session.path.parent / "terrain.glsl", line, column, here=True)
        self.run_frames(3)


@pytest.fixture
def open_pane(folder: Path, any_engine: Engine) -> Iterator[Callable[[], Pane]]:
    """Give what opens a pane on the sketch; the one before is closed."""
    opened: list[Pane] = []

    def open_pane() -> Pane:
        while opened:
            opened.pop().close()
        opened.append(Pane(any_engine, folder))
        return opened[0]

    yield open_pane
    while opened:
        opened.pop().close()


@pytest.fixture
def pane(open_pane: Callable[[], Pane]) -> Pane:
    return open_pane()


def test_the_sketch_and_its_kernels_have_tabs(pane: Pane) -> None:
    assert [e.text.path.name for e in pane.bench.files.editing] == ["sketch.toml", "terrain.glsl"]
    assert pane.bench.files.current is pane.tab("terrain.glsl"), "the code is seen first"
    assert not unsaved(pane.bench.files.editing)


def test_the_button_opens_and_closes_the_pane(pane: Pane) -> None:
    pane.bench.panes.show_code(False)
    pane.click("Code###code")
    assert pane.bench.panes.code_is_open and typing(pane.bench.files) == ["terrain.glsl"]
    pane.click("Code###code")
    assert not pane.bench.panes.code_is_open


def test_what_is_typed_is_drawn_and_not_saved(pane: Pane, folder: Path) -> None:
    file = folder / "terrain.glsl"
    pane.place(5, 17)
    pane.type(" * 0.5")
    assert pane.height() == 0.5, "not before the keys rest"
    pane.run_frames(WAITS)
    assert pane.height() == 0.25
    assert file.read_text(encoding="utf-8") == TERRAIN
    pane.key(imgui.Key.mod_ctrl, imgui.Key.s)
    assert file.read_text(encoding="utf-8") == TERRAIN.replace("level;", "level * 0.5;")
    assert pane.height() == 0.25 and not pane.session.drafts.unsaved and not unsaved(pane.bench.files.editing)


def test_a_mistake_stands_at_its_line_and_the_picture_stays(pane: Pane) -> None:
    pane.place(5, 17)
    pane.type(" * leval")
    pane.run_frames(WAITS)
    assert pane.height() == 0.5
    (wrong,) = pane.bench.problems.errors
    assert wrong.line == 5 and "leval" in wrong.message
    assert pane.editor().has_markers()
    for _ in "val":
        pane.key(imgui.Key.backspace)
    pane.type("vel")
    pane.run_frames(WAITS)
    assert not pane.bench.problems.all and pane.height() == 0.25 and not pane.editor().has_markers()


def test_undo_goes_by_words_and_pauses(pane: Pane) -> None:
    pane.place(5, 17)
    line = "    return level;"
    pane.type(" + one two")
    pane.run_frames(80)
    pane.type("three")
    seen = []
    for _ in range(5):
        pane.key(imgui.Key.mod_ctrl, imgui.Key.z)
        seen.append(pane.editor().get_line_text(4))
    assert seen[:3] == [
        "    return level + one two;",
        "    return level + one;",
        "    return level +;",
    ]
    assert seen[-1] == line
    for _ in range(6):
        pane.key(imgui.Key.mod_ctrl, imgui.Key.y)
    assert pane.editor().get_line_text(4) == "    return level + one twothree;"


def test_letters_that_come_within_one_frame_are_undone_by_words(pane: Pane) -> None:
    pane.place(5, 17)
    for letter in " + one two":
        imgui.get_io().add_input_character(ord(letter))
    pane.run_frames(3)
    assert pane.editor().get_line_text(4) == "    return level + one two;"
    pane.key(imgui.Key.mod_ctrl, imgui.Key.z)
    assert pane.editor().get_line_text(4) == "    return level + one;"
    pane.key(imgui.Key.mod_ctrl, imgui.Key.z)
    assert pane.editor().get_line_text(4) == "    return level +;"


def test_what_is_typed_is_there_again(pane: Pane, folder: Path, open_pane: Callable[[], Pane]) -> None:
    pane.place(5, 17)
    pane.type(" * 0.5")
    pane.run_frames(WAITS)
    again = open_pane()
    again.run_frames(WAITS)
    typed = TERRAIN.replace("level;", "level * 0.5;")
    assert again.height() == 0.25 and again.editor().get_text() == typed
    assert unsaved(again.bench.files.editing) == ["terrain.glsl"]
    again.place(1, 1)
    again.key(imgui.Key.mod_ctrl, imgui.Key.z)
    again.run_frames(WAITS)
    assert again.editor().get_text() == TERRAIN and again.height() == 0.5
    assert KeptTexts(folder / "state").of(folder / "terrain.glsl") is None


def test_what_was_typed_before_a_later_save_is_one_undo_away(
    folder: Path, open_pane: Callable[[], Pane]
) -> None:
    file = folder / "terrain.glsl"
    KeptTexts(folder / "state").keep(file, "// mine\n", TERRAIN)
    file.write_text(TERRAIN.replace("0.5", "0.75"), encoding="utf-8")
    os.utime(file, (time.time() + 60, time.time() + 60))
    pane = open_pane()
    pane.run_frames(WAITS)
    tab = pane.tab("terrain.glsl")
    assert pane.height() == 0.75 and not is_changed(tab)
    pane.place(1, 1)
    pane.key(imgui.Key.mod_ctrl, imgui.Key.z)
    assert pane.editor().get_text() == "// mine\n" and is_changed(tab)


def test_what_cannot_be_read_of_what_was_kept_is_left_out(folder: Path) -> None:
    kept, file = KeptTexts(folder / "state"), folder / "terrain.glsl"
    kept.keep(file, "mine", TERRAIN)
    assert kept.of(file).text == "mine"  # type: ignore[union-attr]
    (stored,) = (folder / "state").iterdir()
    for text in ("{", "[]", '{"format": 2}', '{"format": 1, "path": "elsewhere", "text": "", "over": ""}'):
        stored.write_text(text, encoding="utf-8")
        assert kept.of(file) is None
    kept.forget(file)
    assert kept.of(file) is None and not list((folder / "state").iterdir())


# ── completion ────────────────────────────────────────────────────────────────


def test_names_are_completed(pane: Pane) -> None:
    """Against what the letters begin: a local, a uniform, then the library with the include it needs."""
    pane.place(5, 17)
    pane.type(" * tex")
    pane.key(imgui.Key.tab)
    pane.type(".x + le")
    pane.key(imgui.Key.enter)
    assert pane.editor().get_line_text(4) == "    return level * texel.x + level;"
    pane.type(" + le")
    pane.key(imgui.Key.escape)
    assert typing(pane.bench.files), "Esc closes the list alone"
    pane.key(imgui.Key.enter)
    assert pane.editor().get_line_text(5) == "    ;", "after Esc a new line is a new line"


def test_what_is_completed_is_one_undo_and_is_drawn(pane: Pane) -> None:
    pane.place(5, 17)
    pane.type(" * le")
    pane.key(imgui.Key.tab)
    pane.run_frames(WAITS)
    assert pane.height() == 0.25
    pane.key(imgui.Key.mod_ctrl, imgui.Key.z)
    assert pane.editor().get_line_text(4) == "    return level * le;"


def test_a_function_of_the_library_brings_its_include(pane: Pane) -> None:
    name, places = next(item for item in library_declared().items() if len(item[0]) > 8)
    pane.place(5, 17)
    pane.type(f" + {name[:-1]}")
    pane.key(imgui.Key.tab)
    text = pane.editor().get_text()
    assert text.index(f'#include "{places[0][0]}"') < text.index(f"level + {name};")


def test_nothing_is_completed_in_a_comment(pane: Pane) -> None:
    pane.place(1, 1)
    pane.type("// le")
    pane.key(imgui.Key.tab)
    assert "level" not in pane.editor().get_line_text(0)


def test_a_name_is_explained_and_leads_to_its_declaration(pane: Pane) -> None:
    pane.place(5, 14)
    files, path = pane.bench.files, pane.session.path.parent / "terrain.glsl"
    known = files.names.meaning(path, TERRAIN, TERRAIN.index("level;") + 2)
    assert known is not None and known.detail == "float" and known.origin.tooltip == "How high the hills are"  # type: ignore[union-attr]
    assert files.names.meaning(path, TERRAIN, TERRAIN.index("return") + 2) is None
    pane.key(imgui.Key.f12)
    pane.run_frames(3)
    at = pane.editor().get_main_cursor_position()
    assert (at.line, at.index) == (2, TERRAIN.splitlines()[2].index("level"))
    pane.place(6, 1)
    pane.key(imgui.Key.f12)
    assert "no declaration" in pane.bench.notices.items[-1].text


def test_a_sketch_is_completed_and_explained(pane: Pane, folder: Path) -> None:
    """A technique's path by a part of it, the quote closed; a parameter of it; nothing in a comment."""
    sketch = folder / "sketch.toml"
    files, text = pane.bench.files, sketch.read_text(encoding="utf-8")
    files.open(sketch, 1, 1, here=True)
    pane.run_frames(3)
    pane.type('# use = "fbm')
    pane.key(imgui.Key.tab)
    assert "generation/" not in pane.editor("sketch.toml").get_text()
    pane.editor("sketch.toml").set_text('format = 1\n[[pass]]\nname = "hills"\n')
    files.open(sketch, 4, 1, here=True)
    pane.run_frames(3)
    pane.type('use = "tion/fbm')
    pane.key(imgui.Key.tab)
    assert pane.editor("sketch.toml").get_line_text(3) == 'use = "generation/fbm"'
    pane.key(imgui.Key.end)
    pane.key(imgui.Key.enter)
    pane.type("set.oct")
    pane.key(imgui.Key.tab)
    assert pane.editor("sketch.toml").get_line_text(4) == "set.octaves"
    text = pane.editor("sketch.toml").get_text().replace("set.octaves", "set.octaves = 3")
    known = files.names.meaning(sketch, text, text.index("octaves") + 2)
    assert known is not None and known.detail == "int" and known.label == "octaves"
    site = files.names.declaration(sketch, text, text.index("fbm") + 1)
    assert site is not None and site.path.parent.name == "generation"


# ── find and replace ──────────────────────────────────────────────────────────


def test_a_text_is_found_and_replaced_one_by_one_or_at_once(pane: Pane) -> None:
    pane.place(1, 1)
    pane.key(imgui.Key.mod_ctrl, imgui.Key.f)
    pane.run_frames(2)
    pane.type("LEVEL")
    pane.key(imgui.Key.enter)
    selection = pane.editor().get_main_cursor_selection()
    assert (selection.start.line, selection.start.index) == (2, 14)
    pane.click("##replace")
    pane.type("rise")
    pane.click("Replace##replace one")
    assert pane.editor().get_text() == TERRAIN.replace("level", "rise", 1)
    assert pane.editor().get_main_cursor_selection().start.line == 4, "on to the next one"
    pane.click("All##replace all")
    pane.run_frames(WAITS)
    assert pane.editor().get_text() == TERRAIN.replace("level", "rise") and pane.height() == 0.5
    pane.click("##replace")
    pane.key(imgui.Key.escape)
    pane.run_frames(3)
    assert not pane.bench.files.pane.find.is_open and typing(pane.bench.files)
    pane.key(imgui.Key.mod_ctrl, imgui.Key.z)
    pane.key(imgui.Key.mod_ctrl, imgui.Key.z)
    assert pane.editor().get_text() == TERRAIN


# ── new names ─────────────────────────────────────────────────────────────────


def rename(pane: Pane, line: int, column: int, new: str) -> None:
    pane.place(line, column)
    pane.key(imgui.Key.f2)
    pane.run_frames(3)
    pane.type(new)
    pane.key(imgui.Key.enter)


def test_a_parameter_is_renamed_in_all_files_as_one_step(pane: Pane, folder: Path) -> None:
    """In the kernel, in a file that it includes and in the sketch; one undo takes all of it back."""
    (folder / "shape.glsl").write_text("float shape() { return level * 0.5; }\n", encoding="utf-8")
    uses = TERRAIN.replace("float kernel", '#include "shape.glsl"\nfloat kernel').replace(
        "level;", "shape();"
    )
    sketch = folder / "sketch.toml"
    text = sketch.read_text(encoding="utf-8").replace(
        'use = "./terrain"', 'use = "./terrain"\nset.level = 0.5'
    )
    (folder / "terrain.glsl").write_text(uses, encoding="utf-8")
    sketch.write_text(text, encoding="utf-8")
    pane.session.drafts.reload()
    pane.bench.files.take_saved({folder / "terrain.glsl", sketch})
    pane.run_frames(4)
    assert pane.height() == 0.25
    rename(pane, 3, 17, "rise")
    pane.run_frames(WAITS)
    texts = {e.text.path.name: e.view.written() for e in pane.bench.files.editing if e.view is not None}
    assert texts["terrain.glsl"] == uses.replace("level", "rise")
    assert texts["shape.glsl"] == "float shape() { return rise * 0.5; }\n"
    assert texts["sketch.toml"] == text.replace("level", "rise")
    assert not pane.bench.problems.all and pane.height() == 0.25
    pane.key(imgui.Key.mod_ctrl, imgui.Key.z)
    pane.run_frames(WAITS)
    texts = {e.text.path.name: e.view.written() for e in pane.bench.files.editing if e.view is not None}
    assert texts["terrain.glsl"] == uses and texts["sketch.toml"] == text and "level" in texts["shape.glsl"]
    assert not pane.bench.problems.all and not unsaved(pane.bench.files.editing)
    pane.key(imgui.Key.mod_ctrl, imgui.Key.y)
    assert all("rise" in e.view.written() for e in pane.bench.files.editing if e.view is not None)


@pytest.mark.parametrize(
    ("line", "column", "new", "why"),
    [
        (4, 22, "level", "means something else|already"),
        (3, 17, "for", "word of GLSL"),
        (3, 17, "2b", "is no name"),
    ],
)
def test_a_name_that_cannot_be_says_why_and_stays(
    pane: Pane, line: int, column: int, new: str, why: str
) -> None:
    rename(pane, line, column, new)
    assert pane.editor().get_text() == TERRAIN
    view = pane.tab("terrain.glsl").view
    assert re.search(why, view.renaming.message)  # type: ignore[union-attr]
    pane.key(imgui.Key.escape)
    pane.type("x")
    assert view.renaming is None and pane.editor().get_text() != TERRAIN, "the text has the keys again"  # type: ignore[union-attr]


def test_names_that_are_not_the_sketch_s_own_stay(pane: Pane) -> None:
    pane.place(5, 7)
    pane.key(imgui.Key.f2)
    assert "word of GLSL" in pane.bench.notices.items[-1].text
    shipped = GLSL / next(iter(library_declared().values()))[0][0]
    pane.bench.files.open(shipped, 1, 1, here=True)
    pane.run_frames(4)
    pane.key(imgui.Key.f2)
    assert "not the sketch's own" in pane.bench.notices.items[-1].text


def test_the_list_of_errors_does_not_open_while_code_is_typed(pane: Pane, folder: Path) -> None:
    pane.place(5, 17)
    pane.type(" + zzz")
    pane.run_frames(WAITS)
    assert pane.bench.problems.errors and not pane.bench.problems.open
    pane.key(imgui.Key.escape)
    (folder / "sketch.toml").write_text("format = 1\nsize = nine\n", encoding="utf-8")
    pane.session.drafts.reload()
    pane.run_frames(2)
    assert pane.bench.problems.open, "one that another program saves opens it"


# ── files that are not the sketch's own, and what else writes ─────────────────


def test_values_are_saved_with_what_is_typed_in_the_sketch(pane: Pane, folder: Path) -> None:
    sketch = folder / "sketch.toml"
    pane.bench.files.open(sketch, 2, 1, here=True)
    pane.run_frames(3)
    pane.type("# mine")
    pane.key(imgui.Key.enter)
    pane.run_frames(WAITS)
    pane.session.drafts.set("height.level", 0.75)
    pane.run_frames(2)
    pane.bench.actions.save_values()
    text = sketch.read_text(encoding="utf-8")
    assert "# mine\n" in text and "level = 0.75" in text
    pane.bench.files.take_saved({sketch})
    pane.run_frames(WAITS)
    assert pane.editor("sketch.toml").get_text() == text and not unsaved(pane.bench.files.editing)
    assert pane.height() == 0.75


def test_a_technique_of_the_library_is_copied_into_the_sketch(pane: Pane, folder: Path) -> None:
    """One of several passes, by a file inside it: with its folder, drawn the same."""
    sketch = folder / "sketch.toml"
    text = sketch.read_text(encoding="utf-8").replace('"./terrain"', '"generation/fbm"')
    sketch.write_text(text, encoding="utf-8")
    pane.session.drafts.reload()
    pane.run_frames(4)
    before = pane.session.read_values("height:height")
    (spec,) = [spec for spec in pane.session.sketch.graph.passes if spec.name == "height"]
    inside = next(Path(f) for f in spec.technique.files if Path(f).parent.name == "fbm")
    pane.bench.files.open(inside, here=True)
    pane.run_frames(4)
    shipped = pane.editor(inside.name).get_text()
    pane.type("x")
    assert pane.editor(inside.name).get_text() == shipped, "it is not to be changed"
    pane.click("Copy into this sketch###copy in")
    pane.run_frames(4)
    copy = folder / "fbm" / inside.name
    assert copy.read_bytes() == inside.read_bytes() and pane.session.error is None
    (spec,) = [spec for spec in pane.session.sketch.graph.passes if spec.name == "height"]
    assert spec.use == "./fbm" and pane.bench.files.current.text.path == copy
    assert np.allclose(pane.session.read_values("height:height"), before, atol=1e-6)  # no fast variant
    pane.key(imgui.Key.escape)
    pane.key(imgui.Key.mod_ctrl, imgui.Key.z)
    pane.run_frames(4)
    (spec,) = [spec for spec in pane.session.sketch.graph.passes if spec.name == "height"]
    assert spec.use == "generation/fbm", "one step"


def test_a_window_that_closes_gives_the_pane_no_keys(pane: Pane) -> None:
    pane.place(5, 17)
    pane.key(imgui.Key.escape)
    pane.bench.interface.toggle_keymap()
    pane.run_frames(4)
    pane.bench.interface.toggle_keymap()
    pane.run_frames(6)
    assert not typing(pane.bench.files)
    pane.key(imgui.Key.m)
    assert pane.session.view.map is not None


# ── values of a traced texel ──────────────────────────────────────────────────

LOOP = """// terrain.glsl -- a sum
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) {
    float sum = 0.0;
    for (int i = 0; i < 4; i++)
        sum += 0.5;
    return sum;
}
"""


def test_values_stand_behind_the_lines_with_a_slider_for_a_loop(pane: Pane, folder: Path) -> None:
    tracing = pane.bench.tracing
    (folder / "terrain.glsl").write_text(LOOP, encoding="utf-8")
    pane.session.drafts.reload()
    pane.bench.files.take_saved({folder / "terrain.glsl"})
    pane.run_frames(4)
    pane.session.show("height:height")
    tracing.toggle()
    tracing.pin_at((10, 10), (48, 32))
    draw = pane.draw

    def traced() -> None:
        tracing.update(pane.picture)
        draw()

    pane.draw = traced  # type: ignore[method-assign]
    pane.run_frames(6)
    assert tracing.view is not None, tracing.message
    x, y, _, high = pane.places["##turn"]
    seen = [row for row in tracing.view.rows(str(folder / "terrain.glsl")) if row.items]
    assert [item.text for row in seen if row.number == 6 for item in row.items] == ["2"]
    cursor = pane.editor().get_main_cursor_position()
    imgui.get_io().add_mouse_pos_event(x + 2, y + high / 2)
    pane.run_frames(2)
    pane.press(True)
    pane.press(False)
    pane.run_frames(2)
    rows = tracing.view.rows(str(folder / "terrain.glsl"))
    assert [item.text for row in rows if row.number == 6 for item in row.items] == ["0.5"]
    after = pane.editor().get_main_cursor_position()
    assert (after.line, after.index) == (cursor.line, cursor.index), "the slider takes the click"
    pane.place(6, 5)
    pane.type("x")
    pane.places.clear()
    pane.run_frames(2)
    assert "##turn" in pane.places, "other lines keep theirs"


# ── one order of undo for text, passes and values ─────────────────────────────


@dataclass
class Timeline:
    """What is done in one window, and what it shows after each step."""

    pane: Pane
    shown: list[object] = field(default_factory=list)
    words: int = 0

    def __post_init__(self) -> None:
        self.pane.bench.files.open(self.file, 1, 1, here=True)
        self.pane.run_frames(4)
        self.shown = [self.state]

    @property
    def file(self) -> Path:
        return self.pane.session.path

    @property
    def state(self) -> object:
        """The text in the pane, and the values that are set."""
        shown = self.pane.session.shown
        assert shown is not None
        return self.pane.editor("sketch.toml").get_text(), shown.edits.values

    def rest(self) -> None:
        self.pane.run_frames(WAITS)
        self.pane.run_frames(4, step=0.3)

    def type(self) -> None:
        self.words += 1
        editor = self.pane.editor("sketch.toml")
        editor.set_cursor(text_edit.TextEditor.DocPos(self.words % 2, 0))
        self.pane.type(f"#{self.words}")
        self.pane.key(imgui.Key.enter)

    def edit_passes(self) -> None:
        assert self.pane.bench.passes.duplicate("height")

    def set_value(self) -> None:
        self.words += 1
        self.pane.session.drafts.set("height.level", round(0.5 + 0.001 * self.words, 3))

    def save_outside(self) -> None:
        self.words += 1
        text = self.file.read_text(encoding="utf-8")
        self.file.write_text(f"{text}# {self.words} of another program\n", encoding="utf-8")
        self.pane.session.drafts.reload()
        self.pane.bench.files.take_saved({self.file})

    def do(self, act: Callable[[], None]) -> None:
        act()
        self.rest()
        self.shown.append(self.state)

    def save(self) -> None:
        self.pane.key(imgui.Key.mod_ctrl, imgui.Key.s)
        self.rest()
        assert self.state == self.shown[-1]

    def go(self, by: int) -> object:
        self.pane.key(imgui.Key.mod_ctrl, imgui.Key.z if by < 0 else imgui.Key.y)
        self.rest()
        return self.state

    def there_and_back(self) -> None:
        """Undo everything, step by step, and redo it."""
        for state in reversed(self.shown[:-1]):
            while (now := self.go(-1)) != state and now in self.shown:
                pytest.fail(f"{now} came before {state}")
            while now != state:  # a letter typed after a pause is a step of its own
                before, now = now, self.go(-1)
                assert now != before, f"{state} is lost; seen last: {now}"
        for state in self.shown[1:]:
            now = self.go(1)
            while now != state:
                before, now = now, self.go(1)
                assert now != before, f"{state} is lost; seen last: {now}"


def test_one_undo_for_what_is_typed_and_edited_in_the_graph(pane: Pane) -> None:
    line = Timeline(pane)
    for act in (line.type, line.edit_passes, line.set_value, line.type, line.edit_passes):
        line.do(act)
    line.there_and_back()
    text, values = cast("tuple[str, Any]", line.shown[0])
    pane.key(imgui.Key.escape)  # the keys are the window's
    for _ in range(12):
        line.go(-1)
    assert line.state == (text, values)


@pytest.mark.parametrize("seed", range(6))
def test_undo_goes_back_in_the_order_of_time(pane: Pane, seed: int) -> None:
    """Typing, passes, values, saves here and elsewhere, in any order: each is there again, none is lost."""
    line, chance = Timeline(pane), random.Random(seed)
    for _ in range(9):
        act = chance.choice((line.type, line.edit_passes, line.set_value, line.save, line.save_outside))
        if act == line.save:
            line.save()
        elif act == line.save_outside and unsaved(pane.bench.files.editing):
            continue  # what is typed is one undo away then: see test_problems
        else:
            line.do(act)
    line.there_and_back()


def test_what_is_done_anew_ends_what_could_be_redone(pane: Pane) -> None:
    line = Timeline(pane)
    line.do(line.edit_passes)
    line.go(-1)
    line.do(line.type)
    state = line.state
    assert line.go(1) == state, "the pass is not written into another text"
    line.go(-1)
    line.do(line.set_value)
    state = line.state
    assert line.go(1) == state

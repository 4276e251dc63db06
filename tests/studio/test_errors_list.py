"""The list of what is wrong: what is in it, what a click and a key do, and the editor in the window."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from imgui_bundle import imgui

from playground.engine.engine import Engine
from playground.errors import Diagnostic, PlaygroundError, ShaderError, SketchError
from playground.studio import overlay
from playground.studio.code import open_files as sources
from playground.studio.code import panel as code_window
from playground.studio.code.editors import Editor
from playground.studio.code.open_files import typed_in, unsaved
from playground.studio.code.panel import draw_code
from playground.studio.draw import plate, plate_size
from playground.studio.overlay import draw_notices
from playground.studio.problems import panel as errors_list
from playground.studio.problems.problems import Problems, Warnings, passes_of

from ..loading import load
from ..sketch_texts import map_of_height
from .panel_desk import Bare, errors_of

TERRAIN = """// terrain.glsl -- hills
#include "wave.glsl"
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high
uniform float spare = 0.5; //! slider(0, 1) Nothing
float kernel(ivec2 texel) { return level * wave(vec2(texel)); }
"""
WAVE = "// wave.glsl -- a wave\nfloat wave(vec2 p) {\n    return 0.5 + 0.1 * sin(p.x);\n}\n"
SKETCH = "format = 1\nsize = 17\n" + map_of_height()


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name, text in {"terrain.glsl": TERRAIN, "wave.glsl": WAVE, "sketch.toml": SKETCH}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    for variable in ("PLAYGROUND_EDITOR", "VISUAL", "EDITOR"):
        monkeypatch.delenv(variable, raising=False)
    return tmp_path


def diagnostic(file: str, line: int, message: str, severity: str = "error") -> Diagnostic:
    text = Path(file).read_text(encoding="utf-8").splitlines()[line - 1]
    return Diagnostic(message, file, line, 3, severity, text)


# ── the list itself ──────────────────────────────────────────────────────────


def test_files_with_errors_come_first_in_terminal_wording(folder: Path) -> None:
    wrong = diagnostic("wave.glsl", 3, "this is wrong")
    odd = diagnostic("terrain.glsl", 5, "this is odd", "warning")
    problems, error = Problems(), ShaderError(diagnostics=[wrong])
    problems.take(error, [odd, odd])
    assert problems.all == (wrong, odd)
    assert problems.headline() == "1 error, 1 warning in 2 files"
    assert problems.text() == f"{error}\nwarning: {odd}"
    assert problems.open


def test_warnings_do_not_open_list_and_fixes_close_it(folder: Path) -> None:
    problems = Problems()
    odd = diagnostic("terrain.glsl", 5, "this is odd", "warning")
    problems.take(None, [odd])
    assert not problems.open and problems.warnings == (odd,)
    error = ShaderError(diagnostics=[diagnostic("wave.glsl", 3, "wrong")])
    problems.take(error, [odd])
    assert problems.open
    problems.open = False
    problems.take(error, [odd])
    assert not problems.open, "folded by hand it stays"
    problems.take(ShaderError(diagnostics=error.diagnostics), [odd])
    assert problems.open, "a save that fails again opens it again"
    problems.take(None, [odd])
    assert not problems.open and problems.headline() == "1 warning"


def test_stepping_goes_round(folder: Path) -> None:
    problems = Problems()
    problems.step(1)
    assert problems.at == -1 and not problems.open, "there is nothing to look at"
    problems.take(ShaderError(diagnostics=[diagnostic("wave.glsl", n, "wrong") for n in (1, 2, 3)]))
    seen = []
    for by in (1, 1, 1, 1, -1, -1):
        problems.step(by)
        seen.append(problems.at)
    assert seen == [0, 1, 2, 0, 2, 1]
    other = Problems()
    other.take(ShaderError(diagnostics=[diagnostic("wave.glsl", n, "wrong") for n in (1, 2, 3)]))
    other.step(-1)
    assert other.at == 2


def test_the_lines_around_are_those_of_the_file(folder: Path) -> None:
    problems = Problems()
    wrong = diagnostic("terrain.glsl", 4, "wrong")
    lines = TERRAIN.splitlines()
    assert problems.lines_around(wrong) == [(n, lines[n - 1]) for n in range(2, 7)]
    assert problems.lines_around(diagnostic("terrain.glsl", 1, "wrong")) == [
        (n, lines[n - 1]) for n in (1, 2, 3)
    ]
    (folder / "terrain.glsl").write_text("// nothing of it is left\n", encoding="utf-8")
    assert problems.lines_around(wrong) == [(4, lines[3])], "the line as it was, and no others"
    assert problems.lines_around(Diagnostic("no place")) == []


def test_a_save_that_leaves_size_and_time_as_they_were_is_read(folder: Path) -> None:
    problems, file = Problems(), folder / "terrain.glsl"
    assert problems.lines_around(diagnostic("terrain.glsl", 4, "wrong"))
    stat = file.stat()
    file.write_text(TERRAIN.replace("level", "leval"), encoding="utf-8")
    os.utime(file, ns=(stat.st_atime_ns, stat.st_mtime_ns))
    lines = TERRAIN.replace("level", "leval").splitlines()
    wrong = Diagnostic("wrong", file="terrain.glsl", line=4)
    assert problems.lines_around(wrong) == [(n, lines[n - 1]) for n in range(2, 7)]


def test_headers_that_cannot_be_read_are_listed_with_the_first(folder: Path) -> None:
    sketch = load(folder / "sketch.toml")
    (folder / "terrain.glsl").write_text(
        TERRAIN.replace("slider(0, 1) How", "slyder(0, 1) How"), encoding="utf-8"
    )
    problems, error = Problems(), SketchError("another file is wrong", file="sketch.toml", line=2)
    problems.take(error, (), sketch)
    assert [(d.file, d.line) for d in problems.all] == [("sketch.toml", 2), ("terrain.glsl", 4)]
    with pytest.raises(PlaygroundError) as caught:
        load(folder / "sketch.toml")
    problems.take(caught.value, (), sketch)
    assert [(d.file, d.line) for d in problems.all] == [("terrain.glsl", 4)], "once"


def test_a_warning_moves_with_its_line_and_goes_with_it(folder: Path) -> None:
    odd = diagnostic("terrain.glsl", 5, "odd", "warning")
    problems = Problems()
    (folder / "terrain.glsl").write_text("// one more\n" + TERRAIN, encoding="utf-8")
    problems.take(None, [odd])
    assert problems.warnings == (replace(odd, line=6),)
    (folder / "terrain.glsl").write_text(TERRAIN.replace("spare", "other"), encoding="utf-8")
    problems.take(None, [odd])
    assert problems.warnings == ()


def test_the_sketch_s_own_kernels_are_looked_at_once(folder: Path) -> None:
    reviewed: list[str] = []

    def review(kernel: object) -> tuple[Diagnostic, ...]:
        reviewed.append(Path(kernel.path).name)  # type: ignore[attr-defined]
        return ()

    warnings, sketch = Warnings(review), load(folder / "sketch.toml")
    assert warnings.of(sketch) == []
    for _ in range(3):
        warnings.look()
    (result,) = warnings.of(sketch)
    assert reviewed == ["terrain.glsl"], "once, and the library's view not at all"
    assert (result.line, result.severity) == (5, "warning") and "nothing reads 'spare'" in result.message
    assert warnings.of(sketch.with_values({"height.level": 0.2})) == [result]
    assert not warnings.waiting
    assert passes_of(sketch, diagnostic("wave.glsl", 3, "wrong")) == ["height"]


# ── on the screen ────────────────────────────────────────────────────────────


class Harness(Bare):
    """The panel with the list and the editor."""

    def draw(self) -> None:
        area = (330.0, 0.0, 950.0, 720.0)
        draw_code(self.bench.files, self.bench.problems, self.bench.window.quit, self.theme, area)
        self.bench.problems.take(self.session.error)
        errors_of(self.bench).draw(self.theme, area)
        super().draw()


@pytest.fixture
def harness(any_engine: Engine, folder: Path) -> Iterator[Harness]:
    made = Harness(any_engine, folder / "sketch.toml")
    for name in ("small_button", "text_link", "input_text_multiline"):
        made._watch(imgui, name)
    yield made
    made.close()


def broken(harness: Harness, folder: Path) -> PlaygroundError:
    (folder / "wave.glsl").write_text(WAVE.replace("sin(p.x)", "sine(p.x) * cose(p.y)"), encoding="utf-8")
    harness.session.drafts.reload()
    harness.run_frames(4)
    assert harness.session.error is not None
    return harness.session.error


def test_an_error_is_listed_copied_folded_and_gone_once_fixed(harness: Harness, folder: Path) -> None:
    assert not any("##place" in label for label in harness.places)
    error = broken(harness, folder)
    assert "wave.glsl:3:" in next(label for label in harness.places if label.endswith("##place"))
    assert any(label.startswith("terrain.glsl:2##chain") for label in harness.places)
    harness.click("Copy##errors")
    assert harness.clipboard == str(error)
    harness.click("Fold##errors")
    assert not harness.bench.problems.open
    harness.click(next(label for label in harness.places if label.endswith("##badge")))
    assert harness.bench.problems.open
    (folder / "wave.glsl").write_text(WAVE, encoding="utf-8")
    harness.session.drafts.reload()
    harness.run_frames(2)
    harness.places.clear()
    harness.run_frames(2)
    assert not any("##" in label and ("badge" in label or "place" in label) for label in harness.places)


def test_the_words_can_be_selected(harness: Harness, folder: Path) -> None:
    broken(harness, folder)
    message = harness.session.error.diagnostics[0].message  # type: ignore[union-attr]
    harness.click("##message", 0.01)
    harness.key(imgui.Key.mod_ctrl, imgui.Key.a)
    harness.key(imgui.Key.mod_ctrl, imgui.Key.c)
    assert harness.clipboard in [d.message for d in harness.session.error.diagnostics], message  # type: ignore[union-attr]


def test_f8_steps_through_them(harness: Harness, folder: Path) -> None:
    broken(harness, folder)
    count = len(harness.bench.problems.all)
    assert count > 1
    harness.key(imgui.Key.f8)
    harness.key(imgui.Key.f8)
    assert harness.bench.problems.at == 1
    harness.key(imgui.Key.mod_shift, imgui.Key.f8)
    harness.key(imgui.Key.mod_shift, imgui.Key.f8)
    assert harness.bench.problems.at == count - 1


def test_a_click_on_the_place_starts_the_editor(
    harness: Harness, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[tuple[str, Path, int, int]] = []
    monkeypatch.setattr(sources, "find_editor", lambda: (Editor(("code",)), ""))

    def start(editor: Editor, file: Path, line: int, column: int) -> bool:
        opened.append((editor.name, file, line, column))
        return True

    monkeypatch.setattr(harness.bench.files.opener, "open", start)
    broken(harness, folder)
    first = harness.bench.problems.all[0]
    harness.click(f"{first.location}##place")
    assert opened == [("code", folder / "wave.glsl", 3, first.column)]
    assert not harness.bench.files.editing
    harness.run_frames()
    harness.click(next(label for label in harness.places if "##chain" in label))
    assert opened[-1] == ("code", folder / "terrain.glsl", 2, 0)


def test_without_an_editor_it_opens_here_is_edited_and_saved(
    harness: Harness, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sources, "find_editor", lambda: (None, ""))
    broken(harness, folder)
    first = harness.bench.problems.all[0]
    harness.click(f"{first.location}##place")
    (editing,) = harness.bench.files.editing
    view = code_window._view_of(editing)
    cursor = view.editor.get_main_cursor_position()
    assert (cursor.line, cursor.index) == (2, first.column - 1)
    assert view.editor.has_markers() and not unsaved(harness.bench.files.editing)
    harness.type("// ")
    assert unsaved(harness.bench.files.editing) == ["wave.glsl"]
    expected = view.editor.get_text()
    harness.key(imgui.Key.mod_ctrl, imgui.Key.s)
    assert (folder / "wave.glsl").read_text(encoding="utf-8") == expected != WAVE
    assert not unsaved(harness.bench.files.editing)
    view.editor.undo()
    harness.run_frames(2)
    assert unsaved(harness.bench.files.editing), "what was saved is no longer what is seen"


@pytest.mark.parametrize("answer", ["Take theirs", "Save mine", "Go on typing"])
def test_a_file_that_others_saved_meanwhile_needs_an_answer(
    harness: Harness, folder: Path, answer: str
) -> None:
    wave = folder / "wave.glsl"
    harness.bench.files.open(wave, 4, 1, here=True)
    harness.run_frames(3)
    harness.type("// mine ")
    theirs = "// wave.glsl -- theirs" + WAVE[WAVE.index("\n") :]
    wave.write_text(theirs, encoding="utf-8")
    harness.key(imgui.Key.mod_ctrl, imgui.Key.s)
    assert wave.read_text(encoding="utf-8") == theirs, "not overwritten"
    harness.run_frames(3)
    mine = WAVE.replace("}", "// mine }")
    harness.click(answer)
    editing = harness.bench.files.editing
    assert wave.read_text(encoding="utf-8") == (mine if answer == "Save mine" else theirs)
    assert bool(unsaved(editing)) == (answer == "Go on typing")
    if answer != "Go on typing":
        harness.key(imgui.Key.mod_ctrl, imgui.Key.z)
        assert typed_in(editing[0]) == (theirs if answer == "Save mine" else mine), "nothing is lost"


@pytest.mark.parametrize(
    ("text", "column", "typed", "expected"),
    [
        ("a {\n}\n", 4, "\nb;", "a {\n    b;\n}\n"),
        ("a {\n  b {\n    c;\n  }\n}\n", 4, "\nb;", "a {\n  b;\n  b {\n    c;\n  }\n}\n"),
        ("a {\n\tb;\t// c\n}\n", 4, "\nd;", "a {\n\td;\n\tb;\t// c\n}\n"),
        ("a;\n    b;\t// c\n", 3, "\n{\n", "a;\n{\n    \n    b;\t// c\n"),
        ("a;\n", 3, "\nif (a) {\nb {\nc;\n}\n}\n", "a;\nif (a) {\n    b {\n        c;\n    }\n}\n\n"),
        ("a; // {\n", 9, "\nb;", "a; // {\nb;\n"),
        ("a { // b\n", 9, "\nb;", "a { // b\n    b;\n"),
        ("a {}\n", 4, "\nb;", "a {\n    b;\n}\n"),
        ("a(   b);\n", 3, "\n", "a(\n    b);\n"),
        ("a[2];\n", 1, "}", "}a[2];\n"),
    ],
)
def test_new_lines_are_indented_as_the_file_is(
    harness: Harness, folder: Path, text: str, column: int, typed: str, expected: str
) -> None:
    (folder / "wave.glsl").write_text(text, encoding="utf-8")
    harness.bench.files.open(folder / "wave.glsl", 1, column, here=True)
    harness.run_frames(3)
    editor = code_window._view_of(harness.bench.files.editing[0]).editor
    assert editor.get_text() == text
    for letter in typed:
        if letter == "\n":
            harness.key(imgui.Key.enter)
        else:
            harness.type(letter)
    assert editor.get_text() == expected
    for _ in typed:
        harness.key(imgui.Key.mod_ctrl, imgui.Key.z)
    assert editor.get_text() == text


@pytest.mark.parametrize("right", [False, True])
def test_notices_leave_the_close_button_free(
    harness: Harness, folder: Path, monkeypatch: pytest.MonkeyPatch, right: bool
) -> None:
    plates: list[tuple[imgui.ImVec2, imgui.ImVec2]] = []

    def noted(paint: object, text: str, place: tuple[float, float], **more: Any) -> imgui.ImVec2:
        corner = plate(paint, text, place, **more)  # type: ignore[arg-type]
        plates.append((corner - plate_size(text, more["padding"], more["wrap"]), corner))
        return corner

    monkeypatch.setattr(overlay, "plate", noted)
    harness.bench.files.open(folder / "wave.glsl", here=True)
    for text in ("saved wave.glsl", "a long notice " * 20, "another"):
        harness.bench.notices.say(text)
    area = (330.0, 0.0, 950.0, 720.0)
    draw = harness.draw
    monkeypatch.setattr(
        harness, "draw", lambda: (draw(), draw_notices(harness.bench.notices, harness.theme, area))[0]
    )
    if right:  # where the button's left edge is under the notices' right edge
        monkeypatch.setattr(code_window, "_place", lambda *_: (700.0, 30.0, 560.0, 300.0))
    harness.run_frames(4)
    shown = imgui.internal.find_window_by_name("wave.glsl###wave.glsl")
    edge, top, high = shown.pos.x + shown.size.x, shown.pos.y, imgui.get_frame_height()
    assert len(plates) == 12
    for low, corner in plates[-3:]:
        assert corner.x < edge - high or low.x > edge or corner.y < top or low.y > top + high
        assert low.y >= 14.0 and corner.x <= 1280.0 - 14.0
    for (_, above), (below, _) in itertools.pairwise(plates[-3:]):
        assert below.y > above.y


@pytest.mark.parametrize(
    ("button", "mine", "open_after"), [("Save and close", True, 0), ("Close", False, 0), ("Stay", False, 1)]
)
def test_closing_asks(harness: Harness, folder: Path, button: str, mine: bool, open_after: int) -> None:
    harness.bench.files.open(folder / "wave.glsl", 4, 1, here=True)
    harness.run_frames(3)
    harness.type("// mine ")
    code_window._view_of(harness.bench.files.editing[0]).closing = True
    harness.run_frames(3)
    harness.click(button)
    assert ("mine" in (folder / "wave.glsl").read_text(encoding="utf-8")) == mine
    assert len(harness.bench.files.editing) == open_after


@pytest.mark.parametrize(("button", "quits"), [("Save and quit", True), ("Quit", True), ("Stay", False)])
def test_quitting_asks(harness: Harness, folder: Path, button: str, quits: bool) -> None:
    harness.bench.files.open(folder / "wave.glsl", 4, 1, here=True)
    harness.run_frames(3)
    harness.type("// mine ")
    harness.bench.files.leaving = True
    harness.run_frames(3)
    harness.click(button)
    assert harness.quits == quits
    assert ("mine" in (folder / "wave.glsl").read_text(encoding="utf-8")) == (button == "Save and quit")


def test_a_file_that_is_gone_is_a_sentence(harness: Harness, folder: Path) -> None:
    harness.bench.files.open(folder / "gone.glsl", here=True)
    assert harness.bench.notices.items[-1].text == "there is no file gone.glsl to open"
    assert not harness.bench.files.editing


def test_nothing_wrong_draws_nothing(harness: Harness) -> None:
    harness.run_frames(2)
    assert harness.bench.problems.all == () and errors_list.MAX_ROWS > 0
    assert not any("badge" in label for label in harness.places)

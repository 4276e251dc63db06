"""What is wrong: the list of errors and the editor, numbers that are not finite, the terminal."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from imgui_bundle import imgui

from playground.engine.engine import Engine
from playground.engine.non_finite import NotFinite
from playground.engine.sandbox import SandboxReport
from playground.errors import Diagnostic, PlaygroundError, ShaderError, SketchError
from playground.sketch.templates import make_sketch
from playground.studio.bench import Workbench
from playground.studio.code import open_files as sources
from playground.studio.code.editors import Editor
from playground.studio.code.open_files import typed_in, unsaved
from playground.studio.code.panel import ask_to_close
from playground.studio.interface import WindowControls
from playground.studio.overlay import PATIENCE, checking_text
from playground.studio.problems import panel as errors_list
from playground.studio.problems.non_finite import REST, FiniteWatch, summary
from playground.studio.problems.panel import draw_border, place_in, ref_of
from playground.studio.problems.problems import Problems, TerminalErrors, Warnings, passes_of
from playground.studio.reload.watcher import Follower
from playground.studio.session import Session

from ..loading import load
from ..sketch_texts import map_of, map_of_height, passes
from .panel_desk import Bare, OpenBare, errors_of
from .session_desk import FakeSandbox, OpenSession
from .test_session import SLOPE

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
        area = (330.0, 0.0, 450.0, 720.0)
        self.draw_pane()
        self.bench.problems.take(self.session.error)
        errors_of(self.bench).draw(self.theme, area)
        super().draw()


@pytest.fixture
def harness(any_engine: Engine, folder: Path) -> Iterator[Harness]:
    made = Harness(any_engine, folder / "sketch.toml")
    for name in ("small_button", "text_link", "input_text_multiline"):
        made.watch(imgui, name)
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


def test_the_sign_of_an_error_goes_to_its_line(harness: Harness, folder: Path) -> None:
    broken(harness, folder)
    harness.click("Fold##errors")
    harness.click(next(label for label in harness.places if label.endswith("###jump")))
    current = harness.bench.files.current
    assert current is not None and current.text.path == folder / "wave.glsl" and current.line == 3
    assert not harness.bench.problems.open, "the list stays folded"


def test_a_picture_that_stays_has_a_red_border(harness: Harness, folder: Path) -> None:
    """Counted are the corners of what is drawn behind all windows."""

    def drawn() -> int:
        before = imgui.get_background_draw_list().vtx_buffer.size()
        draw_border(harness.bench.problems, harness.theme, (330.0, 0.0, 600.0, 400.0))
        return imgui.get_background_draw_list().vtx_buffer.size() - before

    counts = []
    harness.run_frames(1, around=lambda draw: (draw(), counts.append(drawn())))
    broken(harness, folder)
    harness.run_frames(1, around=lambda draw: (draw(), counts.append(drawn())))
    assert counts[0] == 0 and counts[1] >= 8


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
    view = editing.view
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


def test_a_later_save_here_keeps_theirs_one_undo_away(harness: Harness, folder: Path) -> None:
    """The newer is shown, and saved: here what is typed."""
    wave = folder / "wave.glsl"
    harness.bench.files.open(wave, 4, 1, here=True)
    harness.run_frames(3)
    harness.type("// mine ")
    theirs = "// wave.glsl -- theirs" + WAVE[WAVE.index("\n") :]
    wave.write_text(theirs, encoding="utf-8")
    harness.key(imgui.Key.mod_ctrl, imgui.Key.s)
    mine = WAVE.replace("}", "// mine }")
    assert wave.read_text(encoding="utf-8") == mine and not unsaved(harness.bench.files.editing)
    harness.key(imgui.Key.mod_ctrl, imgui.Key.z)
    assert typed_in(harness.bench.files.editing[0]) == theirs, "nothing is lost"


def test_what_others_save_is_shown_and_undo_brings_mine_back(harness: Harness, folder: Path) -> None:
    """The newer is shown: here what others saved."""
    wave, files = folder / "wave.glsl", harness.bench.files
    files.open(wave, 4, 1, here=True)
    harness.run_frames(3)
    harness.type("// mine ")
    harness.run_frames(20)
    assert harness.session.drafts.unsaved
    theirs = "// wave.glsl -- theirs" + WAVE[WAVE.index("\n") :]
    wave.write_text(theirs, encoding="utf-8")
    files.take_saved({wave})
    (editing,) = files.editing
    assert editing.view.written() == theirs and not unsaved(files.editing)
    assert not harness.session.drafts.unsaved
    harness.run_frames(2)
    harness.key(imgui.Key.mod_ctrl, imgui.Key.z)
    assert typed_in(editing) == WAVE.replace("}", "// mine }")
    files.take_saved({wave})
    assert typed_in(editing), "its own save, or another file's, takes nothing back"


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
    editor = harness.bench.files.editing[0].view.editor
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


@pytest.mark.parametrize(
    ("button", "mine", "open_after"),
    [
        ("Save and close###save and close", True, 0),
        ("Close without saving###close", False, 0),
        ("Stay###stay", False, 1),
    ],
)
def test_closing_asks(harness: Harness, folder: Path, button: str, mine: bool, open_after: int) -> None:
    harness.bench.files.open(folder / "wave.glsl", 4, 1, here=True)
    harness.run_frames(3)
    harness.type("// mine ")
    ask_to_close(harness.bench.files.editing[0], harness.bench.files)
    harness.run_frames(3)
    harness.click(button)
    assert ("mine" in (folder / "wave.glsl").read_text(encoding="utf-8")) == mine
    assert len(harness.bench.files.editing) == open_after


def test_a_file_that_is_gone_is_a_sentence(harness: Harness, folder: Path) -> None:
    harness.bench.files.open(folder / "gone.glsl", here=True)
    assert harness.bench.notices.items[-1].text == "there is no file gone.glsl to open"
    assert not harness.bench.files.editing


def test_nothing_wrong_draws_nothing(harness: Harness) -> None:
    harness.run_frames(2)
    assert harness.bench.problems.all == () and errors_list.MAX_ROWS > 0
    assert not any("badge" in label for label in harness.places)


# ── non finite ────────────────────────────────────────────────────────────────


FIRST = """// first.glsl -- with a hole
#pragma kernel(output = "first:r32f")
uniform float root = 0.0; //! slider(-1, 1)
float kernel(ivec2 texel) { return texel / 2 == ivec2(6, 15) ? sqrt(root) : 0.5; }
"""
SECOND = """// second.glsl -- one more
#pragma kernel(output = "second:r32f")
uniform sampler2D first; //! input
float kernel(ivec2 texel) { return 1.0 + texelFetch(first, texel, 0).r; }
"""
FINITE_SKETCH = (
    "format = 1\nsize = 33\n"
    + passes(first=("./first", "set = { root = -0.5 }"), second=("./second", 'inputs = { first = "first" }'))
    + map_of("second", channel="red")
)


class Finite:
    """A session, the watch on it, and a clock that the test moves."""

    def __init__(self, engine: Engine, folder: Path) -> None:
        for name, text in (("first.glsl", FIRST), ("second.glsl", SECOND), ("sketch.toml", FINITE_SKETCH)):
            (folder / name).write_text(text, encoding="utf-8")
        self.time = 100.0
        self.session = Session(engine, folder, now=lambda: self.time)
        self.bench = Workbench(
            self.session, WindowControls(lambda: None), folder=folder, now=lambda: self.time
        )
        self.watch = FiniteWatch(lambda: self.time)

    def run_frames(self, seconds: float = 0.0, held: bool = False) -> None:
        self.time += seconds
        self.session.frame((40, 40))
        self.watch.update(self.session, held=held)

    def rest(self) -> list[str]:
        self.run_frames()
        self.run_frames(2 * REST)
        for _ in range(20):
            self.run_frames()
        return [result.path for result in self.watch.non_finite]


@pytest.fixture
def finite(any_engine: Engine, tmp_path: Path) -> Iterator[Finite]:
    made = Finite(any_engine, tmp_path)
    yield made
    made.session.release()


def test_the_first_pass_is_named_and_what_follows_is_counted(finite: Finite) -> None:
    assert finite.rest() == ["first", "second"]
    first = finite.watch.non_finite[0]
    assert (first.output, first.texel, first.value, first.count) == ("first", (12, 30), "NaN", 4)
    expected = "pass 'first' makes NaN at texel (12, 30), 4 texels; first of 2 passes"
    assert summary(finite.watch.non_finite) == expected
    assert finite.watch.patience is None, "nothing more is waited for"


def test_non_finite_scan_waits_for_idle_and_reads_pass_by_pass(finite: Finite) -> None:
    finite.run_frames()
    finite.run_frames(REST / 2)
    assert finite.watch.looks == 0 and finite.watch.patience is not None
    finite.run_frames(REST, held=True)
    assert finite.watch.looks == 0
    for number in range(1, 3):
        finite.run_frames(REST if number == 1 else 0.0)
        assert finite.watch.looks == number
    finite.session.drafts.set("first.root", 0.25)
    finite.run_frames()
    assert finite.watch.looks == 2, "another picture: what was under way is of no use"


def test_it_goes_once_fixed(finite: Finite) -> None:
    assert finite.rest()
    finite.session.drafts.set("first.root", 0.25)
    assert finite.rest() == []
    finite.session.drafts.set("first.root", -0.25)
    assert finite.rest() == ["first", "second"]


def test_texture_map_shows_non_finite_texels_in_magenta(finite: Finite) -> None:
    assert finite.rest()
    first = finite.watch.non_finite[0]
    finite.bench.session.show(ref_of(first))
    assert finite.rest() == ["first", "second"], "what the map does not need is as it was"
    frame = finite.session.read()
    magenta = (frame.array[..., :3] == (255, 0, 255)).all(axis=2)
    assert 0 < magenta.sum() <= 16
    x, y = place_in(first, (0.0, 0.0, 40.0, 40.0))
    assert magenta[int(y), int(x)]
    finite.session.drafts.set("first.root", 0.25)
    assert finite.rest() == []


def test_a_texture_that_was_read_since_changes_nothing(finite: Finite) -> None:
    finite.run_frames()
    finite.session.read_values("first:first")
    ran = list(finite.session.engine.record.ran)
    runs = dict(finite.session.engine.runs)
    assert finite.rest() == ["first", "second"]
    assert dict(finite.session.engine.runs) == runs and finite.session.engine.record.ran == ran, (
        "nothing ran again"
    )


def test_time_that_runs_is_looked_at_now_and_then(finite: Finite, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Session, "animated", True)
    finite.session.clock.playing = True
    finite.run_frames(held=True)
    assert finite.watch.looks == 0
    finite.run_frames()
    seen = finite.watch.looks
    assert finite.watch.non_finite and seen > 0
    for _ in range(10):
        finite.session.redraw()
        finite.run_frames(0.05)
    assert finite.watch.looks == seen
    finite.run_frames(3.0)
    assert finite.watch.looks > seen


def test_a_map_is_placed_as_its_kernel_places_it() -> None:
    wide = NotFinite("p", "o", (0, 0), "NaN", 1, (200, 100))
    assert place_in(wide, (10.0, 20.0, 100.0, 100.0)) == (10.25, 20 + 100 - 25.25)
    named = replace(wide, path="a.b", output="c", value="infinity")
    assert summary((named,)) == "pass 'a.b', output 'c', makes infinity at texel (0, 0), 1 texel"


def test_the_words_lead_to_the_texture_and_back(
    any_engine: Engine, open_bare: OpenBare, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from playground.studio.problems import panel as finite

    Finite(any_engine, tmp_path).session.release()
    bare = open_bare(tmp_path / "sketch.toml")
    bare.watch(finite.imgui, "small_button")
    watch = FiniteWatch(lambda: bare.time)
    draw = bare.draw

    def both() -> None:
        draw()
        watch.update(bare.session, held=False)
        finite.draw_not_finite(
            watch, bare.session, bare.bench.tracing, bare.theme, (400.0, 0.0, 880.0, 720.0)
        )

    monkeypatch.setattr(bare, "draw", both)
    bare.run_frames(120)
    bare.click("Show it")
    assert bare.session.view.map is not None and bare.session.view.map.ref == "first:first"
    bare.click("Back to the picture")
    assert bare.session.view.map is None


def test_nothing_is_done_before_there_is_a_picture() -> None:
    nothing = SimpleNamespace(shown=None, plan=None)
    watch = FiniteWatch(lambda: 0.0)
    watch.update(nothing, held=False)  # type: ignore[arg-type]
    assert watch.patience is None and watch.looks == 0


LIT = """// lit.glsl -- light with a hole
#pragma kernel(output = "frame:rgba16f")
uniform float root = 0.0; //! slider(-1, 1)
uniform sampler2D height; //! input
vec4 kernel(ivec2 texel) {
    float found = texelFetch(height, ivec2(0), 0).r;
    return texel == ivec2(7, 5) ? vec4(sqrt(root)) : vec4(found, 0.25, 0.0, 1.0);
}
"""
SHOWN = """// shown.glsl -- what a screen takes
#pragma kernel(output = "frame:rgba8")
uniform sampler2D picture; //! input
vec4 kernel(ivec2 texel) { return clamp(texelFetch(picture, texel, 0), 0.0, 1.0); }
"""
VIEW = (
    passes(lit="./lit", shown=("./shown", 'inputs = { picture = "lit" }'))
    + """[inputs]
height = "lit.height"
[parameters]
root = "lit.root"
"""
)
IN_VIEW = """format = 1
size = 33
[[pass]]
name = "height"
use = "generation/diamond_square"
[view]
use = "./look"
inputs = { height = "height" }
set = { root = -1.0 }
"""


@pytest.mark.parametrize(
    ("wired", "by_hand"),
    [
        ("", False),
        ('inputs = { height = "height" }\n', True),
        ('inputs = { "lit.height" = "height" }\n', False),
    ],
)
def test_a_hole_that_the_view_makes_is_shown_too(
    any_engine: Engine, tmp_path: Path, wired: str, by_hand: bool
) -> None:
    """Whichever way the view's inputs are wired, and whether its values come from the file or the hand."""
    sketch = IN_VIEW.replace('inputs = { height = "height" }\n', wired)
    if by_hand:
        sketch = sketch.replace("set = { root = -1.0 }\n", "")
    for name, text in (("lit.glsl", LIT), ("shown.glsl", SHOWN), ("look.toml", VIEW)):
        (tmp_path / name).write_text(text, encoding="utf-8")
    finite = Finite(any_engine, tmp_path)
    (tmp_path / "sketch.toml").write_text(sketch, encoding="utf-8")
    finite.session.drafts.reload()
    finite.run_frames()
    if by_hand:
        finite.session.drafts.set("view.root", -1.0)
    finite.rest()
    (result,) = finite.watch.non_finite
    assert (result.path, result.texel, result.size, result.value) == ("view.lit", (7, 5), (40, 40), "NaN")
    ref = ref_of(result)
    assert ref == "view.lit:frame" and finite.session.can_show(ref)
    finite.bench.session.show(ref)
    finite.run_frames()
    assert finite.session.view.map is not None and finite.session.error is None and not finite.session.notes
    frame = finite.session.read()
    magenta = np.argwhere((frame.array[::-1, :, :3] == (255, 0, 255)).all(axis=2))
    assert magenta.tolist() == [[5, 7]], "the texel itself, in a picture of its size"
    finite.rest()
    assert finite.watch.non_finite == (result,), "it has its own name, under any name in the map"
    finite.bench.session.show(None)
    finite.run_frames()
    finite.rest()
    assert finite.watch.non_finite == (result,)
    finite.session.release()


def test_what_the_view_lacks_cannot_be_shown(any_engine: Engine, tmp_path: Path) -> None:
    finite = Finite(any_engine, tmp_path)
    finite.run_frames()
    session = finite.session
    assert session.can_show("view:frame") and session.can_show("first:first")
    for wrong in ("view:light", "view.lit:frame", "other:frame", "first.view:first", "view"):
        assert not session.can_show(wrong)
    session.release()


# ── terminal errors ───────────────────────────────────────────────────────────


ONE, OTHER = Diagnostic("no name 'p'", "terrain.glsl", 3), Diagnostic("a ; is missing", "wave.glsl", 7)


def test_each_error_is_reported_once_and_again_after_fix() -> None:
    printed: list[str] = []
    terminal = TerminalErrors(printed.append)
    for listed in ([ONE], [ONE], [ONE, OTHER], [OTHER], [], [ONE], [ONE]):
        terminal.take(listed)
    assert printed == [str(ONE), str(OTHER), str(ONE)]


def test_a_terminal_that_is_gone_stops_nothing() -> None:
    def gone(_: str) -> None:
        raise BrokenPipeError

    TerminalErrors(gone).take([ONE])


# ── sandbox status ────────────────────────────────────────────────────────────


class FakeWatcher:
    """A watcher that reports what a test sets."""

    def __init__(self) -> None:
        self.changed: set[Path] = set()

    def take(self) -> set[Path]:
        changed, self.changed = self.changed, set()
        return changed

    def follow(self, *_: object, **__: object) -> None:
        pass


@pytest.fixture
def slope(tmp_path: Path) -> Path:
    (tmp_path / "inc").mkdir()
    for name, text in SLOPE.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def test_what_is_tried_is_named_and_timed(slope: Path, open_session: OpenSession) -> None:
    clock, sandbox, watcher = [0.0], FakeSandbox(), FakeWatcher()
    session = open_session(slope, sandbox=sandbox, now=lambda: clock[0])
    follower = Follower(session, watcher)  # type: ignore[arg-type]
    clock[0] = 0.5
    assert session.drafts.checking == ("sketch.toml", 0.5)
    sandbox.answer = SandboxReport(True)
    session.frame((32, 32))
    assert session.drafts.checking is None

    (slope / "terrain.glsl").write_text(SLOPE["terrain.glsl"].replace("0.25", "0.5"), encoding="utf-8")
    watcher.changed = {slope / "terrain.glsl"}
    assert follower.take()
    clock[0] += 2.0
    assert session.drafts.checking == ("terrain.glsl", 2.0)
    (slope / "inc/tilt.glsl").write_text(SLOPE["inc/tilt.glsl"].replace("x)", "y)"), encoding="utf-8")
    watcher.changed = {
        slope / "terrain.glsl",
        slope / "inc/tilt.glsl",
        slope / "sketch.toml",
    }
    assert follower.take()
    subject = "sketch.toml, terrain.glsl and 1 more"
    assert session.drafts.checking == (subject, 0.0), "a newer save begins anew"


def test_the_words() -> None:
    assert checking_text("terrain.glsl", PATIENCE) == "checking terrain.glsl …"
    assert checking_text("terrain.glsl", 3.9) == "checking terrain.glsl … 3 s"


# ── shadowed default ──────────────────────────────────────────────────────────


SIZE = (32, 18)


@pytest.fixture
def shadowed_folder(tmp_path: Path) -> Path:
    made = make_sketch(tmp_path / "hills")
    change(made / "sketch.toml", "size   = 513", "size = 33")
    return made


def change(path: Path, before: str, after: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert before in text
    path.write_text(text.replace(before, after), encoding="utf-8")


def saved(session: Session) -> tuple[np.ndarray, list[str]]:
    session.notes.clear()
    session.drafts.reload()
    session.frame(SIZE)
    frame = session.read()
    assert frame is not None and session.error is None
    return frame.array, list(session.notes)


@pytest.mark.parametrize(
    "edit",
    [
        ("frequency = 5.0", "frequency = 9.0"),
        ("roughness = 0.42", "roughness = 0.6"),
        ("ridges    = 0.6", "ridges = 0.1"),
    ],
)
def test_the_first_edit_that_the_readme_proposes_shows(
    open_session: OpenSession, shadowed_folder: Path, edit
):
    """Step 1: in hills/my_land.glsl, change a number and save; the terrain in the window changes."""
    session = open_session(shadowed_folder)
    before, _ = saved(session)
    change(shadowed_folder / "my_land.glsl", *edit)
    after, notes = saved(session)
    assert notes == [] and np.abs(after.astype(int) - before).mean() > 1


@pytest.mark.slow
def test_a_set_of_the_sketch_is_named_with_its_line(open_session: OpenSession, shadowed_folder: Path):
    change(
        shadowed_folder / "sketch.toml", 'use  = "./my_land"', 'use  = "./my_land"\nset  = { frequency = 5 }'
    )
    session = open_session(shadowed_folder)
    before, _ = saved(session)
    change(shadowed_folder / "my_land.glsl", "frequency = 5.0", "frequency = 9.0")
    after, notes = saved(session)
    np.testing.assert_array_equal(after, before)
    assert notes == [f"height.frequency: the default is 9; {shadowed_folder}/sketch.toml:15 sets 5"]
    assert saved(session)[1] == []


@pytest.mark.slow
def test_what_the_panel_sets_is_named_too(open_session: OpenSession, shadowed_folder: Path):
    session = open_session(shadowed_folder)
    saved(session)
    session.drafts.set("height.frequency", 3.0)
    change(shadowed_folder / "my_land.glsl", "frequency = 5.0", "frequency = 9.0")
    assert saved(session)[1] == ["height.frequency: the default is 9; the panel sets 3"]

"""What the user has set outlives a reload and a check, and is saved and undone."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from playground import memo
from playground.data import elevation
from playground.data.image_files import write_png
from playground.engine.engine import Engine
from playground.engine.sandbox import SandboxReport
from playground.errors import SandboxCrash
from playground.paths import SKETCHES
from playground.sketch.assign import values_of
from playground.sketch.model import Camera
from playground.studio.actions import rounded
from playground.studio.bench import Workbench
from playground.studio.compare.compare import Compare
from playground.studio.edits.edits import Draft, Edits, reload_draft
from playground.studio.graph.graph import Thumbnails
from playground.studio.inspect.inspector import Inspector
from playground.studio.interface import WindowControls
from playground.studio.reload.stages import ReloadStage
from playground.studio.session import Session

from ..loading import load
from ..sketch_texts import map_of, map_of_height, passes
from .session_desk import ADD as DESK_ADD
from .session_desk import BAD, ELEVATION, GOOD, LEVEL, FakeSandbox, Harness, OpenSession
from .session_desk import KERNEL as DESK_KERNEL

KERNEL = """// terrain.glsl -- level terrain
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1)
uniform float other = 0.5; //! slider(0, 1)
float kernel(ivec2 texel) { return level + other; }
"""
SKETCH = "format = 1\nsize = 33\n" + passes(height=("./terrain", "set = { other = 0.25 }")) + map_of("height")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "terrain.glsl").write_text(KERNEL, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    return tmp_path


def edited(folder: Path, **values: float) -> Draft:
    sketch = load(folder)
    return Draft(sketch, sketch, Edits(tuple((f"height.{k}", v) for k, v in values.items())))


def change(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")


LINE = "uniform float level = 0.5; //! slider(0, 1)"
WHOLE = "uniform int level = 1; //! slider(0, 3)"
MENU = "uniform int level = 0; //! menu({})"
AS_FLOAT = ("level + other", "float(level) + other")
# What the user set; then, reload after reload: what is replaced in the files, the values, and the messages.
RELOADS: dict[str, tuple[dict[str, float], list[tuple[list[tuple[str, str]], dict[str, float], str]]]] = {
    "something else": ({"level": 0.9}, [([("level + other", "level - other")], {"level": 0.9}, "")]),
    "a default of its own": ({"level": 0.75}, [([("level = 0.5;", "level = 0.125;")], {"level": 0.75}, "")]),
    "new defaults": (
        {"other": 0.75},
        [([("level = 0.5;", "level = 0.125;"), ("other = 0.5;", "other = 0.625;")],
          {"level": 0.125, "other": 0.75}, "")],
    ),
    "a new value of the file": (
        {"level": 0.9, "other": 0.8},
        [([("other = 0.25", "other = 0.3")], {"level": 0.9, "other": 0.3},
          "height.other: the file's new value, 0.3, is taken")],
    ),
    "the very value": ({"other": 0.75}, [([("other = 0.25", "other = 0.75")], {"other": 0.75}, "")]),
    "another type": (
        {"level": 1.0},
        [([(LINE, WHOLE), AS_FLOAT], {"level": 1},
          "height.level was float and is int now: back to the file's value"),
         ([(WHOLE, LINE), AS_FLOAT[::-1]], {"level": 0.5}, "")],
    ),
    "a smaller range": (
        {"level": 0.9},
        [([(LINE, LINE.replace("(0, 1)", "(0, 0.6)"))], {"level": 0.6},
          "height.level = 0.9 is outside its new range 0 to 0.6: 0.6 is taken")],
    ),
    "another name of its pass, and back": (
        {"level": 0.9},
        [([('"height"', '"ground"')], {},
          "height.level is gone; what was set here waits in case it returns"),
         ([('"ground"', '"height"')], {"level": 0.9}, "")],
    ),
    "no such parameter, another, and back": (
        {"level": 1.0},
        [([(LINE, "const float level = 0.5;")], {},
          "height.level is gone; what was set here waits in case it returns"),
         ([("const float level = 0.5;", WHOLE), AS_FLOAT], {"level": 1}, ""),
         ([(WHOLE, LINE), AS_FLOAT[::-1]], {"level": 1.0}, "")],
    ),
}  # fmt: skip


@pytest.mark.always
@pytest.mark.parametrize("name", RELOADS)
def test_what_was_set_outlives_a_reload_of_other_things(folder: Path, name: str) -> None:
    values, reloads = RELOADS[name]
    draft = edited(folder, **values)
    for replaced, expected, message in reloads:
        for old, new in replaced:
            texts = {path: path.read_text(encoding="utf-8") for path in folder.iterdir()}
            assert any(old in text for text in texts.values())
            for path, text in texts.items():
                path.write_text(text.replace(old, new), encoding="utf-8")
        draft, notes = reload_draft(draft, load(folder))
        known = {path: value for path, value in values_of(draft.sketch).items() if path.startswith("height.")}
        assert known == known | {f"height.{key}": value for key, value in expected.items()}
        assert notes == ([message] if message else [])
    if name == "the very value":
        assert draft.edits == Edits()


def test_a_value_returns_with_its_technique(folder: Path) -> None:
    old = edited(folder, level=0.9)
    away = old.choose("height", "generation/diamond_square")
    assert "height.level" not in values_of(away.sketch) and away.applied == {}
    same, notes = reload_draft(away, load(folder))
    assert notes == []
    back = same.choose("height", "./terrain")
    assert values_of(back.sketch)["height.level"] == 0.9
    assert values_of(back.sketch)["height.other"] == 0.25, "and so does what the file sets there"


def test_a_value_that_another_technique_does_not_take_waits(folder: Path) -> None:
    low = KERNEL.replace("terrain", "low").replace("slider(0, 1)", "slider(0, 0.6)")
    (folder / "low.glsl").write_text(low, encoding="utf-8")
    whole = KERNEL.replace("terrain", "whole").replace("uniform float level = 0.5", "uniform int level = 1")
    whole = whole.replace("return level", "return float(level)")
    (folder / "whole.glsl").write_text(whole, encoding="utf-8")
    for value, use, there in ((0.9, "./low", 0.5), (1.0, "./whole", 1)):
        away = edited(folder, level=value).choose("height", use)
        assert values_of(away.sketch)["height.level"] == there
        same, notes = reload_draft(away, load(folder))
        assert notes == [] and values_of(same.choose("height", "./terrain").sketch)["height.level"] == value


def test_a_choice_keeps_its_name_when_its_menu_is_written_anew(folder: Path) -> None:
    change(folder / "terrain.glsl", LINE, MENU.format('"low", "high"'))
    change(folder / "terrain.glsl", *AS_FLOAT)
    draft = edited(folder, level=1)
    lost = "height.level: its menu has no 'high' any more: back to the file's value"
    for old, menu, value, expected in (
        ('"low", "high"', '"none", "low", "high"', 2, []),
        ('"none", "low", "high"', '"none", "low"', 0, [lost]),
    ):
        change(folder / "terrain.glsl", old, menu)
        draft, notes = reload_draft(draft, load(folder))
        assert values_of(draft.sketch)["height.level"] == value and notes == expected


def test_what_is_locked_stays_over_any_change_of_the_files(folder: Path) -> None:
    sketch = load(folder)
    edits = Edits((("height.other", 0.75),), locked=("height.other", "height.level"))
    old = Draft(sketch, sketch, edits)
    change(folder / "terrain.glsl", "level = 0.5;", "level = 0.125;")
    change(folder / "sketch.toml", "other = 0.25", "other = 0.3")
    draft, notes = reload_draft(old, load(folder))
    values = values_of(draft.sketch)
    assert (values["height.level"], values["height.other"]) == (0.5, 0.75) and notes == []


def test_an_edit_is_taken_back_by_any_name_of_its_parameter(folder: Path) -> None:
    (folder / "both.toml").write_text(
        '[[pass]]\nname = "inner"\nuse = "./terrain"\n[parameters]\nhigh = "inner.level"\n',
        encoding="utf-8",
    )
    change(folder / "sketch.toml", "./terrain", "./both")
    change(folder / "sketch.toml", "set = { other = 0.25 }", "")
    sketch = load(folder)
    draft = Draft(sketch, sketch, Edits((("height.inner.level", 0.75), ("height.inner.other", 0.125))))
    assert values_of(draft.without("height.high").sketch)["height.inner.level"] == 0.5
    assert values_of(draft.without("height.high").sketch)["height.inner.other"] == 0.125


def test_the_camera_stays_until_the_file_moves_it(folder: Path) -> None:
    sketch = load(folder)
    old = Draft(sketch, sketch, Edits(camera=Camera(azimuth=10.0)))
    same, _ = reload_draft(old, replace(sketch, title="another"))
    assert same.sketch.camera.azimuth == 10.0
    moved, notes = reload_draft(old, sketch.with_camera(Camera(azimuth=77.0)))
    assert moved.sketch.camera.azimuth == 77.0 and "camera" in notes[0]


def test_a_technique_chosen_by_hand_stays_until_the_file_chooses(folder: Path) -> None:
    (folder / "other.glsl").write_text(KERNEL.replace("terrain", "other"), encoding="utf-8")
    sketch = load(folder)
    chosen = Draft(sketch, sketch).choose("height", "generation/diamond_square")
    stays, _ = reload_draft(chosen, replace(sketch, title="another"))
    assert stays.sketch.graph.find("height").use == "generation/diamond_square"
    change(folder / "sketch.toml", "./terrain", "./other")
    value, notes = reload_draft(chosen, load(folder))
    assert value.sketch.graph.find("height").use == "./other" and "gave way" in notes[0]


def test_choosing_what_the_file_says_is_no_edit(folder: Path) -> None:
    sketch = load(folder)
    draft = Draft(sketch, sketch).choose("height", "generation/diamond_square")
    assert draft.edits.techniques == (("height", "generation/diamond_square"),)
    assert draft.choose("height", "./terrain").edits.techniques == ()
    assert draft.with_all(Edits()).base is sketch


# ── edits during checks ───────────────────────────────────────────────────────


# ── another sketch is being opened ───────────────────────────────────────────


def test_staying_restores_map_stopped_repeats_and_clock(harness: Harness) -> None:
    harness.session.stop_at("height", 2)
    harness.session.show("height:height")
    harness.session.clock.time, harness.session.clock.playing = 3.0, False
    harness.frame()
    harness.bench.actions.open(harness.folder / "two")
    harness.answer(BAD)
    harness.bench.actions.open(harness.folder / "one")
    harness.answer(GOOD)
    view, clock = harness.session.view, harness.session.clock
    assert harness.name == "one" and view.steps == {"height": 2}
    assert view.map is not None and view.map.ref == "height:height"
    assert (clock.time, clock.playing) == (3.0, False)


def test_undrawable_sketch_keeps_view_of_shown_one(any_engine: Engine, harness: Harness) -> None:
    harness.session.stop_at("height", 2)
    harness.frame()
    harness.write("two/hills.glsl", DESK_KERNEL.replace("level *", "levle *"))
    harness.bench.actions.open(harness.folder / "two")
    harness.answer(GOOD)  # the sandbox has no objection, the driver of this process has one
    assert harness.session.error is not None and harness.name == "one"
    assert harness.session.view.steps == {"height": 2}


def test_a_path_without_a_sketch_changes_nothing(harness: Harness) -> None:
    harness.session.stop_at("height", 2)
    harness.session.clock.time = 3.0
    harness.drafts.set(LEVEL, 0.5)
    harness.frame()
    harness.bench.actions.open(harness.folder / "none.toml")
    harness.frame()
    assert (
        "there is no file" in harness.messages and harness.session.path == harness.folder / "one/sketch.toml"
    )
    assert harness.session.view.steps == {"height": 2} and harness.session.clock.time == 3.0
    harness.bench.undo.undo()
    harness.frame()
    assert harness.level == 0.25


def test_edits_needing_check_are_refused_until_sketch_opens(harness: Harness) -> None:
    harness.drafts.choose("height", "./dunes")
    harness.answer(GOOD)
    harness.bench.actions.open(harness.folder / "two")
    harness.drafts.choose("height", "generation/white_noise")
    assert "height: generation/white_noise is not taken" in harness.messages and "two" in harness.messages
    harness.drafts.set(ELEVATION, harness.file("b.npy"))
    assert "data.elevation: b.npy is not taken" in harness.messages
    harness.bench.undo.undo()
    assert "height: what the file says is not taken" in harness.messages and harness.technique == "./dunes"
    assert harness.bench.undo.history.done == 1
    harness.answer(GOOD)
    assert (harness.name, harness.technique, harness.elevation) == ("two", "./hills", "a.npy")
    assert harness.session.error is None


def test_no_keyframe_is_written_while_another_sketch_is_opened(harness: Harness) -> None:
    harness.drafts.set(LEVEL, 0.5)
    harness.frame()
    before = (harness.folder / "one/sketch.toml").read_bytes()
    harness.bench.actions.open(harness.folder / "two")
    assert not harness.bench.keyframes.add_here([LEVEL], camera=False)
    assert "two" in harness.messages and (harness.folder / "one/sketch.toml").read_bytes() == before
    assert harness.level == 0.5
    harness.answer(GOOD)
    assert (harness.name, harness.level) == ("two", 0.25)


def test_save_is_refused_while_other_sketch_fails_and_edits_stay(harness: Harness) -> None:
    before = (harness.folder / "one/sketch.toml").read_bytes()
    harness.write("two/sketch.toml", "format = 1\n[view")
    harness.bench.actions.open(harness.folder / "two")
    for level in (0.5, 0.75):
        harness.drafts.set(LEVEL, level)
        harness.frame()
        harness.bench.actions.save_values()
        harness.frame()
    assert "sketch.toml is not saved while" in harness.messages and "save a copy" in harness.messages
    assert (harness.folder / "one/sketch.toml").read_bytes() == before
    harness.bench.actions.open(harness.folder / "one")
    harness.answer(GOOD)
    assert (harness.name, harness.level) == ("one", 0.75)
    harness.bench.actions.save_values()
    assert b"level = 0.75" in (harness.folder / "one/sketch.toml").read_bytes()


def test_a_copy_of_what_is_shown_is_opened_instead(harness: Harness) -> None:
    harness.drafts.set(LEVEL, 0.5)
    harness.session.stop_at("height", 2)
    harness.frame()
    harness.bench.actions.open(harness.folder / "two")
    harness.bench.actions.save_a_copy()
    harness.answer(GOOD)
    harness.answer(GOOD)
    assert harness.session.path == Path(harness.session.shown.file.file)
    assert harness.session.path.parent.name.startswith("one") and harness.level == 0.5
    assert harness.session.view.steps == {"height": 2}
    harness.bench.undo.undo()
    harness.frame()
    assert harness.level == 0.25


# ── a save, a technique and a data file meet ─────────────────────────────────


def checks_change(harness: Harness, what: str) -> None:
    if what == "save":
        harness.save("size = 9", "size = 17")
    elif what == "technique":
        harness.drafts.choose("height", "./dunes")
    else:
        harness.drafts.set(ELEVATION, harness.file("b.npy"))


PAIRS = [
    (name, two)
    for name in ("save", "technique", "data")
    for two in ("save", "technique", "data")
    if name != two
]


@pytest.mark.parametrize(("first", "second"), PAIRS)
def test_what_fails_is_named_and_the_rest_is_taken(harness: Harness, first: str, second: str) -> None:
    checks_change(harness, first)
    checks_change(harness, second)
    chosen = second if second != "save" else first  # a choice gives way, what is saved is on the disk
    harness.answer(BAD)
    assert f"{'b.npy' if chosen == 'data' else './dunes'} is not taken: " in harness.messages
    assert "the driver crashed" in harness.messages
    assert harness.drafts.testing, "the rest is tried by itself"
    harness.answer(GOOD)
    assert harness.session.error is None
    rest = first if chosen == second else second
    assert harness.size == (17 if rest == "save" else 9)
    assert harness.technique == ("./dunes" if rest == "technique" else "./hills")
    assert harness.elevation == ("b.npy" if rest == "data" else "a.npy")


def test_failed_save_stays_error_when_technique_is_switched(harness: Harness) -> None:
    harness.save("size = 9", "size = 17")
    harness.answer(BAD)
    error = harness.session.error
    assert error is not None
    harness.drafts.choose("height", "./dunes")
    harness.answer(GOOD)
    assert (harness.technique, harness.size) == ("./dunes", 9) and harness.session.error is error
    harness.drafts.reload()
    harness.answer(GOOD)
    assert (harness.technique, harness.size) == ("./dunes", 17) and harness.session.error is None


@pytest.mark.parametrize("how", ["fails", "is taken back"])
def test_an_undo_that_does_not_come_is_no_longer_done(harness: Harness, how: str) -> None:
    harness.drafts.choose("height", "./dunes")
    harness.answer(GOOD)
    harness.save("size = 9", "size = 17")
    harness.answer(GOOD)
    undo = harness.bench.undo
    undo.undo()
    assert undo.history.done == 0 and harness.drafts.testing
    if how == "is taken back":
        harness.drafts.choose("height", "./dunes")
    harness.answer(BAD)
    harness.frame()
    assert undo.history.done == 1 and harness.technique == "./dunes"
    undo.undo()
    harness.answer(GOOD)
    harness.frame()
    assert undo.history.done == 0 and harness.technique == "./hills"


def test_undo_and_redo_during_a_check(harness: Harness) -> None:
    harness.drafts.choose("height", "./dunes")
    harness.answer(GOOD)
    harness.save("size = 9", "size = 17")
    harness.answer(GOOD)
    undo = harness.bench.undo
    undo.undo()
    assert harness.drafts.testing
    undo.redo()
    harness.answer(GOOD)
    harness.frame()
    assert harness.technique == "./dunes" and not harness.drafts.testing
    undo.undo()
    harness.save("size = 17", "size = 33")
    harness.drafts.set(LEVEL, 0.5)
    harness.answer(GOOD)
    assert (harness.technique, harness.size, harness.level) == ("./hills", 33, 0.5)


def test_a_file_that_is_shown_already_is_not_what_fails(harness: Harness) -> None:
    harness.drafts.choose("height", "./dunes")
    harness.drafts.set(ELEVATION, harness.file("a.npy"))
    harness.frame()
    assert harness.drafts.testing
    harness.answer(BAD)
    assert "a.npy" not in harness.messages and harness.session.error is not None
    assert harness.technique == "./hills" and not harness.drafts.testing


@pytest.mark.parametrize(("answer", "level"), [(GOOD, 0.75), (BAD, 0.25)])
def test_an_undo_affects_what_is_shown_while_a_save_is_checked(
    harness: Harness, answer: SandboxReport, level: float
) -> None:
    harness.save('use = "./hills"\n', 'use = "./hills"\nset = { level = 0.25 }\n')
    harness.frame()
    harness.drafts.set(LEVEL, 0.5)
    harness.frame()
    harness.save("level = 0.25", "level = 0.75")
    harness.bench.undo.undo()
    harness.frame()
    assert harness.drafts.testing and harness.level == 0.25
    harness.answer(answer)
    assert harness.level == level and harness.bench.undo.history.done == 0


def test_a_choice_waits_for_a_file_that_cannot_be_read(harness: Harness) -> None:
    harness.drafts.choose("height", "./dunes")
    harness.save("[view]", "[view")
    assert harness.session.error is not None
    harness.frame()
    harness.save("[view", "[view]")
    harness.answer(GOOD)
    assert harness.session.error is None and harness.technique == "./dunes"


def test_texts_and_a_technique_that_come_together_are_both_shown(harness: Harness) -> None:
    """As a lesson's figure of the sketch that is open does it."""
    text = DESK_ADD.replace("uniform", "uniform float share = 0.5; //! slider(0, 1)\nuniform", 1)
    harness.drafts.read_as({str(harness.folder / "one/add.glsl"): text})
    harness.drafts.restore(Edits(techniques=(("height", "./dunes"),)))
    harness.answer(GOOD)
    assert harness.technique == "./dunes" and harness.session.sketch is not None
    assert values_of(harness.session.sketch)["sum.share"] == 0.5


def save_after_keeping_a(harness: Harness) -> Compare:
    """Keep a state as A, edit it, and save the sketch; return the comparison."""
    compare = harness.bench.inspection.compare
    harness.drafts.set(LEVEL, 0.5)
    harness.frame()
    compare.keep()
    harness.drafts.set(LEVEL, 0.75)
    harness.frame()
    harness.save("size = 9", "size = 17")
    return compare


def test_going_back_to_a_is_an_undo_step_after_a_save_too(harness: Harness) -> None:
    compare = save_after_keeping_a(harness)
    harness.answer(GOOD)
    steps = len(harness.bench.undo.history.steps)
    compare.back()
    harness.frame()
    assert harness.level == 0.5 and len(harness.bench.undo.history.steps) == steps + 1
    harness.bench.undo.undo()
    harness.frame()
    assert harness.level == 0.75


def test_going_back_to_a_during_a_check_stays(harness: Harness) -> None:
    compare = save_after_keeping_a(harness)
    compare.back()
    harness.answer(GOOD)
    assert (harness.level, harness.size) == (0.5, 17)


def test_a_keyframe_that_cannot_be_written_is_still_to_be_undone(harness: Harness) -> None:
    harness.drafts.set(LEVEL, 0.5)
    harness.frame()
    assert harness.bench.keyframes.add_here([LEVEL], camera=False)
    harness.answer(GOOD)
    assert harness.bench.keyframes.keyframes and harness.bench.undo.history.done == 2
    file = harness.folder / "one/sketch.toml"
    before = file.read_text(encoding="utf-8")
    clash = before.replace("[[keyframe]]", "[[keyframe]]  # mine")
    harness.write("one/sketch.toml", clash)
    harness.bench.undo.undo()
    harness.frame()
    assert "changed meanwhile" in harness.messages and "[[keyframe]]" in file.read_text(encoding="utf-8")
    assert harness.bench.undo.history.done == 2, "it is not undone"
    harness.write("one/sketch.toml", before.replace("size = 9", "size = 17"))
    harness.bench.undo.undo()
    harness.answer(GOOD)
    assert harness.bench.keyframes.keyframes == () and harness.level == 0.5 and harness.size == 17
    assert harness.bench.undo.history.done == 1


def test_a_keyframe_keeps_a_technique_that_is_checked(harness: Harness) -> None:
    harness.drafts.set(LEVEL, 0.5)
    harness.frame()
    harness.drafts.choose("height", "./dunes")
    assert harness.bench.keyframes.add_here([LEVEL], camera=False)
    harness.answer(GOOD)
    assert harness.technique == "./dunes" and harness.session.shown is not None
    assert [keyframe.values for keyframe in harness.bench.keyframes.keyframes] == [((LEVEL, 0.5),)]
    assert not harness.session.shown.edits.has(LEVEL)


# ── history ───────────────────────────────────────────────────────────────────


SIZE = (48, 32)
HISTORY_KERNEL = """// terrain.glsl -- a slope
#pragma kernel(output = "height:r32f")
uniform float level = 0.25; //! slider(0, 1)
uniform float other = 0.0; //! slider(0, 1)
float kernel(ivec2 texel) { return level * float(texel.x) / float(size.x) + other; }
"""
HISTORY_SKETCH = (
    "format = 1  # ours\nsize = 33\n"
    + map_of_height()
    + '[[preset]]\nname = "high"\nset = { "height.level" = 1.0, "height.other" = 0.5 }\n'
)


class Desk:
    """A sketch, a session on it, and what a person can ask for."""

    def __init__(self, engine: Engine, folder: Path, path: Path | None = None) -> None:
        self.folder = folder
        if path is None:
            (folder / "terrain.glsl").write_text(HISTORY_KERNEL, encoding="utf-8")
            (folder / "other.glsl").write_text(HISTORY_KERNEL.replace("terrain", "other"), encoding="utf-8")
            (folder / "sketch.toml").write_text(HISTORY_SKETCH, encoding="utf-8")
        self.session = Session(engine, path or folder)
        self.time = 0.0
        self.bench = Workbench(
            self.session, WindowControls(lambda: None), folder=folder, now=lambda: self.time
        )
        self.frame()

    def frame(self) -> np.ndarray:
        """Let a turn of the window pass, a second after the one before; return the picture."""
        self.time += 1.0
        self.session.frame(SIZE)
        self.bench.undo.record()
        self.bench.take_notes()
        frame = self.session.read()
        assert frame is not None and self.session.error is None
        return frame.array

    def value(self, name: str) -> object:
        assert self.session.sketch is not None
        return values_of(self.session.sketch)[f"height.{name}"]

    @property
    def text(self) -> str:
        return (self.folder / "sketch.toml").read_text(encoding="utf-8")

    @property
    def messages(self) -> str:
        return "; ".join(notice.text for notice in self.bench.notices.items)


@pytest.fixture
def desk(tmp_path: Path, any_engine: Engine) -> Iterator[Desk]:
    made = Desk(any_engine, tmp_path)
    yield made
    made.session.release()


def test_everything_is_undone_and_done_again(desk: Desk) -> None:
    session, bench = desk.session, desk.bench
    pictures = [desk.frame()]
    for act in (
        lambda: session.drafts.set("height.level", 0.5),
        lambda: bench.actions.apply_preset("high"),
        lambda: session.drafts.choose("height", "./other"),
        lambda: session.drafts.set_camera(Camera(azimuth=3.0)),
        lambda: session.drafts.lock("height.other", True),
        lambda: bench.actions.reset_values(),
        lambda: bench.undo.seek(2.5),
        lambda: bench.actions.set_all("Random, seed 1", {"height.level": 0.125}),
    ):
        act()
        pictures.append(desk.frame())
    assert len(bench.undo.history.steps) == 8
    assert desk.value("other") == 0.5, "the reset left what is locked"
    for picture in reversed(pictures[:-1]):
        bench.undo.undo()
        np.testing.assert_array_equal(desk.frame(), picture)
    assert session.clock.time == 0.0 and session.shown is not None
    assert session.shown.edits.values == () and session.sketch == session.shown.file
    for picture in pictures[1:]:
        bench.undo.redo()
        np.testing.assert_array_equal(desk.frame(), picture)
    assert session.clock.time == 2.5 and session.shown.edits.locked == ("height.other",)
    bench.undo.go_to(2)
    np.testing.assert_array_equal(desk.frame(), pictures[2])
    bench.undo.redo()
    bench.undo.go_to(0)
    desk.frame()
    bench.undo.undo()
    assert "nothing to undo" in desk.messages


def test_a_locked_parameter_is_left_by_presets(desk: Desk) -> None:
    desk.session.drafts.lock("height.level", True)
    desk.bench.actions.apply_preset("high")
    desk.frame()
    assert (desk.value("level"), desk.value("other")) == (0.25, 0.5)
    assert "1 parameter; 1 locked parameter left alone" in desk.messages


def test_what_is_saved_is_in_the_file_and_can_still_be_undone(desk: Desk) -> None:
    desk.session.drafts.set("height.level", 0.5)
    desk.frame()
    desk.session.drafts.set_camera(Camera(azimuth=12.3456, elevation=30.0))
    before = desk.frame()
    desk.bench.actions.save_values()
    assert 'use = "./terrain"\nset = { level = 0.5 }\n' in desk.text and "azimuth = 12.35" in desk.text
    assert desk.text.startswith("format = 1  # ours\n")
    np.testing.assert_array_equal(desk.frame(), before)
    assert desk.session.shown.edits.values == () and desk.session.shown.edits.camera is None
    assert "saved 1 value and the camera" in desk.messages and "is taken" not in desk.messages
    desk.bench.undo.undo()
    desk.frame()
    assert desk.session.sketch.camera == Camera() and desk.value("level") == 0.5
    desk.bench.undo.undo()
    assert desk.value("level") == 0.25, "what the file said before"
    desk.bench.actions.save_values()
    desk.frame()
    assert "set = { level = 0.25 }" in desk.text and "azimuth = 200" in desk.text
    for _ in range(2):
        desk.bench.undo.redo()
        desk.frame()
    assert desk.value("level") == 0.5 and desk.session.sketch.camera.azimuth == 12.35


def test_a_technique_is_saved_and_undone(desk: Desk) -> None:
    desk.session.drafts.choose("height", "./other")
    desk.frame()
    desk.bench.actions.save_values()
    desk.frame()
    assert 'use = "./other"' in desk.text and desk.session.shown is not None
    assert desk.session.shown.edits.techniques == ()
    desk.bench.undo.undo()
    desk.frame()
    spec = desk.session.shown.base.graph.find("height")
    assert spec is not None and spec.use == "./terrain"


def test_values_by_hand_become_a_preset(desk: Desk) -> None:
    desk.bench.actions.save_as_preset("low")
    assert "would be empty" in desk.messages and "low" not in desk.text
    desk.session.drafts.set("height.level", 0.125)
    desk.bench.actions.save_as_preset(" low ")
    desk.frame()
    assert [p.name for p in desk.session.sketch.presets] == ["high", "low"]
    assert desk.session.sketch.presets[1].values == (("height.level", 0.125),)
    assert desk.value("level") == 0.125 and desk.session.shown is not None
    assert desk.session.shown.edits.has("height.level"), "a preset more is no saved value"


def test_a_file_changed_meanwhile_is_reported(desk: Desk) -> None:
    desk.session.drafts.set("height.level", 0.5)
    text = HISTORY_SKETCH.replace("size = 33", "size = 17")
    (desk.folder / "sketch.toml").write_text(text, encoding="utf-8")
    desk.bench.actions.save_values()
    assert "changed meanwhile" in desk.messages and desk.text == text


def test_a_shipped_sketch_is_offered_as_a_copy(tmp_path: Path, any_engine: Engine) -> None:
    desk = Desk(any_engine, tmp_path, SKETCHES / "white_noise.toml")
    before = (SKETCHES / "white_noise.toml").read_bytes()
    desk.session.drafts.set("height.seed", 4)
    picture = desk.frame()
    desk.bench.actions.save_values()
    assert desk.bench.file.offer == "This sketch belongs to the playground itself."
    desk.bench.actions.save_a_copy()
    np.testing.assert_array_equal(desk.frame(), picture)
    assert desk.session.path == tmp_path / "white_noise" / "sketch.toml"
    assert desk.session.shown is not None and desk.session.shown.edits.values == ()
    assert (SKETCHES / "white_noise.toml").read_bytes() == before
    desk.bench.undo.undo()
    assert desk.value("seed") != 4
    desk.session.release()


@pytest.mark.parametrize("edited", [False, True])
def test_an_elevation_file_is_saved_as_a_sketch_beside_it(tmp_path, any_engine, edited) -> None:
    dem = tmp_path / "data" / "dem.npy"
    dem.parent.mkdir()
    np.save(dem, np.add.outer(np.arange(9.0), np.arange(7.0) ** 2))
    before = dem.read_bytes()
    desk = Desk(any_engine, tmp_path, dem)
    if edited:
        desk.session.drafts.choose("light", "lighting/l_dot_n")
        desk.session.drafts.set("weights.rock_slope", 41.0)
    picture = desk.frame()
    desk.bench.actions.save_values()
    assert f"saved dem.toml in {dem.parent}" in desk.messages and not desk.bench.file.asks
    assert desk.session.path == dem.with_name("dem.toml") and dem.read_bytes() == before
    np.testing.assert_array_equal(desk.frame(), picture)
    saved = load(dem.with_name("dem.toml"))
    assert saved.graph.find("light").use == ("lighting/l_dot_n" if edited else "lighting/ray_cast")
    assert dict(saved.graph.find("weights").values)["rock_slope"] == (41.0 if edited else 30.0)
    desk.bench.actions.save_values()
    assert "nothing differs from the file" in desk.messages


def test_a_step_that_fails_gives_its_name_to_no_other(desk: Desk) -> None:
    with pytest.raises(ZeroDivisionError), desk.bench.undo.step("Random"):
        raise ZeroDivisionError
    desk.session.drafts.set("height.level", 0.5)
    desk.frame()
    assert [step.name for step in desk.bench.undo.history.steps] == [""]


def test_saved_camera_is_rounded_to_short_decimals() -> None:
    result = rounded(Camera(12.3456, 30.0, 1234.5678, (1 / 3, 2.0, 3.0), 35.0))
    assert result == Camera(12.35, 30.0, 1234.57, (0.33, 2.0, 3.0), 35.0)


class Brush:
    """A brush that is on, with so many strokes to take back."""

    on = True

    def __init__(self, strokes: int) -> None:
        self.strokes = strokes
        self.undone = 0
        self.layer = self

    @property
    def can_undo(self) -> bool:
        return self.strokes > 0

    @property
    def can_redo(self) -> bool:
        return self.undone > 0

    def undo(self) -> None:
        self.strokes, self.undone = self.strokes - 1, self.undone + 1

    def redo(self) -> None:
        self.strokes, self.undone = self.strokes + 1, self.undone - 1


def test_undo_and_redo_while_painting_affect_strokes_not_values(desk: Desk) -> None:
    desk.session.drafts.set("height.level", 0.5)
    desk.frame()
    brush = Brush(1)
    desk.bench.undo.painting = brush  # type: ignore[assignment]
    desk.bench.undo.undo()
    assert brush.strokes == 0 and desk.value("level") == 0.5
    assert "took the last stroke back; put the brush down (B) to undo values" in desk.messages
    desk.bench.undo.undo()
    assert "no stroke to take back" in desk.messages and desk.value("level") == 0.5
    desk.bench.undo.redo()
    assert brush.strokes == 1 and desk.value("level") == 0.5
    assert "painted the stroke again; put the brush down (B) to redo values" in desk.messages
    desk.bench.undo.redo()
    assert "no stroke to paint again" in desk.messages
    brush.on = False
    desk.bench.undo.undo()
    assert desk.value("level") == 0.25


# ── session data ──────────────────────────────────────────────────────────────


DATA_SIZE = (32, 32)
DATA_SKETCH = (
    "format = 1\nextent = 100.0\n"
    + passes(height=("generation/heightmap", 'set = { elevation = "terrain.npy" }'))
    + map_of("height")
)


@pytest.fixture
def read(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    """Give the names of the elevation files that this process has read."""
    names: list[str] = []

    def reading(self: elevation.ElevationFile) -> elevation.Elevation:
        names.append(self.path.name)
        return whole(self)

    whole = elevation.ElevationFile.read
    monkeypatch.setattr(elevation.ElevationFile, "read", reading)
    memo.SOURCES.clear()
    yield names
    memo.SOURCES.clear()


@pytest.fixture
def data_folder(tmp_path: Path) -> Path:
    for name, slope in (("terrain.npy", 1.0), ("other.npy", 2.0)):
        np.save(tmp_path / name, slope * np.outer(np.ones(9), np.arange(9)).astype(np.float32))
    (tmp_path / "sketch.toml").write_text(DATA_SKETCH, encoding="utf-8")
    return tmp_path


@pytest.fixture
def session(data_folder: Path, open_session: OpenSession, read: list[str]) -> Session:
    made = open_session(data_folder, sandbox=FakeSandbox())
    return made


def answer(session: Session, report: SandboxReport) -> None:
    FakeSandbox.latest.answer = report
    session.frame(DATA_SIZE)


def test_the_first_picture_s_file_is_read_by_the_sandbox_first(session: Session, read: list[str]) -> None:
    session.frame(DATA_SIZE)
    assert session.drafts.testing and read == []
    answer(session, SandboxReport(True))
    assert session.sketch is not None and set(read) == {"terrain.npy"}


def test_resaved_file_is_tried_and_unread_if_sandbox_dies(
    session: Session, data_folder: Path, read: list[str]
) -> None:
    answer(session, SandboxReport(True))
    read.clear()
    np.save(data_folder / "terrain.npy", np.eye(11, dtype=np.float32))
    session.drafts.reload()
    assert session.drafts.testing and read == []
    answer(session, SandboxReport(False, SandboxCrash("ran out of memory")))
    session.drafts.set_camera(Camera(azimuth=12.0))
    assert session.frame(DATA_SIZE) is not None, "the last good picture stays"
    assert session.drafts.stage is ReloadStage.FAILED and "ran out of memory" in str(session.error)
    assert read == []
    session.drafts.reload()
    assert session.drafts.testing, "it is tried again, not believed"
    answer(session, SandboxReport(True))
    assert session.error is None and read == ["terrain.npy"]
    session.drafts.reload()
    assert not session.drafts.testing, "nothing of it is new by now"


@pytest.mark.parametrize("name", ["other.npy", "gone.npy"])
def test_a_file_chosen_by_hand_is_tried_first(
    session: Session, data_folder: Path, read: list[str], name: str
) -> None:
    answer(session, SandboxReport(True))
    read.clear()
    session.drafts.set("height.elevation", str(data_folder / name))
    assert session.drafts.testing and read == []
    answer(session, SandboxReport(False, SandboxCrash("the decoder crashed")))
    assert "the decoder crashed" in str(session.error) and read == []
    session.frame(DATA_SIZE)
    assert read == [], "what is shown stays as it was"
    session.drafts.set("height.elevation", str(data_folder / "terrain.npy"))
    session.frame(DATA_SIZE)
    assert session.error is None and not session.drafts.testing and session.drafts.stage is ReloadStage.NONE


def test_a_file_chosen_by_hand_is_drawn_once_it_proved_good(
    session: Session, data_folder: Path, read: list[str]
) -> None:
    answer(session, SandboxReport(True))
    before = session.draws
    session.drafts.set("height.elevation", str(data_folder / "other.npy"))
    session.drafts.set("view.channel", "red")
    answer(session, SandboxReport(True))
    assert session.error is None and session.draws > before and "other.npy" in read
    assert dict(session.shown.edits.values)["height.elevation"] == str(data_folder / "other.npy")
    assert "view.channel" in dict(session.shown.edits.values)


@pytest.mark.parametrize("when", ["during its check", "after it"])
def test_a_file_that_is_taken_back_has_no_verdict(session: Session, data_folder: Path, when: str) -> None:
    answer(session, SandboxReport(True))
    bad = SandboxReport(False, SandboxCrash("the decoder crashed"))
    session.drafts.set("height.elevation", str(data_folder / "other.npy"))
    if when == "after it":
        answer(session, bad)
        assert session.drafts.stage is ReloadStage.FAILED
    session.drafts.unset("height.elevation")
    answer(session, bad)  # of a sketch that nobody wants any more
    assert session.error is None and session.drafts.stage is ReloadStage.NONE
    assert session.shown is not None and not session.shown.edits.values


def test_a_file_that_was_only_touched_is_no_other(session: Session, data_folder: Path) -> None:
    answer(session, SandboxReport(True))
    before = session.draws
    path = data_folder / "terrain.npy"
    data = path.read_bytes()
    path.unlink()
    path.write_bytes(data)
    os.utime(path, ns=(10**18, 10**18))
    session.drafts.set_camera(Camera(azimuth=12.0))
    session.frame(DATA_SIZE)
    assert session.draws > before, "the picture does not wait for a check that nobody requested"
    session.drafts.reload()
    assert not session.drafts.testing


def test_other_values_wait_for_nothing(session: Session) -> None:
    answer(session, SandboxReport(True))
    session.drafts.set("view.channel", "red")
    assert not session.drafts.testing


@pytest.mark.slow
def test_the_sandbox_says_what_is_wrong_with_a_bomb(data_folder: Path, any_engine: Engine) -> None:
    from playground.engine.sandbox import Sandbox, TrySketch
    from playground.sketch.load import load

    with (data_folder / "terrain.npy").open("wb") as file:  # 2 GiB of holes, by columns
        np.lib.format.write_array_header_1_0(
            file, {"descr": "<f8", "fortran_order": True, "shape": (16384, 16384)}
        )
        file.truncate(file.tell() + 8 * 16384**2)
    with Sandbox(memory_bytes=2**30) as sandbox:
        report = sandbox.run(TrySketch(load(data_folder)))
        assert not report.ok and report.error is not None
        assert "there is not enough memory to read it" in str(report.error)
        assert "terrain.npy" in str(report.error)
        write_png(data_folder / "fine.png", np.zeros((4, 4, 3), np.uint8))
        np.save(data_folder / "terrain.npy", np.eye(9, dtype=np.float32))
        assert sandbox.run(TrySketch(load(data_folder))).ok, "the same child goes on"


def test_nothing_reads_picture_while_new_data_is_checked(session: Session, data_folder: Path) -> None:
    answer(session, SandboxReport(True))
    picture = session.frame(DATA_SIZE)
    assert picture is not None and session.is_idle
    inspector, thumbnails, compare = Inspector(session), Thumbnails(session), Compare(session)
    assert inspector.at((5, 5), picture) is not None
    assert not thumbnails.refresh(["height:height"], 1.0) and thumbnails.made == 1
    compare.keep()
    compare.follow(picture)
    np.save(data_folder / "terrain.npy", np.full((9, 9), 0.25, np.float32))
    assert session.awaits_data and not session.is_idle
    assert inspector.at((6, 6), picture) is None
    made, draws = thumbnails.made, compare.draws
    thumbnails.refresh(["view:view"], 2.0)
    session.view.framed_for = (64, 32)
    compare.follow(picture)
    assert (thumbnails.made, compare.draws) == (made, draws)
    session.drafts.reload()
    answer(session, SandboxReport(True))
    assert session.is_idle and inspector.at((6, 6), picture) is not None
    for made_there in (inspector, thumbnails, compare):
        made_there.release()


# ── texts that are typed and not saved ────────────────────────────────────────


def test_what_is_typed_is_drawn_as_if_it_were_saved(harness: Harness) -> None:
    """Against the same text saved; the file stays as it was, and is read again once nothing is typed."""
    file = harness.folder / "one/hills.glsl"
    typed = DESK_KERNEL.replace("0.5 * previous(texel)", "0.25 * previous(texel)")
    before = harness.session.read_values("height:height")
    harness.drafts.take_typed(file, typed)
    harness.answer(GOOD)
    drawn = harness.session.read_values("height:height")
    assert file.read_text(encoding="utf-8") == DESK_KERNEL
    harness.drafts.take_typed(file, None)
    harness.answer(GOOD)
    assert np.array_equal(harness.session.read_values("height:height"), before)
    harness.save("0.5 * previous", "0.25 * previous", "one/hills.glsl")
    harness.answer(GOOD)
    assert np.array_equal(harness.session.read_values("height:height"), drawn)
    assert not np.array_equal(drawn, before)


def test_a_typed_mistake_keeps_the_picture_and_names_its_line(harness: Harness) -> None:
    file, shown = harness.folder / "one/sketch.toml", harness.session.shown
    harness.drafts.take_typed(file, file.read_text(encoding="utf-8").replace("size = 9", "size = nine"))
    harness.frame()
    assert harness.session.shown is shown
    (wrong,) = harness.session.error.diagnostics
    harness.bench.problems.take(harness.session.error)
    assert (wrong.line, harness.bench.problems.lines_around(wrong)[1]) == (2, (2, "size = nine"))
    harness.drafts.take_typed(file, None)
    harness.frame()
    assert harness.session.error is None


def test_the_newest_of_what_is_typed_is_checked(harness: Harness) -> None:
    file = harness.folder / "one/hills.glsl"
    for number in (0.1, 0.2, 0.3):
        harness.drafts.take_typed(file, DESK_KERNEL.replace("0.25", str(number)))
    harness.answer(GOOD)
    assert values_of(harness.session.sketch)[LEVEL] == 0.3
    assert not harness.drafts.testing

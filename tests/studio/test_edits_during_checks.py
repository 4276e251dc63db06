"""Edits made while the sandbox checks something belong to the sketch that is shown, and none is lost."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.engine.engine import Engine
from playground.sketch.assign import values_of
from playground.studio.compare.compare import Compare
from playground.studio.edits.edits import Edits

from .session_desk import ADD as DESK_ADD
from .session_desk import BAD, ELEVATION, GOOD, LEVEL, Harness
from .session_desk import KERNEL as DESK_KERNEL

# ── another sketch is being opened ───────────────────────────────────────────


def test_staying_restores_map_stopped_repeats_and_clock(harness: Harness) -> None:
    harness.session.stop_at("height", 2)
    harness.session.show("height:height")
    harness.session.clock.time, harness.session.clock.playing = 3.0, False
    harness.frame()
    harness.bench.commands.open(harness.folder / "two")
    harness.answer(BAD)
    harness.bench.commands.open(harness.folder / "one")
    harness.answer(GOOD)
    view, clock = harness.session.view, harness.session.clock
    assert harness.name == "one" and view.steps == {"height": 2}
    assert view.map is not None and view.map.ref == "height:height"
    assert (clock.time, clock.playing) == (3.0, False)


def test_undrawable_sketch_keeps_view_of_shown_one(any_engine: Engine, harness: Harness) -> None:
    harness.session.stop_at("height", 2)
    harness.frame()
    harness.write("two/hills.glsl", DESK_KERNEL.replace("level *", "levle *"))
    harness.bench.commands.open(harness.folder / "two")
    harness.answer(GOOD)  # the sandbox has no objection, the driver of this process has one
    assert harness.session.error is not None and harness.name == "one"
    assert harness.session.view.steps == {"height": 2}


def test_a_path_without_a_sketch_changes_nothing(harness: Harness) -> None:
    harness.session.stop_at("height", 2)
    harness.session.clock.time = 3.0
    harness.drafts.set(LEVEL, 0.5)
    harness.frame()
    harness.bench.commands.open(harness.folder / "none.toml")
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
    harness.bench.commands.open(harness.folder / "two")
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
    harness.bench.commands.open(harness.folder / "two")
    assert not harness.bench.keyframes.add_here([LEVEL], camera=False)
    assert "two" in harness.messages and (harness.folder / "one/sketch.toml").read_bytes() == before
    assert harness.level == 0.5
    harness.answer(GOOD)
    assert (harness.name, harness.level) == ("two", 0.25)


def test_save_is_refused_while_other_sketch_fails_and_edits_stay(harness: Harness) -> None:
    before = (harness.folder / "one/sketch.toml").read_bytes()
    harness.write("two/sketch.toml", "format = 1\n[view")
    harness.bench.commands.open(harness.folder / "two")
    for level in (0.5, 0.75):
        harness.drafts.set(LEVEL, level)
        harness.frame()
        harness.bench.commands.save_values()
        harness.frame()
    assert "sketch.toml is not saved while" in harness.messages and "save a copy" in harness.messages
    assert (harness.folder / "one/sketch.toml").read_bytes() == before
    harness.bench.commands.open(harness.folder / "one")
    harness.answer(GOOD)
    assert (harness.name, harness.level) == ("one", 0.75)
    harness.bench.commands.save_values()
    assert b"level = 0.75" in (harness.folder / "one/sketch.toml").read_bytes()


def test_a_copy_of_what_is_shown_is_opened_instead(harness: Harness) -> None:
    harness.drafts.set(LEVEL, 0.5)
    harness.session.stop_at("height", 2)
    harness.frame()
    harness.bench.commands.open(harness.folder / "two")
    harness.bench.commands.save_a_copy()
    harness.answer(GOOD)
    harness.answer(GOOD)
    assert harness.session.path == Path(harness.session.shown.file.file)
    assert harness.session.path.parent.name.startswith("one") and harness.level == 0.5
    assert harness.session.view.steps == {"height": 2}
    harness.bench.undo.undo()
    harness.frame()
    assert harness.level == 0.25


# ── a save, a technique and a data file meet ─────────────────────────────────


def change(harness: Harness, what: str) -> None:
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
    change(harness, first)
    change(harness, second)
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
    harness.write("one/sketch.toml", before.replace("size = 9", "size = 17"))
    harness.bench.undo.undo()
    harness.frame()
    assert "changed meanwhile" in harness.messages and "[[keyframe]]" in file.read_text(encoding="utf-8")
    assert harness.bench.undo.history.done == 2, "it is not undone"
    harness.write("one/sketch.toml", before)
    harness.bench.undo.undo()
    harness.answer(GOOD)
    assert harness.bench.keyframes.keyframes == () and harness.level == 0.5
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

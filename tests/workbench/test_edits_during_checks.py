"""Edits made while the sandbox checks something belong to the sketch that is shown, and none is lost."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.engine.engine import Engine
from playground.sketch.assign import values_of
from playground.sketch.model import Camera
from playground.workbench.edits import Edits
from playground.workbench.inspect.compare import Compare

from .checked_desk import ADD, BAD, ELEVATION, GOOD, KERNEL, LEVEL, Desk

# ── another sketch is being opened ───────────────────────────────────────────


@pytest.mark.parametrize("how", ["folder", "file"])
def test_a_dropped_sketch_has_its_remembered_edits(desk: Desk, how: str) -> None:
    desk.drafts.set(LEVEL, 0.5)
    desk.frame()
    dropped = desk.folder / "two"
    desk.drops.take([dropped if how == "folder" else dropped / "sketch.toml"])
    desk.answer(GOOD)
    assert (desk.name, desk.level) == ("two", 0.25)
    desk.drafts.set(LEVEL, 0.75)
    desk.frame()
    desk.drops.take([desk.folder / "one"])
    desk.answer(GOOD)
    assert (desk.name, desk.level) == ("one", 0.5)
    desk.close()
    for name, level in (("one", 0.5), ("two", 0.75)):
        desk.start(name)
        assert desk.level == level
        desk.close()


def test_an_edit_belongs_to_the_sketch_that_is_shown(desk: Desk) -> None:
    desk.bench.commands.open(desk.folder / "two")
    assert desk.drafts.testing and desk.name == "one"
    desk.drafts.set(LEVEL, 0.5)
    desk.drafts.set_camera(Camera(azimuth=3.0))
    desk.drafts.lock(LEVEL, True)
    desk.frame()
    assert desk.level == 0.5
    desk.answer(GOOD)
    assert (desk.name, desk.level) == ("two", 0.25) and desk.session.shown is not None
    assert desk.session.shown.sketch == desk.session.shown.file
    desk.bench.undo.undo()
    assert "nothing to undo" in desk.messages and desk.level == 0.25
    desk.close()
    desk.start("one")
    assert desk.level == 0.5 and desk.session.shown is not None
    assert desk.session.shown.edits.locked == (LEVEL,)


def test_an_edit_of_the_frame_in_which_the_other_is_shown_is_remembered(desk: Desk) -> None:
    desk.bench.commands.open(desk.folder / "two")
    desk.frame()
    desk.drafts.set(LEVEL, 0.5)
    desk.session.stop_at("height", 2)
    desk.answer(GOOD)
    assert (desk.name, desk.level) == ("two", 0.25)
    desk.close()
    desk.start("one")
    assert desk.level == 0.5 and desk.session.view.steps == {"height": 2}


def test_to_stay_restores_the_map_the_stopped_repeats_and_the_clock(desk: Desk) -> None:
    desk.session.stop_at("height", 2)
    desk.session.show("height:height")
    desk.session.clock.time, desk.session.clock.playing = 3.0, False
    desk.frame()
    desk.bench.commands.open(desk.folder / "two")
    desk.answer(BAD)
    desk.bench.commands.open(desk.folder / "one")
    desk.answer(GOOD)
    view, clock = desk.session.view, desk.session.clock
    assert desk.name == "one" and view.steps == {"height": 2}
    assert view.map is not None and view.map.ref == "height:height"
    assert (clock.time, clock.playing) == (3.0, False)


def test_an_opening_that_fails_leaves_the_sketch_its_edits_and_its_undo(desk: Desk) -> None:
    desk.session.stop_at("height", 2)
    desk.drafts.set(LEVEL, 0.5)
    desk.frame()
    desk.write("two/hills.glsl", KERNEL.replace("level *", "levle *"))
    desk.bench.commands.open(desk.folder / "two")
    desk.answer(BAD)
    assert "driver crashed" in str(desk.session.error) and (desk.name, desk.level) == ("one", 0.5)
    assert desk.session.view.steps == {"height": 2}
    desk.drafts.set(LEVEL, 0.75)
    desk.frame()
    desk.bench.undo.undo()
    desk.frame()
    assert desk.level == 0.5
    desk.bench.undo.undo()
    desk.frame()
    assert desk.level == 0.25
    desk.drafts.set(LEVEL, 0.625)
    desk.frame()
    desk.save("levle", "level", "two/hills.glsl")
    desk.answer(GOOD)
    assert (desk.name, desk.level, desk.session.view.steps) == ("two", 0.25, {})
    desk.close()
    desk.start("one")
    assert desk.level == 0.625


def test_a_sketch_that_does_not_draw_leaves_the_view_of_the_one_shown(any_engine: Engine, desk: Desk) -> None:
    desk.session.stop_at("height", 2)
    desk.frame()
    desk.write("two/hills.glsl", KERNEL.replace("level *", "levle *"))
    desk.bench.commands.open(desk.folder / "two")
    desk.answer(GOOD)  # the sandbox has no objection, the driver of this process has one
    assert desk.session.error is not None and desk.name == "one"
    assert desk.session.view.steps == {"height": 2}


def test_a_path_without_a_sketch_changes_nothing(desk: Desk) -> None:
    desk.session.stop_at("height", 2)
    desk.session.clock.time = 3.0
    desk.drafts.set(LEVEL, 0.5)
    desk.frame()
    desk.bench.commands.open(desk.folder / "none.toml")
    desk.frame()
    assert "there is no file" in desk.messages and desk.session.path == desk.folder / "one/sketch.toml"
    assert desk.session.view.steps == {"height": 2} and desk.session.clock.time == 3.0
    desk.bench.undo.undo()
    desk.frame()
    assert desk.level == 0.25


def test_the_sketch_that_is_shown_is_opened_again_with_its_edits_and_its_undo(desk: Desk) -> None:
    desk.drafts.set(LEVEL, 0.5)
    desk.frame()
    desk.bench.commands.open(desk.folder / "two")
    desk.bench.commands.open(desk.folder / "one")
    desk.drafts.set(LEVEL, 0.75)
    desk.frame()
    desk.answer(GOOD)
    assert (desk.name, desk.level, desk.session.path.parent.name) == ("one", 0.75, "one")
    for level in (0.5, 0.25):
        desk.bench.undo.undo()
        desk.frame()
        assert desk.level == level


def test_what_needs_a_check_waits_until_the_other_sketch_is_there(desk: Desk) -> None:
    desk.drafts.choose("height", "./dunes")
    desk.answer(GOOD)
    desk.bench.commands.open(desk.folder / "two")
    desk.drafts.choose("height", "generation/white_noise")
    assert "height: generation/white_noise is not taken" in desk.messages and "two" in desk.messages
    desk.drafts.set(ELEVATION, desk.file("b.npy"))
    assert "data.elevation: b.npy is not taken" in desk.messages
    desk.bench.undo.undo()
    assert "height: what the file says is not taken" in desk.messages and desk.technique == "./dunes"
    assert desk.bench.undo.history.done == 1
    desk.answer(GOOD)
    assert (desk.name, desk.technique, desk.elevation) == ("two", "./hills", "a.npy")
    assert desk.session.error is None


def test_no_keyframe_is_written_while_another_sketch_is_opened(desk: Desk) -> None:
    desk.drafts.set(LEVEL, 0.5)
    desk.frame()
    before = (desk.folder / "one/sketch.toml").read_bytes()
    desk.bench.commands.open(desk.folder / "two")
    assert not desk.bench.keyframes.add_here([LEVEL], camera=False)
    assert "two" in desk.messages and (desk.folder / "one/sketch.toml").read_bytes() == before
    assert desk.level == 0.5
    desk.answer(GOOD)
    assert (desk.name, desk.level) == ("two", 0.25)


def test_nothing_is_saved_while_another_sketch_does_not_open_and_no_edit_is_lost(desk: Desk) -> None:
    before = (desk.folder / "one/sketch.toml").read_bytes()
    desk.write("two/sketch.toml", "format = 1\n[view")
    desk.bench.commands.open(desk.folder / "two")
    for level in (0.5, 0.75):
        desk.drafts.set(LEVEL, level)
        desk.frame()
        desk.bench.commands.save_values()
        desk.frame()
    assert "sketch.toml is not saved while" in desk.messages and "save a copy" in desk.messages
    assert (desk.folder / "one/sketch.toml").read_bytes() == before
    desk.bench.commands.open(desk.folder / "one")
    desk.answer(GOOD)
    assert (desk.name, desk.level) == ("one", 0.75)
    desk.bench.commands.save_values()
    assert b"level = 0.75" in (desk.folder / "one/sketch.toml").read_bytes()


def test_a_copy_of_what_is_shown_is_opened_instead(desk: Desk) -> None:
    desk.drafts.set(LEVEL, 0.5)
    desk.session.stop_at("height", 2)
    desk.frame()
    desk.bench.commands.open(desk.folder / "two")
    desk.bench.commands.save_a_copy()
    desk.answer(GOOD)
    desk.answer(GOOD)
    assert desk.session.path == Path(desk.session.shown.file.file)
    assert desk.session.path.parent.name.startswith("one") and desk.level == 0.5
    assert desk.session.view.steps == {"height": 2}
    desk.bench.undo.undo()
    desk.frame()
    assert desk.level == 0.25


# ── a save, a technique and a data file meet ─────────────────────────────────


def change(desk: Desk, what: str) -> None:
    if what == "save":
        desk.save("size = 9", "size = 17")
    elif what == "technique":
        desk.drafts.choose("height", "./dunes")
    else:
        desk.drafts.set(ELEVATION, desk.file("b.npy"))


PAIRS = [
    (one, two) for one in ("save", "technique", "data") for two in ("save", "technique", "data") if one != two
]


@pytest.mark.parametrize("changes", [*PAIRS, ("technique", "data", "save"), ("save", "data", "technique")])
def test_what_meets_during_a_check_is_all_taken(desk: Desk, changes: tuple[str, ...]) -> None:
    for what in changes:
        change(desk, what)
        desk.frame()
        assert desk.drafts.testing
    desk.drafts.set(LEVEL, 0.5)
    desk.answer(GOOD)
    assert desk.session.error is None and desk.level == 0.5
    assert desk.size == (17 if "save" in changes else 9)
    assert desk.technique == ("./dunes" if "technique" in changes else "./hills")
    assert desk.elevation == ("b.npy" if "data" in changes else "a.npy")


@pytest.mark.parametrize(("first", "second"), PAIRS)
def test_what_fails_is_named_and_the_rest_is_taken(desk: Desk, first: str, second: str) -> None:
    change(desk, first)
    change(desk, second)
    chosen = second if second != "save" else first  # a choice gives way, what is saved is on the disk
    desk.answer(BAD)
    assert f"{'b.npy' if chosen == 'data' else './dunes'} is not taken: " in desk.messages
    assert "the driver crashed" in desk.messages
    assert desk.drafts.testing, "the rest is tried by itself"
    desk.answer(GOOD)
    assert desk.session.error is None
    rest = first if chosen == second else second
    assert desk.size == (17 if rest == "save" else 9)
    assert desk.technique == ("./dunes" if rest == "technique" else "./hills")
    assert desk.elevation == ("b.npy" if rest == "data" else "a.npy")


def test_a_save_that_failed_stays_an_error_when_another_technique_is_shown(desk: Desk) -> None:
    desk.save("size = 9", "size = 17")
    desk.answer(BAD)
    error = desk.session.error
    assert error is not None
    desk.drafts.choose("height", "./dunes")
    desk.answer(GOOD)
    assert (desk.technique, desk.size) == ("./dunes", 9) and desk.session.error is error
    desk.drafts.reload()
    desk.answer(GOOD)
    assert (desk.technique, desk.size) == ("./dunes", 17) and desk.session.error is None


def test_a_choice_waits_for_a_file_that_cannot_be_read(desk: Desk) -> None:
    desk.drafts.choose("height", "./dunes")
    desk.save("[view]", "[view")
    assert desk.session.error is not None
    desk.frame()
    desk.save("[view", "[view]")
    desk.answer(GOOD)
    assert desk.session.error is None and desk.technique == "./dunes"


def test_of_two_choices_for_a_pass_the_last_good_one_counts(desk: Desk) -> None:
    for use in ("generation/white_noise", "./dunes"):
        desk.drafts.choose("height", use)
    desk.save("size = 9", "size = 17")
    desk.answer(BAD)
    assert "./dunes is not taken" in desk.messages
    desk.answer(GOOD)
    assert (desk.technique, desk.size) == ("generation/white_noise", 17)


def test_what_is_chosen_with_a_save_is_an_undo_step(desk: Desk) -> None:
    desk.drafts.choose("height", "./dunes")
    desk.save("size = 9", "size = 17")
    desk.answer(GOOD)
    desk.frame()
    assert desk.bench.undo.history.done == 1
    desk.bench.undo.undo()
    desk.answer(GOOD)
    assert (desk.technique, desk.size) == ("./hills", 17)


@pytest.mark.parametrize("how", ["fails", "is taken back"])
def test_an_undo_that_does_not_come_is_no_longer_done(desk: Desk, how: str) -> None:
    desk.drafts.choose("height", "./dunes")
    desk.answer(GOOD)
    desk.save("size = 9", "size = 17")
    desk.answer(GOOD)
    undo = desk.bench.undo
    undo.undo()
    assert undo.history.done == 0 and desk.drafts.testing
    if how == "is taken back":
        desk.drafts.choose("height", "./dunes")
    desk.answer(BAD)
    desk.frame()
    assert undo.history.done == 1 and desk.technique == "./dunes"
    undo.undo()
    desk.answer(GOOD)
    desk.frame()
    assert undo.history.done == 0 and desk.technique == "./hills"


def test_a_preset_during_a_check_leaves_what_is_chosen(desk: Desk) -> None:
    desk.drafts.set(ELEVATION, desk.file("b.npy"))
    desk.bench.commands.set_all("Preset", {LEVEL: 0.5})
    desk.drafts.unset(LEVEL)
    desk.answer(GOOD)
    assert (desk.elevation, desk.level) == ("b.npy", 0.25)


def test_texts_and_a_technique_that_come_together_are_both_shown(desk: Desk) -> None:
    """As a lesson's figure of the sketch that is open does it."""
    text = ADD.replace("uniform", "uniform float share = 0.5; //! slider(0, 1)\nuniform", 1)
    desk.drafts.read_as({str(desk.folder / "one/add.glsl"): text})
    desk.drafts.restore(Edits(techniques=(("height", "./dunes"),)))
    desk.answer(GOOD)
    assert desk.technique == "./dunes" and desk.session.sketch is not None
    assert values_of(desk.session.sketch)["sum.share"] == 0.5


def test_a_technique_that_is_taken_back_during_its_check_is_gone(desk: Desk) -> None:
    desk.drafts.choose("height", "./dunes")
    desk.drafts.choose("height", "./hills")
    desk.answer(BAD)
    assert desk.session.error is None and desk.technique == "./hills" and not desk.drafts.testing


def test_undo_and_redo_during_a_check(desk: Desk) -> None:
    desk.drafts.choose("height", "./dunes")
    desk.answer(GOOD)
    desk.save("size = 9", "size = 17")
    desk.answer(GOOD)
    undo = desk.bench.undo
    undo.undo()
    assert desk.drafts.testing
    undo.redo()
    desk.answer(GOOD)
    desk.frame()
    assert desk.technique == "./dunes" and not desk.drafts.testing
    undo.undo()
    desk.save("size = 17", "size = 33")
    desk.drafts.set(LEVEL, 0.5)
    desk.answer(GOOD)
    assert (desk.technique, desk.size, desk.level) == ("./hills", 33, 0.5)


def save_after_keeping_a(desk: Desk) -> Compare:
    """Keep a state as A, edit it, and save the sketch; return the comparison."""
    compare = desk.bench.inspection.compare
    desk.drafts.set(LEVEL, 0.5)
    desk.frame()
    compare.keep()
    desk.drafts.set(LEVEL, 0.75)
    desk.frame()
    desk.save("size = 9", "size = 17")
    return compare


def test_going_back_to_a_is_an_undo_step_after_a_save_too(desk: Desk) -> None:
    compare = save_after_keeping_a(desk)
    desk.answer(GOOD)
    steps = len(desk.bench.undo.history.steps)
    compare.back()
    desk.frame()
    assert desk.level == 0.5 and len(desk.bench.undo.history.steps) == steps + 1
    desk.bench.undo.undo()
    desk.frame()
    assert desk.level == 0.75


def test_going_back_to_a_during_a_check_stays(desk: Desk) -> None:
    compare = save_after_keeping_a(desk)
    compare.back()
    desk.answer(GOOD)
    assert (desk.level, desk.size) == (0.5, 17)


def test_a_keyframe_that_cannot_be_written_is_still_to_be_undone(desk: Desk) -> None:
    desk.drafts.set(LEVEL, 0.5)
    desk.frame()
    assert desk.bench.keyframes.add_here([LEVEL], camera=False)
    desk.answer(GOOD)
    assert desk.bench.keyframes.keyframes and desk.bench.undo.history.done == 2
    file = desk.folder / "one/sketch.toml"
    before = file.read_text(encoding="utf-8")
    desk.write("one/sketch.toml", before.replace("size = 9", "size = 17"))
    desk.bench.undo.undo()
    desk.frame()
    assert "changed meanwhile" in desk.messages and "[[keyframe]]" in file.read_text(encoding="utf-8")
    assert desk.bench.undo.history.done == 2, "it is not undone"
    desk.write("one/sketch.toml", before)
    desk.bench.undo.undo()
    desk.answer(GOOD)
    assert desk.bench.keyframes.keyframes == () and desk.level == 0.5
    assert desk.bench.undo.history.done == 1


def test_a_keyframe_keeps_a_technique_that_is_checked(desk: Desk) -> None:
    desk.drafts.set(LEVEL, 0.5)
    desk.frame()
    desk.drafts.choose("height", "./dunes")
    assert desk.bench.keyframes.add_here([LEVEL], camera=False)
    desk.answer(GOOD)
    assert desk.technique == "./dunes" and desk.session.shown is not None
    assert [keyframe.values for keyframe in desk.bench.keyframes.keyframes] == [((LEVEL, 0.5),)]
    assert not desk.session.shown.edits.has(LEVEL)

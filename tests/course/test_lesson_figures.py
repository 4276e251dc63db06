"""A lesson on the stage: what it shows, what it leaves alone, what comes back."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from playground.course import library
from playground.course.model import Break, Compare, Exercise, Figure, Scene, Slider, Steps
from playground.course.read import read_lesson
from playground.course.scenes import BOTH, broken, draw
from playground.course.window.bugs import BROKEN, FIXED, SHOWN
from playground.course.window.figure_view import edits_of, map_of, steps_of
from playground.course.window.panel import play_on
from playground.sketch.find import find
from playground.studio.edits.edits import Draft, Edits, StoredEdits
from playground.studio.picture.view import framed

from ..loading import load
from .lesson_desk import FILE, OWN, Harness, shelved, value


def block(harness: Harness, name: str):
    assert harness.reader.lesson is not None
    return harness.reader.lesson.named[name]


def text_window(harness: Harness):
    """Return the editor of the one file that is open."""
    (editing,) = harness.bench.files.editing
    return editing.view.editor


def as_seen(harness: Harness) -> np.ndarray:
    """Return the picture of the view as the engine draws it by itself, at the size of the view."""
    frame = harness.session.read()
    assert frame is not None
    return frame.array


def of_lesson(harness: Harness, scene: Scene) -> np.ndarray:
    """Return a picture as a book has it, at the size of the view, its aspect ratio unchanged."""
    seen = framed(scene.sketch, scene.time, scene.pixels, (48, 32))
    return draw(harness.session.engine, replace(scene, sketch=seen, pixels=(48, 32))).array


def scenes_of(lesson) -> list[Scene]:
    scenes = []
    for each in lesson.blocks:
        if isinstance(each, Figure | Exercise | Break) and each.scene:
            scenes.append(each.scene)
        elif isinstance(each, Steps | Slider | Compare):
            scenes += each.scenes
    return scenes


def test_scene_edits_reproduce_exact_lesson_sketch(tmp_path, monkeypatch):
    shelved(monkeypatch, tmp_path)
    scenes = scenes_of(read_lesson("halving"))
    assert len(scenes) == 13
    for scene in scenes:
        file = load(Path(scene.sketch.file))
        if scene.view:
            assert map_of(scene).ref == "height:height"  # its picture is looked at below
            continue
        made = Draft(file, file, edits_of(scene, file)).sketch
        assert made.with_values({}) == scene.sketch.with_values({}), scene


def test_lesson_picture_keeps_its_frame_and_own_sketch_default(harness):
    harness.open(show=False)
    session = harness.bench.session
    scene = read_lesson("halving").named["rubble"].scene
    harness.reader.figure.show(replace(scene, pixels=(300, 300)), ("rubble", 0))
    assert session.view.framed_for == (300, 300)
    harness.reader.figure.go_back()
    assert session.view.framed_for == (1280, 720)


def test_every_picture_in_the_view_is_that_of_the_lesson(harness):
    harness.open(show=False)
    for page in range(5):
        harness.reader.go(page)
        for each in harness.reader.section.blocks:
            if not isinstance(each, Figure | Steps | Slider | Exercise) or not hasattr(each, "scene"):
                continue
            if each.scene is None:
                continue
            harness.reader.show(each)
            harness.run_frames(3)
            assert harness.session.error is None
            np.testing.assert_array_equal(as_seen(harness), of_lesson(harness, each.scene), err_msg=each.name)


def test_first_picture_waits_for_click_and_next_page_shows_own(harness):
    own = harness.session.path
    harness.open(show=False)
    assert harness.session.path == own and harness.reader.figure.before_lesson is None
    harness.reader.turn_page(1)
    harness.run_frames(4)
    assert harness.session.path == find("diamond_square_steps")
    assert harness.session.view.steps == {"height.raw": 0, "phase": 0}


def test_page_without_picture_shows_previous_if_stage_is_empty(harness):
    harness.open(3)
    assert harness.reader.figure.key == ("seeds", 1) and value(harness, "height.seed") == 2
    harness.reader.show(block(harness, "rubble"))
    harness.run_frames(2)
    harness.reader.go(4)
    harness.run_frames(2)
    assert harness.reader.figure.key == ("rubble", 0), "what is shown stays"


def test_what_was_open_comes_back_with_its_values_and_its_undo(harness):
    own = harness.session.path
    harness.session.drafts.set("height.seed", 5)
    harness.run_frames(2)
    seen = as_seen(harness)
    harness.open(show=False)
    harness.reader.show(block(harness, "rubble"))
    harness.run_frames(3)
    assert harness.session.path == find("white_noise") and value(harness, "height.seed") == 3
    harness.reader.go(1)
    harness.run_frames(3)
    harness.reader.go_back()
    harness.run_frames(3)
    assert harness.session.path == own and value(harness, "height.seed") == 5
    np.testing.assert_array_equal(as_seen(harness), seen)
    harness.bench.undo.undo()
    assert not harness.session.shown.edits.values


def test_page_turn_keeps_edited_sketch_and_show_replaces_it(harness):
    own = harness.session.path
    harness.session.drafts.set("height.seed", 5)
    harness.run_frames(2)
    harness.open(show=False)
    harness.reader.turn_page(1)
    harness.run_frames(2)
    assert harness.session.path == own
    assert any("stays in view" in notice.text for notice in harness.bench.notices.items)
    harness.reader.show(block(harness, "halves"))
    harness.run_frames(2)
    assert harness.session.path != own


def test_reader_edit_in_figure_is_restored_by_later_undo(harness):
    harness.open()
    harness.session.drafts.set("height.seed", 77)
    harness.run_frames(60)
    harness.reader.go(1)  # another sketch
    harness.run_frames(4)
    harness.reader.show(block(harness, "rubble"))
    harness.run_frames(4)
    assert value(harness, "height.seed") == 3
    harness.bench.undo.undo()
    harness.run_frames(2)
    assert value(harness, "height.seed") == 77
    harness.reader.reset(block(harness, "rubble"))  # the same sketch
    harness.run_frames(60)
    assert value(harness, "height.seed") == 3
    harness.bench.undo.undo()
    harness.run_frames(2)
    assert value(harness, "height.seed") == 77


def test_what_is_compared_with_comes_back_with_what_was_open(harness):
    compare = harness.bench.inspection.compare
    harness.session.drafts.set("height.seed", 5)
    harness.run_frames(2)
    compare.keep()
    harness.session.drafts.set("height.seed", 6)
    harness.run_frames(2)
    harness.open(show=False)
    harness.reader.show(block(harness, "seeds"))
    harness.run_frames(4)
    harness.reader.go_back()
    harness.run_frames(4)
    assert value(harness, "height.seed") == 6
    assert compare.on, "A is there again"
    assert dict(compare.remembered().edits.values) == {"height.seed": 5}


def test_edits_of_broken_sketch_return_once_it_is_fixed(harness):
    own = harness.session.path
    own.write_text(OWN.replace("white_noise", "white_noyse"), encoding="utf-8")
    harness.session.open(own, start=StoredEdits(Edits((("height.seed", 5),))))
    harness.run_frames(2)
    assert harness.session.error is not None and harness.session.drafts.opening
    harness.open(show=False)
    harness.reader.show(block(harness, "rubble"))
    harness.run_frames(3)
    assert value(harness, "height.seed") == 3
    harness.reader.go_back()
    harness.run_frames(3)
    own.write_text(OWN, encoding="utf-8")
    harness.session.drafts.reload()
    harness.run_frames(3)
    assert harness.session.error is None and value(harness, "height.seed") == 5


def test_file_change_during_lesson_overrides_manual_edit(harness):
    own = harness.session.path
    own.write_text(OWN.replace("[view]", "set = { seed = 2 }\n[view]"), encoding="utf-8")
    harness.session.drafts.reload()
    harness.run_frames(2)
    harness.session.drafts.set("height.seed", 5)
    harness.run_frames(2)
    harness.open(show=False)
    harness.reader.show(block(harness, "rubble"))
    harness.run_frames(3)
    own.write_text(OWN.replace("[view]", "set = { seed = 9 }\n[view]"), encoding="utf-8")
    harness.reader.go_back()
    harness.run_frames(3)
    assert harness.session.path == own and "height.seed" not in dict(harness.session.shown.edits.values)


def test_return_to_missing_sketch_is_reported_and_retryable(harness):
    own = harness.session.path
    harness.open(show=False)
    harness.reader.show(block(harness, "rubble"))
    harness.run_frames(3)
    own.rename(own.with_name("away.toml"))
    harness.reader.go_back()
    harness.run_frames(3)
    assert any("sketch.toml" in notice.text for notice in harness.bench.notices.items)
    assert harness.session.path == find("white_noise") and harness.session.error is None
    own.with_name("away.toml").rename(own)
    harness.reader.go_back()
    harness.run_frames(3)
    assert harness.session.path == own and harness.reader.figure.before_lesson is None


def test_opened_copy_keeps_reader_sketch_and_its_autosave(harness):
    own = harness.session.path
    harness.open(3, show=False)
    harness.reader.bugs.edit(block(harness, "mean"))
    harness.run_frames(3)
    assert harness.session.drafts.texts and harness.reader.figure.before_lesson is None
    harness.session.drafts.set("height.seed", 7)
    harness.run_frames(3)
    assert dict(harness.autosave.latest.edits.values) == {"height.seed": 7}, "it is remembered"
    harness.reader.show(block(harness, "seeds"))
    harness.run_frames(4)
    harness.reader.go_back()
    harness.run_frames(3)
    assert harness.session.path == own and value(harness, "height.seed") == 7


def test_nothing_of_a_lesson_is_remembered_of_its_sketches(harness, tmp_path):
    harness.session.drafts.set("height.seed", 5)
    harness.run_frames(2)
    harness.open(show=False)
    harness.reader.show(block(harness, "rubble"))
    harness.run_frames(60)
    harness.session.drafts.set("height.seed", 8)
    harness.run_frames(60)
    harness.autosave.close()
    memories = [json.loads(file.read_text()) for file in (tmp_path / "state").rglob("sessions/*.json")]
    seeds = [(Path(m["sketch"]).parent.name, dict(m["edits"]["values"])["height.seed"]) for m in memories]
    assert seeds == [("own", 5)]


def test_play_on_opens_figure_as_own_sketch_with_its_edits(harness):
    harness.session.open(find("white_noise"))
    harness.run_frames(2)
    harness.session.drafts.set("height.seed", 41)
    harness.run_frames(2)
    harness.autosave.look((800, 600))
    harness.autosave.write()
    harness.open(show=False)
    harness.reader.show(block(harness, "rubble"))
    harness.run_frames(2)
    assert value(harness, "height.seed") == 3
    play_on(harness.reader)
    harness.run_frames(3)
    assert harness.session.path == find("white_noise") and value(harness, "height.seed") == 41
    assert harness.reader.figure.before_lesson is None and harness.bench.interface.panel_shown


def test_dropped_sketch_leaves_figure_even_of_same_file(harness):
    harness.bench.actions.opens = harness.autosave.open
    harness.bench.actions.open(find("white_noise"))
    harness.run_frames(2)
    harness.session.drafts.set("height.seed", 41)
    harness.run_frames(2)
    harness.open(show=False)
    harness.reader.show(block(harness, "rubble"))
    harness.run_frames(3)
    assert harness.session.path == find("white_noise") and value(harness, "height.seed") == 3
    harness.drops.take([find("white_noise")])
    harness.run_frames(3)
    assert harness.reader.figure.before_lesson is None and harness.reader.figure.key is None
    assert value(harness, "height.seed") == 41
    harness.session.drafts.set("height.seed", 42)
    harness.run_frames(3)
    assert dict(harness.autosave.latest.edits.values) == {"height.seed": 42}, "it is remembered"


def test_playing_on_with_the_sketch_that_is_open_keeps_its_undo(harness):
    harness.bench.actions.open(find("white_noise"))
    harness.run_frames(2)
    harness.session.drafts.set("height.seed", 41)
    harness.run_frames(2)
    harness.open(show=False)
    play_on(harness.reader)
    harness.run_frames(3)
    assert value(harness, "height.seed") == 41
    harness.bench.undo.undo()
    harness.run_frames(2)
    assert not harness.session.shown.edits.values


def test_turns_are_stopped_at_and_played_to_the_last(harness):
    harness.open(1)
    repeated = block(harness, "halves")
    harness.reader.move(repeated, 2)
    harness.run_frames(2)
    assert harness.session.view.steps == {"height.raw": 2, "phase": 2}
    np.testing.assert_array_equal(as_seen(harness), of_lesson(harness, repeated.scenes[2]))
    harness.reader.play_or_pause(repeated)
    assert (
        harness.reader.playing == "halves" and 0 < harness.reader.patience(harness.bench.notices.now()) <= 0.8
    )
    harness.run_frames(60)
    assert not harness.reader.playing and harness.reader.at["halves"] == 3
    assert steps_of(repeated.scenes[3]) == {"height.raw": 4, "phase": 4}
    assert harness.session.view.steps == {"height.raw": 4, "phase": 4}


def test_a_sweep_plays_from_the_first_value_to_the_last(harness):
    harness.open(2)
    rough = block(harness, "rough")
    assert value(harness, "height.smoothing") == 0.0
    harness.reader.play_or_pause(rough)
    seen = []
    for _ in range(90):
        harness.run_frames()
        seen.append(value(harness, "height.smoothing"))
    assert list(dict.fromkeys(seen)) == [0.0, 0.5, 1.0] and not harness.reader.playing
    harness.reader.play_or_pause(rough)
    harness.run_frames(2)
    assert value(harness, "height.smoothing") == 0.0, "from the beginning again"


def test_two_variants_are_parted_by_the_line_of_the_view(harness):
    harness.open(2)
    seeds = block(harness, "seeds")
    harness.reader.choose(seeds, BOTH)
    harness.run_frames(4)
    compare = harness.bench.inspection.compare
    assert compare.on and value(harness, "height.seed") == 2
    second = as_seen(harness)  # in full, and the first with it
    harness.run_frames()
    rows = np.frombuffer(compare.picture.read(alignment=1), np.uint8).reshape(32, 48, 4)[::-1]
    np.testing.assert_array_equal(rows, of_lesson(harness, seeds.scenes[0]))
    np.testing.assert_array_equal(second, of_lesson(harness, seeds.scenes[1]))
    harness.reader.choose(seeds, 0)
    harness.run_frames(3)
    assert not compare.on and value(harness, "height.seed") == 1


def test_a_bug_is_drawn_and_fixed_and_the_file_stays_as_it_is(harness):
    before = FILE.read_bytes()
    harness.open(3)
    bug = block(harness, "quarter")
    harness.reader.show(bug)
    harness.reader.bugs.break_it(bug)
    harness.run_frames(4)
    assert harness.reader.bugs.state["quarter"] == BROKEN
    np.testing.assert_array_equal(as_seen(harness), of_lesson(harness, broken(bug)))
    assert [editing.text.path for editing in harness.bench.files.editing] == [FILE]
    text = harness.bench.files.editing[0].text
    assert ": 9.0)" in text.base
    text.save(text.base.replace(": 9.0)", ": 2.0)"))
    harness.run_frames(6)
    assert harness.reader.bugs.state["quarter"] == BROKEN, "another picture, but not the whole one"
    text.save(text.base.replace(": 2.0)", ": float(3))"))
    harness.run_frames(6)
    assert harness.reader.bugs.state["quarter"] == FIXED
    assert any("Fixed" in notice.text for notice in harness.bench.notices.items)
    np.testing.assert_array_equal(as_seen(harness), of_lesson(harness, bug.scene))
    harness.reader.bugs.break_it(bug)
    harness.run_frames(4)
    harness.reader.bugs.fix_it(bug)
    harness.run_frames(4)
    assert harness.reader.bugs.state["quarter"] == SHOWN and not harness.bench.files.editing
    assert not harness.session.drafts.texts
    np.testing.assert_array_equal(as_seen(harness), of_lesson(harness, bug.scene))
    assert FILE.read_bytes() == before


def test_uncompilable_bug_is_reported_and_leaves_with_its_page(harness):
    harness.open(3)
    bug = block(harness, "quarter")
    harness.reader.bugs.break_it(bug)
    harness.run_frames(4)
    text = harness.bench.files.editing[0].text
    text.save(text.base.replace("total /", "totals /"))
    harness.run_frames(4)
    assert harness.session.error is not None and "raw.glsl" in str(harness.session.error)
    assert harness.reader.bugs.state["quarter"] == BROKEN
    harness.reader.turn_page(1)
    harness.run_frames(4)
    assert (
        harness.session.error is None and not harness.session.drafts.texts and not harness.bench.files.editing
    )
    harness.reader.turn_page(-1)
    harness.reader.bugs.break_it(bug)
    assert "totals /" in harness.bench.files.editing[0].text.base, "what was typed is there again"


def test_code_is_shown_as_the_copy_has_it_until_it_is_put_back(harness):
    before = FILE.read_text(encoding="utf-8")
    harness.open(3)
    code, bugs = block(harness, "mean"), harness.reader.bugs
    assert "float(2 * r)" in bugs.excerpt(code).text and not bugs.is_edited(code)
    bugs.edit(code)
    harness.run_frames(3)
    editing = harness.bench.files.editing[0]
    assert editing.text.base == before
    assert before.split("\n")[editing.line - 2].strip() == "// anchor: height"
    editing.text.save(before.replace("float(2 * r)", "float(3 * r)"))
    harness.run_frames(3)
    assert "float(3 * r)" in bugs.excerpt(code).text and bugs.is_edited(code)
    assert harness.session.drafts.texts == {str(FILE): editing.text.base}
    bugs.put_back(code)
    harness.run_frames(3)
    assert not bugs.is_edited(code) and not harness.session.drafts.texts and not harness.bench.files.editing
    assert FILE.read_text(encoding="utf-8") == before


def test_error_in_copy_opens_copy_even_if_its_editor_was_closed(harness):
    harness.open(3)
    bug = block(harness, "quarter")
    harness.bench.files.open(FILE, here=True)  # the reader has the file itself open
    (own,) = harness.bench.files.editing
    harness.reader.bugs.break_it(bug)
    harness.run_frames(3)
    copy = harness.bench.files.editing[-1]
    harness.bench.files.open(FILE, 5, here=True)
    assert (copy.line, copy.focus) == (5, True) and not own.focus
    harness.bench.files.editing.remove(copy)
    harness.bench.files.open(FILE, 6)
    assert harness.bench.files.editing == [own, copy] and copy.line == 6
    harness.reader.bugs.fix_it(bug)
    harness.bench.files.open(FILE, 7, here=True)
    assert harness.bench.files.editing == [own] and own.line == 7


def test_what_was_typed_in_a_copy_and_not_saved_is_there_again(harness):
    harness.open(3)
    bug, code, bugs = block(harness, "quarter"), block(harness, "mean"), harness.reader.bugs
    bugs.break_it(bug)
    harness.run_frames(4)
    text_window(harness).replace_text_in_current_cursor("// mine\n")
    harness.run_frames(2)
    harness.reader.turn_page(1)
    harness.run_frames(3)
    assert not harness.bench.files.editing
    harness.reader.turn_page(-1)
    bugs.break_it(bug)
    harness.run_frames(3)
    assert "// mine" in text_window(harness).get_text()
    text_window(harness).replace_text_in_current_cursor("// more\n")
    harness.bench.files.editing.clear()  # its window is closed
    harness.run_frames(2)
    bugs.focus(bug)
    assert "// more" in text_window(harness).get_text()
    bugs.fix_it(bug)
    harness.run_frames(3)
    bugs.break_it(bug)
    harness.run_frames(3)
    assert "// mine" not in text_window(harness).get_text(), "the lesson's fix forgets what was typed"
    bugs.fix_it(bug)
    bugs.edit(code)
    harness.run_frames(3)
    text_window(harness).replace_text_in_current_cursor("// other\n")
    bugs.put_back(code)
    bugs.edit(code)
    harness.run_frames(3)
    assert "// other" not in text_window(harness).get_text(), "so does putting the file back"


def test_numbers_are_computed_at_idle_and_picture_stays(harness):
    harness.open(1)
    harness.run_frames(3)
    seen, runs = as_seen(harness), dict(harness.session.engine.runs)
    number = harness.reader.numbers.results["halving"]["peaks"]
    values = harness.session.engine.read(block(harness, "peaks").scene.sketch, "height")
    peaks = sum(
        values[y, x] == values[y - 1 : y + 2, x - 1 : x + 2].max() for y in range(1, 32) for x in range(1, 32)
    )
    assert number.value == peaks and 50 < peaks < 200
    assert harness.reader.numbers.fill("{{peaks}} peaks", harness.reader.lesson) == f"{peaks} peaks"
    assert runs, "what the panel counts is that of the picture"
    harness.session.redraw()
    harness.run_frames(2)
    np.testing.assert_array_equal(as_seen(harness), seen)


def test_opening_sketch_takes_stage_from_lesson(harness):
    harness.open()
    assert harness.reader.figure.before_lesson is not None
    harness.bench.actions.open(find("diamond_square_steps"))
    harness.run_frames(3)
    assert harness.reader.figure.before_lesson is None and harness.reader.figure.key is None


def test_a_lesson_is_read_on_in_french_where_it_was(harness):
    harness.open(1)
    harness.reader.set_language("fr")
    harness.run_frames(2)
    assert harness.reader.lesson.title == "Moitiés" and harness.reader.index == 1
    assert harness.reader.section.title == "Étape par étape"
    harness.reader.open("after")
    assert harness.reader.lesson.title == "After it"
    assert any("anglais" in notice.text for notice in harness.bench.notices.items)


def test_an_unknown_lesson_is_named_with_the_nearest(harness):
    assert not harness.reader.open("halvin")
    assert any("no lesson 'halvin'" in n.text and "halving" in n.text for n in harness.bench.notices.items)
    assert harness.reader.lesson is None and library.lesson_files() == ["after", "halving"]


class Silent:
    """A sandbox that never answers."""

    def submit(self, request: object) -> None:
        """Take a sketch, and forget it."""

    def poll(self) -> None:
        """Say nothing."""


def test_while_a_picture_is_tried_the_one_before_stays_as_it_was(harness):
    harness.open(show=False)
    harness.reader.show(block(harness, "rubble"))
    harness.run_frames(3)
    seen = as_seen(harness)
    harness.session.drafts.checks = replace(harness.session.drafts.checks, sandbox=Silent())
    harness.reader.go(1)
    harness.run_frames(3)
    assert harness.reader.figure.busy and harness.session.view.steps == {}
    np.testing.assert_array_equal(as_seen(harness), seen)
    harness.session.drafts.checks = replace(harness.session.drafts.checks, sandbox=None)
    harness.reader.show(block(harness, "halves"))
    harness.run_frames(3)
    assert not harness.reader.figure.busy and harness.session.view.steps == {"height.raw": 0, "phase": 0}

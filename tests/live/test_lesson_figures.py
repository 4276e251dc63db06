"""A lesson on the stage: what it shows, what it leaves alone, what comes back."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from playground.lessons import library
from playground.lessons.figure_renders import broken, draw
from playground.lessons.model import Break, Compare, Exercise, Figure, Scene, Slider, Steps
from playground.lessons.read import read_lesson
from playground.sketch.find import find
from playground.workbench.edits import Draft, Edits
from playground.workbench.framing import framed
from playground.workbench.lesson.bugs import BROKEN, FIXED, SHOWN
from playground.workbench.lesson.figure_state import edits_of, map_of, steps_of
from playground.workbench.lesson.links import play_on
from playground.workbench.lesson.reader import BOTH
from playground.workbench.resume import StoredEdits

from ..loading import load
from .lesson_desk import FILE, OWN, Desk, shelved, value


def block(desk: Desk, name: str):
    assert desk.reader.lesson is not None
    return desk.reader.lesson.named[name]


def text_window(desk: Desk):
    """Return the editor of the one file that is open."""
    (editing,) = desk.bench.files.editing
    return editing.view.editor


def as_seen(desk: Desk) -> np.ndarray:
    """Return the picture of the view as the engine draws it by itself, at the size of the view."""
    frame = desk.session.read()
    assert frame is not None
    return frame.array


def of_lesson(desk: Desk, scene: Scene) -> np.ndarray:
    """Return a picture as a book has it, at the size of the view, its aspect ratio unchanged."""
    seen = framed(scene.sketch, scene.time, scene.pixels, (48, 32))
    return draw(desk.session.engine, replace(scene, sketch=seen, pixels=(48, 32))).array


def scenes_of(lesson) -> list[Scene]:
    found = []
    for each in lesson.blocks:
        if isinstance(each, Figure | Exercise | Break) and each.scene:
            found.append(each.scene)
        elif isinstance(each, Steps | Slider | Compare):
            found += each.scenes
    return found


def test_what_is_set_for_a_picture_makes_the_very_sketch_of_the_lesson(tmp_path, monkeypatch):
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


def test_a_lesson_s_picture_keeps_its_sides_and_the_reader_s_own_those_of_any_picture(desk):
    desk.open(show=False)
    session = desk.bench.session
    scene = read_lesson("halving").named["rubble"].scene
    desk.reader.figure.show(replace(scene, pixels=(300, 300)), ("rubble", 0))
    assert session.view.framed_for == (300, 300)
    desk.reader.figure.go_back()
    assert session.view.framed_for == (1280, 720)


def test_every_picture_in_the_view_is_that_of_the_lesson(desk):
    desk.open(show=False)
    for page in range(5):
        desk.reader.go(page)
        for each in desk.reader.section.blocks:
            if not isinstance(each, Figure | Steps | Slider | Exercise) or not hasattr(each, "scene"):
                continue
            if each.scene is None:
                continue
            desk.reader.show(each)
            desk.run_frames(3)
            assert desk.session.error is None
            np.testing.assert_array_equal(as_seen(desk), of_lesson(desk, each.scene), err_msg=each.name)


def test_the_first_picture_waits_for_a_click_and_next_brings_the_one_after(desk):
    own = desk.session.path
    desk.open(show=False)
    assert desk.session.path == own and desk.reader.figure.before_lesson is None
    desk.reader.turn_page(1)
    desk.run_frames(4)
    assert desk.session.path == find("diamond_square_steps")
    assert desk.session.view.steps == {"height.raw": 0, "phase": 0}


def test_a_page_without_a_picture_shows_the_last_one_before_it_where_nothing_is_shown_yet(desk):
    desk.open(3)
    assert desk.reader.figure.key == ("seeds", 1) and value(desk, "height.seed") == 2
    desk.reader.show(block(desk, "rubble"))
    desk.run_frames(2)
    desk.reader.go(4)
    desk.run_frames(2)
    assert desk.reader.figure.key == ("rubble", 0), "what is shown stays"


def test_what_was_open_comes_back_with_its_values_and_its_undo(desk):
    own = desk.session.path
    desk.session.drafts.set("height.seed", 5)
    desk.run_frames(2)
    seen = as_seen(desk)
    desk.open(show=False)
    desk.reader.show(block(desk, "rubble"))
    desk.run_frames(3)
    assert desk.session.path == find("white_noise") and value(desk, "height.seed") == 3
    desk.reader.go(1)
    desk.run_frames(3)
    desk.reader.go_back()
    desk.run_frames(3)
    assert desk.session.path == own and value(desk, "height.seed") == 5
    np.testing.assert_array_equal(as_seen(desk), seen)
    desk.bench.undo.undo()
    assert not desk.session.shown.edits.values


def test_a_turned_page_does_not_take_a_sketch_that_has_been_changed_but_show_does(desk):
    own = desk.session.path
    desk.session.drafts.set("height.seed", 5)
    desk.run_frames(2)
    desk.open(show=False)
    desk.reader.turn_page(1)
    desk.run_frames(2)
    assert desk.session.path == own
    assert any("stays in view" in notice.text for notice in desk.bench.notices.items)
    desk.reader.show(block(desk, "halves"))
    desk.run_frames(2)
    assert desk.session.path != own


def test_what_a_reader_sets_in_a_picture_comes_back_by_undo_after_another_one(desk):
    desk.open()
    desk.session.drafts.set("height.seed", 77)
    desk.run_frames(60)
    desk.reader.go(1)  # another sketch
    desk.run_frames(4)
    desk.reader.show(block(desk, "rubble"))
    desk.run_frames(4)
    assert value(desk, "height.seed") == 3
    desk.bench.undo.undo()
    desk.run_frames(2)
    assert value(desk, "height.seed") == 77
    desk.reader.reset(block(desk, "rubble"))  # the same sketch
    desk.run_frames(60)
    assert value(desk, "height.seed") == 3
    desk.bench.undo.undo()
    desk.run_frames(2)
    assert value(desk, "height.seed") == 77


def test_what_is_compared_with_comes_back_with_what_was_open(desk):
    compare = desk.bench.inspection.compare
    desk.session.drafts.set("height.seed", 5)
    desk.run_frames(2)
    compare.keep()
    desk.session.drafts.set("height.seed", 6)
    desk.run_frames(2)
    desk.open(show=False)
    desk.reader.show(block(desk, "seeds"))
    desk.run_frames(4)
    desk.reader.go_back()
    desk.run_frames(4)
    assert value(desk, "height.seed") == 6
    assert compare.on, "A is there again"
    assert dict(compare.remembered().edits.values) == {"height.seed": 5}


def test_what_was_set_in_a_sketch_with_a_mistake_comes_back_once_it_is_fixed(desk):
    own = desk.session.path
    own.write_text(OWN.replace("white_noise", "white_noyse"), encoding="utf-8")
    desk.session.open(own, start=StoredEdits(Edits((("height.seed", 5),))))
    desk.run_frames(2)
    assert desk.session.error is not None and desk.session.drafts.opening
    desk.open(show=False)
    desk.reader.show(block(desk, "rubble"))
    desk.run_frames(3)
    assert value(desk, "height.seed") == 3
    desk.reader.go_back()
    desk.run_frames(3)
    own.write_text(OWN, encoding="utf-8")
    desk.session.drafts.reload()
    desk.run_frames(3)
    assert desk.session.error is None and value(desk, "height.seed") == 5


def test_what_the_files_came_to_say_during_a_lesson_goes_before_what_was_set_by_hand(desk):
    own = desk.session.path
    own.write_text(OWN.replace("[view]", "set = { seed = 2 }\n[view]"), encoding="utf-8")
    desk.session.drafts.reload()
    desk.run_frames(2)
    desk.session.drafts.set("height.seed", 5)
    desk.run_frames(2)
    desk.open(show=False)
    desk.reader.show(block(desk, "rubble"))
    desk.run_frames(3)
    own.write_text(OWN.replace("[view]", "set = { seed = 9 }\n[view]"), encoding="utf-8")
    desk.reader.go_back()
    desk.run_frames(3)
    assert desk.session.path == own and "height.seed" not in dict(desk.session.shown.edits.values)


def test_going_back_to_a_sketch_that_is_gone_says_so_and_can_be_requested_again(desk):
    own = desk.session.path
    desk.open(show=False)
    desk.reader.show(block(desk, "rubble"))
    desk.run_frames(3)
    own.rename(own.with_name("away.toml"))
    desk.reader.go_back()
    desk.run_frames(3)
    assert any("sketch.toml" in notice.text for notice in desk.bench.notices.items)
    assert desk.session.path == find("white_noise") and desk.session.error is None
    own.with_name("away.toml").rename(own)
    desk.reader.go_back()
    desk.run_frames(3)
    assert desk.session.path == own and desk.reader.figure.before_lesson is None


def test_a_copy_that_is_opened_leaves_the_readers_sketch_the_readers(desk):
    own = desk.session.path
    desk.open(3, show=False)
    desk.reader.bugs.edit(block(desk, "mean"))
    desk.run_frames(3)
    assert desk.session.drafts.texts and desk.reader.figure.before_lesson is None
    desk.session.drafts.set("height.seed", 7)
    desk.run_frames(3)
    assert dict(desk.autosave._latest.edits.values) == {"height.seed": 7}, "it is remembered"
    desk.reader.show(block(desk, "seeds"))
    desk.run_frames(4)
    desk.reader.go_back()
    desk.run_frames(3)
    assert desk.session.path == own and value(desk, "height.seed") == 7


def test_nothing_of_a_lesson_is_remembered_of_its_sketches(desk, tmp_path):
    desk.session.drafts.set("height.seed", 5)
    desk.run_frames(2)
    desk.open(show=False)
    desk.reader.show(block(desk, "rubble"))
    desk.run_frames(60)
    desk.session.drafts.set("height.seed", 8)
    desk.run_frames(60)
    desk.autosave.close()
    memories = [json.loads(file.read_text()) for file in (tmp_path / "state").rglob("sessions/*.json")]
    assert [(Path(one["sketch"]).parent.name, one["values"]["height.seed"]["value"]) for one in memories] == [
        ("own", 5)
    ]


def test_playing_on_opens_the_sketch_as_the_readers_own_with_what_was_set_there(desk):
    desk.session.open(find("white_noise"))
    desk.run_frames(2)
    desk.session.drafts.set("height.seed", 41)
    desk.run_frames(2)
    desk.autosave.look((800, 600))
    desk.autosave.write()
    desk.open(show=False)
    desk.reader.show(block(desk, "rubble"))
    desk.run_frames(2)
    assert value(desk, "height.seed") == 3
    play_on(desk.reader)
    desk.run_frames(3)
    assert desk.session.path == find("white_noise") and value(desk, "height.seed") == 41
    assert desk.reader.figure.before_lesson is None and desk.bench.interface.panel_shown


def test_a_dropped_sketch_leaves_the_figure_also_where_that_is_of_the_same_file(desk):
    desk.bench.commands.opens = desk.autosave.open
    desk.bench.commands.open(find("white_noise"))
    desk.run_frames(2)
    desk.session.drafts.set("height.seed", 41)
    desk.run_frames(2)
    desk.open(show=False)
    desk.reader.show(block(desk, "rubble"))
    desk.run_frames(3)
    assert desk.session.path == find("white_noise") and value(desk, "height.seed") == 3
    desk.drops.take([find("white_noise")])
    desk.run_frames(3)
    assert desk.reader.figure.before_lesson is None and desk.reader.figure.key is None
    assert value(desk, "height.seed") == 41
    desk.session.drafts.set("height.seed", 42)
    desk.run_frames(3)
    assert dict(desk.autosave._latest.edits.values) == {"height.seed": 42}, "it is remembered"


def test_playing_on_with_the_sketch_that_is_open_keeps_its_undo(desk):
    desk.bench.commands.open(find("white_noise"))
    desk.run_frames(2)
    desk.session.drafts.set("height.seed", 41)
    desk.run_frames(2)
    desk.open(show=False)
    play_on(desk.reader)
    desk.run_frames(3)
    assert value(desk, "height.seed") == 41
    desk.bench.undo.undo()
    desk.run_frames(2)
    assert not desk.session.shown.edits.values


def test_turns_are_stopped_at_and_played_to_the_last(desk):
    desk.open(1)
    repeated = block(desk, "halves")
    desk.reader.move(repeated, 2)
    desk.run_frames(2)
    assert desk.session.view.steps == {"height.raw": 2, "phase": 2}
    np.testing.assert_array_equal(as_seen(desk), of_lesson(desk, repeated.scenes[2]))
    desk.reader.play_or_pause(repeated)
    assert desk.reader.playing == "halves" and 0 < desk.reader.patience(desk.bench.notices.now()) <= 0.8
    desk.run_frames(60)
    assert not desk.reader.playing and desk.reader.at["halves"] == 3
    assert steps_of(repeated.scenes[3]) == {"height.raw": 4, "phase": 4}
    assert desk.session.view.steps == {"height.raw": 4, "phase": 4}


def test_a_sweep_plays_from_the_first_value_to_the_last(desk):
    desk.open(2)
    rough = block(desk, "rough")
    assert value(desk, "height.smoothing") == 0.0
    desk.reader.play_or_pause(rough)
    seen = []
    for _ in range(90):
        desk.run_frames()
        seen.append(value(desk, "height.smoothing"))
    assert list(dict.fromkeys(seen)) == [0.0, 0.5, 1.0] and not desk.reader.playing
    desk.reader.play_or_pause(rough)
    desk.run_frames(2)
    assert value(desk, "height.smoothing") == 0.0, "from the beginning again"


def test_two_variants_are_parted_by_the_line_of_the_view(desk):
    desk.open(2)
    seeds = block(desk, "seeds")
    desk.reader.choose(seeds, BOTH)
    desk.run_frames(4)
    compare = desk.bench.inspection.compare
    assert compare.on and value(desk, "height.seed") == 2
    second = as_seen(desk)  # in full, and the first with it
    desk.run_frames()
    rows = np.frombuffer(compare.picture.read(alignment=1), np.uint8).reshape(32, 48, 4)[::-1]
    np.testing.assert_array_equal(rows, of_lesson(desk, seeds.scenes[0]))
    np.testing.assert_array_equal(second, of_lesson(desk, seeds.scenes[1]))
    desk.reader.choose(seeds, 0)
    desk.run_frames(3)
    assert not compare.on and value(desk, "height.seed") == 1


def test_a_bug_is_drawn_and_fixed_and_the_file_stays_as_it_is(desk):
    before = FILE.read_bytes()
    desk.open(3)
    bug = block(desk, "quarter")
    desk.reader.show(bug)
    desk.reader.bugs.break_it(bug)
    desk.run_frames(4)
    assert desk.reader.bugs.state["quarter"] == BROKEN
    np.testing.assert_array_equal(as_seen(desk), of_lesson(desk, broken(bug)))
    assert [editing.text.path for editing in desk.bench.files.editing] == [FILE]
    text = desk.bench.files.editing[0].text
    assert ": 9.0)" in text.base
    text.save(text.base.replace(": 9.0)", ": 2.0)"))
    desk.run_frames(6)
    assert desk.reader.bugs.state["quarter"] == BROKEN, "another picture, but not the whole one"
    text.save(text.base.replace(": 2.0)", ": float(3))"))
    desk.run_frames(6)
    assert desk.reader.bugs.state["quarter"] == FIXED
    assert any("Fixed" in notice.text for notice in desk.bench.notices.items)
    np.testing.assert_array_equal(as_seen(desk), of_lesson(desk, bug.scene))
    desk.reader.bugs.break_it(bug)
    desk.run_frames(4)
    desk.reader.bugs.fix_it(bug)
    desk.run_frames(4)
    assert desk.reader.bugs.state["quarter"] == SHOWN and not desk.bench.files.editing
    assert not desk.session.drafts.texts
    np.testing.assert_array_equal(as_seen(desk), of_lesson(desk, bug.scene))
    assert FILE.read_bytes() == before


def test_a_bug_that_does_not_compile_says_so_and_leaves_the_stage_with_its_page(desk):
    desk.open(3)
    bug = block(desk, "quarter")
    desk.reader.bugs.break_it(bug)
    desk.run_frames(4)
    text = desk.bench.files.editing[0].text
    text.save(text.base.replace("total /", "totals /"))
    desk.run_frames(4)
    assert desk.session.error is not None and "raw.glsl" in str(desk.session.error)
    assert desk.reader.bugs.state["quarter"] == BROKEN
    desk.reader.turn_page(1)
    desk.run_frames(4)
    assert desk.session.error is None and not desk.session.drafts.texts and not desk.bench.files.editing
    desk.reader.turn_page(-1)
    desk.reader.bugs.break_it(bug)
    assert "totals /" in desk.bench.files.editing[0].text.base, "what was typed is there again"


def test_code_is_shown_as_the_copy_has_it_until_it_is_put_back(desk):
    before = FILE.read_text(encoding="utf-8")
    desk.open(3)
    code, bugs = block(desk, "mean"), desk.reader.bugs
    assert "float(2 * r)" in bugs.excerpt(code).text and not bugs.is_edited(code)
    bugs.edit(code)
    desk.run_frames(3)
    editing = desk.bench.files.editing[0]
    assert editing.text.base == before
    assert before.split("\n")[editing.line - 2].strip() == "// anchor: height"
    editing.text.save(before.replace("float(2 * r)", "float(3 * r)"))
    desk.run_frames(3)
    assert "float(3 * r)" in bugs.excerpt(code).text and bugs.is_edited(code)
    assert desk.session.drafts.texts == {str(FILE): editing.text.base}
    bugs.put_back(code)
    desk.run_frames(3)
    assert not bugs.is_edited(code) and not desk.session.drafts.texts and not desk.bench.files.editing
    assert FILE.read_text(encoding="utf-8") == before


def test_a_mistake_in_a_copy_is_edited_in_the_copy_also_where_its_window_was_closed(desk):
    desk.open(3)
    bug = block(desk, "quarter")
    desk.bench.files.open(FILE, here=True)  # the reader has the file itself open
    (own,) = desk.bench.files.editing
    desk.reader.bugs.break_it(bug)
    desk.run_frames(3)
    copy = desk.bench.files.editing[-1]
    desk.bench.files.open(FILE, 5, here=True)
    assert (copy.line, copy.focus) == (5, True) and not own.focus
    desk.bench.files.editing.remove(copy)
    desk.bench.files.open(FILE, 6)
    assert desk.bench.files.editing == [own, copy] and copy.line == 6
    desk.reader.bugs.fix_it(bug)
    desk.bench.files.open(FILE, 7, here=True)
    assert desk.bench.files.editing == [own] and own.line == 7


def test_what_was_typed_in_a_copy_and_not_saved_is_there_again(desk):
    desk.open(3)
    bug, code, bugs = block(desk, "quarter"), block(desk, "mean"), desk.reader.bugs
    bugs.break_it(bug)
    desk.run_frames(4)
    text_window(desk).replace_text_in_current_cursor("// mine\n")
    desk.run_frames(2)
    desk.reader.turn_page(1)
    desk.run_frames(3)
    assert not desk.bench.files.editing
    desk.reader.turn_page(-1)
    bugs.break_it(bug)
    desk.run_frames(3)
    assert "// mine" in text_window(desk).get_text()
    text_window(desk).replace_text_in_current_cursor("// more\n")
    desk.bench.files.editing.clear()  # its window is closed
    desk.run_frames(2)
    bugs.focus(bug)
    assert "// more" in text_window(desk).get_text()
    bugs.fix_it(bug)
    desk.run_frames(3)
    bugs.break_it(bug)
    desk.run_frames(3)
    assert "// mine" not in text_window(desk).get_text(), "the lesson's fix forgets what was typed"
    bugs.fix_it(bug)
    bugs.edit(code)
    desk.run_frames(3)
    text_window(desk).replace_text_in_current_cursor("// other\n")
    bugs.put_back(code)
    bugs.edit(code)
    desk.run_frames(3)
    assert "// other" not in text_window(desk).get_text(), "so does putting the file back"


def test_numbers_are_computed_while_nothing_moves_and_the_picture_stays(desk):
    desk.open(1)
    desk.run_frames(3)
    seen, runs = as_seen(desk), dict(desk.session.engine.runs)
    number = desk.reader.numbers.known["halving"]["peaks"]
    values = desk.session.engine.read(block(desk, "peaks").scene.sketch, "height")
    peaks = sum(
        values[y, x] == values[y - 1 : y + 2, x - 1 : x + 2].max() for y in range(1, 32) for x in range(1, 32)
    )
    assert number.value == peaks and 50 < peaks < 200
    assert desk.reader.numbers.fill("{{peaks}} peaks", desk.reader.lesson) == f"{peaks} peaks"
    assert runs, "what the panel counts is that of the picture"
    desk.session.redraw()
    desk.run_frames(2)
    np.testing.assert_array_equal(as_seen(desk), seen)


def test_opening_a_sketch_meanwhile_takes_the_stage_from_the_lesson(desk):
    desk.open()
    assert desk.reader.figure.before_lesson is not None
    desk.bench.commands.open(find("diamond_square_steps"))
    desk.run_frames(3)
    assert desk.reader.figure.before_lesson is None and desk.reader.figure.key is None


def test_a_lesson_is_read_on_in_french_where_it_was(desk):
    desk.open(1)
    desk.reader.speak("fr")
    desk.run_frames(2)
    assert desk.reader.lesson.title == "Moitiés" and desk.reader.index == 1
    assert desk.reader.section.title == "Étape par étape"
    desk.reader.open("after")
    assert desk.reader.lesson.title == "After it"
    assert any("anglais" in notice.text for notice in desk.bench.notices.items)


def test_an_unknown_lesson_is_named_with_the_nearest(desk):
    assert not desk.reader.open("halvin")
    assert any("no lesson 'halvin'" in n.text and "halving" in n.text for n in desk.bench.notices.items)
    assert desk.reader.lesson is None and library.lesson_files() == ["after", "halving"]


class Silent:
    """A sandbox that never answers."""

    def submit(self, request: object) -> None:
        """Take a sketch, and forget it."""

    def poll(self) -> None:
        """Say nothing."""


def test_while_a_picture_is_tried_the_one_before_stays_as_it_was(desk):
    desk.open(show=False)
    desk.reader.show(block(desk, "rubble"))
    desk.run_frames(3)
    seen = as_seen(desk)
    desk.session.drafts._checks = replace(desk.session.drafts._checks, sandbox=Silent())
    desk.reader.go(1)
    desk.run_frames(3)
    assert desk.reader.figure.busy and desk.session.view.steps == {}
    np.testing.assert_array_equal(as_seen(desk), seen)
    desk.session.drafts._checks = replace(desk.session.drafts._checks, sandbox=None)
    desk.reader.show(block(desk, "halves"))
    desk.run_frames(3)
    assert not desk.reader.figure.busy and desk.session.view.steps == {"height.raw": 0, "phase": 0}

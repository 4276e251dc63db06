"""The panel of lessons under a mouse and keys, without a screen."""

from __future__ import annotations

import json

import pytest
from imgui_bundle import ImVec2, imgui

from playground import cli
from playground.course.scenes import Sketches
from playground.course.window.panel import follow
from playground.errors import SketchError
from playground.sketch.find import find
from playground.studio.start.thumbnails import thumbnails

from .lesson_desk import FILE, value


def test_lesson_key_restores_last_page_and_toggles_panel(harness, tmp_path):
    harness.key(imgui.Key.f2)
    assert harness.reader.lesson is not None and not harness.bench.interface.panel_shown
    harness.key(imgui.Key.page_down)
    harness.run_frames(3)
    assert harness.reader.index == 1 and harness.session.path == find("diamond_square_steps")
    harness.key(imgui.Key.page_up)
    assert harness.reader.index == 0
    harness.key(imgui.Key.page_down)
    harness.key(imgui.Key.f2)
    assert not harness.reader.progress.shown and harness.bench.interface.panel_shown
    progress = json.loads((tmp_path / "state/terrain-shader-playground/lessons.json").read_text())
    assert (
        progress["lesson"] == "halving" and progress["sections"] == {"halving": 1} and not progress["shown"]
    )
    harness.key(imgui.Key.page_down)
    assert harness.reader.index == 1, "no page is turned that is not seen"


def test_buttons_turn_pages_and_go_to_the_next_lesson(harness):
    harness.open(show=False)
    for _ in range(4):
        harness.click("Next##next")
    assert harness.reader.index == 4 and harness.reader.progress.done == ["halving"]
    harness.click("Next lesson##next")
    assert harness.reader.lesson.name == "after"
    harness.reader.open("halving")
    harness.run_frames(2)
    assert harness.reader.index == 4, "where it was left"


def test_sliders_of_a_figure_act_on_the_session(harness):
    harness.open()
    harness.click("##height.seed", 0.5)
    assert value(harness, "height.seed") != 3
    harness.run_frames(2)
    harness.click("Reset")
    harness.run_frames(2)
    assert value(harness, "height.seed") == 3


def test_a_slider_over_iterations_stops_the_kernels(harness):
    harness.open(1)
    harness.drag("##steps", 0.05, 0.95)
    assert harness.reader.at["halves"] == 3 and harness.session.view.steps == {"height.raw": 4, "phase": 4}
    harness.click("<")
    assert harness.session.view.steps == {"height.raw": 2, "phase": 2}


def test_answer_waits_for_choice_and_solution_for_its_button(harness):
    harness.open(4)
    assert "Show the answer" in harness.places and "Hide it##answer" not in harness.places
    choices = [key for key in harness.places if key == "##choice"]
    assert choices
    harness.reader.chosen["which"] = 1
    harness.run_frames(2)
    assert "Show the answer" in harness.places
    harness.reader.chosen["which"] = 0
    harness.places.clear()
    harness.run_frames(2)
    assert "Show the answer" not in harness.places, "a right choice shows it"
    assert "Show its picture" not in harness.places
    harness.reader.shown.add(("guess", "solution"))
    harness.run_frames(2)
    harness.click("Show its picture")
    harness.run_frames(2)
    assert value(harness, "height.seed") == 9


def test_break_it_and_fix_it_are_buttons(harness):
    harness.open(3)
    assert "Fix it" not in harness.places
    harness.click("Break it")
    harness.run_frames(2)
    assert len(harness.bench.files.editing) == 1
    harness.click("Fix it")
    harness.run_frames(2)
    assert not harness.bench.files.editing and harness.reader.bugs.state["quarter"] == "shown"


@pytest.mark.slow
def test_a_bug_is_fixed_by_typing_in_the_copy(harness):
    before = FILE.read_bytes()
    harness.open(3)
    harness.click("Break it")
    harness.run_frames(3)
    (editing,) = harness.bench.files.editing
    lines = editing.text.base.split("\n")
    start = next(n for n, line in enumerate(lines) if line.startswith("float kernel("))
    wrong = next(n for n, line in enumerate(lines) if ": 9.0)" in line)
    for _ in range(wrong - start):
        harness.key(imgui.Key.down_arrow)
    harness.key(imgui.Key.end)
    for _ in range(len(lines[wrong]) - lines[wrong].index("9.0)")):
        harness.key(imgui.Key.left_arrow)
    harness.key(imgui.Key.delete)
    harness.type("3")
    harness.key(imgui.Key.mod_ctrl, imgui.Key.s)
    harness.run_frames(4)
    assert "4.0 : 3.0)" in editing.text.base
    assert harness.session.error is None
    assert harness.reader.bugs.state["quarter"] == "fixed"
    assert FILE.read_bytes() == before


def test_brackets_that_are_typed_stand_as_they_were_typed(harness):
    harness.open(3)
    harness.click("Break it")
    harness.run_frames(3)
    (editing,) = harness.bench.files.editing
    harness.key(imgui.Key.home)
    harness.type('(all(inside) ? a[0] : "b")')
    harness.run_frames(2)
    assert '(all(inside) ? a[0] : "b")float kernel(' in editing.view.editor.get_text()


def test_languages_are_buttons(harness):
    harness.open(1)
    harness.click("FR##fr")
    assert harness.reader.lesson.title == "Moitiés" and harness.reader.index == 1
    assert "Suivant##next" in harness.places
    harness.click("EN##en")
    assert harness.reader.lesson.title == "Halving"


def test_back_is_there_once_a_lesson_has_taken_the_stage(harness):
    harness.open(show=False)
    assert "Back to my sketch##back" not in harness.places
    harness.click("Show")
    harness.run_frames(3)
    assert harness.session.path == find("white_noise")
    harness.click("Back to my sketch##back")
    harness.run_frames(3)
    assert harness.session.path.parent.name == "own"


def test_links_lead_to_lessons_and_sketches(harness, monkeypatch):
    harness.open(show=False)
    opened: list[str] = []
    monkeypatch.setattr(
        "playground.course.window.panel.webbrowser.open",
        lambda address: bool(opened.append(address)) or True,
    )
    for address in (
        "https://doi.org/10.1145/358523.358553",
        "thesis:1.3.2",
        "term:texel",
        "lesson:after",
        "sketch:white_noise",
    ):
        follow(harness.reader, address)
        harness.run_frames(3)
    assert opened == ["https://doi.org/10.1145/358523.358553"]
    assert any("One element of a texture" in notice.text for notice in harness.bench.notices.items)
    assert any("section 1.3.2" in notice.text for notice in harness.bench.notices.items)
    assert harness.reader.lesson.name == "after" and harness.session.path == find("white_noise")
    assert harness.reader.figure.before_lesson is None, "it is the reader's own"


def test_a_narrow_window_makes_the_panel_no_narrower_for_good(harness):
    harness.open(show=False)
    before = harness.reader.progress.width
    imgui.get_io().display_size = ImVec2(500, 400)
    for scale in (1.0, 1.337, 0.691):
        harness.theme.rescale(scale)
        harness.run_frames(3)
        assert harness.reader.progress.width == before, scale


def test_every_page_is_drawn_in_both_languages_at_every_size(harness):
    for language in ("en", "fr"):
        for page in range(5):
            harness.reader.open("halving", language=language, page=page)
            harness.reader.shown |= {
                (name, what) for name in ("guess", "try") for what in ("hint", "solution")
            }
            harness.run_frames(3)
            right = harness.reader.progress.width
            for label, (x, _, wide, _) in harness.places.items():
                in_view = x >= right  # of the view's own
                assert in_view or (x >= 0 and x + wide <= right + 1), (language, page, label)
            harness.places.clear()


def test_lessons_are_read_only_when_they_are_opened(harness, monkeypatch):
    monkeypatch.setattr(Sketches, "load", lambda *_: pytest.fail("a sketch is loaded"))
    assert [summary.title for summary in harness.reader.summaries] == ["Halving", "After it"]


def test_bare_command_opens_window_with_the_start_page(monkeypatch):
    values: list[dict[str, object]] = []
    monkeypatch.setattr("playground.doctor.where_to_show", lambda *_: ":0")
    monkeypatch.setattr("playground.studio.commands.open_window", lambda *_, **rest: values.append(rest))
    assert cli.main([]) == 0
    assert values == [{}]


def test_a_lesson_begins_in_a_language_by_a_request_or_a_card(harness):
    harness.lessons.begin({})
    assert harness.reader.lesson is None, "no lesson opens by itself"
    halving, after = harness.lessons.start_cards()
    assert (halving.title, after.title) == ("Halving", "After it")
    assert after.act() and harness.reader.lesson.name == "after"
    harness.lessons.begin({"lesson": "halving", "language": "fr"})
    harness.run_frames(3)
    assert harness.reader.lesson.title == "Moitiés" and harness.session.path == find("white_noise")


def test_a_lesson_s_card_has_the_picture_of_its_hero_s_sketch(harness, monkeypatch):
    drawn = {"halving": "white_noise"}
    monkeypatch.setattr("playground.course.figures.hero_sketches", lambda: drawn)
    halving, after = harness.lessons.start_cards()
    place = next(row.cell for row in thumbnails() if row.name == "white_noise")
    assert (halving.cell, after.cell) == (place, -1) and place >= 0


def test_a_trace_is_stepped_through_and_its_question_checked(harness):
    harness.open(2)
    harness.run_frames(6)
    lines = harness.reader.numbers.traces["halving", "centre"]
    question = harness.reader.lesson.named["corners"]
    assert lines.answer(question).accepts("2.1")
    assert harness.reader.numbers.failed == {} and harness.reader.numbers.pending == []
    harness.click("##steps", 0.97)
    assert harness.reader.at["centre"] == 3
    for text, right in (("", None), ("2,2", False), ("2,1", True)):
        harness.reader.typed["corners"] = text
        harness.reader.check_number(question)
        harness.run_frames(2)
        assert harness.reader.checked["corners"] is right
        assert (("corners", "answer") in harness.reader.shown) == (right is True)
    harness.reader.open("halving", language="fr", page=2)
    harness.run_frames(3)
    assert "2,1" in harness.reader.numbers.fill("{{corners}}", harness.reader.lesson)


def test_a_trace_that_fails_says_why_and_leaves_the_rest(harness, monkeypatch):
    def failing(engine, lesson, traced_block):
        raise SketchError("no such texel")

    monkeypatch.setattr("playground.course.window.reader.traced", failing)
    harness.open(2)
    harness.run_frames(6)
    assert harness.reader.numbers.failed["halving", "centre"] == "no such texel"
    harness.reader.typed["corners"] = "2.1"
    harness.reader.check_number(harness.reader.lesson.named["corners"])
    assert "corners" not in harness.reader.checked, "there is nothing to compare with"

"""The panel of lessons under a mouse and keys, without a screen."""

from __future__ import annotations

import json

import pytest
from imgui_bundle import ImVec2, imgui

from playground import cli
from playground.lessons.scenes import Sketches
from playground.sketch.find import find
from playground.workbench.lesson.links import follow

from .lesson_desk import FILE, value


def test_a_key_brings_the_lessons_where_they_were_left_and_takes_them_away(desk, tmp_path):
    desk.key(imgui.Key.f2)
    assert desk.reader.lesson is not None and not desk.bench.interface.panel_shown
    desk.key(imgui.Key.page_down)
    desk.run_frames(3)
    assert desk.reader.index == 1 and desk.session.path == find("diamond_square_steps")
    desk.key(imgui.Key.page_up)
    assert desk.reader.index == 0
    desk.key(imgui.Key.page_down)
    desk.key(imgui.Key.f2)
    assert not desk.reader.progress.shown and desk.bench.interface.panel_shown
    progress = json.loads((tmp_path / "state/terrain-shader-playground/lessons.json").read_text())
    assert (
        progress["lesson"] == "halving" and progress["sections"] == {"halving": 1} and not progress["shown"]
    )
    desk.key(imgui.Key.page_down)
    assert desk.reader.index == 1, "no page is turned that is not seen"


def test_buttons_turn_pages_and_go_to_the_next_lesson(desk):
    desk.open(show=False)
    for _ in range(4):
        desk.click("Next##next")
    assert desk.reader.index == 4 and desk.reader.progress.done == ["halving"]
    desk.click("Next lesson##next")
    assert desk.reader.lesson.name == "after"
    desk.reader.open("halving")
    desk.run_frames(2)
    assert desk.reader.index == 4, "where it was left"


def test_sliders_of_a_figure_act_on_the_session(desk):
    desk.open()
    desk.click("##height.seed", 0.5)
    assert value(desk, "height.seed") != 3
    desk.run_frames(2)
    desk.click("Reset")
    desk.run_frames(2)
    assert value(desk, "height.seed") == 3


def test_a_slider_over_iterations_stops_the_kernels(desk):
    desk.open(1)
    desk.drag("##steps", 0.05, 0.95)
    assert desk.reader.at["halves"] == 3 and desk.session.view.steps == {"height.raw": 4, "phase": 4}
    desk.click("<")
    assert desk.session.view.steps == {"height.raw": 2, "phase": 2}


def test_an_answer_waits_for_a_choice_and_a_solution_for_its_button(desk):
    desk.open(4)
    assert "Show the answer" in desk.places and "Hide it##answer" not in desk.places
    choices = [key for key in desk.places if key == "##choice"]
    assert choices
    desk.reader.chosen["which"] = 1
    desk.run_frames(2)
    assert "Show the answer" in desk.places
    desk.reader.chosen["which"] = 0
    desk.places.clear()
    desk.run_frames(2)
    assert "Show the answer" not in desk.places, "a right choice shows it"
    assert "Show its picture" not in desk.places
    desk.reader.shown.add(("guess", "solution"))
    desk.run_frames(2)
    desk.click("Show its picture")
    desk.run_frames(2)
    assert value(desk, "height.seed") == 9


def test_break_it_and_fix_it_are_buttons(desk):
    desk.open(3)
    assert "Fix it" not in desk.places
    desk.click("Break it")
    desk.run_frames(2)
    assert len(desk.bench.files.editing) == 1
    desk.click("Fix it")
    desk.run_frames(2)
    assert not desk.bench.files.editing and desk.reader.bugs.state["quarter"] == "shown"


@pytest.mark.slow
def test_a_bug_is_fixed_by_typing_in_the_copy(desk):
    before = FILE.read_bytes()
    desk.open(3)
    desk.click("Break it")
    desk.run_frames(3)
    (editing,) = desk.bench.files.editing
    lines = editing.text.base.split("\n")
    start = next(n for n, line in enumerate(lines) if line.startswith("float kernel("))
    wrong = next(n for n, line in enumerate(lines) if ": 9.0)" in line)
    for _ in range(wrong - start):
        desk.key(imgui.Key.down_arrow)
    desk.key(imgui.Key.end)
    for _ in range(len(lines[wrong]) - lines[wrong].index("9.0)")):
        desk.key(imgui.Key.left_arrow)
    desk.key(imgui.Key.delete)
    desk.type("3")
    desk.key(imgui.Key.mod_ctrl, imgui.Key.s)
    desk.run_frames(4)
    assert "4.0 : 3.0)" in editing.text.base
    assert desk.session.error is None
    assert desk.reader.bugs.state["quarter"] == "fixed"
    assert FILE.read_bytes() == before


def test_brackets_that_are_typed_stand_as_they_were_typed(desk):
    desk.open(3)
    desk.click("Break it")
    desk.run_frames(3)
    (editing,) = desk.bench.files.editing
    desk.key(imgui.Key.home)
    desk.type('(all(inside) ? a[0] : "b")')
    desk.run_frames(2)
    assert '(all(inside) ? a[0] : "b")float kernel(' in editing.view.editor.get_text()


def test_languages_are_buttons(desk):
    desk.open(1)
    desk.click("FR##fr")
    assert desk.reader.lesson.title == "Moitiés" and desk.reader.index == 1
    assert "Suivant##next" in desk.places
    desk.click("EN##en")
    assert desk.reader.lesson.title == "Halving"


def test_back_is_there_once_a_lesson_has_taken_the_stage(desk):
    desk.open(show=False)
    assert "Back to my sketch##back" not in desk.places
    desk.click("Show")
    desk.run_frames(3)
    assert desk.session.path == find("white_noise")
    desk.click("Back to my sketch##back")
    desk.run_frames(3)
    assert desk.session.path.parent.name == "own"


def test_links_lead_to_lessons_and_sketches(desk, monkeypatch):
    desk.open(show=False)
    opened: list[str] = []
    monkeypatch.setattr(
        "playground.workbench.lesson.links.webbrowser.open",
        lambda address: bool(opened.append(address)) or True,
    )
    for address in (
        "https://doi.org/10.1145/358523.358553",
        "thesis:1.3.2",
        "term:texel",
        "lesson:after",
        "sketch:white_noise",
    ):
        follow(desk.reader, address)
        desk.run_frames(3)
    assert opened == ["https://doi.org/10.1145/358523.358553"]
    assert any("One element of a texture" in notice.text for notice in desk.bench.notices.items)
    assert any("section 1.3.2" in notice.text for notice in desk.bench.notices.items)
    assert desk.reader.lesson.name == "after" and desk.session.path == find("white_noise")
    assert desk.reader.figure.before_lesson is None, "it is the reader's own"


def test_a_narrow_window_makes_the_panel_no_narrower_for_good(desk):
    desk.open(show=False)
    before = desk.reader.progress.width
    imgui.get_io().display_size = ImVec2(500, 400)
    desk.run_frames(3)
    assert desk.reader.progress.width == before


def test_every_page_is_drawn_in_both_languages_at_every_size(desk):
    for language in ("en", "fr"):
        for page in range(5):
            desk.reader.open("halving", language=language, page=page)
            desk.reader.shown |= {(name, what) for name in ("guess", "try") for what in ("hint", "solution")}
            desk.run_frames(3)
            right = desk.reader.progress.width
            for label, (x, _, wide, _) in desk.places.items():
                in_view = x >= right  # of the view's own
                assert in_view or (x >= 0 and x + wide <= right + 1), (language, page, label)
            desk.places.clear()


def test_lessons_are_read_only_when_they_are_opened(desk, monkeypatch):
    monkeypatch.setattr(Sketches, "load", lambda *_: pytest.fail("a sketch is loaded"))
    assert [one.title for one in desk.reader.summaries] == ["Halving", "After it"]


def test_the_command_without_arguments_shows_lessons_in_its_window(monkeypatch):
    given: list[dict[str, object]] = []
    monkeypatch.setattr("playground.doctor.where_to_show", lambda *_: ":0")
    monkeypatch.setattr(cli.live, "open_window", lambda *_, **rest: given.append(rest))
    assert cli.main([]) == 0
    assert given == [{"show_lessons": True}]


@pytest.mark.parametrize("shown", [True, False])
def test_lessons_next_to_a_sketch_open_where_they_were_left_unless_they_were_closed(desk, shown):
    desk.reader.progress.lesson, desk.reader.progress.shown = "after", shown
    assert desk.lessons is not None
    desk.lessons.begin("", "", show_lessons=True)
    assert desk.reader.figure.before_lesson is None, "the sketch stays in view"
    assert (desk.reader.lesson.name if desk.reader.lesson else "") == ("after" if shown else "")
    desk.lessons.begin("halving", "fr", show_lessons=False)
    desk.run_frames(3)
    assert desk.reader.lesson.title == "Moitiés" and desk.session.path == find("white_noise")

"""Traces in lessons: values stand beside their lines, questions take their answers from them."""

from __future__ import annotations

import json
import zipfile
from dataclasses import replace
from itertools import count

import pytest

from playground.cli import main
from playground.course.book.html import LessonContext, block_html, traced_code, traced_steps
from playground.course.grading import grade as grading
from playground.course.library import labels
from playground.course.measures import filled, named_in
from playground.course.model import Asked, Question, Trace
from playground.course.notebook.lesson import NotebookLesson
from playground.course.rules import broken_rules, wrong_pictures
from playground.course.talk.beats import beats_of
from playground.course.traces import Answer, lines_of, number_in, numbers_in, numbers_of_traces, results_of
from playground.engine.trace.model import Call, Event
from playground.engine.trace.model import Trace as TexelTrace
from playground.errors import SketchError
from playground.paths import GLSL
from playground.shader.source import read_text

FILE = "generation/fbm/sum.glsl"
BLOCK = Trace(1, "", "octaves", None, "raw", (3, 5), file=FILE, anchor="sum", loop="k", rows=(0, 1, 3))
BLOCK = replace(BLOCK, variables=("strength", "total"))
NOISES = (0.5, -0.25, 0.125, 1.0)


def handmade(noises=NOISES, gain=0.5):
    """What a run of the kernel gives, written by hand: total and strength are summed here in Python."""
    path, source = str(GLSL / FILE), read_text(GLSL / FILE).split("\n")

    def line(text):
        return next(number for number, code in enumerate(source, 1) if text in code)

    call = Call(0, "kernel", path, line("float kernel("), line("return total") + 1, None, 0)
    events, loop, numbers = call.events, line("for (int k"), count()

    def add(kind, name, value, text, iteration=None, type_="float"):
        inside = iteration is not None
        event = Event(
            next(numbers), kind, name, type_, value, path, line(text), 5, 9, 0,
            (iteration,) if inside else (), (loop,) if inside else (), line(text), (loop,) if inside else (),
        )  # fmt: skip
        events.append(event)

    add("enter", "kernel", None, "float kernel(", type_="")
    add("argument", "texel", (3, 5), "float kernel(", type_="ivec2")
    add("set", "gain", gain, "float gain")
    total, strength = 0.0, 1.0
    add("set", "strength", strength, "float strength")
    add("set", "total", total, "float total")
    for k, noise in enumerate(noises):
        add("iteration", "k", k, "for (int k", k, "int")
        total += strength * noise
        add("set", "total", total, "total +=", k)
        strength *= gain
        add("set", "strength", strength, "strength *=", k)
    add("return", "kernel", total, "return total")
    return TexelTrace(
        "raw", (3, 5), (), {}, {}, True, [call], list(events), True, len(events), ("kernel",), ("perlin",),
        {path: tuple(source)},
    )  # fmt: skip


def asking(variable, step=None):
    return Question(7, "", "far", of=Asked("octaves", variable, step), points=1, ask="?", answer="!")


def beside(lines, code):
    return next(line for line in lines.lines if code in line.code).values


def test_values_stand_beside_the_line_that_set_them():
    lines = lines_of(handmade(), BLOCK)
    (total,) = beside(lines, "total +=")
    assert total.is_looped and total.texts == ("0.5", "0.375", "0.4062", "0.5312")
    assert total.text(1) == "total = 0.375" and total.on_paper(lines.rows) == "total = 0.5 | 0.375 | 0.5312"
    assert [value.text(2) for value in beside(lines, "float gain")] == ["gain = 0.5"]
    assert [value.text(0) for value in beside(lines, "return")] == ["→ 0.5312"]
    source = read_text(GLSL / FILE).split("\n")
    assert all(source[line.number - 1].endswith(line.code) for line in lines.lines)
    assert "total += strength" in lines.text() and "│ total = 0.5 |" in lines.text()


def test_a_table_has_a_row_for_each_step_named():
    lines = lines_of(handmade(), BLOCK)
    assert [lines.label(row) for row in lines.rows] == ["k = 0", "k = 1", "k = 3"]
    assert [[lines.cell(name, row) for name in lines.columns] for row in lines.rows] == [
        ["0.5", "0.5"],
        ["0.25", "0.375"],
        ["0.0625", "0.5312"],
    ]
    assert lines.markdown().split("\n")[-1] == "| 3 | 0.0625 | 0.5312 |"


def test_what_a_question_asks_for_is_nowhere_in_the_figure():
    lines = lines_of(handmade(), BLOCK, {("total", 3): "far"})
    (total,) = beside(lines, "total +=")
    assert total.text(3) == "total = ?" and total.text(3, reveals=True) == "total = 0.5312"
    assert lines.cell("total", 3) == "?" and lines.cell("strength", 3) == "0.0625"
    assert total.on_paper(lines.rows) == "total = 0.5 | 0.375 | ?"


def test_an_answer_is_the_value_to_the_digits_of_the_figure():
    answer = lines_of(handmade(), BLOCK).answer(asking("total", 1))
    assert (answer.value, answer.text, answer.tolerance) == (0.375, "0.375", pytest.approx(1e-4))
    assert all(answer.accepts(text) for text in ("0.375", " 0,3751", ".3749", "+0.375", "3.75e-1"))
    assert not any(answer.accepts(text) for text in ("0.3752", "0.37", "", "nan", "0.375 m", "3/8", "inf"))
    follows = lines_of(handmade((0.5, 0.75)), replace(BLOCK, rows=(0, 1)))
    assert follows.answer(asking("total", 1)).value == 0.875  # another run, another answer
    assert lines_of(handmade(), BLOCK).answer(asking("texel.y")) == Answer(5, "5", 0.0)


def test_signs_and_blanks_of_a_number_are_those_of_any_keyboard():
    assert number_in("−1 234,5") == -1234.5 and number_in("1\u202f000") == 1000.0
    assert number_in("1.2.3") is None and number_in("1e999999") is None and number_in("0x10") is None


def test_numbers_that_a_text_may_name():
    numbers = numbers_in(lines_of(handmade(), BLOCK))
    assert numbers["octaves:total:1"].text == "0.375" and numbers["octaves:gain"].value == 0.5
    assert (
        numbers_in(lines_of(handmade((-0.5,)), replace(BLOCK, rows=(0,))))["octaves:total:0"].text == "−0.5"
    )
    assert "octaves:texel" not in numbers


def test_nested_and_missing_iterations_have_no_value():
    """A line that did not run in a step has nothing beside it there."""
    trace = handmade()
    call = trace.calls[0]
    call.events[:] = [e for e in call.events if not (e.name == "strength" and e.iterations == (2,))]
    lines = lines_of(trace, replace(BLOCK, rows=(2,)))
    assert beside(lines, "strength *=")[0].texts[2] == "" and lines.cell("strength", 2) == ""


@pytest.mark.parametrize(
    "change, words",
    [
        ({"function": "perln"}, ("does not call 'perln'", "perlin")),
        ({"call": 2}, ("call = 2", "once")),
        ({"loop": "q"}, ("no loop over 'q'", "k")),
        ({"variables": ("totl",)}, ("'totl'", "total")),
        ({"rows": (9,)}, ("no step 9", "0 to 3")),
        ({"anchor": "summ"}, ("'summ'", "sum")),
        ({"file": "generation/diamond_square/raw.glsl", "anchor": "height"}, ("fbm/sum.glsl", "raw.glsl")),
    ],
)
def test_what_a_block_names_and_the_run_has_not(change, words):
    with pytest.raises(SketchError) as error:
        lines_of(handmade(), replace(BLOCK, **change))
    assert all(word in str(error.value) for word in ("octaves", *words))


@pytest.mark.parametrize(
    "variable, step, words",
    [
        ("totl", 1, ("'totl'", "total")),
        ("total", 7, ("step 7", "0 to 3")),
        ("gain", 2, ("no steps",)),
        ("k", None, ("each step", "0 to 3")),
        ("texel", None, ("texel.x",)),
        ("kernel", 1, ("'kernel'",)),
    ],
)
def test_what_a_question_asks_for_and_the_trace_has_not(variable, step, words):
    with pytest.raises(SketchError) as error:
        lines_of(handmade(), BLOCK).answer(asking(variable, step))
    assert error.value.diagnostics[0].line == 7
    assert all(word in str(error.value) for word in ("far", "octaves", *words))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"is_complete": False, "count": 70000}, ("70000",)),
        ({"texel_values": {"h": (0.5,)}, "outputs": {"h": (0.501,)}}, ("0.501", "0.5", "fewer digits")),
    ],
)
def test_a_run_that_is_not_the_texel_s_is_refused(change, words):
    with pytest.raises(SketchError) as error:
        lines_of(replace(handmade(), **change), BLOCK)
    assert all(word in str(error.value) for word in ("octaves", *words))
    last_bits = {"texel_values": {"h": (0.5,)}, "outputs": {"h": (0.50000006,)}}
    assert lines_of(replace(handmade(), **last_bits), BLOCK).steps == (0, 1, 2, 3)


def test_an_answer_that_is_not_finite_is_refused():
    with pytest.raises(SketchError, match="nobody can compute"):
        lines_of(handmade((float("nan"),)), replace(BLOCK, rows=(0,))).answer(asking("total", 0))


# ── in each medium ───────────────────────────────────────────────────────────


def test_the_engine_s_trace_sums_the_corners_that_are_given(lesson, engine):
    """The kernel's centre is the mean of four corners that the lesson's sketch sets: 0.2, 0.9, 0.6, 0.4."""
    results = results_of(engine, lesson)
    answer = results.answers["corners"]
    assert answer.accepts("2.1") and not answer.accepts("2.102") and results.numbers["corners"].text == "2.1"
    assert results.numbers["height:count:3"].value == 4
    assert results.traces["height"].steps == (0, 1, 2, 3)


def test_the_answer_follows_what_the_lesson_sets(make_lesson, engine):
    corners = 'iteration = 1\nset = { "height.corners" = [0.5, 0.5, 0.5, 0.5] }'
    assert results_of(engine, make_lesson(("iteration = 1", corners))).answers["corners"].value == 2.0


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("[2, 2]\niteration", "[9, 2]\niteration", ("trace 'height'", "texel", "4")),
        ("iteration = 1", "iteration = 9", ("trace 'height'", "iteration", "5")),
        ('loop      = "i"', 'loop = "j"', ("no loop over 'j'", "i")),
        ('variables = ["total", "count"]', 'variables = ["totl"]', ("'totl'", "did you mean 'total'")),
        ("rows      = [0, 1, 2, 3]", "rows = [0, 4]", ("no step 4", "0 to 3")),
        ('variable = "total"', 'variable = "totall"', ("question 'corners'", "did you mean 'total'")),
        ("step     = 3", "step = 5", ("question 'corners'", "step 5", "0 to 3")),
        ("height:count:3", "height:cuont:3", ("height:cuont:3", "did you mean 'height:count:3'")),
    ],
)
def test_a_check_names_what_the_run_has_not(make_lesson, engine, before, after, words):
    wrong = [sentence for _, sentence in wrong_pictures(engine, make_lesson((before, after)))]
    assert len(wrong) == 1 and all(word in wrong[0] for word in words), wrong


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ('trace    = "height"', 'trace = "hieght"', ("question 'corners'", "did you mean 'height'")),
        ("{{height:count:3}}", "{{hight:count:3}}", ("no trace 'hight'", "did you mean 'height'")),
        ('anchor    = "height"', 'anchor = "heigt"', ("no anchor 'heigt'", "did you mean 'height'")),
    ],
)
def test_a_rule_names_what_the_text_has_not(make_lesson, before, after, words):
    wrong = [sentence for _, sentence in broken_rules(make_lesson((before, after)))]
    assert any(all(word in sentence for word in words) for sentence in wrong), wrong


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ('pass      = "height.raw"', 'pass = "height.row"', ("no pass 'height.row'", "height.raw")),
        ("texel     = [2, 2]", "texel = [2]", ("texel = [2]", "[column, row]")),
        ("iteration = 1", 'iteration = "last"', ("iteration", "from 0")),
        ("rows      = [0, 1, 2, 3]", "rows = [0.5]", ("rows", "whole numbers")),
        ('loop      = "i"', "", ("variables", "loop")),
        ("rows      = [0, 1, 2, 3]\n", "", ("rows",)),
        ("iteration = 1", "steps = { \"height.raw\" = 1 }", ("steps",)),
        ("points   = 2", "points = 0", ("points", "1 to 100")),
        ('trace    = "height"\n', "", ("variable", "trace")),
        ("points   = 2", 'choices = ["a"]\nright = 0', ("choices", "number")),
    ],
)  # fmt: skip
def test_a_block_that_cannot_be_read(make_lesson, before, after, words):
    with pytest.raises(SketchError) as error:
        make_lesson((before, after))
    assert error.value.diagnostics[0].line and all(word in str(error.value) for word in words)


def test_an_answer_is_in_no_text_that_comes_before_it(lesson, engine):
    """2.1 stands neither in the hand-out's page nor beside the code nor in a notebook's figure."""
    results = results_of(engine, lesson)
    lines = results.traces["height"]
    shown = [lines.text(), lines.markdown()]
    shown += [each.text(step) for line in lines.lines for each in line.values for step in range(4)]
    assert not any("2.1" in text for text in shown)
    html = traced_code(lines, labels("book", "en")) + traced_steps(lines, labels("book", "en"))
    assert "2.1" not in html and html.count("data-asked") == 2


@pytest.mark.parametrize("answers", ["none", "end", "inline"])
def test_a_page_without_answers_has_none_in_its_figure(lesson, engine, answers):
    setting = LessonContext(
        lesson, labels("book", "en"), results_of(engine, lesson), str, lambda link: {}, answers=answers
    )
    html = "".join(block_html(lesson.named[name], setting) for name in ("height", "corners"))
    assert ("2.1" in html) == ("data-full" in html) == (answers != "none")
    assert "?" in html and ("data-value" in html) == (answers != "none")


def test_a_presentation_has_the_code_then_the_table(lesson, engine):
    beats = [beat for beat in beats_of(lesson) if "raw.glsl" in beat.label]
    assert [beat.kind for beat in beats] == ["code", "board"]
    assert "total" in beats[0].code.text
    numbers = numbers_of_traces(engine, lesson, named_in(beats[1].board))
    assert filled(beats[1].board, numbers, "en").split("\n")[-1] == "| 3 | ? | 4 |"


def test_a_notebook_checks_a_number(lesson, monkeypatch, engine):
    monkeypatch.setattr("playground.course.notebook.lesson.on_engine", lambda task: task(engine))
    notebook = NotebookLesson(lesson)
    assert notebook.answer("corners", 2.1) == "Right: 2.1."
    assert "Not this number" in notebook.answer("corners", "2,2")
    assert "Write a number" in notebook.answer("corners", "")
    html = notebook.trace("height")._repr_html_()
    assert 'type="range"' in html and "total = ?" in html and "2.1" not in html
    assert "│" in str(notebook.trace("height"))
    with pytest.raises(SketchError, match="no trace"):
        notebook.trace("mean")
    with pytest.raises(SketchError, match="asks for no number"):
        notebook.answer("count", 25)


class Silent:
    """A parent that is told nothing."""

    def report(self, progress):
        pass


@pytest.fixture
def judged(any_engine, monkeypatch):
    """Return the mark of the text of a file, in a language, for the shipped question about the march."""
    monkeypatch.setattr(grading, "open_engine", lambda **choice: any_engine)

    def mark(text, language="en"):
        service = grading.open_service(Silent(), grading.Options(("shadows",), language))
        return service.answer(grading.Request("shadows-third-step", text))

    return mark


@pytest.mark.parametrize(
    ("text", "points", "word"),
    [
        (None, 1.0, "right"),
        ("Shadows\n\nnumber: 128.6\n", 1.0, "right"),
        ("number:128,6 ", 1.0, "right"),
        ("number: 1\nNumber: 128.7\r\n", 1.0, "right"),
        ("nombre: 128,6", 1.0, "right"),
        ("number: 120", 0.0, "128.6"),
        ("number:", 0.0, "no number"),
        ("128.6", 0.0, "no number"),
        ("number: <b>" + "9" * 9000, 0.0, "no number"),
    ],
)
def test_a_number_that_was_handed_in_is_graded(judged, text, points, word):
    mark = judged(text)
    assert (
        (mark.points, mark.of) == (points, 1) and word in mark.sentences[0] and len(mark.sentences[0]) < 200
    )


def test_a_french_report_has_commas(judged):
    assert "128,6" in judged("number: 3", "fr").sentences[0]


@pytest.mark.slow
def test_a_question_is_handed_out_and_comes_back_graded(tmp_path, capsys):
    zipped = tmp_path / "week.zip"
    assert main(["lesson", "handout", "shadows", "-o", str(zipped)]) == 0
    with zipfile.ZipFile(zipped) as archive:
        archive.extractall(tmp_path / "class" / "Ana")
        page = archive.read("week/exercises.html").decode()
    assert "128.6" not in page and "Your" not in page.split("<main>")[0]
    assert page.index("terrain &gt; ray") < page.index("shadows-third-step.txt")
    assert "march.foot" not in page  # of the model answer of an exercise
    (file,) = (tmp_path / "class").rglob("shadows-third-step.txt")
    text = file.read_text("utf-8")
    file.write_text(text.replace("number: ", "number: 128.6"), "utf-8")
    capsys.readouterr()
    assert main(["lesson", "grade", str(tmp_path / "class"), "-o", str(tmp_path / "report"), "--json"]) == 0
    marks = json.loads(capsys.readouterr().out)[0]["exercises"]
    assert marks["shadows-third-step"]["points"] == 1 and marks["shadows-write-march"]["points"] == 0


def test_the_terminal_prints_code_values_and_table(capsys):
    assert main(["lesson", "trace", "shadows", "march"]) == 0
    out = capsys.readouterr().out
    assert "ray = 42.87 | 85.74 | ? |" in out and "3\t?\t0\tfalse\n" in out and "128.6" not in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("shadows mrch", ("no trace 'mrch'", "did you mean 'march'")),
        ("flight", ("flight", "no trace")),
        ("shadws", ("no lesson 'shadws'", "shadows")),
    ],
)
def test_the_terminal_refuses_a_trace_that_is_not_there(arguments, words, capsys):
    assert main(["lesson", "trace", *arguments.split()]) == 2
    error = capsys.readouterr().err
    assert all(word in error for word in words)

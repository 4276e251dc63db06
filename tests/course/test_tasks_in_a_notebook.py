"""Exercises in a notebook: a starter in a cell, a verdict, an endless loop that costs only its points."""

from __future__ import annotations

import json

import pytest

from playground.course.judging import JudgeProcess
from playground.course.notebook import lesson as notebook_lesson
from playground.course.notebook.build import notebook_text
from playground.course.notebook.lesson import NotebookLesson
from playground.course.tasks import Work, answer, starter_text
from playground.errors import SketchError

from .test_tasks import CHALLENGE, FORMULA, KERNEL, RAW, VALUES, _starters, task

__all__ = ["_starters", "task"]


@pytest.fixture(scope="module")
def process():
    with JudgeProcess(limit_seconds=3.0, software=True) as judge_process:
        yield judge_process


@pytest.fixture
def opened(task, engine, process, monkeypatch):
    monkeypatch.setattr(notebook_lesson, "on_engine", lambda work: work(engine))
    monkeypatch.setattr(notebook_lesson, "_judge", lambda: process)
    return lambda *value: NotebookLesson(task(*value).lesson)


@pytest.mark.slow
def test_verdict_shows_points_marks_and_no_hidden_pictures(opened):
    lesson = opened(KERNEL)
    checked = lesson.check("third", RAW.replace(FORMULA, "number * smoothing"))
    assert str(checked).split("\n")[0] == "0 of 3 points"
    assert [line[0] for line in checked.lines] == ["✗", "✗", "✗"]
    html = checked._repr_html_()
    assert "<code>height</code> differs" in html
    assert html.count("<img") == 3 and "yours" in html and "what differs" in html  # of one check
    right = lesson.check("third", RAW)
    assert str(right).startswith("3 of 3 points\n✓ ") and "<img" not in right._repr_html_()


@pytest.mark.slow
def test_values_are_checked_and_a_picture_is_matched(opened):
    values = opened(VALUES)
    assert values.check("third", {"height.smoothing": 0.6}).verdict.passed
    with pytest.raises(SketchError, match="asks for values"):
        values.check("third", "float")
    challenge = opened(CHALLENGE, "challenge")
    near, far = (challenge.match("third", {"height.smoothing": value}) for value in (0.58, 0.2))
    assert 80.0 < near.match.score < 100.0 and far.match.score < near.match.score
    assert far.best == near.match.score and "<img" in far._repr_html_()
    assert "Solved." in str(challenge.match("third", {"height.smoothing": 0.6}))
    assert (
        "is no number" in str(challenge.match("third", {"height.smoothing": "no"}).match.diagnostics) or True
    )
    with pytest.raises(SketchError, match=r"lesson\.match"):
        challenge.check("third", {})
    with pytest.raises(SketchError, match="does not check itself"):
        challenge.exercise("first")


def test_the_cells_hold_the_starter_and_the_check(task, opened):
    lesson = task(KERNEL).lesson
    text = notebook_text(lesson, {})
    code = ["".join(cell["source"]) for cell in json.loads(text)["cells"] if cell["cell_type"] == "code"]
    asked = []
    fake = type("L", (), {"check": lambda self, *value: asked.append(value)})()
    (cell,) = [item for item in code if item.startswith('lesson.check("third"')]
    exec(cell, {"lesson": fake})
    assert asked == [("third", "\n" + starter_text(lesson.named["third"]))]
    assert 'lesson.exercise("third")' in code
    values = notebook_text(task(VALUES).lesson, {})
    assert "{'height.smoothing': 0.5}" in values


def test_a_term_is_bold(task):
    assert "**[texel](#Glossary" in notebook_text(task(VALUES).lesson, {}).replace("\\", "")


@pytest.mark.slow
def test_an_endless_loop_ends_and_the_next_work_is_judged(task, process):
    block = task(KERNEL, "exercise", ("points = 3", "points = 3\nset = { size = 257 }")).block
    loop = "for (int i = 0; i < 65000; i++) x = fract(sin(x) * 43758.5);"  # no more steps run in software
    endless = RAW.replace(
        "    float total = 0.0;", f"    float x = smoothing; {loop * 60}\n    float total = 0.0;"
    ).replace("float total = 0.0;", "float total = x * 1.0e-30;")
    verdict = process.check(block, Work(endless))
    assert verdict.points == 0.0 and "took longer than 3 s" in verdict.diagnostics[0].message
    assert [result.passed for result in process.check(block, answer(block)).results[:2]] == [True, True]

"""Exercises that check themselves: the format, the judge, those who try to fool it; in a notebook as well."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from playground.course import tasks as task_module
from playground.course.judging import JudgeProcess
from playground.course.library import labels
from playground.course.measures import MEASURES
from playground.course.model import Check
from playground.course.notebook import lesson as notebook_lesson
from playground.course.notebook.build import notebook_text
from playground.course.notebook.lesson import NotebookLesson
from playground.course.rules import wrong_pictures
from playground.course.tasks import (
    LEVELS,
    SHARE,
    Wanted,
    Work,
    answer,
    answers,
    compare,
    judge,
    points_of,
    scene_of,
    score,
    sentences,
    share_differing,
    starter,
    starter_text,
    tasks_of,
)
from playground.course.traces import results_of
from playground.errors import SketchError
from playground.paths import GLSL
from playground.shader.source import read_text

FILE = "generation/diamond_square/raw.glsl"
RAW = read_text(GLSL / FILE)
FORMULA = "number * share * smoothing"
STATE = 'sketch = "diamond_square_steps"\npixels = [96, 96]\nalt = "Discs."'
KERNEL = f"""
{STATE}
file   = "{FILE}"
start  = "small/start.glsl"
points = 3

[[check]]

[[check]]
of        = "height"
tolerance = 0.0001
at        = {{ "height.seed" = 5 }}
hidden    = true

[[check]]
what    = "spread"
between = [0.81, 0.83]
"""
VALUES = f"""
{STATE}
set     = {{ "height.smoothing" = 0.6 }}
sliders = ["height.smoothing"]

[[check]]
at     = {{ "height.seed" = 9 }}
hidden = true
"""
CHALLENGE = f"""
{STATE}
set     = {{ "height.smoothing" = 0.6 }}
begin   = {{ "height.smoothing" = 0.1 }}
sliders = ["height.smoothing"]
"""


@pytest.fixture(autouse=True)
def _starters(tmp_path, monkeypatch):
    """Put starters into a folder of the test's own."""
    folder = tmp_path / "exercises"
    (folder / "small").mkdir(parents=True)
    (folder / "small/start.glsl").write_text(RAW.replace(FORMULA, "0.0"), encoding="utf-8")
    monkeypatch.setattr(task_module, "EXERCISES", folder)
    monkeypatch.setattr("playground.course.fences.EXERCISES", folder)


@pytest.fixture
def task(make_lesson):
    """Read a block in the place of the small lesson's last exercise."""
    last = '```exercise third\nask      = "Change."\nsolution = "So."\n'

    def read(body, kind="exercise", *changes):
        for before, after in changes:
            assert before in body
            body = body.replace(before, after)
        extra = 'solution = "So."\n' if kind == "exercise" else ""
        head = f'```{kind} third\nask = "Change."\n{extra}'
        lesson = make_lesson((last, f"{head}{body}"))
        return SimpleNamespace(lesson=lesson, block=lesson.named["third"])

    return read


@pytest.mark.parametrize(
    ("body", "before", "after", "sentence"),
    [
        (KERNEL, FILE, "generation/diamond_square/rww.glsl", "not in glsl/; did you mean 'generation/diam"),
        (KERNEL, FILE, "generation/white_noise.glsl", "sketch diamond_square_steps does not use it"),
        (KERNEL, "small/start.glsl", "small/strat.glsl", "did you mean 'small/start.glsl'?"),
        (KERNEL, "small/start.glsl", "../small/start.glsl", "not in course/exercises/"),
        (KERNEL, 'start  = "small/start.glsl"\n', "", "give its start, its answer, or both"),
        (KERNEL, f'file   = "{FILE}"\n', "", "of which kernel?"),
        (KERNEL, 'of        = "height"', 'of = "hieght"', "did you mean 'height'?"),
        (KERNEL, "tolerance = 0.0001\n", "", "a check of 'height' needs tolerance"),
        (KERNEL, "tolerance = 0.0001", "tolerance = -1.0", "tolerance = -1.0: expected 0 or more"),
        (KERNEL, 'at        = { "height.seed" = 5 }\n', "", "hidden = true: give at"),
        (KERNEL, '"height.seed" = 5', '"height.sed" = 5', "did you mean 'height.seed'?"),
        (KERNEL, '"height.seed" = 5', '"height.seed" = -5', "height.seed = -5"),
        (KERNEL, "between = [0.81, 0.83]", "", "a measure needs between"),
        (KERNEL, '"spread"', '"spraed"', "there is no such measure; did you mean 'spread'?"),
        (KERNEL, "points = 3", "points = 0", "points = 0: expected 1 to 100"),
        (
            KERNEL,
            "[[check]]\n\n[[check]]\nof",
            "[[check]]\ntolerance = 2.0\n\n[[check]]\nof",
            "a fraction of",
        ),
        (KERNEL, 'sketch = "diamond_square_steps"\n', "", 'needs sketch = "…"'),
        (
            VALUES,
            'sliders = ["height.smoothing"]',
            'sliders = ["height.seed"]',
            "the answer sets no height.seed",
        ),
        (VALUES, '{ "height.seed" = 9 }', '{ "height.smoothing" = 0.9 }', "is what the student sets"),
        (VALUES, 'sliders = ["height.smoothing"]', "", 'give file = "…" or sliders = ["…"]'),
    ],
)
def test_what_is_wrong_in_an_exercise_is_said_in_one_sentence(task, body, before, after, sentence):
    with pytest.raises(SketchError) as raised:
        task(body, "exercise", (before, after))
    (result,) = raised.value.diagnostics
    assert sentence in result.message and result.line


@pytest.mark.parametrize(
    ("before", "after", "sentence"),
    [
        ('begin   = { "height.smoothing"', 'begin = { "height.seed"', "'height.seed' is none of the sliders"),
        ("begin ", "goal = 101\nbegin ", "goal = 101: expected a score, 1 to 100"),
        ('sliders = ["height.smoothing"]', "", 'give file = "…" or sliders = ["…"]'),
    ],
)
def test_what_is_wrong_in_a_challenge_is_said_in_one_sentence(task, before, after, sentence):
    body = CHALLENGE.replace("0.1", "0").replace("= 0 ", "= 0.1 ")
    with pytest.raises(SketchError, match=re.escape(sentence)):
        task(body, "challenge", (before, after))


def test_an_exercise_without_work_is_as_before(make_lesson):
    lesson = make_lesson()
    assert [task.name for task in tasks_of(lesson)] == ["corners"] and lesson.named["first"].points == 0


@pytest.mark.parametrize("body", [KERNEL, VALUES])
def test_the_answer_has_all_points_and_the_starter_none(task, engine, body):
    block = task(body).block
    expected = answers(engine, block)
    assert judge(engine, block, answer(block), expected).passed
    assert judge(engine, block, starter(block), expected).points == 0.0
    assert judge(engine, block, Work()).points == 0.0


def test_the_rules_prove_a_task(task, engine):
    def sentence(body, *changes):
        return [s for _, s in wrong_pictures(engine, task(body, "exercise", *changes).lesson)]

    assert sentence(KERNEL) == sentence(VALUES) == []
    (result,) = sentence(KERNEL, ("[0.81, 0.83]", "[0.0, 2.0]"))
    assert result == "exercise 'third': check 3: the starter passes it already"
    (result,) = sentence(KERNEL, ("[0.81, 0.83]", "[2.0, 3.0]"))
    assert "the model answer fails: Spread from lowest to highest of `height` is 0.8" in result
    (result,) = sentence(KERNEL, ("tolerance = 0.0001", "tolerance = 0.9"), ("0.81", "0.82"))[:1]
    assert result == "exercise 'third': check 2: the starter passes it already"
    (result,) = sentence(KERNEL, ('"height.seed" = 5', '"height.seed" = 7821'))
    assert "check 2: at its values all is as at those that are shown" in result


def test_the_rules_prove_a_challenge(task, engine):
    assert list(wrong_pictures(engine, task(CHALLENGE, "challenge").lesson)) == []
    same = task(CHALLENGE, "challenge", ('smoothing" = 0.1', 'smoothing" = 0.6')).lesson
    (result,) = [sentence for _, sentence in wrong_pictures(engine, same)]
    assert "the picture to begin from is the one to match" in result


# ── those who try to fool it, and those who err ──────────────────────────────


def results(engine, block, text):
    verdict = judge(engine, block, Work(text))
    return verdict, sentences(verdict, "en")


def test_kernel_fitted_to_shown_values_fails_hidden_values(task, engine):
    shown_only = RAW.replace(FORMULA, "number * (seed == 7821u ? share : 1.0) * smoothing")
    verdict, said = results(engine, task(KERNEL).block, shown_only)
    assert [result.passed for result in verdict.results] == [True, False, True]
    assert verdict.points == 2.0
    assert said[1].startswith("At other values, which are not shown: `height` differs by up to 0.")
    assert "5" not in said[1].partition(":")[0]  # not at which


def test_what_a_hidden_check_shows_is_no_picture(task, engine):
    verdict, _ = results(engine, task(KERNEL).block, RAW.replace(FORMULA, "0.0"))
    assert [result.check.hidden for result in verdict.visible] == [False, False]


def test_text_with_error_gets_verdict_with_compiler_message(task, engine):
    verdict, said = results(engine, task(KERNEL).block, RAW.replace(FORMULA, "number * shair"))
    assert verdict.points == 0.0 and not verdict.results
    line = next(n for n, text in enumerate(RAW.split("\n"), 1) if FORMULA in text)
    assert verdict.diagnostics[0].line == line and "shair" in said[0]


@pytest.mark.parametrize("text", ["", "void main() {}", "\x00", "#pragma kernel(", RAW[:900]])
def test_a_text_that_is_no_kernel_is_a_verdict(task, engine, text):
    verdict, said = results(engine, task(KERNEL).block, text)
    assert verdict.points == 0.0 and len(said) >= 1


def test_a_parameter_that_is_gone_is_named(task, engine):
    renamed = re.sub(r"\bsmoothing\b", "rough", RAW)
    _, said = results(engine, task(KERNEL).block, renamed)
    assert said == ["the kernel has no parameter 'smoothing', which is set here"]


def test_a_value_that_is_refused_is_not_told_where_it_is_hidden(task, engine):
    text = RAW.replace(
        "uniform uint seed = 7u;         //! slider(0, 9999)", "uniform uint seed = 7u; //! slider(6, 9999)"
    )
    assert text != RAW
    verdict, said = results(engine, task(KERNEL).block, text)
    assert [result.passed for result in verdict.results] == [True, False, True]
    assert said[1].endswith("this cannot be drawn: a parameter does not take its value.")


def test_a_slider_of_ones_own_is_welcome(task, engine):
    own = RAW.replace(
        "uniform uint seed", "uniform float mine = 1.0; //! slider(0, 2) Mine\nuniform uint seed"
    )
    verdict, _ = results(engine, task(KERNEL).block, own.replace(FORMULA, f"mine * {FORMULA}"))
    assert verdict.passed


@pytest.mark.parametrize("value", ["0.0 / (number - number)", "1.0 / (share - share)"])
def test_numbers_that_are_none_differ(task, engine, value):
    verdict, said = results(engine, task(KERNEL).block, RAW.replace(FORMULA, value))
    assert verdict.points == 0.0
    assert re.match(r"At other values.*: `height` has \d+ texels that are not finite", said[1])


def test_a_measure_without_a_value_is_said_so(task, engine):
    flat = re.sub(r"(kernel\([^)]*\)\s*\{)", r"\1 return 0.5;", RAW)
    assert flat != RAW
    block = task(KERNEL, "exercise", ('"spread"', '"edge_match"')).block
    verdict, said = results(engine, block, flat)
    assert not verdict.results[2].passed and not verdict.results[2].mistake
    assert said[2].endswith("of `height` has no value for this texture.")
    assert sentences(verdict, "fr")[2].endswith("de `height` n’a pas de valeur pour cette texture.")


def test_a_measure_is_of_the_scenes_own_pixels(task, engine, monkeypatch):
    seen = []

    def measured(engine, measure):
        seen.append(measure.scene.pixels)
        return SimpleNamespace(value=0.82)

    monkeypatch.setattr("playground.course.tasks.measured", measured)
    block = task(KERNEL, "exercise", ("[96, 96]", "[480, 270]")).block
    verdict, _ = results(engine, block, RAW)
    assert verdict.results[2].passed and seen == [(480, 270)]


def test_a_texture_of_another_size_differs():
    check = Check(0.1, of="height")
    first, other = (Wanted(texture=np.zeros(shape, np.float32)) for shape in ((5, 5), (5, 5, 4)))
    result = compare(check, first, other)
    assert not result.passed and result.sizes == ((5, 5, 1), (5, 5, 4))


@pytest.mark.parametrize(
    ("expected", "mine", "greys"),
    [(0.5, 0.25, (128, 64)), (0.0, 1.0, (0, 255)), (300.0, 150.0, (255, 128)), (-1.0, 0.0, (0, 128))],
)
def test_constant_texture_is_shown_as_its_value(expected, mine, greys):
    first, other = (Wanted(texture=np.full((5, 5), value, np.float32)) for value in (expected, mine))
    result = compare(Check(0.1, of="height"), other, first)
    assert (np.unique(result.expected).tolist(), np.unique(result.mine).tolist()) == ([greys[0]], [greys[1]])


def test_values_that_are_not_asked_for_are_named(task, engine):
    block = task(VALUES).block
    verdict = judge(engine, block, Work(values={"height.sede": 4}))
    assert "'height.sede' is not set in this task" in sentences(verdict, "en")[0]
    verdict = judge(engine, block, Work(values={"height.smoothing": 7.0}))
    assert verdict.points == 0.0 and "height.smoothing" in sentences(verdict, "en")[0]
    assert judge(engine, block, Work(values={"height.smoothing": 0.6})).passed


def test_a_kernels_author_sets_no_values(task, engine):
    """Values of an exercise that is a kernel are the exercise's: nobody turns a difference off."""
    block = task(KERNEL, "exercise", ("points = 3", 'points = 3\nsliders = ["height.smoothing"]')).block
    quiet = scene_of(block, Work(RAW.replace(FORMULA, "0.0"), {"height.smoothing": 0.0}))
    assert dict(quiet.sketch.overrides) == dict(block.scene.sketch.overrides)


# ── comparing ────────────────────────────────────────────────────────────────


def test_pictures_are_compared_as_in_the_browser():
    code = (GLSL.parent / "playground/publish/web/runtime/work_check.js").read_text(encoding="utf-8")
    assert f"LEVELS = {LEVELS};" in code and f"SHARE = {SHARE};" in code
    first = np.full((50, 20, 3), 100, np.uint8)
    other = first.copy()
    other[:] += np.uint8(LEVELS)
    assert share_differing(first, other) == 0.0
    other[3, 4, 1] += 1
    assert share_differing(first, other) == 1 / 1000
    assert share_differing(first, first[:40]) == 1.0


@pytest.mark.parametrize(
    ("rows", "columns", "position"),
    [
        (slice(0, 9), slice(0, 9), "top-left"),
        (slice(0, 9), slice(0, 30), "top"),
        (slice(0, 30), slice(21, 30), "right"),
        (slice(12, 18), slice(12, 18), "middle"),
        (slice(0, 30), slice(0, 30), ""),
    ],
)
def test_where_a_picture_differs(rows, columns, position):
    expected = np.full((30, 30, 3), 90, np.uint8)
    mine = expected.copy()
    mine[rows, columns] = 10
    result = compare(Check(SHARE), Wanted(mine), Wanted(expected))
    assert result.region == position and result.bias < 0
    # A texture's first row is the south's.
    up = compare(
        Check(1.0, of="x"), *(Wanted(texture=p[::-1, :, 0].astype(np.float32)) for p in (mine, expected))
    )
    assert up.region == position


def test_score_is_linear_from_start_to_target_picture():
    target, begin = np.full((9, 16, 3), 200, np.uint8), np.full((9, 16, 3), 100, np.uint8)
    for level, expected in ((200, 100.0), (100, 0.0), (150, 50.0), (175, 75.0), (20, 0.0), (250, 50.0)):
        assert score(target, begin, np.full_like(target, level)) == pytest.approx(expected)
    with pytest.raises(ValueError, match="one size"):
        score(target, begin, target[:4])


@pytest.mark.slow
def test_both_languages_say_all(task, engine):
    assert {f"measure_{name}" for name in MEASURES} <= labels("tasks", "en").keys()
    block = task(KERNEL).block
    verdict, _ = results(engine, block, RAW.replace(FORMULA, "0.0"))
    said = sentences(verdict, "fr")
    assert "0,0001" in said[1] and "." not in said[1].replace("`", "")[:-1]
    assert points_of(replace(verdict, points=1.5), "fr") == "1,5 point sur 3"
    assert points_of(replace(verdict, points=2.0), "fr") == "2 points sur 3"
    assert points_of(replace(verdict, points=1.0, of=2), "en") == "1 of 2 points"


# ── in a notebook ─────────────────────────────────────────────────────────────


__all__ = ["_starters", "task"]


@pytest.fixture(scope="module")
def process():
    with JudgeProcess(limit_seconds=3.0, software=True) as judge_process:
        yield judge_process


@pytest.fixture
def opened(task, engine, process, monkeypatch):
    monkeypatch.setattr(notebook_lesson, "on_engine", lambda work: work(engine))
    monkeypatch.setattr(notebook_lesson, "judge_process", lambda: process)
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


def test_the_cells_hold_the_starter_and_the_check(task, opened, engine):
    lesson = task(KERNEL).lesson
    text = notebook_text(lesson, results_of(engine, lesson))
    code = ["".join(cell["source"]) for cell in json.loads(text)["cells"] if cell["cell_type"] == "code"]
    asked = []
    fake = type("L", (), {"check": lambda self, *value: asked.append(value)})()
    (cell,) = [item for item in code if item.startswith('lesson.check("third"')]
    exec(cell, {"lesson": fake})
    assert asked == [("third", "\n" + starter_text(lesson.named["third"]))]
    assert 'lesson.exercise("third")' in code
    lesson = task(VALUES).lesson
    values = notebook_text(lesson, results_of(engine, lesson))
    assert "{'height.smoothing': 0.5}" in values


def test_a_term_is_bold(task, engine):
    lesson = task(VALUES).lesson
    assert "**[texel](#Glossary" in notebook_text(lesson, results_of(engine, lesson)).replace("\\", "")


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

"""The course: what its file may hold, and how long its lessons take."""

from __future__ import annotations

import pytest

from playground.course import library
from playground.course.document import read_document
from playground.course.library import number_of, parts
from playground.course.read import summaries, times_of, words_in
from playground.course.rules import broken_rules
from playground.errors import SketchError

PART = '[[part]]\ntitle = { en = "All", fr = "Tout" }\nlessons = ["second", "first"]\n'


@pytest.fixture
def course(tmp_path, write_lesson, monkeypatch):
    """Write a course of two lessons, its file with a text replaced."""
    (tmp_path / "texts/en").mkdir(parents=True)
    for name in ("first", "second"):
        (tmp_path / f"texts/en/{name}.md").write_bytes(write_lesson().read_bytes())
    monkeypatch.setattr(library, "TEXTS", tmp_path / "texts")

    def write(before="", after=""):
        assert before in PART
        (tmp_path / "course.toml").write_text(PART.replace(before, after) if before else PART)

    return write


def test_a_lessons_number_is_its_place(course):
    course()
    assert [(summary.number, summary.name, summary.part) for summary in summaries("fr")] == [
        (0, "second", "Tout"),
        (1, "first", "Tout"),
    ]
    assert [number_of(name) for name in ("second", "first", "elsewhere")] == [0, 1, 2]


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ('"second"', '"secnd"', "no lesson 'secnd'; did you mean 'second'?"),
        ('"second"', "3", "no lesson 3"),
        ('"second"', '"first"', "lesson 'first' is in the course twice"),
        ('"second", ', "", "in no part of the course: second"),
        (', fr = "Tout"', "", "a part of the course has a title in 'fr'"),
        ("lessons", "lesons", "no key 'lesons' here; did you mean 'lessons'?"),
    ],
)
def test_a_mistake_in_it_is_a_sentence_with_a_line(course, before, after, words):
    course(before, after)
    with pytest.raises(SketchError, match=r"course.toml(:[123])?: ") as caught:
        parts()
    assert words.replace("'", "") in str(caught.value).replace("'", "").replace('"', "")


def test_lesson_time_adds_words_and_blocks(write_lesson):
    """Counted by hand: two figures' worth of pictures, two series, a code, a question, a bug."""
    before = times_of(read_document(write_lesson()))
    seconds = 15 + 30 + 30 + 15 + 30 + 120 + 30  # figure, step, slider, compare, code, break, question
    assert 60 * before.reading - seconds <= 60 + 60 * 100 / 200  # hardly 100 words
    longer = write_lesson(("A picture first.", "word " * 400))
    assert times_of(read_document(longer)).reading == before.reading + 2
    exercise = ('ask      = "Predict."', 'ask      = "' + "word " * 200 + '"')
    assert times_of(read_document(write_lesson(exercise))).exercises == before.exercises + 1 == 14
    kernel = ('ask      = "Predict."', 'ask = "Predict."\nfile = "x.glsl"')
    assert times_of(read_document(write_lesson(kernel))).exercises == before.exercises + 2


def test_what_is_no_word_takes_no_time():
    assert words_in("## Two words") == 2
    assert words_in(r"A [linked word](term:texel) and $\frac{a + b}{2}$, `code` — and so on.") == 9
    assert words_in("| a | b |\n|---|---|\n| c | d |") == 4


def test_a_lesson_that_takes_too_long_breaks_a_rule(make_lesson):
    long = make_lesson(("Exercises", "word " * 1800))
    assert any(f"reading takes {long.minutes} minutes; at most 12" in text for _, text in broken_rules(long))

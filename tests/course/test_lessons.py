"""The lessons that ship: there are all of them, in both languages, and they keep their promises."""

from __future__ import annotations

import re

import pytest

from playground.course.glossary import terms_of
from playground.course.library import LANGUAGES, SOURCE, TEXTS, lesson_files, lesson_names
from playground.course.measures import Number, filled
from playground.course.model import Break, Prose
from playground.course.read import read_lesson, read_lessons, status_of, summaries
from playground.course.rules import MAX_MINUTES, broken_rules, wrong_pictures
from playground.course.scenes import bug_region, pictures_of, with_bug
from playground.paths import GLSL
from playground.shader.source import read_text

from .conftest import SKETCHES

NAMES = [summary.name for summary in summaries()]


@pytest.fixture(scope="module", params=NAMES)
def shipped(request):
    return {language: read_lesson(request.param, language, SKETCHES) for language in LANGUAGES}


@pytest.mark.slow
def test_they_are_numbered_in_the_order_of_the_course():
    assert [summary.number for summary in summaries()] == list(range(len(NAMES))) and len(NAMES) >= 12
    assert NAMES == lesson_names() and sorted(NAMES) == lesson_files()
    assert [lesson.title for lesson in read_lessons("fr")] == [summary.title for summary in summaries("fr")]


def test_french_has_no_break_space_before_signs_thin_in_numbers():
    """No line begins with a sign: before ; : ! ? and » stands U+00A0, and « has it after itself."""
    lessons = list((TEXTS / "fr").glob("*.md"))
    assert len(lessons) == len(NAMES)
    wrong = [
        f"{path.name}:{number}: {result[0]!r}"
        for path in [*lessons, *TEXTS.parent.rglob("*fr.toml")]
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        for result in re.finditer(
            r".?(?:[ \u202f][;:!?»](?!\S)|«[ \u202f]|(?<!\d)\u202f|\u202f(?!\d)).?", line
        )
        if not re.search(r"`[^`]*$", line[: result.start() + 1])  # code is as it is typed
    ]
    assert not wrong


def test_none_takes_longer_than_it_may():
    assert [summary.name for summary in summaries() if summary.minutes > MAX_MINUTES] == []


def test_no_translation_is_stale_or_without_a_lesson():
    for language in LANGUAGES:
        if language != SOURCE:
            assert [path.stem for path in sorted((TEXTS / language).glob("*.md"))] == lesson_files()
            states = {name: status_of(name, language).state for name in NAMES}
            assert states == dict.fromkeys(NAMES, "current")


def test_each_keeps_to_the_rules(shipped):
    for language, lesson in shipped.items():
        texts = [text for _, text in broken_rules(lesson)]
        assert [text for text in texts if not text.startswith("reading takes")] == [], language


def test_french_is_set_as_french_is(shipped):
    """A no-break space before ; : ? ! and within quotation marks; code and formulas aside."""
    for words in shipped["fr"].texts():
        text = re.sub(r"`[^`]*`|\$[^$]*\$|\]\([^)]*\)|https://\S+", "", words)
        wrong = re.findall(r"[^\n]{0,20}(?:(?<=\w) [;:?!»]|« )[^\n]{0,10}", text)
        assert not wrong, wrong


def test_a_translation_says_as_much(shipped):
    """Paragraph by paragraph: none is left in English, none is a line where there were ten."""
    for english, french in zip(shipped["en"].blocks, shipped["fr"].blocks, strict=True):
        if isinstance(english, Prose) and english.kind == "paragraph" and len(english.markdown) > 80:
            assert isinstance(french, Prose)
            assert french.markdown != english.markdown
            assert 0.6 < len(french.markdown) / len(english.markdown) < 2.0, french.markdown[:80]


def test_its_terms_are_linked_in_every_language(shipped):
    linked = {language: {term.key for term in terms_of(lesson)} for language, lesson in shipped.items()}
    assert len(linked["en"]) >= 3 and linked["fr"] == linked["en"]


def test_the_names_of_its_pictures_are_its_own(shipped):
    names = [picture.name for picture in pictures_of(shipped["en"])]
    assert len(names) == len(set(names)) and names


def test_the_fixed_lines_of_every_bug_restore_its_shader(shipped):
    """The lines that a lesson shows as the fix, put back into its file, make the shipped text again."""
    for block in shipped["en"].blocks:
        if isinstance(block, Break):
            result = bug_region(block)
            shipped_text = read_text(GLSL / block.file)
            assert code_of(result.with_lines(result.correct)) == code_of(shipped_text), block.name
            assert code_of(result.with_lines(result.broken)) == code_of(with_bug(block)), block.name


def code_of(text):
    """Return the lines of a shader that are code."""
    return [line.strip() for line in text.split("\n") if line.strip() and not line.strip().startswith("//")]


@pytest.mark.slow
def test_bugs_are_visible_and_claims_hold(shipped, engine):
    assert list(wrong_pictures(engine, shipped["en"])) == []


def test_every_number_is_in_its_sentence(shipped):
    """What each is does not matter here: the test above computes all of them."""
    numbers = {measure.name: Number(1.0, "1") for measure in shipped["en"].measures}
    for language, lesson in shipped.items():
        for words in lesson.texts():
            assert "…" not in filled(words, numbers, language) or "…" in words

"""The course: its file, its glossary, the pictures at the heads of its lessons, how long they take."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from playground.course import library
from playground.course.document import read_document
from playground.course.figures import hero_of
from playground.course.glossary import alphabetical, linked_term, terms, terms_in
from playground.course.library import LANGUAGES, lesson_names, number_of, parts
from playground.course.read import summaries, times_of, words_in
from playground.course.rules import broken_rules
from playground.course.scenes import Sketches
from playground.course.site import glossary
from playground.course.tasks import EXERCISES
from playground.engine.engine import Engine
from playground.errors import SketchError
from playground.paths import SKETCHES
from playground.sketch.load import load
from playground.sketch.templates import make_sketch

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
    """Counted by hand: two figures' worth of pictures, two series, a code, a trace, a question, a bug."""
    before = times_of(read_document(write_lesson()))
    # Figure, step, slider, compare, code, trace, break, question; one for a number is an exercise.
    seconds = 15 + 30 + 30 + 15 + 30 + 30 + 120 + 30
    assert 60 * before.reading - seconds <= 60 + 60 * 100 / 200  # hardly 100 words
    longer = write_lesson(("A picture first.", "word " * 400))
    assert times_of(read_document(longer)).reading == before.reading + 2
    exercise = ('ask      = "Predict."', 'ask      = "' + "word " * 200 + '"')
    assert times_of(read_document(write_lesson(exercise))).exercises == before.exercises + 1 == 15
    kernel = ('ask      = "Predict."', 'ask = "Predict."\nfile = "x.glsl"')
    assert times_of(read_document(write_lesson(kernel))).exercises == before.exercises + 2


def test_what_is_no_word_takes_no_time():
    assert words_in("## Two words") == 2
    assert words_in(r"A [linked word](term:texel) and $\frac{a + b}{2}$, `code` — and so on.") == 9
    assert words_in("| a | b |\n|---|---|\n| c | d |") == 4


def test_a_lesson_that_takes_too_long_breaks_a_rule(make_lesson):
    long = make_lesson(("Exercises", "word " * 1800))
    assert any(f"reading takes {long.minutes} minutes; at most 12" in text for _, text in broken_rules(long))


# ── glossary ──────────────────────────────────────────────────────────────────


def test_terms_are_found_by_the_links_of_a_text():
    assert linked_term("term:texel") is terms()["texel"]
    assert linked_term("term:texl") is None and linked_term("lesson:texel") is None
    text = "A [mesh](term:mesh) of [texels](term:texel), `[mip](term:mip_level)`."
    assert [term.key for term in terms_in(text, "[again](term:mesh) [x](term:none)")] == ["mesh", "texel"]


def test_a_definition_names_the_term_in_its_language():
    term = terms()["mesh"]
    assert term.definition("en") == "mesh: Triangles that are drawn in perspective."
    assert term.definition("fr") == "maillage\u00a0: Des triangles dessinés en perspective."


def test_accents_do_not_count_in_the_alphabet():
    names = [term.names["fr"][0] for term in alphabetical("fr")]
    assert names.index("échantillonnage") < names.index("élévation") < names.index("esquisse")
    assert len(names) == len(terms())


def test_definitions_can_be_titles_of_links():
    for term in terms().values():
        for language in ("en", "fr"):
            assert '"' not in term.definition(language) and "\\" not in term.definition(language)


def test_the_glossary_has_each_term_in_both_languages():
    terms = alphabetical("en")
    assert len(terms) > 70
    for language in LANGUAGES:
        names = [term.names[language][0] for term in terms]
        assert len(set(names)) == len(names)
        text = glossary(language, str)
        for term in terms:
            assert f"{{ #{term.key} }}" in text
            assert re.fullmatch(r"[^.].*\.", term.meaning[language]) and len(term.meaning[language]) < 200
    avoided = {word for term in terms for word in term.avoid}
    assert not avoided & {term.names["en"][0] for term in terms}


def test_sections_of_the_thesis_have_a_page():
    form = re.compile(r"(?:(?:\d(?:\.\d)+|introduction), p\. \d+)?")
    assert not [term.key for term in terms().values() if not form.fullmatch(term.thesis)]


def test_a_term_without_its_french_is_refused(tmp_path: Path):
    file = tmp_path / "glossary.toml"
    file.write_text('[texel]\nen = ["texel"]\nmeans = "One element."\n')
    with pytest.raises(ValueError, match=r"texel.*missing.*fr"):
        terms(file)


# ── heroes ────────────────────────────────────────────────────────────────────


def test_every_lesson_has_a_picture_of_its_own_at_its_head():
    sketches, seen = Sketches(), {}
    for name in lesson_names():
        hero = hero_of(name, sketches)
        assert hero is not None, name
        assert set(hero.alt) == {"en", "fr"}
        scene = hero.scene
        key = (scene.sketch, scene.time, scene.steps)
        assert seen.setdefault(key, name) == name


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('sketch = "fbm"\nalt.en = "a"', "alt in 'fr'"),
        ('sketch = "fbn"\nalt = { en = "a", fr = "b" }', "did you mean 'fbm'"),
        ('sketch = "fbm"\nwide = 1\nalt = { en = "a", fr = "b" }', "wide"),
        ('sketch = "fbm"\ncamera = { elevation = 99.0 }\nalt = { en = "a", fr = "b" }', "expected -89 to 89"),
    ],
)
def test_what_is_wrong_with_one_is_said(tmp_path, text, said):
    path = tmp_path / "heroes.toml"
    path.write_text(f"[fractals]\n{text}\n", encoding="utf-8")
    with pytest.raises(SketchError, match=said):
        hero_of("fractals", path=path)


def test_a_lesson_may_have_none():
    assert hero_of("none_of_them") is None


def test_empty_template_matches_first_lesson_and_start_kernel(engine: Engine, tmp_path: Path) -> None:
    made = make_sketch(tmp_path / "first", empty=True)
    assert sorted(path.name for path in made.iterdir()) == ["height.glsl", "sketch.toml"]
    assert (made / "height.glsl").read_bytes() == (EXERCISES / "first_height/empty.glsl").read_bytes()
    assert not engine.read(load(made), "height").any()
    own, shipped = (
        tomllib.loads(path.read_text()) for path in (made / "sketch.toml", SKETCHES / "first_height.toml")
    )
    assert own["pass"][0].pop("use") == "./height"
    assert shipped["pass"][0].pop("use") == "generation/first_height"
    assert own.pop("title") == "First" and shipped.pop("title")
    assert "main" not in own and shipped.pop("main")  # the kernel begins without parameters
    assert own["shot"][0].pop("name") and shipped["shot"][0].pop("name")
    assert own == shipped

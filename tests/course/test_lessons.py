"""The lessons that ship: all of them, in both languages; they keep their promises and can be shown."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from string import Formatter

import pytest

from playground.course.document import formulas
from playground.course.glossary import terms_of
from playground.course.library import HERE, LANGUAGES, SOURCE, TEXTS, labels, lesson_files, lesson_names
from playground.course.measures import Number, filled, named_in
from playground.course.model import Break, Compare, Exercise, Figure, Prose, Question, Slider, Steps, Trace
from playground.course.read import read_lesson, read_lessons, status_of, summaries
from playground.course.rules import MAX_MINUTES, broken_rules, wrong_pictures
from playground.course.scenes import bug_region, pictures_of, with_bug
from playground.course.typeset import set_formula, written
from playground.course.window.figure_view import edits_of, map_of, steps_of
from playground.paths import GLSL
from playground.shader.source import read_text
from playground.studio.edits.edits import Draft
from playground.studio.theme import Theme

from ..loading import load
from ..studio.test_fonts import constants, missing
from ..studio.test_fonts import theme as theme
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


def test_each_label_has_the_same_places_in_every_language():
    def places(text: str) -> list[str]:
        return sorted(part[1] for part in Formatter().parse(text) if part[1] is not None)

    english, french = (tomllib.loads((HERE / f"labels/{code}.toml").read_text("utf-8")) for code in LANGUAGES)
    said = french.pop("said")
    assert labels("window", "xx") == labels("window", "en")
    assert english.keys() == french.keys()
    for part, table in english.items():
        tables = (table, french[part]) if isinstance(table, dict) else ({part: table}, {part: french[part]})
        assert tables[0].keys() == tables[1].keys(), part
        for key, text in tables[0].items():
            assert places(text) == places(tables[1][key]), (part, key)
    for text, translation in said.items():
        assert places(text) == places(translation), text
    assert not any("'" in text for text in french["window"].values()), "the apostrophe is ’"


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
    english = shipped["en"]
    names = {measure.name for measure in english.measures}
    names |= {block.name for block in english.blocks if isinstance(block, Question) and block.of}
    traces = {block.name for block in english.blocks if isinstance(block, Trace)}
    named = {name for text in english.texts() for name in named_in(text) if ":" in name}
    names |= {name for name in named if name.partition(":")[0] in traces}
    numbers = {name: Number(1.0, "1") for name in names}
    for language, lesson in shipped.items():
        for words in lesson.texts():
            assert "…" not in filled(words, numbers, language) or "…" in words


FILES = sorted(TEXTS.glob("*/*.md"))


def test_there_are_lessons_in_every_language():
    assert {path.parent.name for path in FILES} == set(LANGUAGES) and len(lesson_files()) >= 10


@pytest.mark.parametrize("path", FILES, ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_every_formula_can_be_set(path):
    for latex in formulas(path.read_text(encoding="utf-8")):
        typeset_formula = set_formula(latex, 20, 0xFFEEEEEE, display=False)
        assert typeset_formula is not None, latex
        shown = typeset_formula.pixels[typeset_formula.pixels[..., 3] > 0].astype(int)
        assert not ((shown[:, 0] > 200) & (shown[:, 1] < 50)).any(), f"{latex}: red is what is not known"


@pytest.mark.slow
@pytest.mark.parametrize("name", lesson_files())
def test_every_picture_can_be_set_by_hand(name):
    count = 0
    for block in read_lesson(name).blocks:
        if isinstance(block, Figure | Break | Exercise):
            written = isinstance(block, Exercise) and block.file  # its picture is of a kernel, not of values
            scenes = (block.scene,) if block.scene and not written else ()
        else:
            scenes = block.scenes if isinstance(block, Steps | Slider | Compare) else ()
        for scene in scenes:
            count += 1
            file = load(Path(scene.sketch.file))
            made = Draft(file, file, edits_of(scene, file)).sketch
            assert all(step >= 0 for step in steps_of(scene).values())
            if scene.view:
                shown = map_of(scene)
                assert shown is not None and ":" in shown.ref
            else:
                same = made.with_values({}) == scene.sketch.with_values({})
                assert same, block.name  # the difference of two sketches is thousands of lines
    assert count >= 5


COURSE = Path(__file__).resolve().parents[2] / "playground" / "course"
FOLDER = COURSE / "texts"


@pytest.mark.slow
def test_labels_of_lessons_can_be_shown(theme: Theme):
    text = "".join(s for path in COURSE.rglob("*.py") for s in constants(path))
    text += "".join(path.read_text(encoding="utf-8") for path in (COURSE / "labels").glob("*.toml"))
    assert "→" in text
    for font in (theme.text, theme.bold, theme.italic):
        assert not missing(written(text), font)


@pytest.mark.parametrize("language", sorted(path.name for path in FOLDER.iterdir() if path.is_dir()))
def test_lessons_can_be_shown(theme: Theme, language: str):
    text = "".join(path.read_text(encoding="utf-8") for path in (FOLDER / language).glob("*"))
    assert len(text) > 10_000
    for font in (theme.text, theme.bold, theme.italic, theme.code):
        assert not missing(written(text), font)

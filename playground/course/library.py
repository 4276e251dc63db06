"""Find lessons, their languages, texts and labels; the order of lessons, by the parts of the course.

``labels/`` has one catalogue a language. A ``Said`` is a message by its English text; ``in_language`` gives
another. What drivers, compilers, systems and parsers report stays as it is.
"""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from playground.errors import SketchError, nearest
from playground.memo import INTERFACE
from playground.shader.parameter import spell
from playground.sketch.toml_table import TomlFile

HERE = Path(__file__).resolve().parent

TEXTS = HERE / "texts"
"""A folder for each language, in it a file for each lesson."""

SOURCE = "en"
"""The language that lessons are written in."""

LANGUAGES = {"en": "English", "fr": "Français"}
"""The languages that lessons can be read in, by code, each as it calls itself."""

THESIS = (
    "H. Belaiche, Illumination réaliste de terrains en temps réel, mémoire de magistère, "
    "Université Mohamed Khider, Biskra, 2010"
)
"""What all lessons come from."""


def lesson_file(name: str, language: str = SOURCE) -> Path:
    """Return the path of a lesson's text; raise ``SketchError`` for an unknown name or language."""
    if language not in LANGUAGES:
        raise SketchError(f"no language '{language}'{nearest(language, LANGUAGES)}")
    if name not in lesson_files():
        raise SketchError(f"no lesson '{name}'{nearest(name, lesson_files())}")
    return TEXTS / language / f"{name}.md"


def lesson_files() -> list[str]:
    """List the names of lessons by their files, in no order of their own."""
    return sorted(path.stem for path in (TEXTS / SOURCE).glob("*.md"))


def preferred_language(environment: Mapping[str, str] = os.environ) -> str:
    """Return the language that the environment asks for, if lessons have it; else English."""
    for variable in ("LC_ALL", "LC_MESSAGES", "LANG"):
        language = environment.get(variable, "")
        if language:
            code = language[:2].lower()
            return code if code in LANGUAGES else SOURCE
    return SOURCE


@dataclass(frozen=True, slots=True)
class CoursePart:
    """A part of the course."""

    titles: Mapping[str, str]  # by language
    lessons: tuple[str, ...]  # names, in their order


def course_file() -> Path:
    """Return the file that holds the course of the lessons: next to the folder of their texts."""
    return TEXTS.parent / "course.toml"


def parts() -> list[CoursePart]:
    """Return the parts of the course, in their order.

    Raises ``SketchError`` at what is wrong with its file: a part without a title in each language,
    a lesson that has no text, is named twice, or is in no part.
    """
    path = course_file()
    file = TomlFile(path, path.parent)
    file.only(file.table, ("part",))
    names, seen, parts_read = lesson_files(), set[str](), []
    for index, table in enumerate(file.tables("part")):
        key_path = ("part", index)
        file.only(table, ("title", "lessons"), *key_path)
        titles = file.take(table, "title", dict, {}, *key_path)
        file.only(titles, tuple(LANGUAGES), *key_path, "title")
        for code in LANGUAGES:
            if not file.take(titles, code, str, "", *key_path, "title").strip():
                raise file.error(f"a part of the course has a title in '{code}'", *key_path)
        lessons = file.take(table, "lessons", list, [], *key_path)
        for name in lessons:
            if not isinstance(name, str) or name not in names:
                hint = nearest(name, names) if isinstance(name, str) else ""
                raise file.error(f"no lesson {spell(name)}{hint}", *key_path, "lessons")
            if name in seen:
                raise file.error(f"lesson {spell(name)} is in the course twice", *key_path, "lessons")
            seen.add(name)
        parts_read.append(CoursePart(titles, tuple(lessons)))
    if left := [name for name in names if name not in seen]:
        raise file.error(f"in no part of the course: {', '.join(left)}")
    return parts_read


def lesson_names() -> list[str]:
    """List the names of all lessons in the course's order; raise as ``parts`` does."""
    return [name for part in parts() for name in part.lessons]


def number_of(name: str) -> int:
    """Return a lesson's number, from 0; one whose text is elsewhere comes after all others."""
    names = lesson_names()
    return names.index(name) if name in names else len(names)


class Labels(dict[str, str]):
    """Labels in one language, by key."""

    def __call__(self, key: str, *values: object, **named: object) -> str:
        """Return a label with values in its places."""
        return self[key].format(*values, **named)


@INTERFACE.cached()
def labels(part: str, language: str) -> Labels:
    """Return the labels of a part (a table of the catalogue), with those that all parts share.

    Those of English for a language without a catalogue.
    """
    catalogue = _catalogue(language) or _catalogue(SOURCE)
    shared = {key: text for key, text in catalogue.items() if isinstance(text, str)}
    return Labels(shared | catalogue[part])


@INTERFACE.cached()
def _catalogue(language: str) -> dict[str, Any]:
    file = HERE / "labels" / f"{language}.toml"
    return tomllib.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}


class Said(str):
    """An English sentence that knows what it is made of: a pattern, and what stands in its places."""

    __slots__ = ("pattern", "values")
    pattern: str
    values: dict[str, object]

    def __new__(cls, pattern: str, **values: object) -> Said:
        """Make it of a pattern, as ``str.format`` takes it."""
        made = super().__new__(cls, pattern.format(**values))
        made.pattern, made.values = pattern, values
        return made

    def __reduce__(self) -> tuple[object, ...]:
        """Cross a process border whole."""
        return partial(type(self), self.pattern, **self.values), ()


def in_language(text: str, language: str) -> str:
    """Return a message in a language that it is known in; else as it is."""
    if not isinstance(text, Said):
        return text
    values = {k: in_language(v, language) if isinstance(v, str) else v for k, v in text.values.items()}
    return patterns(language).get(text.pattern, text.pattern).format(**values)


def decimal(number: str, language: str) -> str:
    """Return a number as a language writes it: in French, decimals follow a comma."""
    return number.replace(".", ",") if language == "fr" else number


def patterns(language: str) -> dict[str, str]:
    """Return the patterns of a language by their English ones; none for English."""
    return dict(_catalogue(language).get("said", {}))

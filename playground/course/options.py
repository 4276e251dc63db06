"""The options of the course: lessons and languages, and what it adds to ``playground live``."""

from __future__ import annotations

from typing import Annotated

from playground.commands.options import value
from playground.errors import SketchError, nearest


def complete_lesson(incomplete: str) -> list[str]:
    """Return the lessons that complete a word."""
    from playground.course.library import lesson_files

    return [name for name in lesson_files() if name.startswith(incomplete)]


def complete_language(incomplete: str) -> list[str]:
    """Return the codes of languages that complete a word."""
    from playground.course.library import LANGUAGES

    return [code for code in LANGUAGES if code.startswith(incomplete)]


def read_language(text: str) -> str:
    """Return the language that an option names, or the system's; raise ``SketchError`` for an unknown one."""
    from playground.course.library import LANGUAGES, preferred_language

    if text and text not in LANGUAGES:
        raise SketchError(f"--lang {text}: no such language{nearest(text, LANGUAGES)}")
    return text or preferred_language()


Language = Annotated[
    str, value("--lang CODE", "Language: en or fr; that of the system by default.", complete_language)
]


def live_options(
    lesson: Annotated[str, value("--lesson NAME", "Open a lesson next to the sketch.", complete_lesson)] = "",
    lang: Language = "",
) -> dict[str, object]:
    """Return what ``playground live`` is to ask of a window's lessons."""
    return {"lesson": lesson, "language": lang}


LIVE_EXAMPLES = ("playground live --lesson diamond_square --lang fr",)

"""The language of lessons that an option names."""

from __future__ import annotations

from playground.errors import SketchError, nearest


def read_language(text: str) -> str:
    """Return the language that an option names, or the system's; raise ``SketchError`` for an unknown one."""
    from playground.course.library import LANGUAGES, preferred_language

    if text and text not in LANGUAGES:
        raise SketchError(f"--lang {text}: no such language{nearest(text, LANGUAGES)}")
    return text or preferred_language()

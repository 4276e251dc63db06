"""The catalogue of lessons: by number, in a language, read when they are opened.

What reads Markdown is imported with the first of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from playground.course.library import SOURCE
from playground.course.model import Lesson
from playground.course.scenes import Sketches
from playground.errors import PlaygroundError

if TYPE_CHECKING:
    from playground.course.read import Summary


@dataclass
class Catalogue:
    """The lessons of one window; ``say`` reports errors."""

    say: Callable[[str], None]
    _sketches: Sketches = field(default_factory=Sketches)
    _listed: dict[str, list[Summary]] = field(default_factory=dict)  # by language
    _missing: set[str] = field(default_factory=set)  # lessons reported to have no translation

    def listed(self, language: str) -> list[Summary]:
        """Return all lessons, in their order."""
        if language not in self._listed:
            from playground.course.read import summaries

            try:
                self._listed[language] = summaries(language)
            except PlaygroundError as error:
                self.say(str(error))
                self._listed[language] = []
        return self._listed[language]

    def read(self, name: str, language: str, untranslated: str) -> Lesson:
        """Return a lesson; without a translation in English, and ``untranslated`` is reported once.

        Raises ``SketchError`` for one that is not there or not well written.
        """
        from playground.course.read import read_lesson

        try:
            return read_lesson(name, language, self._sketches)
        except PlaygroundError:
            if language == SOURCE:
                raise
            lesson = read_lesson(name, SOURCE, self._sketches)
            if name not in self._missing:
                self._missing.add(name)
                self.say(untranslated)
            return lesson

"""What the course says in the reader's language: labels, and sentences that are English where they arise.

``labels/`` has one catalogue a language. A ``Said`` is its English text; ``in_language`` gives another. What
drivers, compilers, systems and parsers say stays as they say it.
"""

from __future__ import annotations

import tomllib
from functools import partial
from typing import Any

from playground.course.library import HERE, SOURCE
from playground.memo import INTERFACE


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


def patterns(language: str) -> dict[str, str]:
    """Return the patterns of a language by their English ones; none for English."""
    return dict(_catalogue(language).get("said", {}))

"""Sentences that are English where they arise, and in the reader's language where they are read.

A ``Said`` is its English text; ``in_language`` gives another. What drivers, compilers, systems and
parsers say stays as they say it.
"""

from __future__ import annotations

import tomllib
from functools import partial
from pathlib import Path

from playground.memo import INTERFACE


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


@INTERFACE.cached()
def patterns(language: str) -> dict[str, str]:
    """Return the patterns of a language by their English ones; none for English."""
    file = Path(__file__).resolve().parent / "labels" / f"said_{language}.toml"
    if not file.is_file():
        return {}
    with file.open("rb") as handle:
        return dict(tomllib.load(handle))

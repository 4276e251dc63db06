"""The glossary: the project's terms in each language, to which lessons link as ``[texel](term:texel)``.

A lesson links a term where it first appears. Each reader of lessons shows the link in its own way:
the window as a tooltip, a book as a link to its page of terms, a notebook as a link to its last cell.
"""

from __future__ import annotations

import tomllib
import unicodedata
from dataclasses import dataclass
from pathlib import Path

from playground.course.document import links
from playground.course.library import HERE
from playground.course.model import Lesson, Markdown
from playground.memo import INTERFACE

FILE = HERE / "glossary.toml"
"""The terms."""

MEANING = {"en": "means", "fr": "signifie"}
"""The key of a term's sentence, by language."""

_OPTIONAL = {"avoid", "thesis", "thesis_name"}


@dataclass(frozen=True, slots=True)
class Term:
    """A term in each language, with its meaning."""

    key: str
    names: dict[str, tuple[str, ...]]  # by language; the first is the one to use
    meaning: dict[str, str]  # one message, by language
    avoid: tuple[str, ...] = ()  # English words that this project does not use for it
    thesis: str = ""  # section of the thesis that names it
    thesis_name: str = ""  # what the thesis calls it, where that is another word

    def definition(self, language: str) -> str:
        """Return its name and its sentence: "texel: One element of a texture, …"."""
        colon = "\u00a0: " if language == "fr" else ": "
        return f"{self.names[language][0]}{colon}{self.meaning[language]}"


@INTERFACE.cached()
def terms(file: Path = FILE) -> dict[str, Term]:
    """Read the terms by key, in the order of the file; raise ``ValueError`` for one that lacks something."""
    with file.open("rb") as handle:
        tables = tomllib.load(handle)
    required = {*MEANING, *MEANING.values()}
    result = {}
    for key, entry in tables.items():
        unknown, missing = set(entry) - required - _OPTIONAL, required - set(entry)
        if unknown or missing:
            raise ValueError(f"{file.name}: {key}: unknown {sorted(unknown)}, missing {sorted(missing)}")
        names = {language: tuple(entry[language]) for language in MEANING}
        meaning = {language: entry[text] for language, text in MEANING.items()}
        rest = {**entry, "avoid": tuple(entry.get("avoid", ()))}
        result[key] = Term(key, names, meaning, **{name: rest[name] for name in _OPTIONAL & set(rest)})
    return result


def alphabetical(language: str) -> list[Term]:
    """Return all terms by their names in a language; accents do not count."""

    def letters(term: Term) -> str:
        decomposed = unicodedata.normalize("NFD", term.names[language][0].lower())
        return "".join(letter for letter in decomposed if letter.isalnum())

    return sorted(terms().values(), key=letters)


def linked_term(address: str) -> Term | None:
    """Return the term that a link leads to, None for another link or a term there is not."""
    kind, _, key = address.partition(":")
    return terms().get(key) if kind == "term" else None


def terms_in(*texts: Markdown) -> list[Term]:
    """Return the terms that texts link to, each once, in the order of the texts."""
    linked_terms = (linked_term(address) for text in texts for address in links(text))
    return list({term.key: term for term in linked_terms if term}.values())


def terms_of(lesson: Lesson) -> list[Term]:
    """Return the terms that a lesson links to, in its order."""
    return terms_in(*lesson.texts())

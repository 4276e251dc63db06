"""Generate the glossary, in English and in French, from the one file that holds its terms."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

from .markdown import escaped, slug

ROOT = Path(__file__).resolve().parents[2]

FILE = ROOT / "playground" / "lessons" / "glossary.toml"
"""The terms: the lessons may read the same file."""

LANGUAGES = ("en", "fr")

_HEADS = {
    "en": "# Glossary\n\nThe terms of this project, one sentence each. Code, messages, lessons and these"
    " pages use them. [En français](glossaire.md).\n\n",
    "fr": "# Glossaire\n\nLes termes de ce projet, une phrase chacun. Le code, les messages, les leçons et"
    " ces pages les emploient. [In English](glossary.md).\n\n",
}
_ALSO = {"en": "also", "fr": "aussi"}
_THESIS = {"en": "thesis", "fr": "mémoire"}
_COLON = {"en": ": ", "fr": "\u00a0: "}
_NEXT = {"en": "; ", "fr": "\u00a0; "}
_OTHER = {"en": ("fr", "in French"), "fr": ("en", "en anglais")}


@dataclass(frozen=True, slots=True)
class Term:
    """A term in each language, with its meaning."""

    key: str
    names: dict[str, tuple[str, ...]]  # by language; the first is the one to use
    meaning: dict[str, str]  # one sentence, by language
    avoid: tuple[str, ...] = ()  # English words that this project does not use for it
    thesis: str = ""  # section of the thesis that names it
    thesis_name: str = ""  # what the thesis calls it, where that is another word


def terms(file: Path = FILE) -> list[Term]:
    """Read the terms in the order of the file; raise ``ValueError`` for one that lacks something."""
    found = []
    with file.open("rb") as handle:
        tables = tomllib.load(handle)
    for key, given in tables.items():
        unknown = set(given) - {"en", "fr", "means", "signifie", "avoid", "thesis", "thesis_name"}
        missing = {"en", "fr", "means", "signifie"} - set(given)
        if unknown or missing:
            raise ValueError(f"{file.name}: {key}: unknown {sorted(unknown)}, missing {sorted(missing)}")
        names = {language: tuple(given[language]) for language in LANGUAGES}
        meaning = {"en": given["means"], "fr": given["signifie"]}
        found.append(
            Term(
                key,
                names,
                meaning,
                tuple(given.get("avoid", ())),
                given.get("thesis", ""),
                given.get("thesis_name", ""),
            )
        )
    return found


def page(language: str) -> str:
    """Return the glossary in a language, by its own alphabet."""
    entries = sorted(terms(), key=lambda term: slug(_unaccented(term.names[language][0])))
    return _HEADS[language] + "".join(_entry(term, language) for term in entries)


def _entry(term: Term, language: str) -> str:
    name, *synonyms = term.names[language]
    other, label = _OTHER[language]
    notes = [(label, f"*{escaped(', '.join(term.names[other]))}*")]
    if synonyms:
        notes.insert(0, (_ALSO[language], escaped(", ".join(synonyms))))
    if term.avoid and language == "en":
        notes.append(("not", escaped(", ".join(term.avoid))))
    if term.thesis:
        named = f" (« {escaped(term.thesis_name)} »)" if term.thesis_name else ""
        notes.append((_THESIS[language], escaped(term.thesis) + named))
    told = _NEXT[language].join(f"{about}{_COLON[language]}{text}" for about, text in notes)
    return (
        f"**{escaped(name)}** {{ #{term.key} }}\n:   {escaped(term.meaning[language])}"
        f"\n\n    <small>{told}</small>\n\n"
    )


def _unaccented(text: str) -> str:
    import unicodedata

    return "".join(c for c in unicodedata.normalize("NFD", text) if not unicodedata.combining(c))

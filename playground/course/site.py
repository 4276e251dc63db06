"""What the course adds to the documentation: the glossary, in English and in French."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from playground.course.glossary import FILE, Term, alphabetical

Escape = Callable[[str], str]
"""Returns plain text as Markdown that shows just that text."""

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


def glossary(language: str, escaped: Escape) -> str:
    """Return the glossary in a language, by its own alphabet."""
    return _HEADS[language] + "".join(_entry(term, language, escaped) for term in alphabetical(language))


def _entry(term: Term, language: str, escaped: Escape) -> str:
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
    notes_text = _NEXT[language].join(f"{about}{_COLON[language]}{text}" for about, text in notes)
    return (
        f"**{escaped(name)}** {{ #{term.key} }}\n:   {escaped(term.meaning[language])}"
        f"\n\n    <small>{notes_text}</small>\n\n"
    )


PAGES = {
    "reference/glossary.md": partial(glossary, "en"),
    "reference/glossaire.md": partial(glossary, "fr"),
}
"""What writes each page, by its path in the site."""

HOMES = {FILE: "reference/glossary.md"}
"""The page in the site that a file of the checkout is."""

"""What the course adds to the documentation: the glossary, in English and in French."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from playground.course.glossary import FILE, Term, alphabetical
from playground.course.library import SOURCE, Labels, labels

Escape = Callable[[str], str]
"""Returns plain text as Markdown that shows just that text."""


def glossary(language: str, escaped: Escape) -> str:
    """Return the glossary in a language, by its own alphabet."""
    say = labels("site", language)
    return say["head"] + "".join(_entry(term, language, say, escaped) for term in alphabetical(language))


def _entry(term: Term, language: str, say: Labels, escaped: Escape) -> str:
    name, *synonyms = term.names[language]
    other, book = say["other"], labels("book", language)
    notes = [(book["other_language"], f"*{escaped(', '.join(term.names[other]))}*")]
    if synonyms:
        notes.insert(0, (book["also"], escaped(", ".join(synonyms))))
    if term.avoid and language == SOURCE:
        notes.append(("not", escaped(", ".join(term.avoid))))
    if term.thesis:
        named = f" (« {escaped(term.thesis_name)} »)" if term.thesis_name else ""
        notes.append((say["thesis"], escaped(term.thesis) + named))
    notes_text = say["separator"].join(f"{about}{say['colon']}{text}" for about, text in notes)
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

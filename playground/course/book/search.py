"""What the search of the book looks through: the texts of its pages, section by section, as plain words."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

from playground.course import model
from playground.course.book.blocks import LessonContext
from playground.course.book.page import GLOSSARY, Book, section_id
from playground.course.glossary import alphabetical
from playground.course.markdown import every_token, parser

Entry = tuple[str, str, str, str]
"""An address in the book, the title of its page, of its section, and its text."""

_HIDDEN = {"answer", "fix", "hint", "solution"}
"""Fields of blocks that are folded away: a search does not give them away."""


_ENDS = ("softbreak", "paragraph_close", "heading_close", "td_close", "th_close")


def lesson_entries(lesson: model.Lesson, setting: LessonContext) -> Iterator[Entry]:
    """Yield the sections of a lesson; what stands before the first is its page."""
    for number, section in enumerate(lesson.sections):
        texts = [setting.filled(text) for block in section.blocks for text in _texts(block)]
        if not number:
            yield f"{lesson.name}.html", lesson.title, "", _words(lesson.goal, *texts)
            continue
        address = f"{lesson.name}.html#{section_id(number, section)}"
        yield address, lesson.title, _words(section.title), _words(*texts)


def glossary_entries(book: Book) -> Iterator[Entry]:
    """Yield the terms, by all their names in the language of the book."""
    for term in alphabetical(book.language):
        names = ", ".join(term.names[book.language])
        yield f"{GLOSSARY}.html#{term.key}", book.label("glossary"), names, term.meaning[book.language]


def words_script(entries: list[Entry]) -> str:
    """Return the script that gives find.js its texts."""
    return f"globalThis.bookWords={json.dumps(entries, ensure_ascii=False, separators=(',', ':'))};\n"


def _texts(block: model.Block) -> Iterator[str]:
    for each in model.translated_fields(type(block)):
        if each.name not in _HIDDEN and each.name != "alt":
            value = getattr(block, each.name)
            yield from value if isinstance(value, tuple) else (value,)


def _words(*texts: str) -> str:
    """Return Markdown as its words, code too; of formulas those within a line, signs by their names."""
    return " ".join(" ".join(map(_plain, texts)).split())


def _plain(text: str) -> str:
    parts = []
    for token in every_token(parser().parse(text)):
        if token.type in _ENDS:
            parts.append(" ")
        elif token.type == "math_inline":
            parts.append(re.sub(r"[\\{}]", "", token.content))
        elif token.type in ("text", "code_inline", "fence", "code_block"):
            parts.append(token.content)
    return "".join(parts)

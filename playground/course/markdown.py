"""Read Markdown: the parts that a lesson's text falls into, and its formulas."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from markdown_it import MarkdownIt
from markdown_it.token import Token
from mdit_py_plugins.dollarmath import dollarmath_plugin

_KINDS = {
    "heading_open": "heading",
    "paragraph_open": "paragraph",
    "bullet_list_open": "list",
    "ordered_list_open": "list",
    "table_open": "table",
    "math_block": "formula",
    "blockquote_open": "quote",
    "code_block": "code",
    "fence": "fence",
    "hr": "rule",
}


@dataclass(frozen=True, slots=True)
class Piece:
    """A top-level part of a text: a paragraph, a list, a fenced block."""

    kind: str  # heading | paragraph | list | table | formula | quote | code | fence | rule
    text: str  # as written, without the empty lines around it
    line: int  # from 1, in the text
    level: int = 0  # of a heading, from 1
    info: str = ""  # of a fence: what follows its opening
    inside: str = ""  # of a fence: its lines


def parser() -> MarkdownIt:
    """Return the parser of lessons: CommonMark without HTML, with tables and formulas between dollars."""
    markdown = MarkdownIt("commonmark", {"html": False}).enable("table")
    return markdown.use(
        dollarmath_plugin, allow_space=False, allow_digits=False, allow_labels=False, double_inline=False
    )


def pieces(text: str) -> list[Piece]:
    """Split a text into its top-level parts, in order."""
    lines = text.split("\n")
    indices = []
    for token in parser().parse(text):
        if token.level or token.map is None or token.type not in _KINDS:
            continue
        start, end = token.map
        written = "\n".join(lines[start:end]).strip("\n")
        level = int(token.tag[1]) if token.type == "heading_open" else 0
        fence = token.type == "fence"
        info, inside = (token.info.strip(), token.content) if fence else ("", "")
        indices.append(Piece(_KINDS[token.type], written, start + 1, level, info, inside))
    return indices


def formulas(text: str) -> Iterator[str]:
    """Yield the formulas of a text, as LaTeX."""
    for token in every_token(parser().parse(text)):
        if token.type.startswith("math_"):
            yield token.content


def links(text: str) -> Iterator[str]:
    """Yield the addresses that a text links to."""
    for token in every_token(parser().parse(text)):
        if token.type == "link_open":
            yield str(token.attrs["href"])


def images(text: str) -> Iterator[str]:
    """Yield the addresses of a text's images."""
    for token in every_token(parser().parse(text)):
        if token.type == "image":
            yield str(token.attrs["src"])


def every_token(tokens: list[Token]) -> Iterator[Token]:
    """Yield every token, those inside of others too."""
    for token in tokens:
        yield token
        yield from every_token(token.children or [])

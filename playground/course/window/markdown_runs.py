"""Markdown as runs of one style each: what the layout needs, without a font or a width."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from markdown_it.token import Token

from playground.course.markdown import parser
from playground.memo import INTERFACE


@dataclass(frozen=True)
class Run:
    """Something of one style in a line."""

    text: str
    bold: bool = False
    italic: bool = False
    code: bool = False
    formula: bool = False  # ``text`` is LaTeX
    link: str = ""
    breaks: bool = False  # a line ends here
    alone: bool = False  # it is on lines of its own: code, a formula


Runs = tuple[Run, ...]

INSTEAD = str.maketrans({"\u202f": "\u00a0", "⅓": "1/3", "⅔": "2/3"})
"""Replacements for characters that the text's font lacks."""


@dataclass(frozen=True)
class TextBlock:
    """A part of a text that is on lines of its own."""

    kind: str  # paragraph | heading | formula | code | table | rule
    runs: Runs = ()
    level: int = 0  # of a heading, from 1
    indent: int = 0  # lists and quotes that it is in
    mark: str = ""  # of a list's item: "•" or "2."
    rows: tuple[tuple[Runs, ...], ...] = ()  # of a table; the first is its head
    numbers: tuple[bool, ...] = ()  # of a table: which columns are aligned right
    close: bool = False  # it follows closely on the part before, as items of a list do


@INTERFACE.cached()
def parts_of(words: str) -> tuple[TextBlock, ...]:
    """Return the parts of a text."""
    return tuple(_parts(parser().parse(words)))


def written(text: str) -> str:
    """Return a text as the font can show it."""
    return text.translate(INSTEAD)


def plain(words: str) -> str:
    """Return a text without its marks, on one line."""
    texts = []
    for part in parts_of(words):
        runs = [*part.runs, *(run for row in part.rows for cell in row for run in cell)]
        texts.append("".join(run.text or " " for run in runs))
    return written(" ".join(" ".join(texts).split()))


def _parts(tokens: list[Token]) -> Iterator[TextBlock]:
    lists: list[int | None] = []  # the next number of each list that is open; None: of one with dots
    quotes, mark, tight = 0, "", False
    at = 0
    while at < len(tokens):
        token = tokens[at]
        indent = len(lists) + quotes
        if token.type in ("bullet_list_open", "ordered_list_open"):
            start = int(token.attrs.get("start", 1))
            lists.append(None if token.type == "bullet_list_open" else start)
            tight = False
        elif token.type in ("bullet_list_close", "ordered_list_close"):
            lists.pop()
            tight = False
        elif token.type == "list_item_open":
            number = lists[-1]
            mark = "•" if number is None else f"{number}."
            lists[-1] = None if number is None else number + 1
        elif token.type in ("blockquote_open", "blockquote_close"):
            quotes += 1 if token.type == "blockquote_open" else -1
        elif token.type == "inline":
            opener = tokens[at - 1]
            heading = opener.type == "heading_open"
            level = int(opener.tag[1]) if heading else 0
            runs = runs_of(token)
            yield TextBlock("heading" if heading else "paragraph", runs, level, indent, mark, close=tight)
            tight, mark = bool(lists), ""
        elif token.type == "math_block":
            yield TextBlock("formula", (Run(token.content.strip(), formula=True, alone=True),), indent=indent)
        elif token.type in ("fence", "code_block"):
            yield TextBlock("code", (Run(token.content.rstrip("\n"), code=True, alone=True),), indent=indent)
        elif token.type == "hr":
            yield TextBlock("rule")
        elif token.type == "table_open":
            end = next(n for n in range(at, len(tokens)) if tokens[n].type == "table_close")
            yield _table(tokens[at:end], indent)
            at = end
        at += 1


def _table(tokens: list[Token], indent: int) -> TextBlock:
    rows: list[list[Runs]] = []
    numbers: list[bool] = []
    for at, token in enumerate(tokens):
        if token.type == "tr_open":
            rows.append([])
        elif token.type in ("th_open", "td_open"):
            runs = runs_of(tokens[at + 1])
            if token.type == "th_open":
                numbers.append("right" in str(token.attrs.get("style", "")))
                runs = tuple(replace(run, bold=True) for run in runs)
            rows[-1].append(runs)
    return TextBlock("table", indent=indent, rows=tuple(map(tuple, rows)), numbers=tuple(numbers))


def runs_of(inline: Token) -> Runs:
    """Return the runs of an inline token."""
    runs: list[Run] = []
    style = Run("")
    for token in inline.children or []:
        if token.type in ("strong_open", "strong_close"):
            style = replace(style, bold=token.nesting == 1)
        elif token.type in ("em_open", "em_close"):
            style = replace(style, italic=token.nesting == 1)
        elif token.type == "link_open":
            style = replace(style, link=str(token.attrs["href"]))
        elif token.type == "link_close":
            style = replace(style, link="")
        elif token.type == "code_inline":
            runs.append(replace(style, text=token.content, code=True))
        elif token.type.startswith("math_"):
            runs.append(replace(style, text=token.content, formula=True))
        elif token.type == "hardbreak":
            runs.append(Run("", breaks=True))
        elif token.type == "softbreak":
            runs.append(replace(style, text=" "))
        elif token.content:
            term = style.link.startswith("term:")  # a term of the field is in bold where it first appears
            runs.append(replace(style, text=token.content, bold=style.bold or term))
    return tuple(runs)

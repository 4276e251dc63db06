"""Write Markdown, formulas and code as HTML."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from latex2mathml.converter import convert
from markdown_it.renderer import RendererHTML
from markdown_it.token import Token

from playground.course.markdown import parser
from playground.markup import Markup, joined, tag
from playground.memo import INTERFACE

Anchor = Callable[[str], dict[str, str]]
"""Maps a link to the attributes of its element: "lesson:fourier" → {"href": "fourier.html"}."""

MAX_INDENT = 24
"""Blanks of indent that book.css knows; a line with more wraps under these."""


def prose(markdown: str, anchor: Anchor) -> Markup:
    """Return blocks of Markdown as HTML."""
    return Markup(_rendered(markdown, anchor, inline=False))


def line(markdown: str, anchor: Anchor) -> Markup:
    """Return Markdown within a line as HTML; of several paragraphs, one after the other."""
    if "\n\n" in markdown:
        return prose(markdown, anchor)
    return Markup(_rendered(markdown, anchor, inline=True))


def plain(markdown: str) -> str:
    """Return Markdown within a line as plain text, formulas as they are written."""
    tokens = parser().parseInline(markdown)[0].children or []
    return "".join(
        token.content for token in tokens if token.type in ("text", "code_inline", "math_inline", "softbreak")
    )


def formula(latex: str, *, alone: bool = False) -> Markup:
    """Return a formula as MathML."""
    return Markup(convert(latex, display="block" if alone else "inline"))


@INTERFACE.cached()
def code(text: str) -> Markup:
    """Return GLSL as HTML, its tokens marked with classes."""
    from pygments import highlight
    from pygments.formatters import HtmlFormatter
    from pygments.lexers.graphics import GLShaderLexer

    formatter: Any = HtmlFormatter(nowrap=True, classprefix="t-")
    return Markup(highlight(text, GLShaderLexer(stripnl=False), formatter).rstrip("\n"))


def code_block(text: str, label: str) -> Markup:
    """Return GLSL as a block whose lines wrap where they are too wide."""
    text = text.strip("\n")
    inside = wrapped_lines(text, code(text))
    return tag("pre", tag("code", inside), class_="code", role="group", aria_label=label)


def wrapped_lines(text: str, html: Markup) -> Markup:
    """Return lines of code each in an element of its own, which wraps under its own indent.

    ``html`` is the text with as many lines. A line's class says its indent, as styles in a page may not;
    its end is inside, so that what is copied is the text.
    """
    lines = zip(text.split("\n"), html.split("\n"), strict=True)
    return joined(*(_wrapped(line_text, Markup(f"{marked}\n")) for line_text, marked in lines))


def _wrapped(text: str, html: Markup) -> Markup:
    indent = min(len(text) - len(text.lstrip(" ")), MAX_INDENT)
    return tag("span", html, class_=f"l i{indent}" if indent else "l")


def _plain_block(text: str) -> Markup:
    return tag("pre", tag("code", wrapped_lines(text, joined(text))), class_="code")


class _Renderer(RendererHTML):
    """Formulas as MathML, links of our own, tables that can be scrolled."""

    def math_inline(self, tokens: Sequence[Token], idx: int, options: Any, env: Any) -> str:
        return formula(tokens[idx].content)

    def math_block(self, tokens: Sequence[Token], idx: int, options: Any, env: Any) -> str:
        return f'<div class="formula" tabindex="0">{formula(tokens[idx].content, alone=True)}</div>\n'

    def link_open(self, tokens: Sequence[Token], idx: int, options: Any, env: Any) -> str:
        href = str(tokens[idx].attrs["href"])
        return tag("a", **env["anchor"](href)).removesuffix("</a>")

    def table_open(self, tokens: Sequence[Token], idx: int, options: Any, env: Any) -> str:
        return '<div class="table" tabindex="0"><table>\n'

    def table_close(self, tokens: Sequence[Token], idx: int, options: Any, env: Any) -> str:
        return "</table></div>\n"

    def code_block(self, tokens: Sequence[Token], idx: int, options: Any, env: Any) -> str:
        return str(_plain_block(tokens[idx].content.rstrip("\n")))

    def fence(self, tokens: Sequence[Token], idx: int, options: Any, env: Any) -> str:
        token = tokens[idx]
        text = token.content.rstrip("\n")
        return code_block(text, token.info or "code") if token.info == "glsl" else str(_plain_block(text))


def _rendered(markdown: str, anchor: Anchor, *, inline: bool) -> str:
    parser_ = parser()
    parser_.renderer = _Renderer(parser_)
    env: dict[str, Any] = {"anchor": anchor}
    return str(parser_.renderInline(markdown, env) if inline else parser_.render(markdown, env))

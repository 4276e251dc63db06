"""The tokens of a GLSL text, each with its place."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from itertools import zip_longest
from typing import NamedTuple

_TOKEN = re.compile(
    r"[\s\\]*(?:(?P<word>[A-Za-z_]\w*)"
    r"|(?P<number>(?:0[xX][0-9a-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\w*)"
    r"|(?P<comment>//(?:[^\n\\]|\\(?:\r?\n|.)?)*|/\*.*?(?:\*/|\Z))"
    r"|(?P<mark><<=|>>=|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||\^\^|\#\#|[-+*/%&|^]=|[-+*/%&|^~!<>=?:;,.(){}\[\]])"
    r"|(?P<directive>\#(?:\"[^\"\n]*\"|[^\n\\/]|\\(?:\r?\n|.)?|/(?![/*])|/\*.*?(?:\*/|\Z))*)"
    r'|(?P<string>"[^"\n]*")'
    r"|(?P<other>[^\s\\]))",
    re.DOTALL,
)
_DIRECTIVE = re.compile(r"\s*#\s*(\w*)\s*(.*)", re.DOTALL)
_KINDS = ("", *_TOKEN.groupindex)
_COMMENT = _KINDS.index("comment")
_NOTHING: frozenset[str] = frozenset()


class Token(NamedTuple):
    """A token; of a macro's text it has the place of the call that it stands for."""

    text: str
    kind: str  # word | number | mark | directive | string | other
    start: int
    end: int
    spelled: int  # where the text spells it: in a macro's definition, else start; -1 of a predefined macro
    macros: frozenset[str] = _NOTHING  # those that it comes from


class Comment(NamedTuple):
    """A comment, with its marks."""

    text: str
    start: int
    end: int


def tokenize(text: str) -> tuple[list[Token], list[Comment]]:
    """Return the tokens of a text, directives whole among them, and its comments."""
    tokens: list[Token] = []
    comments: list[Comment] = []
    new, add = tuple.__new__, tokens.append
    for match in _TOKEN.finditer(text, 0, len(text.rstrip())):
        kind = match.lastindex or 0
        start, end = match.span(kind)
        if kind == _COMMENT:
            comments.append(Comment(text[start:end], start, end))
        else:
            add(new(Token, (text[start:end], _KINDS[kind], start, end, start, _NOTHING)))
    return tokens, comments


def as_written(text: str) -> Iterator[Token]:
    """Yield every token of a text where it is written: those of a directive follow a token ``#``."""
    for token in tokenize(text)[0]:
        if token.kind != "directive":
            yield token
            continue
        start = token.start + 1
        yield token._replace(text="#", end=start)
        for inner in tokenize(token.text[1:])[0]:
            yield inner._replace(
                start=inner.start + start, end=inner.end + start, spelled=inner.start + start
            )


def is_named(line: str, names: Collection[str], *, called: bool = False) -> bool:
    """Return whether a line has one of some names; ``called``: before a bracket, or at its end."""
    if not any(name in line for name in names):
        return False
    tokens = list(as_written(line))
    return any(
        token.text in names and (not called or after is None or after.text == "(")
        for token, after in zip_longest(tokens, tokens[1:])
    )


def directive(line: str) -> tuple[str, str]:
    """Return the word of the directive that a line is, and what follows it; ("", "") for none."""
    match = _DIRECTIVE.match(line) if "#" in line else None
    return (match[1], match[2].rstrip()) if match else ("", "")


def place_of(line: str, name: str) -> int:
    """Return where a line first names something, or -1."""
    if name not in line:
        return -1
    return next((token.start for token in as_written(line) if token.text == name), -1)


def with_edits(text: str, edits: Mapping[tuple[int, int], str]) -> str:
    """Return a text with what stands for some spans, none within another, in their place."""
    parts, end = list[str](), 0
    for (start, after), new in sorted(edits.items()):
        parts += [text[end:start], new]
        end = after
    return "".join([*parts, text[end:]])


def without_comments(text: str) -> str:
    """Return a text with blanks in place of its comments: as long, on the same lines."""
    if "/" not in text:
        return text
    tokens, comments = tokenize(text)
    spans = [(comment.start, comment.end) for comment in comments]
    for token in tokens:
        if token.kind == "directive" and "/*" in token.text:
            offset = token.start + 1
            spans += [(one.start + offset, one.end + offset) for one in tokenize(token.text[1:])[1]]
    blanks = {(s, e): "\n".join([" " * len(line) for line in text[s:e].split("\n")]) for s, e in spans}
    return with_edits(text, blanks)

"""Know on which line of a TOML text each key stands, for error messages.

The standard reader gives a line for a syntax error only; a wrong value deserves one too.
This walks any text, also one that is not TOML, and gives what it has found so far.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress

Place = tuple[str | int, ...]
"""Where something is: keys, and places in a list, as ``("pass", 0, "use")``."""

TOKEN = re.compile(
    r'"""(?:[^\\]|\\.)*?"{3,5}(?!")'
    r"|'''.*?'{3,5}(?!')"
    r'|"(?:[^"\\\n]|\\.)*"'
    r"|'[^'\n]*'"
    r"|\#[^\n]*"
    r"|\n"
    r"|[\[\]{},=.]"
    r"""|[^\s\[\]{},=."'\#]+"""
    r"|[^\S\n]+"
    r"|.",
    re.DOTALL,
)
_DEEPEST = 40


def key_lines(text: str) -> dict[Place, int]:
    """Map each table and key, as ``("pass", 0, "use")``, to its line, from 1."""
    walker = _Walker(text)
    with suppress(_End):
        walker.document()
    return walker.found


def line_of(lines: dict[Place, int], place: Place) -> int:
    """Return the line of a place, or of the nearest table around it; 0 if none is known."""
    while place:
        for known in (place, (*place, 0)):  # a list of tables begins with its first
            if known in lines:
                return lines[known]
        place = place[:-1]
    return 0


class _End(Exception):
    """The text is at its end, or no longer TOML."""


class _Walker:
    def __init__(self, text: str) -> None:
        self.found: dict[Place, int] = {}
        self.tables: dict[Place, int] = {}  # how many tables each [[list]] has, less one
        self.tokens = self._tokens(text)
        self.again: tuple[str, int] | None = None  # a token to be read once more
        self.line = 1
        self.token = ""

    def _tokens(self, text: str) -> Iterator[tuple[str, int]]:
        line = 1
        for match in TOKEN.finditer(text):
            token = match.group()
            if token == "\n" or not (token.isspace() or token.startswith("#")):
                yield token, line
            line += token.count("\n")

    def step(self) -> str:
        """Go to the next token that is neither space nor comment, and return it."""
        self.token, self.line = self.again or next(self.tokens, ("", 0))
        self.again = None
        if not self.token:
            raise _End
        return self.token

    def solid(self) -> str:
        """Go to the next token that is not a line's end either."""
        while self.step() == "\n":
            pass
        return self.token

    def document(self) -> None:
        table: Place = ()
        while True:
            self.solid()
            if self.token == "[":
                table = self.header()
            else:
                self.pair(table, 0)

    def header(self) -> Place:
        line, is_list = self.line, False
        if self.step() == "[":
            is_list = True
            self.step()
        parts = self.key("]")
        place = self.inside(parts[:-1])
        place = (*place, parts[-1])
        if is_list:
            self.tables[place] = self.tables.get(place, -1) + 1
            self.step()  # the second bracket
        place = self.inside(parts)
        self.found.setdefault(place, line)
        return place

    def inside(self, parts: list[str]) -> Place:
        """Return the place of a table's name: in a list it means the last table there."""
        place: Place = ()
        for part in parts:
            place = (*place, part)
            if place in self.tables:
                place = (*place, self.tables[place])
        return place

    def key(self, end: str) -> list[str]:
        """Read a dotted key up to ``end``, from the token that is read already."""
        parts: list[str] = []
        while self.token != end:
            if self.token == "\n" or self.token in "[]{},=":
                raise _End
            if self.token != ".":
                parts.append(self.token[1:-1] if self.token[0] in "\"'" else self.token)
            self.step()
        if not parts:
            raise _End
        return parts

    def pair(self, table: Place, depth: int) -> None:
        line = self.line
        place = (*table, *self.key("="))
        self.found.setdefault(place, line)
        self.step()
        self.value(place, depth)

    def value(self, place: Place, depth: int) -> None:
        """Read a value from the token that is read already, to its last token or to a line's end."""
        if depth > _DEEPEST:
            raise _End
        if self.token == "[":
            index = 0
            while self.solid() != "]":
                if self.token == ",":
                    index += 1
                else:
                    self.found.setdefault((*place, index), self.line)
                    self.value((*place, index), depth + 1)
        elif self.token == "{":
            while self.solid() != "}":
                if self.token != ",":
                    self.pair(place, depth + 1)
        # A plain value may be several tokens, as 0.5 is three; what follows them ends it.
        elif depth == 0:
            while self.token != "\n":
                self.step()
        else:
            self.plain()

    def plain(self) -> None:
        """Read on to where a plain value ends, and leave what ends it to be read again."""
        while True:
            if self.step() in ",]}\n":
                self.again = (self.token, self.line)
                return

"""Change single values of a TOML text and leave every other byte of it as it is.

The text is read for where its keys and values stand, and changed by cutting and pasting
there: comments, order, spaces, line endings and the way that tables are written stay.
It must be TOML already; nothing is checked here.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass

from playground.sketch.toml_lines import TOKEN, Place

_BARE = re.compile(r"[A-Za-z0-9_-]+")


@dataclass(frozen=True, slots=True)
class Pair:
    """Where a key and its value stand."""

    key: int  # where the key begins
    value: int  # where the value begins
    end: int  # behind the value
    inline: bool  # it stands in { … }, not on a line of its own


class Spans:
    """Where everything stands in a text."""

    def __init__(self, text: str) -> None:
        self.pairs: dict[Place, Pair] = {}
        self.bodies: dict[Place, int] = {(): 0}  # table with a header → behind its last pair, or its header
        self._lists: dict[Place, int] = {}  # how many tables each [[list]] has, less one
        self._tokens = [
            (m.group(), m.start())
            for m in TOKEN.finditer(text)
            if m.group() == "\n" or not (m.group().isspace() or m.group().startswith("#"))
        ]
        self._at = 0
        table: Place = ()
        while self._at < len(self._tokens):
            if self._token == "\n":
                self._at += 1
            elif self._token == "[":
                table = self._header()
            else:
                self.bodies[table] = self._pair(table, inline=False)

    def find(self, table: Place, key: str) -> Place | None:
        """Return the place of a dotted key in a table, however its dots are written."""
        for place in self.pairs:
            if place[: len(table)] == table and ".".join(map(str, place[len(table) :])) == key:
                return place
        return None

    def inside(self, table: Place) -> list[Pair]:
        """Return the innermost pairs of a table, first one first."""
        places = [place for place in self.pairs if place[: len(table)] == table and len(place) > len(table)]
        outer = [p for p in places if not any(p[:n] in self.pairs for n in range(len(table) + 1, len(p)))]
        return sorted((self.pairs[place] for place in outer), key=lambda pair: pair.key)

    @property
    def _token(self) -> str:
        return self._tokens[self._at][0] if self._at < len(self._tokens) else "\n"

    def _end(self) -> int:
        """Return where the token before this one ended."""
        token, start = self._tokens[self._at - 1]
        return start + len(token)

    def _header(self) -> Place:
        self._at += 1
        is_list = self._token == "["
        self._at += is_list
        parts = self._key("]")
        if is_list:
            place = (*self._inside(parts[:-1]), parts[-1])
            self._lists[place] = self._lists.get(place, -1) + 1
            self._at += 1
        place = self._inside(parts)
        self.bodies[place] = self._end()
        return place

    def _inside(self, parts: list[str]) -> Place:
        place: Place = ()
        for part in parts:
            place = (*place, part)
            if place in self._lists:
                place = (*place, self._lists[place])
        return place

    def _key(self, end: str) -> list[str]:
        parts: list[str] = []
        while self._token != end:
            token = self._token
            if token[0] == '"':
                parts.append(json.loads(token))
            elif token != ".":
                parts.append(token[1:-1] if token[0] == "'" else token)
            self._at += 1
        self._at += 1
        return parts

    def _pair(self, table: Place, *, inline: bool) -> int:
        start = self._tokens[self._at][1]
        place = (*table, *self._key("="))
        value = self._tokens[self._at][1]
        end = self._value(place, inner=inline)
        self.pairs[place] = Pair(start, value, end, inline)
        return end

    def _value(self, place: Place, *, inner: bool) -> int:
        """Read a value; return where it ends."""
        if self._token in "[{":
            closing = "]" if self._token == "[" else "}"
            self._at += 1
            index = 0
            while self._token != closing:
                if self._token in ",\n":
                    index += self._token == ","
                    self._at += 1
                elif closing == "}":
                    self._pair(place, inline=True)
                else:
                    self._value((*place, index), inner=True)
            self._at += 1
            return self._end()
        while self._token != "\n" and not (inner and self._token in ",]}"):
            self._at += 1  # a plain value may be several tokens, as 0.5 is three
        return self._end()


def put(text: str, table: Place, key: str, value: str) -> str:
    """Return the text with a key of a table set; ``value`` as TOML writes it.

    The table is written as it is written so far: in braces, under a header, by dotted keys.
    Where there is none yet, it begins in braces at the end of the table around it.
    """
    spans = Spans(text)
    place = spans.find(table, key)
    if place is not None:
        pair = spans.pairs[place]
        return text[: pair.value] + value + text[pair.end :]
    pairs, written = spans.inside(table), f"{key_text(key)} = {value}"
    if table in spans.pairs:
        own = spans.pairs[table]
        if not pairs:
            return f"{text[: own.value]}{{ {written} }}{text[own.end :]}"
        return f"{text[: pairs[-1].end]}, {written}{text[pairs[-1].end :]}"
    if table in spans.bodies:
        return _line_after(text, spans.bodies[table], written)
    around = next(table[:n] for n in range(len(table) - 1, -1, -1) if table[:n] in spans.bodies)
    prefix = ".".join(key_text(str(part)) for part in table[len(around) :])
    if pairs:
        return _line_after(text, pairs[-1].end, f"{prefix}.{written}")
    return _line_after(text, spans.bodies[around], f"{prefix} = {{ {written} }}")


def drop(text: str, table: Place, key: str) -> str:
    """Return the text without a key of a table; as it is where there is no such key."""
    spans = Spans(text)
    place = spans.find(table, key)
    if place is None:
        return text
    pair = spans.pairs[place]
    if not pair.inline:
        start, end = text.rfind("\n", 0, pair.key) + 1, text.find("\n", pair.end)
        return text[:start] + (text[end + 1 :] if end >= 0 else "")
    braces = next(place[:n] for n in range(len(place) - 1, 0, -1) if place[:n] in spans.pairs)
    row = spans.inside(braces)
    index = row.index(pair)
    if len(row) == 1:
        own = spans.pairs[braces]
        return f"{text[: own.value]}{{}}{text[own.end :]}"
    if index + 1 < len(row):
        return text[: pair.key] + text[row[index + 1].key :]
    return text[: row[index - 1].end] + text[pair.end :]


def append(text: str, lines: list[str]) -> str:
    """Return the text with lines at its end, after an empty one."""
    newline = newline_of(text)
    head = text if text.endswith("\n") or not text else text + newline
    return head + newline + "".join(line + newline for line in lines)


def newline_of(text: str) -> str:
    """Return how the lines of a text end."""
    return "\r\n" if "\r\n" in text else "\n"


def key_text(key: str) -> str:
    """Return a key as TOML writes it: in quotes where it is more than one bare word."""
    return key if _BARE.fullmatch(key) else text_of(key)


def text_of(text: str) -> str:
    """Return a text as TOML writes it, in quotes."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _line_after(text: str, position: int, written: str) -> str:
    """Return the text with a line after the one that a position is on, indented as that one is."""
    start = text.rfind("\n", 0, position) + 1
    line = text[start:position]
    indent = line[: len(line) - len(line.lstrip(" \t"))]
    end = text.find("\n", position)
    newline = newline_of(text)
    if end < 0:
        return f"{text}{newline}{indent}{written}"
    return f"{text[: end + 1]}{indent}{written}{newline}{text[end + 1 :]}"

"""A TOML text: the line of each key, the span of each value, and changes of single values.

The standard reader gives a line for a syntax error only; a wrong value deserves one too, and a value
that is saved is overwritten at its position. ``TomlPlaces`` reads any text, also one that is not TOML: it
goes on behind the line at which what it cannot read begins.

``put``, ``drop`` and ``append`` change the text only there: comments, order, spaces, line endings and the
way that tables are written stay. They take a text that is TOML already; nothing is checked here.
"""

from __future__ import annotations

import json
import re
import tomllib
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

KeyPath = tuple[str | int, ...]
"""Where something is: keys, and places in a list, as ``("pass", 0, "use")``."""

_TOKEN = re.compile(
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
_MAX_DEPTH = 40
_MAX_UNCLOSED = 20  # lines with a bracket that is not closed: each is looked for up to the end


class Header(NamedTuple):
    """The header of a table."""

    start: int  # of its first bracket
    keys: list[str]
    is_list: bool  # [[…]]


@dataclass(frozen=True, slots=True)
class Pair:
    """The span of a key and its value."""

    key: int  # where the key begins
    value: int  # where the value begins
    end: int  # behind the value
    inline: bool  # it is in { … }, not on a line of its own


class _Token(NamedTuple):
    text: str  # "" at the end
    start: int
    line: int


class _End(Exception):
    """What is read here is no TOML, or not whole."""


class TomlPlaces:
    """The lines and spans of all keys and values in a text."""

    def __init__(self, text: str) -> None:
        self.lines: dict[KeyPath, int] = {}  # of each table, key and value in a list, from 1
        self.pairs: dict[KeyPath, Pair] = {}
        self.bodies: dict[KeyPath, int] = {(): 0}  # table with a header → behind its last pair, or its header
        self.headers: list[Header] = []
        self._lists: dict[KeyPath, int] = {}  # how many tables each [[list]] has, less one
        self._tokens = _tokens(text)
        self._at = 0
        self._document()

    def line(self, position: KeyPath) -> int:
        """Return the line of a place, or of the nearest table around it; 0 if none is known.

        A key may be a dotted path, however the text writes its dots: in quotes or without.
        """
        position = _split(position)
        while position:
            for key_path in (position, (*position, 0)):  # a list of tables begins with its first
                if key_path in self._lines_by_parts:
                    return self._lines_by_parts[key_path]
            position = position[:-1]
        return 0

    @cached_property
    def _lines_by_parts(self) -> dict[KeyPath, int]:
        return {_split(key_path): line for key_path, line in reversed(self.lines.items())}

    def find(self, table: KeyPath, key: str) -> KeyPath | None:
        """Return the place of a dotted key in a table, however its dots are written."""
        for key_path in self.pairs:
            if key_path[: len(table)] == table and ".".join(map(str, key_path[len(table) :])) == key:
                return key_path
        return None

    def inside(self, table: KeyPath) -> list[Pair]:
        """Return the innermost pairs of a table, first one first."""
        places = [
            key_path
            for key_path in self.pairs
            if key_path[: len(table)] == table and len(key_path) > len(table)
        ]
        outer = [p for p in places if not any(p[:n] in self.pairs for n in range(len(table) + 1, len(p)))]
        return sorted((self.pairs[key_path] for key_path in outer), key=lambda pair: pair.key)

    # ── reading ──────────────────────────────────────────────────────────────

    @property
    def _now(self) -> _Token:
        return self._tokens[self._at]

    def _step(self) -> None:
        """Go to the next token; raise ``_End`` where this one is the last."""
        if not self._now.text:
            raise _End
        self._at += 1

    def _behind(self) -> int:
        """Return where the token before this one ends."""
        before = self._tokens[self._at - 1]
        return before.start + len(before.text)

    def _document(self) -> None:
        table: KeyPath = ()
        unclosed = 0
        while self._now.text and unclosed < _MAX_UNCLOSED:
            begins = self._at
            try:
                if self._now.text == "\n":
                    self._step()
                elif self._now.text == "[":
                    table = self._header()
                else:
                    self.bodies[table] = self._pair(table, depth=0)
            except _End:
                unclosed += not self._now.text
                self._at = begins
                while self._now.text not in ("", "\n"):
                    self._at += 1

    def _header(self) -> KeyPath:
        first = self._now
        self._step()
        is_list = self._now.text == "["
        if is_list:
            self._step()
        keys = self._key("]")
        if is_list:
            key_path = (*self._place_of(keys[:-1]), keys[-1])
            self._lists[key_path] = self._lists.get(key_path, -1) + 1
            self._step()  # the second bracket
        key_path = self._place_of(keys)
        self.lines.setdefault(key_path, first.line)
        self.bodies[key_path] = self._behind()
        self.headers.append(Header(first.start, keys, is_list))
        return key_path

    def _place_of(self, keys: list[str]) -> KeyPath:
        """Return the place of a table's name: in a list it means the last table there."""
        key_path: KeyPath = ()
        for key in keys:
            key_path = (*key_path, key)
            if key_path in self._lists:
                key_path = (*key_path, self._lists[key_path])
        return key_path

    def _key(self, end: str) -> list[str]:
        """Read a dotted key, and the token that ends it."""
        keys: list[str] = []
        while (text := self._now.text) != end:
            if text in ("", "\n", *"[]{},="):
                raise _End
            if text != ".":
                keys.append(_unquoted(text))
            self._step()
        if not keys:
            raise _End
        self._step()
        return keys

    def _pair(self, table: KeyPath, depth: int) -> int:
        """Read a key and its value; return where it ends."""
        first = self._now
        key_path = (*table, *self._key("="))
        self.lines.setdefault(key_path, first.line)
        value = self._now.start
        end = self._value(key_path, depth)
        self.pairs[key_path] = Pair(first.start, value, end, inline=depth > 0)
        return end

    def _value(self, key_path: KeyPath, depth: int) -> int:
        """Read a value; return where it ends."""
        if depth > _MAX_DEPTH:
            raise _End
        if self._now.text not in ("[", "{"):
            # A plain value may be several tokens, as 0.5 is three.
            while self._now.text not in ("", "\n") and not (depth and self._now.text in ",]}"):
                self._step()
            return self._behind()
        closing = "]" if self._now.text == "[" else "}"
        self._step()
        index = 0
        while self._now.text != closing:
            if self._now.text in ("", "\n", ","):
                index += self._now.text == ","
                self._step()
            elif closing == "}":
                self._pair(key_path, depth + 1)
            else:
                begins = self._at
                self.lines.setdefault((*key_path, index), self._now.line)
                self._value((*key_path, index), depth + 1)
                if self._at == begins:  # a bracket of the other kind, which no value begins with
                    raise _End
        self._step()
        return self._behind()


def _split(key_path: KeyPath) -> KeyPath:
    """Return a place with each dotted key split into its parts."""
    return tuple(part for key in key_path for part in (key.split(".") if isinstance(key, str) else (key,)))


def _tokens(text: str) -> list[_Token]:
    """Return the tokens of a text, without spaces and comments, and an empty one at its end."""
    tokens, line = [], 1
    for match in _TOKEN.finditer(text):
        token = match.group()
        if token == "\n" or not (token.isspace() or token.startswith("#")):
            tokens.append(_Token(token, match.start(), line))
        line += token.count("\n")
    return [*tokens, _Token("", len(text), line)]


def _unquoted(token: str) -> str:
    """Return the key that a token writes."""
    if token[0] not in "\"'":
        return token
    try:
        return str(tomllib.loads(f"key = {token}")["key"])
    except tomllib.TOMLDecodeError:
        return token[1:-1]


_BARE = re.compile(r"[A-Za-z0-9_-]+")


def put(text: str, table: KeyPath, key: str, value: str) -> str:
    """Return the text with a key of a table set; ``value`` as TOML writes it.

    The table is written as it is written so far: in braces, under a header, by dotted keys.
    Where there is none yet, it begins in braces at the end of the table around it.
    """
    places = TomlPlaces(text)
    position = places.find(table, key)
    if position is not None:
        pair = places.pairs[position]
        return text[: pair.value] + value + text[pair.end :]
    pairs, written = places.inside(table), f"{key_text(key)} = {value}"
    if table in places.pairs:
        own = places.pairs[table]
        if not pairs:
            return f"{text[: own.value]}{{ {written} }}{text[own.end :]}"
        return f"{text[: pairs[-1].end]}, {written}{text[pairs[-1].end :]}"
    if table in places.bodies:
        return _line_after(text, places.bodies[table], written)
    around = next(table[:n] for n in range(len(table) - 1, -1, -1) if table[:n] in places.bodies)
    prefix = ".".join(key_text(str(part)) for part in table[len(around) :])
    if pairs:
        return _line_after(text, pairs[-1].end, f"{prefix}.{written}")
    return _line_after(text, places.bodies[around], f"{prefix} = {{ {written} }}")


def drop(text: str, table: KeyPath, key: str) -> str:
    """Return the text without a key of a table; as it is where there is no such key."""
    places = TomlPlaces(text)
    key_path = places.find(table, key)
    if key_path is None:
        return text
    pair = places.pairs[key_path]
    if not pair.inline:
        start, end = text.rfind("\n", 0, pair.key) + 1, text.find("\n", pair.end)
        return text[:start] + (text[end + 1 :] if end >= 0 else "")
    braces = next(key_path[:n] for n in range(len(key_path) - 1, 0, -1) if key_path[:n] in places.pairs)
    row = places.inside(braces)
    index = row.index(pair)
    if len(row) == 1:
        own = places.pairs[braces]
        return f"{text[: own.value]}{{}}{text[own.end :]}"
    if index + 1 < len(row):
        return text[: pair.key] + text[row[index + 1].key :]
    return text[: row[index - 1].end] + text[pair.end :]


def append(text: str, lines: list[str]) -> str:
    """Return the text with lines at its end, after an empty one."""
    newline = newline_of(text)
    head = text if text.endswith("\n") or not text else text + newline
    return head + newline + "".join(line + newline for line in lines)


def blocks(text: str, name: str) -> list[tuple[int, int]]:
    """Return where each table of a list begins and ends, as those of ``[[pass]]``.

    The comments right above a table are in its block, and so are tables inside it; the empty lines
    after it are not.
    """
    headers = [(text.rfind("\n", 0, h.start) + 1, h) for h in TomlPlaces(text).headers]
    spans = []
    for number, (start, header) in enumerate(headers):
        if not header.is_list or header.keys != [name]:
            continue
        following = (s for s, h in headers[number + 1 :] if h.keys[0] != name or len(h.keys) == 1)
        end = next((_above(text, s) for s in following), len(text))
        last = start + len(text[start:end].rstrip())  # the end of the last line that is not empty
        line_end = text.find("\n", last, end)
        spans.append((_above(text, start), line_end + 1 if line_end >= 0 else end))
    return spans


def _above(text: str, start: int) -> int:
    """Return where the comments right above a line begin; the line itself, where there are none."""
    while start > 0:
        before = text.rfind("\n", 0, start - 1) + 1
        if not text[before:start].lstrip().startswith("#"):
            break
        start = before
    return start


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

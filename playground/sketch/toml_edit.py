"""Change single values of a TOML text and leave every other byte of it as it is.

``toml_places`` locates its keys and values; the text is changed only there: comments, order,
spaces, line endings and the way that tables are written stay.
It must be TOML already; nothing is checked here.
"""

from __future__ import annotations

import json
import re

from playground.sketch.toml_places import Place, TomlPlaces

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def put(text: str, table: Place, key: str, value: str) -> str:
    """Return the text with a key of a table set; ``value`` as TOML writes it.

    The table is written as it is written so far: in braces, under a header, by dotted keys.
    Where there is none yet, it begins in braces at the end of the table around it.
    """
    places = TomlPlaces(text)
    place = places.find(table, key)
    if place is not None:
        pair = places.pairs[place]
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


def drop(text: str, table: Place, key: str) -> str:
    """Return the text without a key of a table; as it is where there is no such key."""
    places = TomlPlaces(text)
    place = places.find(table, key)
    if place is None:
        return text
    pair = places.pairs[place]
    if not pair.inline:
        start, end = text.rfind("\n", 0, pair.key) + 1, text.find("\n", pair.end)
        return text[:start] + (text[end + 1 :] if end >= 0 else "")
    braces = next(place[:n] for n in range(len(place) - 1, 0, -1) if place[:n] in places.pairs)
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

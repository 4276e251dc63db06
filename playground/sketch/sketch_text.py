"""What a place in a sketch's TOML is: in which table, at which key or value, of which technique.

The line that is being typed is rarely TOML, so all other lines are read, and that one by itself.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from playground.errors import PlaygroundError
from playground.sketch.assign import find_targets
from playground.sketch.edited import EditedText
from playground.sketch.load import load_with
from playground.sketch.model import Parameter, Sketch, Technique
from playground.sketch.techniques import Techniques
from playground.sketch.toml_sketch import DEFAULT_VIEW
from playground.sketch.toml_table import LISTS
from playground.sketch.toml_text import KeyPath, Pair, TomlPlaces

_KEY = re.compile(r"[\w.-]|\"")
_TEXT = re.compile(r"\"((?:[^\"\\\n]|\\.)*)\"|'([^'\n]*)'")


@dataclass(frozen=True, slots=True)
class Cursor:
    """A place in a TOML text."""

    table: KeyPath  # the table with a header that it is in: ("pass", 0); () at the head
    keys: tuple[str, ...]  # of the inline tables around it: ("set",); with it the key of a value
    is_value: bool  # whether a value is typed there, else a key
    is_header: bool  # whether it is in the brackets of a table's header
    word: str  # what is typed before the place, without an opening quote
    start: int  # where that begins
    quoted: bool  # whether a quote was opened


def cursor_at(text: str, at: int) -> Cursor:
    """Return what a place is."""
    line = text.rfind("\n", 0, at) + 1
    end = text.find("\n", at)
    before = text[line:at]
    others = text[:line] + " " * ((end if end >= 0 else len(text)) - line) + (text[end:] if end >= 0 else "")
    places = TomlPlaces(others)
    table: KeyPath = ()
    counts: dict[str, int] = {}
    for header in places.headers:
        name = header.keys[0]
        if header.start >= line:
            break
        if header.is_list:
            counts[name] = counts.get(name, -1) + 1
            table = (name, counts[name])
        else:
            table = tuple(header.keys)
    if before.lstrip().startswith("["):
        word = before.lstrip().lstrip("[").strip()
        return Cursor(table, (), False, True, word, at - len(word), False)
    keys, rest, is_value = _inside(before)
    if not is_value and not keys and (around := _open_list(others, line)):
        keys, is_value = around, True
    quoted = len(re.findall(r"(?<!\\)\"", rest)) % 2 == 1
    word = rest.rpartition('"')[2] if quoted else re.split(r"[\s,\[{=]", rest)[-1]
    keys = tuple(part for key in keys for part in key.split("."))
    if not is_value and not quoted:  # set.octaves
        *before_dot, word = word.split(".")
        keys += tuple(before_dot)
    return Cursor(table, keys, is_value, False, word, at - len(word), quoted)


def _open_list(text: str, line: int) -> tuple[str, ...]:
    """Return the key whose list of several lines a line is in; () for none."""
    for match in re.finditer(r"^[ \t]*([\w.-]+)[ \t]*=[ \t]*\[([^\]]*)(?:\]|\Z)", text[:line], re.MULTILINE):
        if match.end() == line and not match[0].endswith("]"):
            return (match[1],)
    return ()


def _inside(before: str) -> tuple[tuple[str, ...], str, bool]:
    """Return of a line's part before a place: the keys around it, what is typed, whether a value."""
    keys: list[str] = []
    stack: list[str] = []  # opening brackets
    piece, quote, is_value = "", "", False
    held: list[tuple[str, bool]] = []
    for letter in before:
        if quote:
            piece += letter
            quote = "" if letter == quote else quote
            continue
        if letter in "\"'":
            quote = letter
            piece += letter
        elif letter == "#":
            return (), "", False
        elif letter == "=" and not is_value:
            keys.append(piece.strip().strip("\"'"))
            piece, is_value = "", True
        elif letter in "{[":
            stack.append(letter)
            held.append((piece, is_value))
            piece, is_value = "", letter == "["
        elif letter in "}]" and stack:
            opened = stack.pop()
            if opened == "{" and is_value and keys:
                keys.pop()
            piece, is_value = held.pop()
        elif letter == ",":
            if is_value and not (stack and stack[-1] == "["):
                keys[-1:] = []
                is_value = False
            piece = ""
        else:
            piece += letter
    return tuple(keys), piece.lstrip() if not piece.strip().startswith('"') else piece.strip(), is_value


class SketchText:
    """A sketch's or a technique's text: its passes and what fills them, as far as that can be read."""

    def __init__(self, opened: EditedText, text: str | None = None) -> None:
        """Read it; ``text`` instead of the opened one's where one line of that is left out."""
        self.path = opened.path
        self.root = opened.path.parent
        self.text = opened.text if text is None else text
        self.places = TomlPlaces(self.text)
        self._techniques = Techniques()

    def value(self, key_path: KeyPath) -> str:
        """Return a text that a key has; "" for none, and for what is no text."""
        pair = self.places.pairs.get(key_path)
        match = _TEXT.match(self.text, pair.value, pair.end) if pair is not None else None
        return (match[1] if match[1] is not None else match[2]) if match else ""

    def tables(self, key: str) -> list[KeyPath]:
        """Return the tables of a list: ("pass", 0), ("pass", 1)."""
        return [
            table_path for table_path in self.places.bodies if len(table_path) == 2 and table_path[0] == key
        ]

    def names(self, key: str) -> dict[str, KeyPath]:
        """Return the names that the tables of a list have, and the place of each table."""
        tables_by_name = {self.value((*table_path, "name")): table_path for table_path in self.tables(key)}
        tables_by_name.pop("", None)
        return tables_by_name

    def technique(self, table: KeyPath) -> Technique | None:
        """Return what fills the pass of a table, or the view; None where it cannot be read."""
        use = self.value((*table, "use"))
        if not use and table == ("view",):
            use = DEFAULT_VIEW
        try:
            return self._techniques.read(use, self.path.parent, self.root) if use else None
        except PlaygroundError:
            return None

    def technique_of(self, name: str) -> Technique | None:
        """Return what fills a pass by its name."""
        table = ("view",) if name == "view" else self.names("pass").get(name)
        return self.technique(table) if table is not None else None

    def parameter(self, table: KeyPath, path: str) -> Parameter | None:
        """Return the parameter that a path means in a table's ``set``: of its technique, or of the sketch."""
        technique: Technique | None
        if table[:1] in (("pass",), ("view",)):
            technique = self.technique(table)
        else:
            head, _, path = path.partition(".")
            technique = self.technique_of(head)
        targets = find_targets(technique, path) if technique is not None and path else ()
        return targets[0].parameter if targets else None

    def loaded(self) -> Sketch | None:
        """Return the sketch, where its text is one."""
        try:
            return load_with(Techniques(), self.path, self.text)
        except PlaygroundError:
            return None

    def settings(self) -> Iterator[tuple[KeyPath, str, Pair]]:
        """Yield what is set: the table, the parameter's path there, and where that is in the text."""
        for key_path, pair in self.places.pairs.items():
            if key_path[:1] and key_path[0] in (*LISTS, "view"):
                size = 1 if key_path[0] == "view" else 2
                rest = key_path[size:]
                if len(rest) >= 2 and rest[0] == "set":
                    yield key_path[:size], ".".join(map(str, rest[1:])), pair


def own_techniques(folder: Path) -> list[str]:
    """Return what ``use`` may name of a folder's own files: "./noon"."""
    endings = (".glsl", ".toml", ".frag", ".fs")
    if not folder.is_dir():
        return []
    names = {path.name.rpartition(".")[0] for path in folder.iterdir() if path.name.endswith(endings)}
    return sorted(f"./{name}" for name in names if name and not name.endswith(".fast"))

"""The texts that are open in an editor, by path, and positions in them as the editor counts."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from urllib.parse import unquote, urlsplit

from lsprotocol import types
from pygls import uris

from playground.allowed_files import SHADERS, looking_once, reading_unsaved, root_of
from playground.paths import GLSL, SKETCHES
from playground.shader.source import normalised, read_text

Units = Callable[[str], int]
"""How many units an editor counts for a text: of UTF-16, unless it has agreed to others."""

_HEAD = re.compile(r"^[ \t]*format[ \t]*=", re.MULTILINE)
_PASS = re.compile(r"^[ \t]*\[\[[ \t]*pass[ \t]*\]\]", re.MULTILINE)


@dataclass(frozen=True)
class Text:
    """A text with LF at its lines' ends, and places in it as an editor gives them."""

    text: str
    units: Units

    @cached_property
    def _starts(self) -> list[int]:
        return [0, *(match.end() for match in re.finditer("\n", self.text))]

    @cached_property
    def lines(self) -> list[str]:
        """Its lines, without their ends."""
        return self.text.split("\n")

    def offset(self, position: types.Position) -> int:
        """Return where a position is in the text; one behind its line's end is at that end."""
        if position.line >= len(self.lines):
            return len(self.text)
        line, at = self.lines[position.line], 0
        while at < len(line) and self.units(line[:at]) < position.character:
            at += 1
        return self._starts[position.line] + at

    def position(self, offset: int) -> types.Position:
        """Return the position of a place in the text."""
        row = bisect_right(self._starts, offset) - 1
        start = self._starts[row]
        return types.Position(row, self.units(self.text[start:offset]))

    def range(self, start: int, end: int) -> types.Range:
        """Return the range between two places in the text."""
        return types.Range(self.position(start), self.position(end))

    def line_start(self, row: int) -> int:
        """Return where a line begins, counted from 0; the text's end for one that is not there."""
        return self._starts[row] if row < len(self._starts) else len(self.text)


@dataclass(frozen=True)
class Document(Text):
    """An open text."""

    uri: str
    path: Path  # where it is or would be saved, links followed
    version: int | None

    @property
    def is_toml(self) -> bool:
        """Whether it is, or may become, a sketch or a technique of several passes."""
        return self.path.suffix == ".toml"

    @property
    def is_ours(self) -> bool:
        """Whether it is a shader, or a TOML that is a sketch or a technique and of no other program."""
        if not self.is_toml:
            return self.path.suffix in SHADERS
        head = self.text.partition("\n[")[0]
        is_sketch = self.path.name == "sketch.toml" or self.path.is_relative_to(GLSL)
        return is_sketch or bool(_HEAD.search(head) or _PASS.search(self.text))

    @property
    def root(self) -> Path:
        """The folder that it may include from, besides ``glsl/``."""
        return root_for(self.path)


def root_for(path: Path) -> Path:
    """Return the folder that a file may include from, as ``check`` has it."""
    return GLSL if path.is_relative_to(GLSL) and not path.is_relative_to(SKETCHES) else root_of(path)


class Documents:
    """The open texts."""

    def __init__(self) -> None:
        self.units: Units = lambda text: len(text.encode("utf-16-le")) // 2
        self.folders: tuple[Path, ...] = ()  # that are open in the editor
        self._open: dict[str, Document] = {}  # by URI

    def __iter__(self) -> Iterator[Document]:
        return iter(list(self._open.values()))

    def put(self, uri: str, text: str, version: int | None = None, language: str = "") -> Document:
        """Add or replace an open text."""
        cached = self._open.get(uri)
        path = cached.path if cached is not None else self._path(uri, language)
        document = self._open[uri] = Document(normalised(text), self.units, uri, path, version)
        return document

    def remove(self, uri: str) -> Document | None:
        """Forget a text that was closed."""
        return self._open.pop(uri, None)

    def get(self, uri: str) -> Document | None:
        """Return an open text by its URI; None for one that is not open."""
        return self._open.get(uri)

    def at(self, path: Path) -> Document | None:
        """Return the open text of a file; None where it is not open."""
        return next((document for document in self if document.path == path), None)

    def uri_of(self, path: Path) -> str:
        """Return the URI of a file, as the editor wrote it where the file is open."""
        document = self.at(path)
        return document.uri if document is not None else str(uris.from_fs_path(str(path)))

    def text_of(self, path: Path) -> Text:
        """Return the text of a file, as it is open; raise ``SketchError`` where it cannot be read."""
        return self.at(path) or Text(read_text(path), self.units)

    @contextmanager
    def reading(self) -> Iterator[None]:
        """Take the open texts in place of what their files hold."""
        texts = {document.path: document.text for document in self}
        with reading_unsaved(texts), looking_once():
            yield

    def is_open_folder(self, path: Path) -> bool:
        """Return whether a file is in a folder that is open in the editor, or is open itself."""
        return any(path.is_relative_to(folder) for folder in self.folders) or self.at(path) is not None

    def _path(self, uri: str, language: str) -> Path:
        parts = urlsplit(uri)
        if parts.scheme == "file":
            return Path(str(uris.to_fs_path(uri))).absolute().resolve()
        path = Path(unquote(parts.path))
        name = re.sub(r"[^\w.-]", "_", path.name) or "untitled"
        if not path.suffix:
            name += ".toml" if "toml" in language else ".glsl"
        folder = path.parent if path.is_absolute() and path.parent.is_dir() else None
        return (folder or next(iter(self.folders), Path.cwd())).resolve() / name

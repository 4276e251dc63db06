"""Split a lesson's file: TOML between two lines of ``+++``, then the parts of its Markdown."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path

from playground.course.markdown import Piece, pieces
from playground.course.model import Prose
from playground.errors import SketchError
from playground.shader.parameter import spell
from playground.shader.source import read_text
from playground.sketch.toml_table import TomlFile

_EDGE = "+++"
_HEADING = re.compile(r"^#+\s*(.*?)\s*#*$")


@dataclass(frozen=True)
class Document:
    """A lesson's file: its front matter, and the pieces of its Markdown with their lines."""

    path: Path
    front: TomlFile
    pieces: tuple[Piece, ...]  # lines as in the file


def read_document(path: Path) -> Document:
    """Split a lesson's file; raise ``SketchError`` where it does not begin with front matter."""
    lines = read_text(path).split("\n")
    edges = [number for number, line in enumerate(lines) if line.rstrip() == _EDGE]
    if len(edges) < 2 or edges[0] != 0:
        raise SketchError(f"a lesson begins with TOML between two lines of {_EDGE}", file=path, line=1)
    end = edges[1]
    front = TomlFile(path, path.parent, "\n".join(lines[1:end]), 1)
    body = "\n".join(lines[end + 1 :])
    moved = tuple(replace(piece, line=piece.line + end + 1) for piece in pieces(body))
    return Document(path, front, moved)


def prose_of(piece: Piece) -> Prose:
    """Return the prose of a piece that is no block of a lesson's own."""
    markdown = piece.text
    if piece.kind == "heading":
        match = _HEADING.match(markdown)
        markdown = match[1] if match else markdown
    kind = "code" if piece.kind == "fence" else piece.kind
    return Prose(piece.line, piece.text, kind, piece.level, markdown)


def texts_in(front: TomlFile, key: str) -> tuple[str, ...]:
    """Return the list of texts that a key has; raise ``SketchError`` for anything else."""
    texts = front.take(front.table, key, list, [])
    if not all(isinstance(item, str) for item in texts):
        raise front.error(f"{key} = {spell(texts)}: expected texts in quotes", key)
    return tuple(texts)

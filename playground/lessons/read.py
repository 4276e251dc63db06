"""Read a lesson: TOML between two lines of ``+++``, then Markdown."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from playground.errors import SketchError
from playground.lessons.fences import READERS, open_fence, read_fence
from playground.lessons.library import SOURCE, lesson_file, lesson_files
from playground.lessons.markdown import Piece, pieces
from playground.lessons.model import Block, Lesson, Prose
from playground.lessons.scenes import Sketches
from playground.sketch.find import shipped_sketches
from playground.sketch.source import read_text
from playground.sketch.toml_table import TomlFile

_EDGE = "+++"
_HEADING = re.compile(r"^#+\s*(.*?)\s*#*$")
_FRONT = ("number", "title", "goal", "minutes", "thesis", "papers", "sketch")
_LISTS = ("thesis", "papers")


@dataclass(frozen=True)
class Text:
    """A lesson's file, parted: its front matter, and the pieces of its Markdown with their lines."""

    path: Path
    front: TomlFile
    pieces: tuple[Piece, ...]  # lines as in the file


def read_lesson(name: str, language: str = SOURCE, sketches: Sketches | None = None) -> Lesson:
    """Return a lesson in a language.

    Raises ``SketchError`` naming file and line of what is wrong. ``sketches`` keeps what
    several lessons show from being loaded again.
    """
    from playground.lessons.translate import translated  # it needs ``part``

    text = part(lesson_file(name))
    lesson = _lesson(name, text, sketches or Sketches())
    return (
        lesson
        if language == SOURCE
        else translated(lesson, text, part(lesson_file(name, language)), language)
    )


def read_file(path: Path, sketches: Sketches | None = None) -> Lesson:
    """Return the lesson of an English file anywhere; raise as ``read_lesson`` does."""
    return _lesson(path.stem, part(path), sketches or Sketches())


def read_lessons(language: str = SOURCE) -> list[Lesson]:
    """Return all lessons in a language, in their order; raise as ``read_lesson`` does."""
    sketches = Sketches()
    return sorted(
        (read_lesson(name, language, sketches) for name in lesson_files()), key=lambda one: one.number
    )


@dataclass(frozen=True, slots=True)
class Summary:
    """What there is to say of a lesson without reading it."""

    number: int
    name: str
    title: str
    goal: str
    minutes: int


def summaries(language: str = SOURCE) -> list[Summary]:
    """List every lesson in its order, by the front of its file; raise ``SketchError`` where that is wrong."""
    found = []
    for name in lesson_files():
        front = part(lesson_file(name)).front
        number, minutes = (front.take(front.table, key, int, 0) for key in ("number", "minutes"))
        words = [front.take(front.table, key, str, "") for key in ("title", "goal")]
        if language != SOURCE and (path := lesson_file(name, language)).is_file():
            other = part(path).front
            words = [other.take(other.table, key, str, words[i]) for i, key in enumerate(("title", "goal"))]
        found.append(Summary(number, name, words[0], words[1], minutes))
    return sorted(found, key=lambda one: one.number)


def part(path: Path) -> Text:
    """Part a lesson's file; raise ``SketchError`` where it does not begin with front matter."""
    lines = read_text(path).split("\n")
    if lines[0].rstrip() != _EDGE or _EDGE not in [line.rstrip() for line in lines[1:]]:
        raise SketchError(f"a lesson begins with TOML between two lines of {_EDGE}", file=path, line=1)
    end = [line.rstrip() for line in lines].index(_EDGE, 1)
    front = TomlFile(path, path.parent, "\n".join(lines[1:end]), 1)
    body = "\n".join(lines[end + 1 :])
    moved = tuple(replace(piece, line=piece.line + end + 1) for piece in pieces(body))
    return Text(path, front, moved)


def _lesson(name: str, text: Text, sketches: Sketches) -> Lesson:
    front = text.front
    front.only(front.table, _FRONT)
    missing = [key for key in _FRONT if key not in front.table]
    if missing:
        raise front.error(f"front matter lacks {', '.join(missing)}")
    sketch = front.take(front.table, "sketch", str, "")
    if sketch not in shipped_sketches():
        raise front.error(f"sketch = '{sketch}': no sketch that ships has that name", "sketch")
    blocks = tuple(block_of(piece, text, sketches) for piece in text.pieces)
    _check_names(blocks, text)
    return Lesson(
        name,
        SOURCE,
        str(text.path),
        front.take(front.table, "number", int, 0),
        front.take(front.table, "title", str, ""),
        front.take(front.table, "goal", str, ""),
        front.take(front.table, "minutes", int, 10),
        texts_of(front, "thesis"),
        texts_of(front, "papers"),
        sketch,
        blocks,
    )


def block_of(piece: Piece, text: Text, sketches: Sketches) -> Block:
    """Return the block that a piece of an English file is."""
    if piece.kind == "fence" and piece.info.partition(" ")[0] in READERS:
        return read_fence(open_fence(piece, text.path, piece.line, sketches))
    if piece.kind == "fence" and " " in piece.info:
        open_fence(piece, text.path, piece.line, sketches)  # says which kinds there are
    return prose_of(piece)


def prose_of(piece: Piece) -> Prose:
    """Return what a piece that is no block of a lesson's own says."""
    words = piece.text
    if piece.kind == "heading":
        found = _HEADING.match(words)
        words = found[1] if found else words
    kind = "code" if piece.kind == "fence" else piece.kind
    return Prose(piece.line, piece.text, kind, piece.level, words)


def texts_of(front: TomlFile, key: str) -> tuple[str, ...]:
    """Return a list of texts of the front matter."""
    table: Mapping[str, Any] = front.table
    found = front.take(table, key, list, [])
    if not all(isinstance(item, str) for item in found):
        raise front.error(f"{key}: expected a list of texts in quotes", key)
    return tuple(found)


def _check_names(blocks: tuple[Block, ...], text: Text) -> None:
    seen: dict[str, int] = {}
    for block in blocks:
        name = getattr(block, "name", "")
        if name and name in seen:
            message = f"a second block named '{name}'; the first is on line {seen[name]}"
            raise SketchError(message, file=text.path, line=block.line)
        if name:
            seen[name] = block.line

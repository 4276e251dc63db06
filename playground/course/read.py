"""Read lessons, in their own language or in a translation, and how long that takes a reader."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from playground.course.document import Document, prose_of, read_document, texts_in
from playground.course.fences import READERS, open_fence, read_fence
from playground.course.library import SOURCE, lesson_file, lesson_names, number_of, parts
from playground.course.markdown import Piece
from playground.course.model import Block, Lesson
from playground.course.scenes import Sketches
from playground.course.translate import translated
from playground.errors import SketchError
from playground.sketch.find import shipped_sketches

WORDS_A_MINUTE = 200

BLOCK_SECONDS = {
    "figure": 15.0,
    "compare": 15.0,
    "step": 30.0,
    "slider": 30.0,
    "code": 30.0,
    "question": 30.0,
    "break": 120.0,
}
"""[s] What a block takes besides its words: a picture to be looked at, a bug to be found."""

TASK_SECONDS, KERNEL_SECONDS = 240.0, 360.0
"""[s] What an exercise or a challenge takes besides its words, and one in which a kernel is written."""

_TASKS = ("exercise", "challenge")
_READ = (
    *("caption", "captions", "label", "labels", "text"),
    *("ask", "choices", "answer", "hint", "fix", "solution"),
)
_UNREAD = re.compile(r"\]\([^)]*\)|[#*`|]+")  # addresses of links, and marks
_FORMULA = re.compile(r"(\$\$?)[^$]+\1")


@dataclass(frozen=True, slots=True)
class Times:
    """How long a lesson takes."""

    reading: int  # [min]
    exercises: int  # [min]


def times_of(text: Document) -> Times:
    """Return the times of a lesson from its English file, each rounded up to whole minutes."""
    reading = sum(_reading_seconds(piece) for piece in text.pieces)
    exercises = sum(_task_seconds(piece) for piece in text.pieces)
    return Times(math.ceil(reading / 60.0), math.ceil(exercises / 60.0))


def words_in(markdown: str) -> int:
    """Count the words that are read of a text; a formula is one."""
    plain = _UNREAD.sub(" ", _FORMULA.sub(" formula ", markdown))
    return sum(any(c.isalnum() for c in word) for word in plain.split())


def _reading_seconds(piece: Piece) -> float:
    if piece.kind != "fence":
        return _seconds(words_in(piece.text))
    kind = piece.info.partition(" ")[0]
    return 0.0 if kind in _TASKS else _seconds(_block_words(piece)) + BLOCK_SECONDS.get(kind, 0.0)


def _task_seconds(piece: Piece) -> float:
    if piece.kind != "fence" or piece.info.partition(" ")[0] not in _TASKS:
        return 0.0
    own = KERNEL_SECONDS if "file" in _table(piece) else TASK_SECONDS
    return _seconds(_block_words(piece)) + own


def _block_words(piece: Piece) -> int:
    table = _table(piece)
    values: Iterable[Any] = (table[key] for key in _READ if key in table)
    texts = (text for value in values for text in (value if isinstance(value, list) else [value]))
    return sum(words_in(text) for text in texts if isinstance(text, str))


def _table(piece: Piece) -> Mapping[str, Any]:
    try:
        return tomllib.loads(piece.inside)
    except (ValueError, RecursionError):  # reading the lesson says what is wrong, and where
        return {}


def _seconds(words: int) -> float:
    return 60.0 * words / WORDS_A_MINUTE


_FRONT = ("title", "goal", "thesis", "papers", "sketch")


def read_lesson(name: str, language: str = SOURCE, sketches: Sketches | None = None) -> Lesson:
    """Return a lesson in a language.

    Raises ``SketchError`` naming file and line of what is wrong. ``sketches`` keeps what
    several lessons show from being loaded again.
    """
    english = read_document(lesson_file(name))
    lesson = _lesson(name, english, sketches or Sketches())
    if language == SOURCE:
        return lesson
    return translated(lesson, english, read_document(lesson_file(name, language)), language)


def read_file(path: Path, sketches: Sketches | None = None) -> Lesson:
    """Return the lesson of an English file anywhere; raise as ``read_lesson`` does."""
    return _lesson(path.stem, read_document(path), sketches or Sketches())


def read_lessons(language: str = SOURCE) -> list[Lesson]:
    """Return all lessons in a language, in the course's order; raise as ``read_lesson`` does."""
    sketches = Sketches()
    return [read_lesson(name, language, sketches) for name in lesson_names()]


@dataclass(frozen=True, slots=True)
class Summary:
    """What a list of lessons shows of one, read without its pictures."""

    number: int  # its place in the course, from 0
    name: str
    title: str
    goal: str
    minutes: int  # reading
    exercise_minutes: int
    part: str  # title of the part of the course that it is in


def summaries(language: str = SOURCE) -> list[Summary]:
    """List every lesson in the course's order; raise ``SketchError`` where course or front are wrong."""
    named = [(name, part.titles[language]) for part in parts() for name in part.lessons]
    return [_summary(number, name, title, language) for number, (name, title) in enumerate(named)]


def _summary(number: int, name: str, part: str, language: str) -> Summary:
    text = read_document(lesson_file(name))
    times, front = times_of(text), text.front
    title, goal = (front.take(front.table, key, str, "") for key in ("title", "goal"))
    if language != SOURCE and (path := lesson_file(name, language)).is_file():
        other = read_document(path).front
        title, goal = (
            other.take(other.table, key, str, english) for key, english in (("title", title), ("goal", goal))
        )
    return Summary(number, name, title, goal, times.reading, times.exercises, part)


def _lesson(name: str, text: Document, sketches: Sketches) -> Lesson:
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
    times = times_of(text)
    return Lesson(
        name=name,
        language=SOURCE,
        file=str(text.path),
        number=number_of(name),
        title=front.take(front.table, "title", str, ""),
        goal=front.take(front.table, "goal", str, ""),
        minutes=times.reading,
        exercise_minutes=times.exercises,
        thesis=texts_in(front, "thesis"),
        papers=texts_in(front, "papers"),
        sketch=sketch,
        blocks=blocks,
    )


def block_of(piece: Piece, text: Document, sketches: Sketches) -> Block:
    """Return the block that a piece of an English file is."""
    if piece.kind == "fence" and piece.info.partition(" ")[0] in READERS:
        return read_fence(open_fence(piece, text.path, piece.line, sketches))
    if piece.kind == "fence" and " " in piece.info:
        open_fence(piece, text.path, piece.line, sketches)  # says which kinds there are
    return prose_of(piece)


def _check_names(blocks: tuple[Block, ...], text: Document) -> None:
    seen: dict[str, int] = {}
    for block in blocks:
        name = getattr(block, "name", "")
        if name and name in seen:
            message = f"a second block named '{name}'; the first is on line {seen[name]}"
            raise SketchError(message, file=text.path, line=block.line)
        if name:
            seen[name] = block.line

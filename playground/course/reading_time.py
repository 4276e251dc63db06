"""How long a lesson takes: its reading by its words and blocks, and apart from it its exercises."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from playground.course.document import Document
from playground.course.markdown import Piece

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

"""Read lessons, in English or a translation: how long each takes a reader, what of a translation is stale.

A translation records which English it was made from: ``source`` in its front matter holds a hash of each
English block. Where the English has changed since, the translated text is still shown, and ``status_of``
names the block.
"""

from __future__ import annotations

import difflib
import hashlib
import math
import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from playground.course.document import Document, Fence, Piece, prose_of, read_document, texts_in
from playground.course.fences import READERS, open_fence, read_fence
from playground.course.library import SOURCE, lesson_file, lesson_names, number_of, parts
from playground.course.model import Block, Lesson, Named, Prose, block_classes, key_of, translated_fields
from playground.course.scenes import Sketches
from playground.errors import SketchError, counted
from playground.files import write_file
from playground.sketch.find import shipped_sketches

_TRANSLATED_FRONT = ("title", "goal", "source")
_SOURCE = re.compile(r"^source\s*=\s*\[.*?\]", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True, slots=True)
class Stale:
    """What a translation lacks of today's English."""

    changed: tuple[int, ...] = ()  # indices of English blocks whose text is another now
    added: tuple[int, ...] = ()  # indices of English blocks that were not there
    removed: int = 0  # how many are there no more

    @property
    def any(self) -> bool:
        """Whether there is anything to translate."""
        return bool(self.changed or self.added or self.removed)


def hashes(text: Document) -> list[str]:
    """Return the hash of each block of an English file; the first is that of title and goal."""
    front = "\n".join(str(text.front.table.get(key, "")) for key in ("title", "goal"))
    return [_hash(front), *(_hash(piece.text) for piece in text.pieces)]


def stale(english: Document, other: Document) -> Stale:
    """Compare what a translation was made from with what the English says now; index 0 is the front.

    Raises ``SketchError`` where the translation has other blocks than it was marked with.
    """
    return _matched(_source(other), hashes(english))[1]


def translated(lesson: Lesson, english: Document, other: Document, language: str) -> Lesson:
    """Return a lesson with the texts of a translation.

    Raises ``SketchError`` where the translation has other blocks than the English had when it
    was made, sets more than texts, or lacks some. Of a stale translation, the English blocks
    that are new, or that its texts no longer fit, stay in English.
    """
    front = other.front
    front.only(front.table, _TRANSLATED_FRONT)
    if then := _source(other):
        pairs, lost = _matched(then, hashes(english))
    else:
        pairs, lost = dict(enumerate(range(len(other.pieces)))), Stale()
        _check_count(lesson.blocks, other)
    sketches = Sketches()
    changed = {index - 1 for index in lost.changed}
    blocks = []
    for index, block in enumerate(lesson.blocks):
        try:
            put = index in pairs
            blocks.append(_put(block, other.pieces[pairs[index]], other, sketches) if put else block)
        except SketchError:
            if index not in changed:
                raise
            blocks.append(block)  # its English has become something else altogether
    return replace(
        lesson,
        language=language,
        title=front.take(front.table, "title", str, lesson.title),
        goal=front.take(front.table, "goal", str, lesson.goal),
        blocks=tuple(blocks),
        stale=tuple(index - 1 for index in (*lost.changed, *lost.added)),
    )


def mark(lesson: Lesson, english: Document, other: Document, language: str) -> None:
    """Write the hashes into a translation whose texts all fit today's English; raise as ``translated``.

    Nothing is written where it raises.
    """
    unmarked = copy(other.front)
    unmarked.table = {key: value for key, value in other.front.table.items() if key != "source"}
    translated(lesson, english, replace(other, front=unmarked), language)
    write_hashes(english, other)


def write_hashes(english: Document, other: Document) -> None:
    """Write the hashes of today's English into a translation; the file is replaced whole.

    Raises ``SketchError`` where it has not as many blocks.
    """
    _check_count(english.pieces, other)
    text = other.path.read_text(encoding="utf-8")
    rows = [f'    "{digest}",' for digest in hashes(english)]
    line = "\n".join(["source = [", *rows, "]"])
    edge = text.index("\n+++", 3)
    front, rest = text[:edge], text[edge:]
    front = _SOURCE.sub(line, front, count=1) if _SOURCE.search(front) else f"{front}\n{line}"
    tomllib.loads(front.removeprefix("+++"))  # what is written can be read
    write_file(other.path, front + rest)


def _source(other: Document) -> tuple[str, ...]:
    """Return the hashes that a translation holds, none where it was not marked yet."""
    texts = texts_in(other.front, "source")
    if texts and len(texts) != len(other.pieces) + 1:
        message = f"{len(other.pieces)} blocks, but source names {len(texts) - 1}"
        raise other.front.error(message, "source")
    return texts


def _matched(then: Sequence[str], now: Sequence[str]) -> tuple[dict[int, int], Stale]:
    """Map English blocks to those of a translation, equal or replaced; say what it lacks of the English.

    The map counts blocks without the front, ``Stale`` with it.
    """
    matches: dict[int, int] = {}
    changed: list[int] = []
    added: list[int] = []
    removed = 0
    for tag, low, high, first, last in difflib.SequenceMatcher(None, then, now, False).get_opcodes():
        both = min(high - low, last - first)
        matches |= dict(zip(range(first, first + both), range(low, low + both), strict=True))
        if tag != "equal":
            changed += range(first, first + both)
            added += range(first + both, last)
            removed += high - low - both
    pairs = {new - 1: old - 1 for new, old in matches.items() if new and old}
    return pairs, Stale(tuple(changed), tuple(added), removed)


def _put(block: Block, piece: Piece, other: Document, sketches: Sketches) -> Block:
    _check_kind(block, piece, other)
    if isinstance(block, Prose):
        return replace(block, markdown=prose_of(piece).markdown)
    assert isinstance(block, Named)
    return replace(block, **_texts(block, open_fence(piece, other.path, piece.line, sketches)))


def _check_kind(english: Block | Piece, piece: Piece, other: Document) -> None:
    """Raise ``SketchError`` where a piece of a translation is another kind of block than the English one."""
    if isinstance(english, Named) or (isinstance(english, Piece) and english.kind == "fence"):
        head = " ".join(english.text.split("\n", 1)[0].lstrip("`~").split())
        here = piece.info if piece.kind == "fence" else f"a {piece.kind}"
        message = f"expected the block '{head}' here, found {here}" if here != head else ""
    else:
        mine, theirs = prose_of(piece), prose_of(english) if isinstance(english, Piece) else english
        assert isinstance(theirs, Prose)
        same = (mine.kind, mine.level) == (theirs.kind, theirs.level)
        message = f"a {mine.kind} is here, where the English has a {theirs.kind} (line {english.line})"
        message = "" if same else message
    if message:
        raise SketchError(message, file=other.path, line=piece.line)


def _texts(block: Named, fence: Fence) -> dict[str, Any]:
    """Return the texts of a translated block, by field; raise ``SketchError`` where they do not fit."""
    texts = translated_fields(type(block))
    keys = [key_of(text) for text in texts]
    for key in fence.file.table:
        if key not in keys:
            message = f"'{key}' is not for a translation, which sets only {', '.join(keys)}"
            raise fence.error(message, key)
    plan: dict[str, Any] = {}
    for text in texts:
        key, there = key_of(text), getattr(block, text.name)
        listed = "listed" in text.metadata
        texts_given: Any = fence.texts(key) if listed else fence.markdown(key, needed=bool(there))
        if listed and len(texts_given) != len(there):
            raise fence.error(f"{key}: {len(texts_given)} here, {len(there)} in English", key)
        if texts_given and not there:
            raise fence.error(f"{key}: the English has none", key)
        plan[text.name] = texts_given
    return plan


def _check_count(english: Sequence[Block | Piece], other: Document) -> None:
    """Raise ``SketchError`` at the first block that is another, where there are not as many as in English."""
    if len(other.pieces) == len(english):
        return
    for piece, part in zip(other.pieces, english, strict=False):
        _check_kind(part, piece, other)
    message = f"{len(other.pieces)} blocks, where the English has {len(english)}"
    raise SketchError(message, file=other.path, line=other.pieces[-1].line if other.pieces else 1)


def _hash(text: str) -> str:
    """Hash a text: where its lines are broken does not matter."""
    return hashlib.sha256(" ".join(text.split()).encode()).hexdigest()[:8]


@dataclass(frozen=True)
class Status:
    """The state of a translation."""

    lesson: str
    language: str
    state: str  # missing | unmarked | stale | current
    changed_lines: tuple[int, ...] = ()  # of the English file
    new_lines: tuple[int, ...] = ()
    removed_blocks: int = 0

    @property
    def sentences(self) -> list[str]:
        """What there is to do, in English."""
        listed = []
        if self.state == "unmarked":
            listed.append(f"playground lesson translated {self.lesson} --lang {self.language}")
        for change, lines in (("changed", self.changed_lines), ("new", self.new_lines)):
            if lines:
                listed.append(f"{change}: line{'s' if len(lines) > 1 else ''} {', '.join(map(str, lines))}")
        if self.removed_blocks:
            listed.append(f"{counted(self.removed_blocks, 'block')} of it no longer in English")
        return listed


def status_of(name: str, language: str) -> Status:
    """Return the state of a translation; raise ``SketchError`` for one that cannot be read."""
    path = lesson_file(name, language)
    if not path.is_file():
        return Status(name, language, "missing")
    english, other = read_document(lesson_file(name)), read_document(path)
    if not other.front.table.get("source"):
        return Status(name, language, "unmarked")
    lost = stale(english, other)
    if not lost.any:
        return Status(name, language, "current")
    return Status(
        name,
        language,
        "stale",
        _lines(english, lost.changed),
        _lines(english, lost.added),
        lost.removed,
    )


def _lines(english: Document, indices: Sequence[int]) -> tuple[int, ...]:
    """Return the lines of blocks; the first index is that of title and goal."""
    return tuple(english.pieces[index - 1].line if index else 1 for index in indices)


WORDS_A_MINUTE = 200

BLOCK_SECONDS = {
    "figure": 15.0,
    "compare": 15.0,
    "step": 30.0,
    "slider": 30.0,
    "code": 30.0,
    "trace": 30.0,
    "question": 30.0,
    "break": 120.0,
    "measure": 0.0,
}
"""[s] What a block takes besides its words: a picture to be looked at, a bug to be found."""

TASK_SECONDS, KERNEL_SECONDS = 240.0, 360.0
"""[s] What an exercise or a challenge takes besides its words, and one in which a kernel is written."""

NUMBER_SECONDS = 90.0
"""[s] What a question for a number takes besides its words: it is computed by hand."""

TASKS = ("exercise", "challenge")
"""The kinds of block that count as exercises, and not as reading; so does a question for a number."""

_READ = {key_of(text) for kind in block_classes(Named) for text in translated_fields(kind)} - {"alt"}
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
    if kind in TASKS or _asks_number(piece):
        return 0.0
    return _seconds(_block_words(piece)) + (BLOCK_SECONDS[kind] if kind in READERS else 0.0)


def _task_seconds(piece: Piece) -> float:
    if _asks_number(piece):
        return _seconds(_block_words(piece)) + NUMBER_SECONDS
    if piece.kind != "fence" or piece.info.partition(" ")[0] not in TASKS:
        return 0.0
    own = KERNEL_SECONDS if "file" in _table(piece) else TASK_SECONDS
    return _seconds(_block_words(piece)) + own


def _asks_number(piece: Piece) -> bool:
    is_question = piece.kind == "fence" and piece.info.partition(" ")[0] == "question"
    return is_question and "trace" in _table(piece)


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

"""Take from a submission the file of each exercise: by its name, wherever in the submission it is.

An exercise's file is ``LESSON-EXERCISE.glsl`` or ``LESSON-EXERCISE.toml``, as the hand-out has it. What
systems and browsers make of a name ("x (1).glsl", "x.glsl.txt", other capitals) is taken as meant.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from playground.course.grading.entries import Entry, entries_of, printable
from playground.course.translatable import Said
from playground.errors import DataError

_NUMBERED = re.compile(r"(?:[ _-]*\(\d+\)|[ _-]+copy(?:[ _-]*\d+)?|[ _-]+kopie)+(?=\.[^.]+$)")
_MARKS = {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}  # of what Windows writes as "Unicode"


@dataclass(frozen=True)
class HandedIn:
    """The file of one exercise, or why there is none."""

    text: str = ""
    problem: str = ""  # a message without a full stop; "": there is none
    note: str = ""  # on which of several files it is
    missing: bool = False  # it was not handed in


def read_submission(path: Path, names: Collection[str]) -> dict[str, HandedIn]:
    """Return the wanted files of a submission by their names; what is wrong with one is in it, in a message.

    Never raises for what a student has done.
    """
    try:
        entries = entries_of(path)
    except DataError as error:
        problem = Said("{name} {what}", name=printable(path.name), what=error.diagnostics[0].message)
        return {name: HandedIn(problem=problem) for name in names}
    entries_by_name = {name: [e for e in entries if _plain_name(e.name) == name.casefold()] for name in names}
    archives = [entry for entry in entries if entry.is_archive][:1]  # what is missing may be in one
    return {name: _file_of(named) if named else _file_of(archives) for name, named in entries_by_name.items()}


def lessons_in(path: Path, lessons: Collection[str]) -> set[str]:
    """Return the lessons, of those named, of which a submission holds files; none where it cannot be read."""
    try:
        stems = {_plain_name(entry.name).partition("-")[0] for entry in entries_of(path)}
    except DataError:
        return set()
    return stems & set(lessons)


def _file_of(entries: list[Entry]) -> HandedIn:
    """Return the first of the files that go by one name, and say so where another differs."""
    if not entries:
        return HandedIn(missing=True)
    first = _read(entries[0])
    others = [_read(entry) for entry in entries[1:4]]
    if all(other.text == first.text and not other.problem for other in others):
        return first
    note = Said(
        "{count} files of this name were handed in; graded: {path}",
        count=len(entries),
        path=printable(entries[0].path),
    )
    return HandedIn(first.text, first.problem, note)


def _read(entry: Entry) -> HandedIn:
    try:
        data = entry.read()
        encoding = _MARKS.get(data[:2], "utf-8-sig")
        text = data.decode(encoding).replace("\r\n", "\n").replace("\r", "\n")
    except DataError as error:
        return HandedIn(
            problem=Said("{name} {what}", name=printable(entry.name), what=error.diagnostics[0].message)
        )
    except UnicodeDecodeError:
        return HandedIn(
            problem=Said("{name} is not UTF-8 text; save the file as UTF-8", name=printable(entry.name))
        )
    if "\0" in text:
        return HandedIn(problem=Said("{name} is not a text: it holds zero bytes", name=printable(entry.name)))
    return HandedIn(text)


def _plain_name(name: str) -> str:
    """Return a file's name without what a copy or a download has added to it."""
    name = unicodedata.normalize("NFKC", name).casefold()
    if name.endswith((".glsl.txt", ".toml.txt")):
        name = name.removesuffix(".txt")
    return _NUMBERED.sub("", name)

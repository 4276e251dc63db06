"""Find the submissions in a folder: a folder or a zip for each student, by whose name the student goes."""

from __future__ import annotations

import unicodedata
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path

from playground.course.grading.entries import is_by_system, is_zip
from playground.course.grading.report import is_report
from playground.errors import DataError
from playground.paths import shown


@dataclass(frozen=True)
class Submission:
    """What one student has handed in."""

    student: str  # the folder's or the zip's name, as given; numbered where another has it
    path: Path


def find_submissions(folder: Path, report: Path) -> tuple[list[Submission], list[str]]:
    """List the submissions of a folder by name, and in a message each what else is there.

    ``report`` is left out: it may be in the same folder. No two students have one name. Raises
    ``DataError`` for a folder that is missing or holds no submission.
    """
    if not folder.is_dir():
        what = "is a file" if folder.is_file() else "there is no such folder"
        raise DataError(
            f"{what}; expected a folder with a folder or a zip for each student", file=shown(folder)
        )
    paths: list[Path] = []
    others: list[str] = []
    try:
        items = sorted(
            folder.iterdir(), key=lambda path: (unicodedata.normalize("NFKD", path.name), path.name)
        )
    except OSError as error:
        raise DataError(f"cannot be read: {error.strerror}", file=shown(folder)) from None
    for path in items:
        if path.name.startswith(".") or is_by_system(path.name) or path.resolve() == report.resolve():
            continue
        if path.is_symlink() or not (path.is_dir() or is_zip(path)):
            others.append(f"{readable(path.name)!r} is no folder and no zip")
        elif is_report(path):
            others.append(f"{readable(path.name)!r} is an earlier report of grades")
        else:
            paths.append(path)
    if not paths:
        raise DataError("holds no folder and no zip; expected one for each student", file=shown(folder))
    names = Counter(_student_of(path) for path in paths)
    students = _numbered(
        [_student_of(path) if names[_student_of(path)] == 1 else readable(path.name) for path in paths]
    )
    return [Submission(student, path) for student, path in zip(students, paths, strict=True)], others


def readable(name: str) -> str:
    """Return a file's name as text: bytes that are no UTF-8 become question marks in diamonds."""
    return name.encode("utf-8", "surrogateescape").decode("utf-8", "replace")


def _numbered(names: Sequence[str]) -> list[str]:
    """Return names of which no two are the same: the second "Ana" is "Ana (2)", if none has that name."""
    taken, result = set(names), list[str]()
    for name in names:
        alone = name
        if name in result:
            alone = next(new for n in count(2) if (new := f"{name} ({n})") not in taken)
            taken.add(alone)
        result.append(alone)
    return result


def _student_of(path: Path) -> str:
    return readable(path.stem if path.suffix.lower() == ".zip" else path.name)

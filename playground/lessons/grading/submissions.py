"""Find the submissions in a folder: a folder or a zip for each student, by whose name the student goes."""

from __future__ import annotations

import unicodedata
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from playground.errors import DataError
from playground.lessons.grading.entries import is_by_system, is_zip
from playground.paths import shown


@dataclass(frozen=True)
class Submission:
    """What one student has handed in."""

    student: str  # the folder's or the zip's name, as given
    path: Path


def find_submissions(folder: Path, report: Path) -> tuple[list[Submission], list[str]]:
    """List the submissions of a folder by name, and the names of what else is there.

    ``report`` is left out: it may be in the same folder. Raises ``DataError`` for a folder that is missing
    or holds no submission.
    """
    if not folder.is_dir():
        what = "is a file" if folder.is_file() else "there is no such folder"
        raise DataError(
            f"{what}; expected a folder with a folder or a zip for each student", file=shown(folder)
        )
    found: list[Path] = []
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
            others.append(readable(path.name))
        else:
            found.append(path)
    if not found:
        raise DataError("holds no folder and no zip; expected one for each student", file=shown(folder))
    names = Counter(_student_of(path) for path in found)
    alone = {
        path: _student_of(path) if names[_student_of(path)] == 1 else readable(path.name) for path in found
    }
    return [Submission(alone[path], path) for path in found], others


def readable(name: str) -> str:
    """Return a file's name as text: bytes that are no UTF-8 become question marks in diamonds."""
    return name.encode("utf-8", "surrogateescape").decode("utf-8", "replace")


def _student_of(path: Path) -> str:
    return readable(path.stem if is_zip(path) and not path.is_dir() else path.name)

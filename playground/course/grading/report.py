"""Write the report of grades into a folder: the table, the contact sheet, its pictures.

grades.csv    a row for each student; one that was changed since is kept as "grades (1).csv"
index.html    the contact sheet, with the hash of grades.csv as it was written
pictures/     named after their bytes: equal ones share a file
"""

from __future__ import annotations

import hashlib
import io
import re
from collections.abc import Sequence
from itertools import count
from pathlib import Path

from PIL import Image

from playground.course.grading.marks import Graded
from playground.course.grading.page import ReportContext, page, table_hash_of
from playground.course.grading.table import table_bytes
from playground.errors import DataError
from playground.files import write_file
from playground.paths import shown

TABLE, PAGE, PICTURES = "grades.csv", "index.html", "pictures"
_PICTURE = re.compile(r"[0-9a-f]{20}\.webp")


def is_report(folder: Path) -> bool:
    """Return whether a folder holds a report of grades."""
    files = (folder / TABLE).is_file() and (folder / PAGE).is_file()
    return files and (folder / PICTURES).is_dir()


def check_folder(folder: Path) -> None:
    """Raise ``DataError`` where a report would go over what is none."""
    there = folder.exists()
    if there and (not folder.is_dir() or (any(folder.iterdir()) and not (folder / TABLE).is_file())):
        message = "there is something here that is no report of grades; name a new or empty folder"
        raise DataError(message, file=shown(folder))
    if not there and not folder.absolute().parent.is_dir():
        raise DataError(f"there is no folder '{folder.parent}' to write into", file=shown(folder))


def write_report(
    folder: Path, graded: Sequence[Graded], titles: dict[str, str], language: str, renderer: str
) -> tuple[Path, Path | None]:
    """Write the report; return its page, and what an earlier table that was changed since is now kept as.

    Pictures of an earlier report that are no longer shown are removed.
    Raises ``DataError`` where it cannot be written.
    """
    written: set[str] = set()

    def file_of(data: bytes) -> str:
        name = f"{hashlib.sha256(data).hexdigest()[:20]}.webp"
        if name not in written:
            written.add(name)
            _write(folder / PICTURES / name, data)
        return f"{PICTURES}/{name}"

    try:
        (folder / PICTURES).mkdir(parents=True, exist_ok=True)
        table = table_bytes(graded, list(titles), language)
        text = page(graded, titles, ReportContext(language, renderer, file_of, _size_of, _hash(table)))
        kept = _keep_changed(folder, table)
        _write(folder / TABLE, table)
        _write(folder / PAGE, text.encode("utf-8", "replace"))
        for old in (folder / PICTURES).iterdir():
            if _PICTURE.fullmatch(old.name) and old.name not in written:
                old.unlink()
    except OSError as error:
        raise DataError(f"cannot be written: {error.strerror}", file=shown(folder)) from None
    return folder / PAGE, kept


def _keep_changed(folder: Path, new: bytes) -> Path | None:
    """Copy a table that is not as the last report wrote it to a name that is free, and return that."""
    table, page_file = folder / TABLE, folder / PAGE
    if not table.is_file():
        return None
    data = table.read_bytes()
    written = table_hash_of(page_file.read_text("utf-8", "replace")) if page_file.is_file() else ""
    if data == new or _hash(data) == written:
        return None
    names = (table.with_stem(f"{table.stem} ({number})") for number in count(1))
    kept = next(path for path in names if not path.exists())
    _write(kept, data)
    return kept


def _hash(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _size_of(data: bytes) -> tuple[int, int]:
    with Image.open(io.BytesIO(data)) as picture:
        return picture.size


def _write(path: Path, data: bytes) -> None:
    write_file(path, data)

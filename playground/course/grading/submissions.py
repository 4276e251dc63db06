"""Find submissions, and read the files of one, a folder or a zip, of which nothing is trusted.

No link is followed, nothing is written to the disk, and how many files and bytes are looked at is
bounded before the first is read. A zip that lies in the folder is looked into as if it were a folder.
"""

from __future__ import annotations

import os
import re
import stat
import unicodedata
import zipfile
import zlib
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path

from playground.course.grading.report import is_report
from playground.course.library import Said
from playground.errors import DataError
from playground.paths import shown

MAX_FILES = 4000
"""Files and folders that a submission may hold."""

MAX_TEXT_BYTES = 2**20
"""Bytes of a file that is graded: a kernel or a sketch's TOML."""

_MAX_DEPTH = 16  # folders in folders
_MAX_ZIP_BYTES = 2**28  # [bytes] a zip may have
_MAX_LIST_BYTES = 2**21  # [bytes] a zip's list of files may have
_MAX_UNPACKED_BYTES = 2**30  # [bytes] its files may become
_ALWAYS_FINE = 2**26  # [bytes] unpacked, with any ratio
_MAX_RATIO = 200  # of what is unpacked to the zip
_ENDING = ".zip"
_FIRST_MARK = b"PK\x03\x04"  # of a zip's first file; section 4.3.7
_END_MARK = b"PK\x05\x06"  # of a zip's list; APPNOTE 6.3.10, section 4.3.16
_ZIP64_MARK, _ZIP64_BYTES = b"PK\x06\x07", 20  # of what points to a larger list; section 4.3.15
_END_BYTES = 22 + 2**16  # its record and the longest comment
TOO_MANY = "holds more than {most} files; expected the folder of the hand-out"
_BY_SYSTEMS = ("__macosx", ".ds_store", "thumbs.db", "desktop.ini")


@dataclass(frozen=True)
class Entry:
    """One file of a submission."""

    path: str  # within it, with "/"
    read: Callable[[], bytes]  # its bytes; raises ``DataError`` in a message
    is_archive: bool = False  # a zip that is not looked into: ``read`` raises why

    @property
    def name(self) -> str:
        """The file's own name."""
        return self.path.rpartition("/")[2]


def entries_of(path: Path) -> list[Entry]:
    """List a submission's files, those of the zips in it as well, the shallowest first.

    Raises ``DataError`` in a message for what is no folder and no zip, for more than is looked at, and for
    a zip that was made to do harm.
    """
    entries = list(_zip_entries(path) if is_zip(path) else _folder_entries(path))
    return sorted(entries, key=lambda entry: (entry.path.count("/"), entry.path))


def is_zip(path: Path) -> bool:
    """Return whether a path is a zip: a file, by its ending or else by its first bytes; never a link."""
    try:
        if not stat.S_ISREG(path.lstat().st_mode):
            return False
        if path.suffix.lower() == _ENDING:
            return True
        with path.open("rb") as file:
            return file.read(len(_FIRST_MARK)) == _FIRST_MARK
    except OSError:
        return False


def is_by_system(path: str) -> bool:
    """Return whether a file is one that macOS or Windows adds by itself, or a hidden one."""
    parts = path.split("/")
    return any(part.casefold() in _BY_SYSTEMS or part.startswith("._") for part in parts)


def _folder_entries(top: Path) -> Iterator[Entry]:
    count, waiting = 0, [(top, "")]
    while waiting:
        folder, prefix = waiting.pop()
        for item in _listed(folder):
            path = f"{prefix}{item.name}"
            if is_by_system(path):
                continue
            count += 1
            if count > MAX_FILES:
                raise DataError(Said(TOO_MANY, most=MAX_FILES))
            if item.is_dir(follow_symlinks=False):
                if path.count("/") < _MAX_DEPTH:
                    waiting.append((Path(item.path), f"{path}/"))
            elif is_zip(Path(item.path)):
                yield from _inner_entries(path, Path(item.path))
            else:
                yield Entry(path, _reader_of(Path(item.path)))


def _inner_entries(name: str, path: Path) -> Iterator[Entry]:
    """Yield the files of a zip in a folder; of one that cannot be read, the zip itself."""
    try:
        entries = [Entry(f"{name}/{e.path}", e.read, e.is_archive) for e in _zip_entries(path)]
    except DataError as error:
        entries = [Entry(name, _raiser(error), is_archive=True)]
    yield from entries


def _raiser(error: DataError) -> Callable[[], bytes]:
    def read() -> bytes:
        raise error

    return read


def _listed(folder: Path) -> list[os.DirEntry[str]]:
    try:
        with os.scandir(folder) as items:
            result = []
            for item in items:
                result.append(item)
                if len(result) > MAX_FILES:
                    break
            return sorted(result, key=lambda item: item.name)
    except OSError as error:
        raise DataError(Said("cannot be read: {why}", why=error.strerror)) from None


def _reader_of(path: Path) -> Callable[[], bytes]:
    def read() -> bytes:
        try:
            kind = path.lstat()
            if stat.S_ISLNK(kind.st_mode):
                raise DataError(Said("is a link to another file; only plain files are read"))
            if not stat.S_ISREG(kind.st_mode):  # to open a pipe or a device may never end
                raise DataError(Said("is a pipe, a socket or a device; only plain files are read"))
            _check_size(kind.st_size)
            flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
            flags |= getattr(os, "O_BINARY", 0)
            with os.fdopen(os.open(path, flags), "rb") as file:
                return _whole(file.read(MAX_TEXT_BYTES + 1))
        except OSError as error:
            raise DataError(Said("cannot be read: {why}", why=error.strerror)) from None

    return read


def _check_size(size: int) -> None:
    if size > MAX_TEXT_BYTES:
        raise DataError(
            Said(
                "has {size:.0f} MiB; a text of at most {most:.0f} is read",
                size=size / 2**20,
                most=MAX_TEXT_BYTES / 2**20,
            )
        )


def _whole(data: bytes) -> bytes:
    _check_size(len(data))  # a file may have grown, and a zip lies about its files' sizes
    return data


def _zip_entries(path: Path) -> Iterator[Entry]:
    """Yield the files of a zip; raise ``DataError`` for one that is not safe, before anything is unpacked."""
    try:
        _check_list(path)
        with zipfile.ZipFile(path) as archive:
            items = [item for item in archive.infolist() if not is_by_system(item.filename)]
            _check_zip(items, path.stat().st_size)
    except DataError:
        raise
    except (OSError, zipfile.BadZipFile, NotImplementedError, RuntimeError, ValueError) as error:
        raise DataError(Said("is no zip that can be read: {why}", why=_reason(error))) from None
    for item in items:
        if item.filename.lower().endswith(_ENDING):
            nested = DataError(Said("is a zip in a zip, which is not looked into; hand in its folder"))
            yield Entry(item.filename, _raiser(nested), is_archive=True)
        elif not item.is_dir():
            yield Entry(item.filename, _zip_reader(path, item))


def _check_list(path: Path) -> None:
    """Raise ``DataError`` for a zip whose list of files alone would take too much memory."""
    if not stat.S_ISREG(path.lstat().st_mode):
        raise DataError(Said("is a link or a device; only plain files are read"))
    size = path.stat().st_size
    if size > _MAX_ZIP_BYTES:
        raise DataError(
            Said(
                "has {size:.0f} MiB; a zip of at most {most} is read",
                size=size / 2**20,
                most=_MAX_ZIP_BYTES // 2**20,
            )
        )
    with path.open("rb") as file:
        file.seek(max(size - _END_BYTES - _ZIP64_BYTES, 0))
        tail = file.read(_END_BYTES + _ZIP64_BYTES)
    end_mark = tail.rfind(_END_MARK)
    if end_mark < 0 or len(tail) < end_mark + 20:
        raise DataError(Said("is no zip that can be read: it is cut short, or something else by this name"))
    count = int.from_bytes(tail[end_mark + 10 : end_mark + 12], "little")
    length = int.from_bytes(tail[end_mark + 12 : end_mark + 16], "little")
    # With this mark before the end record, that of a larger list (zip64) counts, whatever is written here.
    larger = tail[max(end_mark - _ZIP64_BYTES, 0) : end_mark].startswith(_ZIP64_MARK)
    if larger or count > MAX_FILES or length > _MAX_LIST_BYTES:
        raise DataError(Said(TOO_MANY, most=MAX_FILES))


def _check_zip(items: list[zipfile.ZipInfo], size: int) -> None:
    if len(items) > MAX_FILES:
        raise DataError(Said(TOO_MANY, most=MAX_FILES))
    whole = sum(item.file_size for item in items)
    if sum(item.compress_size for item in items) > size:
        raise DataError(Said("its files overlap, as those of a zip bomb do; it is not unpacked"))
    if whole > _MAX_UNPACKED_BYTES or (whole > _ALWAYS_FINE and whole > _MAX_RATIO * size):
        raise DataError(
            Said(
                "would become {whole:.0f} MiB from {size:.2g}, as a zip bomb does; it is not unpacked",
                whole=whole / 2**20,
                size=size / 2**20,
            )
        )
    for item in items:
        name = item.filename
        if name.startswith("/") or "\\" in name or ".." in name.split("/") or name[1:2] == ":":
            raise DataError(
                Said(
                    "holds '{name}', which leads out of its folder; it is not unpacked", name=printable(name)
                )
            )


def _zip_reader(path: Path, item: zipfile.ZipInfo) -> Callable[[], bytes]:
    def read() -> bytes:
        if stat.S_IFMT(item.external_attr >> 16) not in (0, stat.S_IFREG):
            raise DataError(Said("is a link or a device; only plain files are read"))
        if item.flag_bits & 1:
            raise DataError(Said("is encrypted; expected a zip without a password"))
        _check_size(item.file_size)
        try:
            with zipfile.ZipFile(path) as archive, archive.open(item) as file:
                return _whole(file.read(MAX_TEXT_BYTES + 1))
        except (
            OSError,
            zipfile.BadZipFile,
            NotImplementedError,
            RuntimeError,
            zlib.error,
            EOFError,
        ) as error:
            raise DataError(Said("is damaged in its zip: {why}", why=_reason(error))) from None

    return read


def printable(text: str, most: int = 80) -> str:
    """Return a name as it can be shown in one line, by others as well: no control characters."""
    return "".join(c if c.isprintable() else "?" for c in text)[:most]


def _reason(error: BaseException) -> str:
    text = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return printable(" ".join(text.split()).rstrip(".")) or type(error).__name__


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


_NUMBERED = re.compile(r"(?:[ _-]*\(\d+\)|[ _-]+copy(?:[ _-]*\d+)?|[ _-]+kopie)+(?=\.[^.]+$)")
_ENCODINGS = {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}  # of what Windows writes as "Unicode"


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
        encoding = _ENCODINGS.get(data[:2], "utf-8-sig")
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

"""Accept pictures of a folder of results as references, and undo that.

A picture becomes a reference as it was looked at: its pixels, and the fingerprint of what
drew it. Nothing is drawn again. It is refused, in a message, where it would be wrong: a
broken picture, one that is not there any more, references that have changed since the
shot was checked.

A record's paths are from the folder that the tests were started in; where that is not on
this machine (results of a continuous integration), from the folder of this process.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.data.image_files import read_png, write_png
from playground.errors import DataError, ParameterError, nearest
from playground.files import make_folder, read_regular, write_file
from playground.paths import shown
from playground.verify.shots.references import FOLDER, accepted_in
from playground.verify.shots.results import Record, digest_of, digests_of
from playground.verify.shots.verdicts import verdict_on

_SLUG = re.compile(r"[a-z0-9-]+")


@dataclass(frozen=True)
class Change:
    """What accepting a picture did to the references of its shot; enough to undo it."""

    name: str  # "sketch/shot"
    written: Path | None  # None: one of the references was this picture already
    removed: tuple[Path, ...] = ()  # further references, which would have let the old picture pass
    before: dict[Path, bytes] = field(default_factory=dict)  # the files that were there, whole
    after: dict[str, str] = field(default_factory=dict)  # name → SHA-256 of those that are there now

    @property
    def further(self) -> bool:
        """Whether it was added to the references that were there."""
        return self.written is not None and bool(self.before) and self.written not in self.before

    @property
    def messages(self) -> list[str]:
        """Return what was done, a line for each file."""
        if self.written is None:
            return [f"{self.name}: a reference is this picture already"]
        replaced = "a further one that may match" if self.further else "the first"
        if self.written in self.before:
            replaced = "in place of the one before"
        lines = [f"wrote {shown(self.written)}  ({replaced})"]
        return lines + [
            f"removed {shown(path)}  (it let the picture before this one pass)" for path in self.removed
        ]


def accept(folder: Path, record: Record, *, also: bool = False) -> Change:
    """Write the picture of a record in ``folder`` as its shot's reference.

    It takes the place of all references that its renderer has for the shot; with ``also``
    they stay, and it becomes a further one that may match. Raises ``DataError`` where it
    must not, or cannot, be written; nothing is changed then.
    """
    if record.ok:
        raise DataError(f"{record.name}: it passed, so nothing to accept")
    if not verdict_on(record.word).acceptable:
        raise DataError(f"{record.name}: no reference can be made of it ({record.message})")
    if also and record.word == "unreadable":
        raise DataError(f"{record.name}: its reference is damaged, so it cannot stay next to this one")
    position = _place(record)
    pixels = _picture(folder, record)
    there = accepted_in(position, record.shot)
    if digests_of(there) != record.expected.references:
        if any(_shows(path, pixels) for path in there):
            return Change(record.name, None)
        raise DataError(f"{record.name}: {_changed(record, there)} since it was checked; run the tests again")
    before = {path: read_regular(path) for path in there}
    written = _further(position, record.shot, there) if also and there else position / f"{record.shot}.png"
    make_folder(position)
    write_png(written, pixels, text=record.actual.texts)
    removed = () if also else tuple(path for path in there if path != written)
    for path in removed:
        path.unlink()
    return Change(record.name, written, removed, before, digests_of(accepted_in(position, record.shot)))


def undo(change: Change) -> list[str]:
    """Restore the references as they were before a change, and return a line for each file.

    Raises ``DataError`` where one has been written since: that would be lost.
    """
    if change.written is None:
        return []
    folder, shot = change.written.parent, change.name.rpartition("/")[2]
    if digests_of(accepted_in(folder, shot)) != change.after:
        raise DataError(
            f"{change.name}: its references have changed since it was accepted; nothing is undone"
        )
    lines = []
    for path, data in change.before.items():
        if path.exists() and digest_of(data) == digest_of(read_regular(path)):
            continue
        write_file(path, data)
        lines.append(f"restored {shown(path)}")
    if change.written not in change.before:
        change.written.unlink()
        lines.append(f"removed {shown(change.written)}  (there was none before)")
    return lines


def choose(records: list[Record], patterns: list[str]) -> list[Record]:
    """Return the records that are named, as "sketch/shot" or with ``*``, ``?`` and ``[abc]``.

    A pattern means only shots that failed; a name means itself. Raises ``ParameterError``
    for one that nothing has.
    """
    cached: dict[str, Record] = {}
    for pattern in patterns:
        named = [record for record in records if record.name == pattern]
        if not named:
            named = [record for record in records if not record.ok and fnmatchcase(record.name, pattern)]
        if not named:
            wild = any(mark in pattern for mark in "*?[")
            what = "no shot that failed matches" if wild else "there is no result of a shot"
            raise ParameterError(f"{what} '{pattern}'{nearest(pattern, [r.name for r in records])}")
        cached |= {record.name: record for record in named}
    return list(cached.values())


def _place(record: Record) -> Path:
    """Return the folder of a record's references; raise ``DataError`` for none that can be one."""
    home = Path(record.expected.home)
    if home.name != FOLDER or ".." in home.parts or not _SLUG.fullmatch(record.renderer or "-"):
        raise DataError(f"{record.name}: its record does not say where its references belong")
    root = Path(record.run.root)
    base = root if record.run.root and root.is_absolute() and root.is_dir() else Path.cwd()
    return base / home / record.sketch / record.renderer


def _picture(folder: Path, record: Record) -> NDArray[np.uint8]:
    if "actual" not in record.actual.pictures:
        raise DataError(f"{record.name}: there is no picture of it in {shown(folder)}; run the tests again")
    path = folder / record.actual.pictures["actual"]
    try:
        data = read_regular(path)
    except OSError:
        raise DataError(f"{record.name}: its picture is not there any more; run the tests again") from None
    if digest_of(data) != record.actual.digest:
        raise DataError(f"{record.name}: its picture has changed since it was checked; run the tests again")
    return read_png(path)[0]


def _shows(path: Path, pixels: NDArray[np.uint8]) -> bool:
    try:
        return np.array_equal(read_png(path)[0], pixels)
    except DataError:
        return False


def _changed(record: Record, there: list[Path]) -> str:
    names = {path.name for path in there}
    gone = sorted(record.expected.references.keys() - names)
    new = sorted(names - record.expected.references.keys())
    if gone:
        return f"the reference {gone[0]} has gone"
    return f"the reference {new[0]} has come" if new else "the reference has changed"


def _further(folder: Path, shot: str, there: list[Path]) -> Path:
    number = 2
    while folder / f"{shot}.{number}.png" in there:
        number += 1
    return folder / f"{shot}.{number}.png"

"""Tell one state of a file from another, reading it no more often than it changes."""

from __future__ import annotations

import hashlib
import time
from pathlib import Path

from playground.allowed_files import sidecars
from playground.errors import DataError
from playground.files import open_regular, require_regular
from playground.memo import FILES
from playground.paths import shown

_TICK = 50_000_000  # [ns] more than a file system's clock takes to move on
LARGE = 2**26  # [bytes] takes longer to read than a tick lasts


def content_key(path: Path) -> str:
    """Return what changes whenever a file's contents do: their hash, or of a large file its times and size.

    The files next to it that say how to read it count as its contents.
    Raises ``DataError`` for a file that cannot be read.
    """
    files = (path, *sidecars(path))
    try:
        stats = [require_regular(file) for file in files]
    except OSError as error:
        raise DataError(f"cannot be read: {error.strerror}", file=shown(path)) from None
    if sum(stat.st_size for stat in stats) < LARGE:
        return _hash_of(files)
    times = (f"{stat.st_mtime_ns} {stat.st_ctime_ns} {stat.st_size} {stat.st_ino}" for stat in stats)
    return " ".join(f"{file.suffix} {time}" for file, time in zip(files, times, strict=True))


def content_hash(path: Path) -> str:
    """Return a hash of a file's contents, worked out again when its times, size or identity change.

    The files next to it that say how to read it count as its contents.
    Raises ``DataError`` for a file that cannot be read.
    """
    return _hash_of((path, *sidecars(path)))


def _hash_of(files: tuple[Path, ...]) -> str:
    path, *further = files
    if not further:
        return _own_hash(path)
    parts = [_own_hash(path), *(f"{file.suffix} {_own_hash(file)}" for file in further)]
    return hashlib.blake2b(" ".join(parts).encode(), digest_size=16).hexdigest()


def _own_hash(path: Path) -> str:
    try:
        stat = require_regular(path)
        # Two saves may fall into one tick of a file system's clock: what is so new is not remembered.
        is_new = abs(time.time_ns() - max(stat.st_mtime_ns, stat.st_ctime_ns)) < _TICK
        work_out = file_hash if is_new else _remembered_hash
        return work_out(str(path), stat.st_mtime_ns, stat.st_ctime_ns, stat.st_size, stat.st_ino)
    except OSError as error:
        raise DataError(f"cannot be read: {error.strerror}", file=shown(path)) from None


def file_hash(path: str, modified: int, changed: int, size: int, inode: int) -> str:
    """Read a file and return its hash; the other arguments tell whether it has changed since."""
    with open_regular(Path(path)) as file:
        return hashlib.file_digest(file, lambda: hashlib.blake2b(digest_size=16)).hexdigest()


_remembered_hash = FILES.cached()(file_hash)

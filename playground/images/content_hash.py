"""Tell whether a file has changed, and hash its contents, reading it no more often than it changes."""

from __future__ import annotations

import hashlib
import time
from functools import lru_cache
from pathlib import Path

from playground.errors import DataError
from playground.paths import shown

_TICK = 50_000_000  # [ns] more than a file system's clock takes to move on


def version_of(path: Path) -> tuple[int, ...]:
    """Return what changes whenever a file does, without reading it: its times, size and identity.

    A file that was written only now has another version at each call, for two saves may fall into one
    tick of a file system's clock. Raises ``DataError`` for a file that is not there.
    """
    try:
        stat = path.stat()
    except OSError as error:
        raise _unreadable(path, error) from None
    now = time.time_ns()
    version = (stat.st_mtime_ns, stat.st_ctime_ns, stat.st_size, stat.st_ino)
    return (*version, now) if abs(now - stat.st_mtime_ns) < _TICK else version


def content_hash(path: Path) -> str:
    """Return a hash of a file's contents, worked out anew when its version changes.

    Raises ``DataError`` for a file that cannot be read.
    """
    try:
        return _hash(str(path), version_of(path))
    except OSError as error:
        raise _unreadable(path, error) from None


def _unreadable(path: Path, error: OSError) -> DataError:
    return DataError(f"cannot be read: {error.strerror}", file=shown(path))


@lru_cache(maxsize=256)
def _hash(path: str, version: tuple[int, ...]) -> str:
    with Path(path).open("rb") as file:
        return hashlib.file_digest(file, lambda: hashlib.blake2b(digest_size=16)).hexdigest()

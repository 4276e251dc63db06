"""Write files under a temporary name in the same folder: locked while written, removed after.

The writer holds a lock on the file, which the system releases however a process ends. So
an unlocked one is left over from a process that was killed: it is removed the first
time that a process writes into its folder.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import BinaryIO

_NAMED = re.compile(r"\..{1,40}\.[0-9a-f]{12}\.part", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Partial:
    """A file that is being written."""

    path: Path
    handle: BinaryIO

    def rename(self, path: Path) -> None:
        """Give it the name that it is written for."""
        self.handle.flush()
        if sys.platform == "win32":
            self.handle.close()  # elsewhere it stays locked until it has its name
        self.path.replace(path)


@contextmanager
def partial_file(path: Path) -> Iterator[Partial]:
    """Create a file in the folder of ``path``, open in the block and removed after it, unless it was renamed.

    Raises ``OSError`` where it cannot be made.
    """
    remove_left_over(path.parent.absolute())
    partial = _made(path)
    try:
        with partial.handle:
            yield partial
    finally:
        partial.path.unlink(missing_ok=True)


@cache
def remove_left_over(folder: Path) -> None:
    """Remove the files that ended processes left in a folder; once for each folder."""
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if entry.name.startswith(".") and _NAMED.fullmatch(entry.name) and entry.is_file():
                with suppress(OSError), Path(entry.path).open("r+b") as left:
                    if _locked(left, wait=False):
                        if sys.platform == "win32":
                            left.close()  # there an open file cannot be removed
                        Path(entry.path).unlink(missing_ok=True)


def _made(path: Path) -> Partial:
    while True:
        partial = path.with_name(f".{path.name[:40]}.{os.urandom(6).hex()}.part")
        handle = partial.open("xb")
        try:
            _locked(handle, wait=True)
            # Another process may have found it before it was locked, and removed it.
            if partial.exists():
                return Partial(partial, handle)
        except BaseException:
            handle.close()
            partial.unlink(missing_ok=True)
            raise
        handle.close()


def _locked(file: BinaryIO, *, wait: bool) -> bool:
    """Lock a file until it is closed; return False where another process has locked it."""
    if sys.platform == "win32":  # there an open file cannot be removed, which is as good
        return True
    import fcntl

    try:
        fcntl.flock(file, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:  # another process has, or this file system has no locks
        return False
    return True

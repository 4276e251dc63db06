"""Open what a user or a sketch names, but nothing that is not a regular file.

To open a FIFO waits for a writer, and to read ``/dev/zero`` never ends.
"""

from __future__ import annotations

import errno
import os
import stat
from io import BufferedReader, FileIO
from pathlib import Path

_FLAGS = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
_KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a FIFO",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


class NotRegularError(OSError):
    """A folder, a FIFO, a socket or a device is where a file was expected; ``strerror`` is the message."""

    strerror: str


def require_regular(path: Path) -> os.stat_result:
    """Return a regular file's status, links followed.

    Raises ``NotRegularError`` for what is there and is none, ``OSError`` where nothing is there.
    """
    return _regular(path.stat(), path)


def open_regular(path: Path) -> BufferedReader:
    """Open a regular file to read its bytes; raise as ``require_regular`` does."""
    number, _ = _opened(path)
    return BufferedReader(FileIO(path, opener=lambda *_: number))  # its name is the path, as libraries expect


def read_regular(path: Path, most: int | None = None) -> bytes:
    """Read a regular file, of one larger than ``most`` bytes the beginning; raise as ``open_regular``."""
    number, size = _opened(path)
    left, blocks = size + 1 if most is None else min(size + 1, most), []
    try:
        while left and (block := os.read(number, left)):  # a text in one: a buffered file takes twice as long
            blocks.append(block)
            left -= len(block)
    finally:
        os.close(number)
    return b"".join(blocks)


def irregularity(path: Path) -> str:
    """Return why what is at a path cannot be read as a file; "" for a regular file, or where nothing is."""
    try:
        require_regular(path)
    except NotRegularError as error:
        return error.strerror
    except (OSError, ValueError):
        pass
    return ""


def _opened(path: Path) -> tuple[int, int]:
    """Return the descriptor of a regular file and its size."""
    require_regular(path)  # to open a device may have effects of its own
    number = os.open(path, _FLAGS)
    try:
        return number, _regular(os.fstat(number), path).st_size  # another may have taken its place
    except OSError:
        os.close(number)
        raise


def _regular(status: os.stat_result, path: Path) -> os.stat_result:
    kind = stat.S_IFMT(status.st_mode)
    if kind == stat.S_IFREG:
        return status
    number = errno.EISDIR if kind == stat.S_IFDIR else errno.EINVAL
    raise NotRegularError(number, f"this is {_KINDS.get(kind, 'something else')}, not a file", str(path))

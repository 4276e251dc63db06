"""Open what a user or a sketch names, but nothing that is not a regular file.

To open a FIFO waits for a writer, and to read ``/dev/zero`` never ends.
"""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path
from typing import BinaryIO

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


def require_regular(path: str | Path) -> os.stat_result:
    """Return a regular file's status, links followed.

    Raises ``NotRegularError`` for what is there and is none, ``OSError`` where nothing is there.
    """
    return _regular(Path(path).stat(), path)


def open_regular(path: str | Path) -> BinaryIO:
    """Open a regular file to read its bytes; raise as ``require_regular`` does."""
    require_regular(path)  # to open a device may have effects of its own
    file = os.fdopen(os.open(path, _FLAGS), "rb")
    try:
        _regular(os.fstat(file.fileno()), path)  # another may have taken its place
    except OSError:
        file.close()
        raise
    return file


def read_regular(path: str | Path) -> bytes:
    """Read a regular file; raise as ``require_regular`` does."""
    with open_regular(path) as file:
        return file.read()


def irregularity(path: str | Path) -> str:
    """Return why what is at a path cannot be read as a file; "" for a regular file, or where nothing is."""
    try:
        require_regular(path)
    except NotRegularError as error:
        return error.strerror
    except (OSError, ValueError):
        pass
    return ""


def _regular(status: os.stat_result, path: str | Path) -> os.stat_result:
    kind = stat.S_IFMT(status.st_mode)
    if kind == stat.S_IFREG:
        return status
    number = errno.EISDIR if kind == stat.S_IFDIR else errno.EINVAL
    raise NotRegularError(number, f"this is {_KINDS.get(kind, 'something else')}, not a file", str(path))

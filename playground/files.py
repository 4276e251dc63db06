"""Files: open what a user or a sketch names, write whole or not at all, find names that are free.

Nothing that is not a regular file is opened: to open a FIFO waits for a writer, and to read ``/dev/zero``
never ends.

A file is written under a temporary name in its folder, which takes its place when it is complete. The writer
holds a lock on it, which the system releases however a process ends. So an unlocked one is left over from
a process that was killed: it is removed the first time that a process writes into its folder.
"""

from __future__ import annotations

import errno
import logging
import os
import re
import stat
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from io import BufferedReader, FileIO
from itertools import chain, count
from pathlib import Path
from typing import BinaryIO

from playground.errors import DataError, nearest
from playground.paths import shown

_FLAGS = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
_KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a FIFO",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}
_NAMED = re.compile(r"\..{1,40}\.[0-9a-f]{12}\.part", re.DOTALL)


# Reading


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


def checked_file(path: str | Path) -> Path:
    """Return the path of a file that exists and is not empty.

    Raises:
        DataError: nothing there (with the nearest name in that folder), a folder,
            an empty file, or no permission.
    """
    path = Path(path)
    try:
        if require_regular(path).st_size == 0:
            raise DataError("the file is empty", file=path)
    except (FileNotFoundError, NotADirectoryError) as error:
        if not path.parent.is_dir():
            raise DataError(f"there is no folder '{shown(path.parent)}'", file=path) from error
        near = nearest(path.name, (p.name for p in path.parent.iterdir() if p.suffix == path.suffix))
        raise DataError(f"there is no such file{near}", file=path) from error
    except NotRegularError as error:
        raise DataError(reason(error), file=path) from None
    except (OSError, ValueError) as error:
        raise DataError(f"cannot be read: {reason(error)}", file=path) from error
    return path


def reason(error: BaseException) -> str:
    """Return in a few words of one line what an error of a library means."""
    text = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return " ".join(text.split()).rstrip(".") or type(error).__name__


@contextmanager
def reading(path: Path) -> Iterator[BinaryIO]:
    """Open a file; what a decoder raises in the block becomes a ``DataError``."""
    logging.getLogger(__name__).debug("read %s", shown(path))
    # Of damaged files Pillow raises OSError, SyntaxError, ValueError, struct.error …; of odd ones it warns.
    try:
        with warnings.catch_warnings(), open_regular(path) as handle:
            warnings.simplefilter("ignore")
            yield handle
    except DataError:
        raise
    except (PermissionError, NotRegularError) as error:
        raise DataError(f"cannot be read: {reason(error)}", file=path) from error
    except Exception as error:
        raise DataError(f"the file is damaged or cut short: {reason(error)}", file=path) from error


# Writing


@contextmanager
def writing(path: str | Path) -> Iterator[None]:
    """Raise an ``OSError`` of the block as a ``DataError`` that says that the file cannot be written."""
    try:
        yield
    except OSError as error:
        raise DataError(f"cannot be written: {reason(error)}", file=path) from error


def make_folder(path: Path) -> Path:
    """Make a folder, with its parents, where there is none; raise ``DataError`` where it cannot be made."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError) as error:
        taken = next(one for one in (path, *path.parents) if os.path.lexists(one))
        raise DataError(
            f"is a {'link to nothing' if taken.is_symlink() else 'file'}; expected a folder", file=taken
        ) from error
    except OSError as error:
        raise DataError(f"no folder can be made: {reason(error)}", file=path) from error
    return path


@contextmanager
def new_name(path: str | Path) -> Iterator[Path]:
    """Reserve the first of `hills.png`, `hills-2.png` and so on that no file has, to write to in the block.

    An empty file holds the name from here on, so that no other program takes it; it is
    removed when the block fails.

    Raises:
        DataError: a missing folder, no permission, a full disk.
    """
    name = next(name for name in numbered_names(Path(path)) if _takes(name))
    try:
        yield name
    except BaseException:
        name.unlink(missing_ok=True)
        raise


def numbered_names(path: Path) -> Iterator[Path]:
    """Yield `hills.png`, `hills-2.png` and so on, of which the first that is free is a new name."""
    return chain([path], (path.with_name(f"{path.stem}-{n}{path.suffix}") for n in count(2)))


def _takes(path: Path) -> bool:
    """Make an empty file; say no where something has the name."""
    try:
        path.touch(exist_ok=False)
    except FileExistsError:
        return False
    except OSError as error:
        raise DataError(f"nothing can be written here: {reason(error)}", file=path.parent) from error
    return True


@contextmanager
def replacing(path: str | Path) -> Iterator[BinaryIO]:
    """Open a new file that takes the name `path` when the block ends well.

    It is written in the same folder. When the block fails, the temporary file is
    removed and a file that had the name stays as it was.

    Raises:
        DataError: a missing folder, a folder of that name, no permission, a full disk.
    """
    path = Path(path)
    if "\0" in str(path):
        raise DataError("a file's name cannot hold a zero character", file=repr(str(path)))
    with writing(path):
        if not path.parent.is_dir():
            raise DataError(f"there is no folder '{shown(path.parent)}' to write into", file=path)
        if path.is_dir():
            raise DataError("is a folder; expected the name of a file to write", file=path)
        with partial_file(path) as partial:
            yield partial.handle
            partial.rename(path)


def write_file(path: str | Path, data: bytes | str) -> None:
    """Write a file, whole or not at all, a text as UTF-8; raise ``DataError`` as ``replacing`` does."""
    with replacing(path) as handle:
        handle.write(data.encode() if isinstance(data, str) else data)


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

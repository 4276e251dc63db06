"""A text file that is edited in the window: read, saved whole, and never over what others saved meanwhile."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from playground.errors import DataError
from playground.files import partial_file, read_regular, reason
from playground.paths import shown

MAX_FILE_BYTES = 8 * 2**20
"""Bytes that a file may have."""


@dataclass
class OpenText:
    """One file; ``base`` is its text as it was when last read or saved, with line feeds only."""

    path: Path
    base: str = ""
    _bytes: bytes = b""
    _ending: str = "\n"
    _mark: bool = field(default=False)  # it begins with a byte order mark

    @property
    def title(self) -> str:
        """What it is called."""
        return shown(self.path)

    @property
    def needs_saving(self) -> bool:
        """Whether changes are lost unless they are saved."""
        return True

    def saved(self) -> str:
        """Return the notice after a save."""
        return f"saved {self.title}"

    @classmethod
    def read(cls, path: Path) -> OpenText:
        """Read a file; raise ``DataError`` in a message where it cannot be edited as a text."""
        made = cls(path)
        made.reload()
        return made

    def reload(self) -> str:
        """Read the file as it is now, and return its text."""
        data = self._on_disk()
        try:
            text = data.decode("utf-8")
        except UnicodeDecodeError as error:
            raise DataError(f"not UTF-8 text (byte {error.start})", file=shown(self.path)) from None
        self._bytes, self._mark = data, text.startswith("\ufeff")
        self._ending = "\r\n" if "\r\n" in text else "\n"
        self.base = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
        return self.base

    def changed_outside(self) -> bool:
        """Say whether the file is another than when it was last read or saved; gone counts as well."""
        try:
            return self._on_disk() != self._bytes
        except DataError:
            return True

    def save(self, text: str, *, over: bool = False) -> bool:
        """Save a text in one go; False, and nothing is written, if the file was changed meanwhile.

        ``over`` saves all the same. Line ends and a byte order mark stay as the file had them.
        Raises ``DataError`` where the file cannot be written.
        """
        if not over and self.changed_outside():
            return False
        lines = text.replace("\n", self._ending)
        data = (("\ufeff" if self._mark else "") + lines).encode("utf-8")
        target = self.path.resolve()  # a link stays a link
        if target.exists() and not os.access(target, os.W_OK):
            raise DataError("is read-only, so it was not saved", file=shown(self.path))
        try:
            with partial_file(target) as partial:
                partial.handle.write(data)
                partial.handle.flush()
                os.fsync(partial.handle.fileno())
                if target.exists():
                    shutil.copymode(target, partial.path)
                partial.rename(target)
        except OSError as error:
            raise DataError(f"could not be saved: {reason(error)}", file=shown(self.path)) from None
        self.base, self._bytes = text, data
        return True

    def _on_disk(self) -> bytes:
        try:
            if self.path.stat().st_size > MAX_FILE_BYTES:
                raise DataError(f"larger than {MAX_FILE_BYTES // 2**20} MiB", file=shown(self.path))
            return read_regular(self.path)
        except FileNotFoundError:
            raise DataError("there is no such file", file=shown(self.path)) from None
        except OSError as error:
            raise DataError(reason(error), file=shown(self.path)) from None


class TextView(Protocol):
    """What shows an open file and takes what is typed."""

    @property
    def changed(self) -> bool:
        """Whether there is anything that is not saved."""

    def written(self) -> str:
        """Return the text as it is in the editor."""


@dataclass(eq=False)
class Editing:
    """A file that is open in a window of our own, and where it is to be looked at."""

    text: OpenText
    line: int = 1
    column: int = 1
    focus: bool = True  # it is to come to the front, at its line
    view: TextView | None = None  # None until it is drawn for the first time


def unsaved(open_files: Iterable[Editing]) -> list[str]:
    """Return the names of open files with changes that are not saved."""
    return [
        e.text.path.name for e in open_files if e.text.needs_saving and e.view is not None and e.view.changed
    ]


def typed_in(editing: Editing) -> str | None:
    """Return the text of an open file where it has changes that are not saved; else None."""
    view = editing.view
    return view.written() if view is not None and view.changed else None

"""Files that are open in windows of our own or in the user's editor.

A text file is read, saved whole, and never over what others saved meanwhile.
"""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from playground.errors import DataError, Diagnostic, PlaygroundError
from playground.files import partial_file, read_regular, reason
from playground.memo import INTERFACE
from playground.paths import shown, without_part
from playground.studio.code.editors import Opener, find_editor
from playground.studio.notices import Notices
from playground.studio.problems.problems import Problems
from playground.studio.reload.dependencies import path_named

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


_LOOK_AGAIN = 5.0  # [s]


@dataclass
class OpenFiles:
    """The files that are open in windows of our own, and what opens others."""

    notices: Notices
    opener: Opener = field(default_factory=Opener)  # starts the user's editor
    editing: list[Editing] = field(default_factory=list)
    copy_of: Callable[[Path], Editing | None] = lambda path: None  # what is drawn in place of a file
    leaving: bool = False  # the window is to close, and something is not saved: the user decides what to do

    def open(self, path: Path, line: int = 0, column: int = 0, *, here: bool = False) -> None:
        """Open a file at a line and a column, both from 1, 0 where unknown.

        ``here``: in a window of our own.
        """
        if not path.is_file():
            self.notices.say(f"there is no file {shown(path)} to open")
            return
        copy = self.copy_of(path)
        open_file = copy or next((item for item in self.editing if item.text.path == path), None)
        if not here and copy is None:
            editor, complaint = find_editor()
            if complaint:
                self.notices.say(complaint)
            if editor is not None and self.opener.open(editor, path, line, column):
                self.notices.say(f"opened {shown(path)} in {editor.name}")
                return
        if open_file is None:
            try:
                open_file = Editing(OpenText.read(path))
            except PlaygroundError as error:
                self.notices.say(str(error))
                return
        self.focus(open_file, line, column)

    def focus(self, editing: Editing, line: int = 1, column: int = 1) -> None:
        """Bring an open file to the front at a place, also where its window was closed."""
        if all(other is not editing for other in self.editing):
            self.editing.append(editing)
        editing.line, editing.column, editing.focus = max(line, 1), max(column, 1), True

    def open_problem(self, diagnostic: Diagnostic, *, here: bool = False) -> None:
        """Open the file that a mistake is in, at its place."""
        if not diagnostic.file:
            return
        whole = without_part(diagnostic.file) == diagnostic.file
        position = (diagnostic.line, diagnostic.column) if whole else (0, 0)  # a line of a string has none
        self.open(path_named(diagnostic.file), *position, here=here)

    def open_current(self, problems: Problems) -> None:
        """Open the file of the current mistake, at first of the first."""
        if problems.all:
            self.open_problem(problems.all[max(problems.at, 0)])
        else:
            self.notices.say("no errors, so nothing to edit")

    def open_place(self, location: str) -> None:
        """Open "file:line", as an include chain has it."""
        name, _, line = location.rpartition(":")
        self.open(path_named(name or location), int(line) if name and line.isdigit() else 0)


def editor_name() -> str:
    """Return what a click on a place opens: "code", "vim"; "" for the window of our own."""
    return _name_at(int(time.monotonic() / _LOOK_AGAIN))


@INTERFACE.cached()
def _name_at(_: int) -> str:
    """Look for the editor; a tooltip calls this every frame, and the whole PATH is searched."""
    editor, _why = find_editor()
    return editor.name if editor is not None else ""

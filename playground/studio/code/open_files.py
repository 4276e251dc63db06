"""Open a file at a line where its user edits: another program, or a window of our own."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from playground.errors import Diagnostic, PlaygroundError
from playground.memo import INTERFACE
from playground.paths import shown, without_part
from playground.studio.code.editors import Opener, find_editor
from playground.studio.code.text_file import Editing, OpenText
from playground.studio.notices import Notices
from playground.studio.problems.problems import Problems
from playground.studio.reload.dependencies import path_named

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

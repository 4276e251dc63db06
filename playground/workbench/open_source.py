"""Open a file at a line where its user edits: another program, or a window of our own."""

from __future__ import annotations

import time
from functools import lru_cache
from pathlib import Path

from playground.errors import Diagnostic, PlaygroundError
from playground.paths import shown
from playground.workbench.actions import Actions
from playground.workbench.dependencies import path_named
from playground.workbench.editors import find_editor
from playground.workbench.text_file import Editing, OpenText

_LOOK_AGAIN = 5.0  # [s]


def open_problem(actions: Actions, diagnostic: Diagnostic, *, here: bool = False) -> None:
    """Open the file that a mistake is in, at its place; ``here``: in a window of our own."""
    if diagnostic.file:
        open_source(actions, path_named(diagnostic.file), diagnostic.line, diagnostic.column, here=here)


def edit_problem(actions: Actions) -> None:
    """Open the file of the mistake that is looked at, at first of the first."""
    problems = actions.problems
    if not problems.all:
        actions.say("nothing is wrong, so there is nothing to edit")
        return
    open_problem(actions, problems.all[max(problems.at, 0)])


def open_place(actions: Actions, place: str) -> None:
    """Open "file:line", as an include chain has it."""
    name, _, line = place.rpartition(":")
    open_source(actions, path_named(name or place), int(line) if name and line.isdigit() else 0)


def open_source(actions: Actions, path: Path, line: int = 0, column: int = 0, *, here: bool = False) -> None:
    """Open a file at a line and a column, both from 1; 0 where unknown."""
    if not path.is_file():
        actions.say(f"there is no file {shown(path)} to open")
        return
    copy = actions.copy_of(path)
    known = copy or next((wanted for wanted in actions.editing if wanted.text.path == path), None)
    if not here and copy is None:
        editor, complaint = find_editor()
        if complaint:
            actions.say(complaint)
        if editor is not None and actions.opener.open(editor, path, line, column):
            actions.say(f"opened {shown(path)} in {editor.name}")
            return
    if known is None:
        try:
            known = Editing(OpenText.read(path))
        except PlaygroundError as error:
            actions.say(str(error))
            return
    if all(other is not known for other in actions.editing):
        actions.editing.append(known)
    known.line, known.column, known.asked = max(line, 1), max(column, 1), True


def editor_name() -> str:
    """Return what a click on a place opens: "code", "vim"; "" for the window of our own."""
    return _name_at(int(time.monotonic() / _LOOK_AGAIN))


@lru_cache(maxsize=1)
def _name_at(_: int) -> str:
    """Look for the editor; a tooltip asks at every turn, and the whole PATH is searched."""
    editor, _why = find_editor()
    return editor.name if editor is not None else ""

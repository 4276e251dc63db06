"""Copies of shaders to break and fix: drawn in place of the files, never written over them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from playground.paths import shown
from playground.workbench.open_files import OpenFiles
from playground.workbench.text_file import Editing, OpenText, typed_in


@dataclass
class Copy(OpenText):
    """A text that replaces a file; saving it draws it."""

    apply: Callable[[str], None] = field(default=lambda text: None)
    leave: Callable[[str], None] = field(default=lambda text: None)  # gets what was typed and not saved
    note: str = ""  # shown when it is applied
    label: str = ""  # follows its name

    @property
    def title(self) -> str:
        """What it is called: its file, and that it is a copy."""
        return f"{shown(self.path)} {self.label}".rstrip()

    @property
    def needs_saving(self) -> bool:
        """Whether unsaved changes must be saved: never, a lesson stores them."""
        return False

    def saved(self) -> str:
        """Return the notice for a copy that was applied."""
        return self.note

    def reload(self) -> str:
        """Return its text as it was applied last."""
        return self.base

    def changed_outside(self) -> bool:
        """Return False: no other program has it."""
        return False

    def save(self, text: str, *, over: bool = False) -> bool:
        """Draw the text; the file stays as it is."""
        self.base = text
        self.apply(text)
        return True


@dataclass
class Copies:
    """The copies that are open or replace their files, by the file."""

    files: OpenFiles
    open: dict[Path, Copy] = field(default_factory=dict)
    _windows: dict[Path, Editing] = field(default_factory=dict)  # also of one whose window was closed

    def __post_init__(self) -> None:
        self.files.copy_of = self._windows.get

    def edit(self, copy: Copy, line: int = 1) -> None:
        """Open a copy in the window's own editor, in place of another of the same file."""
        self.close(copy.path)
        self.open[copy.path] = copy
        editing = self._windows[copy.path] = Editing(copy)
        self.files.focus(editing, line)

    def focus(self, path: Path, line: int = 1) -> bool:
        """Bring the copy of a file to the front, opening its window again; return whether there is one."""
        editing = self._windows.get(path)
        if editing is None:
            return False
        self.files.focus(editing, line)
        return True

    def close(self, path: Path | None = None) -> None:
        """Close the copy of a file, or all of them; each receives what was typed in it and not saved."""
        gone = [copy for file, copy in self.open.items() if path is None or file == path]
        self.files.editing[:] = [e for e in self.files.editing if all(e.text is not c for c in gone)]
        for copy in gone:
            typed = typed_in(self._windows.pop(copy.path))
            if typed is not None:
                copy.leave(typed)
            del self.open[copy.path]

    def text_of(self, path: Path) -> str | None:
        """Return the text that replaces a file; None where the file itself is drawn."""
        copy = self.open.get(path)
        return copy.base if copy is not None else None


def line_of(text: str, part: str) -> int:
    """Return the line, from 1, that a part of a text begins on; 1 where it is not in it."""
    at = text.find(part)
    return text.count("\n", 0, at) + 1 if at >= 0 else 1

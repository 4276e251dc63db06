"""Files that are open in the code pane or in the user's editor.

A text file is read, and saved whole. What is typed is drawn without being saved, and kept in the user's state
folder until it is: a window that is closed asks nothing. Where a file is saved by others while something is
typed here, the newer of the two is shown, and the other is one undo away.
"""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable, Collection, Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from playground.allowed_files import TEXTS, signature
from playground.errors import DataError, Diagnostic, PlaygroundError
from playground.files import partial_file, read_regular, reason
from playground.memo import INTERFACE
from playground.paths import GLSL, SKETCHES, shown, without_part
from playground.shader.libraries import libraries, library_around
from playground.sketch.model import Sketch
from playground.studio.code.editors import Opener, find_editor
from playground.studio.code.names import Names
from playground.studio.code.unsaved_texts import KeptTexts, hash_of_text
from playground.studio.edits.history import Typed
from playground.studio.language import tr
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
        return tr("saved {file}", file=self.title)

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


class TextView(Typed, Protocol):
    """What shows an open file and takes what is typed."""

    @property
    def changed(self) -> bool:
        """Whether there is anything that is not saved."""

    def written(self) -> str:
        """Return the text as it is in the editor."""

    def replace(self, text: str, *, is_own: bool = False) -> None:
        """Replace the text as one step that can be undone; ``is_own``: the window wrote it itself."""

    def note_saved(self) -> None:
        """Take in that the text as it is now is that of the file."""


@dataclass(eq=False)
class Editing:
    """A file that is open in the code pane, and where it is to be looked at."""

    text: OpenText
    line: int = 1
    column: int = 1
    focus: bool = True  # it is to come to the front, at its line
    takes_keys: bool = True  # with that it gets the keys
    view: TextView | None = None  # None until it is drawn for the first time
    typed_before: str | None = None  # what was typed when the window was closed, where it is not saved
    is_older: bool = False  # than what the file holds: one undo away

    @property
    def belongs_to(self) -> str:
        """What it belongs to where it is not to be changed: "library", "sketch" (a shipped one); or ""."""
        path = self.text.path
        if not self.text.needs_saving:  # a copy of a lesson's
            return ""
        if path.is_relative_to(GLSL) or library_around(path, libraries()):
            return "sketch" if path.is_relative_to(SKETCHES) else "library"
        return ""


def unsaved(open_files: Iterable[Editing]) -> list[str]:
    """Return the names of open files with changes that are not saved."""
    return [e.text.path.name for e in open_files if e.text.needs_saving and is_changed(e)]


def is_changed(editing: Editing) -> bool:
    """Return whether an open file has changes that are not saved."""
    if editing.view is None:
        return editing.typed_before is not None and not editing.is_older
    return editing.view.changed


def typed_in(editing: Editing) -> str | None:
    """Return the text of an open file where it has changes that are not saved; else None."""
    view = editing.view
    return view.written() if view is not None and view.changed else None


def own_files(sketch: Sketch) -> list[Path]:
    """Return the texts of a sketch that are its own: its file, then the kernels in its folder."""
    main, folder = Path(sketch.file), Path(sketch.folder)
    texts = [Path(name) for name in sketch.files if Path(name).suffix in TEXTS]
    own = [path for path in texts if path.is_relative_to(folder) and not _is_library(path)]
    return list(dict.fromkeys([main, *own]))


def library_files(sketch: Sketch) -> list[Path]:
    """Return the texts of the library that a sketch is made of."""
    return [path for name in sketch.files if (path := Path(name)).suffix in TEXTS and _is_library(path)]


def _is_library(path: Path) -> bool:
    return path.is_relative_to(GLSL) and not path.is_relative_to(SKETCHES)


def _saved_at(path: Path) -> int:
    """Return when a file was saved [ns since the epoch]; 0 where there is none."""
    found = signature(path)
    return 0 if found is None else found.modified


_LOOK_AGAIN = 5.0  # [s]


MAX_TABS = 8
"""Files of a sketch that are open from the beginning."""


@dataclass
class Find:
    """What is looked for in the text that is seen, and what takes its place."""

    is_open: bool = False
    asks: str = ""  # which of its fields is to get the keys
    settles: int = 0  # frames that this still takes
    text: str = ""
    new: str = ""
    case: bool = False  # letters count as they are written
    words: bool = False  # whole words alone

    def focus(self, field: str) -> None:
        """Give a field the keys."""
        self.asks, self.settles = field, 3


@dataclass
class PaneState:
    """What the code pane and the window tell each other."""

    has_keys: bool = False
    asked_at: int = -100  # the frame in which it was asked to take them
    jumps: bool = False  # the current file is to be seen
    draws_in: float | None = None  # [s] until what is typed is drawn; None: it is
    find: Find = field(default_factory=Find)


@dataclass
class OpenFiles:
    """The files that are open in the code pane, and what opens others."""

    notices: Notices
    opener: Opener = field(default_factory=Opener)  # starts the user's editor
    editing: list[Editing] = field(default_factory=list)  # in the order of their tabs
    current: Editing | None = None  # the one that is seen
    copy_of: Callable[[Path], Editing | None] = lambda path: None  # what is drawn in place of a file
    kept: KeptTexts = field(default_factory=KeptTexts)
    take_typed: Callable[[Path, str | None], None] = lambda path, text: None  # draws it; None: the file
    show: Callable[[], None] = lambda: None  # opens the code pane
    copy_in: Callable[[Path], None] = lambda path: None  # makes a file of the library the sketch's own
    step: Callable[[int], None] = lambda by: None  # undoes or redoes what came last, of any kind
    names: Names = field(init=False)
    pane: PaneState = field(default_factory=PaneState)
    sketch: Sketch | None = None  # that is shown
    _followed: tuple[Path | None, bool] = (None, False)

    def __post_init__(self) -> None:
        self.names = Names(self._typed)

    # ── opening ──────────────────────────────────────────────────────────────

    def open(self, path: Path, line: int = 0, column: int = 0, *, here: bool = False) -> None:
        """Open a file at a line and a column, both from 1, 0 where unknown.

        ``here``: in the code pane.
        """
        if not path.is_file():
            self.notices.say(tr("there is no file {file} to open", file=shown(path)))
            return
        copy = self.copy_of(path)
        open_file = copy or self.at(path)
        if not here and copy is None:
            editor, complaint = find_editor()
            if complaint:
                self.notices.say(complaint)
            if editor is not None and self.opener.open(editor, path, line, column):
                self.notices.say(tr("opened {file} in {editor}", file=shown(path), editor=editor.name))
                return
        if open_file is None:
            try:
                open_file = self._read(path)
            except PlaygroundError as error:
                self.notices.say(str(error))
                return
        self.focus(open_file, line, column)

    def at(self, path: Path) -> Editing | None:
        """Return the tab of a file; None where it has none."""
        return next((item for item in self.editing if item.text.path == path), None)

    def focus(self, editing: Editing, line: int = 1, column: int = 1) -> None:
        """Bring an open file to the front at a place, also where its tab was closed."""
        if all(other is not editing for other in self.editing):
            self.editing.append(editing)
        editing.line, editing.column, editing.focus = max(line, 1), max(column, 1), True
        editing.takes_keys = True
        self.show()

    def reveal(self, path: Path, line: int) -> None:
        """Show a line of a file in the code pane, without giving it the keys."""
        try:
            editing = self.copy_of(path) or self.tab_of(path)
        except PlaygroundError as error:
            self.notices.say(str(error))
            return
        if all(other is not editing for other in self.editing):
            self.editing.append(editing)
        editing.line, editing.column, editing.focus = max(line, 1), 1, True
        editing.takes_keys = False

    def follow(self, path: Path, sketch: Sketch | None) -> None:
        """Have the tabs of the sketch in a file, once it is shown: its own file, and its own kernels.

        Tabs of another with nothing unsaved in them close.
        """
        self.sketch = sketch
        if self._followed == (path, sketch is not None):
            return
        is_other, self._followed = self._followed[0] != path, (path, sketch is not None)
        files = own_files(sketch)[:MAX_TABS] if sketch is not None else [path]
        if is_other:
            kept = [e for e in self.editing if e.text.path in files or is_changed(e) or e.focus]
            self.editing[:] = kept
        for file in files:
            if file.is_file():
                with suppress(PlaygroundError):
                    self.tab_of(file)
        if self.current is None or all(e is not self.current for e in self.editing):
            self.current = next((e for e in self.editing if e.text.path.suffix != ".toml"), None)
            self.current = self.current or next(iter(self.editing), None)
            self.pane.jumps = self.current is not None

    def own(self) -> list[Path]:
        """Return the sketch's own files."""
        return [] if self.sketch is None else own_files(self.sketch)

    def _read(self, path: Path) -> Editing:
        """Return a file with what was typed in it the last time and not saved, which is drawn."""
        editing = Editing(OpenText.read(path))
        kept = self.kept.of(path)
        if kept is None or kept.text == editing.text.base or editing.belongs_to:
            return editing
        editing.typed_before = kept.text
        editing.is_older = kept.over != hash_of_text(editing.text.base) and kept.time < _saved_at(path)
        if editing.is_older:
            self.notices.say(tr("{file} was saved since; undo brings back what was typed", file=path.name))
        else:
            self.notices.say(tr("{file} has what was typed and not saved", file=path.name))
            self.take_typed(path, kept.text)
        return editing

    # ── typing and saving ────────────────────────────────────────────────────

    def draw_typed(self, editing: Editing) -> None:
        """Draw what is typed in a file, and keep it; a lesson's copy is drawn when it is saved."""
        if editing.view is None or not editing.text.needs_saving:
            return
        path, text = editing.text.path, editing.view.written()
        if text == editing.text.base:
            self.kept.forget(path)
            self.take_typed(path, None)
            return
        try:
            self.kept.keep(path, text, editing.text.base)
        except (PlaygroundError, OSError) as error:
            self.notices.say(tr("what is typed cannot be kept: {reason}", reason=error))
        self.take_typed(path, text)

    def keep_typed(self) -> None:
        """Keep what is typed in all files: the window closes."""
        for editing in self.editing:
            text = typed_in(editing)
            if text is not None and editing.text.needs_saving:
                with suppress(PlaygroundError, OSError):
                    self.kept.keep(editing.text.path, text, editing.text.base)

    def save(self, editing: Editing) -> bool:
        """Save an open file; return whether that worked.

        Where others saved it meanwhile, what is typed here is the newer; theirs is one undo away.
        """
        view, text = editing.view, editing.text
        if view is None:
            return False
        mine = view.written()
        try:
            if not text.save(mine):
                with suppress(PlaygroundError):  # the file may be gone
                    view.replace(OpenText.read(text.path).base)
                    view.replace(mine)
                    note = "undo brings back what others had saved of {file}"
                    self.notices.say(tr(note, file=text.path.name))
                text.save(mine, over=True)
        except PlaygroundError as error:
            self.notices.say(str(error))
            return False
        view.note_saved()
        if text.needs_saving:
            self.kept.forget(text.path)
            self.take_typed(text.path, None)
        self.notices.say(text.saved())
        return True

    def close(self, editing: Editing) -> None:
        """Close a tab; what is typed in it and not saved is taken back."""
        self.editing[:] = [other for other in self.editing if other is not editing]
        if editing.text.needs_saving and is_changed(editing):
            self.kept.forget(editing.text.path)
            self.take_typed(editing.text.path, None)

    def take_saved(self, changed: Collection[Path], *, is_own: bool = False) -> None:
        """Show what others saved of open files; what is typed here and not saved is one undo away.

        ``is_own``: the window saved it, as a step of its own or as a step that was undone.
        """
        for editing in self.editing:
            text, view = editing.text, editing.view
            if text.path not in changed or not text.needs_saving or not text.changed_outside():
                continue
            was_changed, mine = is_changed(editing), view.written() if view is not None else None
            try:
                theirs = text.reload()
            except PlaygroundError:  # it is gone, or no text: what is typed stays
                continue
            if view is not None and theirs != mine:
                view.replace(theirs, is_own=is_own)
            if view is not None:
                view.note_saved()
            if was_changed:
                editing.is_older = True
                self.kept.forget(text.path)
                self.take_typed(text.path, None)
                if theirs != mine and not is_own:
                    note = "{file} was saved by others; undo brings back what was typed"
                    self.notices.say(tr(note, file=text.path.name))

    def open_declaration(self, path: Path, text: str, at: int) -> None:
        """Open the place where what stands at a place of an open text is declared."""
        site = self.names.declaration(path, text, at)
        if site is None:
            self.notices.say(tr("no declaration is known here"))
            return
        before = site.text[: site.at]
        self.open(site.path, before.count("\n") + 1, site.at - before.rfind("\n"), here=True)

    def tab_of(self, path: Path) -> Editing:
        """Return the tab of a file, a new one behind the others where it has none; raise ``DataError``."""
        editing = self.at(path)
        if editing is None:
            editing = self._read(path)
            editing.focus = False
            self.editing.append(editing)
        return editing

    def _typed(self) -> dict[Path, str]:
        """Return what is typed in open files and not saved."""
        return {e.text.path: typed for e in self.editing if (typed := typed_in(e)) is not None}

    # ── mistakes ─────────────────────────────────────────────────────────────

    def open_problem(self, diagnostic: Diagnostic, *, here: bool = False) -> None:
        """Open the file that a mistake is in, at its place."""
        if not diagnostic.file:
            return
        whole = without_part(diagnostic.file) == diagnostic.file
        position = (diagnostic.line, diagnostic.column) if whole else (0, 0)  # a line of a string has none
        self.open(path_named(diagnostic.file), *position, here=here)

    def open_current(self, problems: Problems, *, here: bool) -> None:
        """Open the file of the current mistake, at first of the first; ``here``: in the code pane."""
        if problems.all:
            self.open_problem(problems.all[max(problems.at, 0)], here=here)
        else:
            self.notices.say(tr("no errors, so nothing to edit"))

    def open_place(self, location: str) -> None:
        """Open "file:line", as an include chain has it."""
        name, _, line = location.rpartition(":")
        self.open(path_named(name or location), int(line) if name and line.isdigit() else 0)


def editor_name() -> str:
    """Return what a click on a place opens: "code", "vim"; "" for the code pane."""
    return _name_at(int(time.monotonic() / _LOOK_AGAIN))


@INTERFACE.cached()
def _name_at(_: int) -> str:
    """Look for the editor; a tooltip calls this every frame, and the whole PATH is searched."""
    editor, _why = find_editor()
    return editor.name if editor is not None else ""

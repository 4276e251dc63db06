"""Shaders that a reader breaks, fixes or edits: each as a copy that is drawn in place of its file.

Nothing is written. Turning a page closes its copies; what was typed in them is
there again when they are opened the next time.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from playground.course.model import Break, Code, Scene
from playground.course.scenes import Excerpt, Picture, draw, excerpt, with_bug
from playground.course.tasks import SHARE, share_differing
from playground.course.window.figure_view import FigureView
from playground.errors import PlaygroundError
from playground.paths import GLSL, shown
from playground.shader.source import read_text
from playground.sketch.model import kernels_of
from playground.sketch.replace_technique import with_texts
from playground.studio.code.open_files import Editing, OpenFiles, OpenText, typed_in
from playground.studio.compare.compare import as_before
from playground.studio.notices import Notices
from playground.studio.session import Session


@dataclass
class Copy(OpenText):
    """A text that replaces a file; saving it draws it."""

    keep: Callable[[str], None] = field(default=lambda text: None)  # what is saved, or typed at its end
    draw: Callable[[], None] = field(default=lambda: None)
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
        self.keep(text)
        self.draw()
        return True


@dataclass
class Copies:
    """The copies that are open or replace their files, by the file."""

    files: OpenFiles
    set_texts: Callable[[Mapping[str, str]], None]  # draws texts in place of files, by absolute path
    label: Callable[..., str]  # of the interface, by key
    open: dict[Path, Copy] = field(default_factory=dict)
    _windows: dict[Path, Editing] = field(default_factory=dict)  # also of one whose window was closed

    def __post_init__(self) -> None:
        self.files.copy_of = self._windows.get

    @property
    def texts(self) -> Mapping[str, str]:
        """What replaces files, by absolute path."""
        return {str(path): copy.base for path, copy in self.open.items()}

    def draw(self) -> None:
        """Draw the copies in place of their files."""
        self.set_texts(self.texts)

    def edit(self, path: Path, text: str, keep: Callable[[str], None], line: int = 1) -> Copy:
        """Open a copy of a file in the window's own editor, in place of another of the same file."""
        self.close(path)
        note, label = self.label("applied"), self.label("copy")
        copy = self.open[path] = Copy(path, text, keep=keep, draw=self.draw, note=note, label=label)
        editing = self._windows[path] = Editing(copy)
        self.files.focus(editing, line)
        return copy

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
                copy.keep(typed)
            del self.open[copy.path]

    def text_of(self, path: Path) -> str | None:
        """Return the text that replaces a file; None where the file itself is drawn."""
        copy = self.open.get(path)
        return copy.base if copy is not None else None


_KERNEL = re.compile(r"^\w+ kernel\(.*$", re.MULTILINE)


def kernel_line(text: str) -> int:
    """Return the line, from 1, that a text's kernel begins on; 1 where there is none."""
    begins = _KERNEL.search(text)
    return text.count("\n", 0, begins.start()) + 1 if begins else 1


WHOLE, BROKEN, FIXED, SHOWN = "", "broken", "fixed", "shown"
"""How far a bug has come: SHOWN where the lesson has fixed it."""


@dataclass(kw_only=True)
class Bugs:
    """The bugs and edited copies of one reader."""

    session: Session
    notices: Notices
    copies: Copies
    figure: FigureView
    label: Callable[..., str]  # of the interface, by key, with values in its places
    state: dict[str, str] = field(default_factory=dict)  # of each bug, by block
    typed: dict[str, str] = field(default_factory=dict)  # what was typed in a copy, by block

    def __post_init__(self) -> None:
        self._on: Break | None = None  # the bug whose copy is drawn
        self._to_check = False

    @property
    def waits(self) -> bool:
        """Whether a fix is still to be checked."""
        return self._to_check and not self.figure.busy

    # ── bugs ─────────────────────────────────────────────────────────────────

    def break_it(self, block: Break) -> None:
        """Draw a bug, and open the text that it is in."""
        if block.scene is None:
            return
        self.leave()
        try:
            text = self.typed.get(block.name) or with_bug(block)
        except PlaygroundError as error:
            self.notices.say(str(error))
            return
        self._edit(block, text, kernel_line(text))  # the bug itself is to be found
        self._on, self.state[block.name] = block, BROKEN
        self.figure.show(block.scene, (block.name, 1), self.copies.texts)
        self._to_check = text != with_bug(block)

    def focus(self, block: Break) -> None:
        """Bring the copy of a bug to the front, also where its window was closed."""
        self.copies.focus(file_of(block))

    def fix_it(self, block: Break) -> None:
        """Draw the file's own text again."""
        if block.scene is None:
            return
        self.copies.close(file_of(block))
        self.typed.pop(block.name, None)
        self._on, self._to_check = None, False
        self.state[block.name] = SHOWN
        self.figure.show(block.scene, (block.name, 0), self.copies.texts)

    def check(self) -> bool:
        """Check whether the reader's own fix shows the whole picture; return whether there was one."""
        session, block = self.session, self._on
        if not self._to_check or block is None or block.scene is None or self.figure.busy:
            return False
        self._to_check = False
        if session.error is not None or session.plan is None or not session.is_idle:
            return True
        path = file_of(block)
        text = self.copies.text_of(path)
        if text is None:
            return True
        try:
            with as_before(session.engine, session.plan):
                same = self._difference(block.scene, {str(path): text}) <= SHARE
        except PlaygroundError as error:
            self.notices.say(str(error))
            return True
        if same and self.state[block.name] != FIXED:
            self.notices.say(self.label("fixed"))
        self.state[block.name] = FIXED if same else BROKEN
        return True

    def _difference(self, scene: Scene, texts: Mapping[str, str]) -> float:
        small = Picture("", scene).smaller().scene
        engine = self.session.engine
        whole = draw(engine, small).array
        mine = draw(engine, replace(small, sketch=with_texts(small.sketch, texts))).array
        return share_differing(mine, whole)

    # ── code ─────────────────────────────────────────────────────────────────

    def excerpt(self, block: Code) -> Excerpt:
        """Return the code as it is now: in the copy, or in the file; raise ``SketchError`` if it is gone."""
        path = file_of(block)
        text = self.copies.text_of(path)
        return excerpt(block.file, block.anchor, read_text(path) if text is None else text)

    def edit(self, block: Code) -> None:
        """Open a copy of the code's file at its place."""
        path = file_of(block)
        try:
            line = self.excerpt(block).line
            if not self.copies.focus(path, line):
                text = self.copies.text_of(path) or self.typed.get(block.name) or read_text(path)
                self._edit(block, text, line)
                self.copies.draw()
        except PlaygroundError as error:
            self.notices.say(str(error))
            return
        sketch = self.session.sketch
        if sketch is not None and not _uses(sketch.graph, path):
            self.notices.say(self.label("not_in_view", shown(path)))

    def is_edited(self, block: Code) -> bool:
        """Return whether a copy with another text replaces the code's file."""
        text = self.copies.text_of(file_of(block))
        return text is not None and text != read_text(file_of(block))

    def put_back(self, block: Code) -> None:
        """Draw the file's own text again, and forget what was typed."""
        self.copies.close(file_of(block))
        self.typed.pop(block.name, None)
        if self._on is not None and file_of(self._on) == file_of(block):
            self.typed.pop(self._on.name, None)
            self.leave()
        self.copies.draw()

    # ── copies ───────────────────────────────────────────────────────────────

    def leave(self) -> None:
        """Stop drawing a bug: another picture comes."""
        if self._on is not None:
            self.copies.close(file_of(self._on))
            if self.state[self._on.name] == BROKEN:
                self.state[self._on.name] = WHOLE
            self._on, self._to_check = None, False

    def close_all(self, *, drawn: bool = True) -> None:
        """Close all copies; ``drawn``: and draw the files themselves."""
        self.leave()
        if self.copies.open:
            self.copies.close()
        if drawn and self.session.drafts.texts:
            self.copies.draw()

    def forget(self) -> None:
        """Forget what was typed and fixed: another lesson is opened."""
        self.close_all()
        self.state.clear()
        self.typed.clear()

    def _edit(self, block: Break | Code, text: str, line: int) -> None:
        def keep(new: str) -> None:
            self.typed[block.name] = new
            self._to_check = self._on is not None

        self.copies.edit(file_of(block), text, keep, line)


def file_of(block: Break | Code) -> Path:
    """Return the file that a block is about."""
    return (GLSL / block.file).resolve()


def _uses(technique: object, path: Path) -> bool:
    return str(path) in {file for _, kernel in kernels_of(technique) for file in kernel.files}  # type: ignore[arg-type]

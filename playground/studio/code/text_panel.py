"""The text of one open file: its editor, its steps of undo, and how its lines are indented.

A text is indented as its own lines are; undo goes by words and pauses.
"""

from __future__ import annotations

import math
import re
from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from imgui_bundle import imgui_color_text_edit as text_edit

from playground.errors import Diagnostic
from playground.shader.syntax.tokens import without_comments
from playground.studio.code.open_files import Editing, OpenFiles
from playground.studio.draw import Area

if TYPE_CHECKING:
    from playground.sketch.suggestions import Suggestion

# ── indentation ───────────────────────────────────────────────────────────────


DEFAULT_STEP = " " * 4
_PAIRS = {"}": "{", "]": "[", ")": "("}
_BLANK = re.compile(r"[ \t]*")


def step_of(text: str) -> str:
    """Return one step of indentation: that of most lines after an open brace, else of most lines."""
    lines = [line for line in without_comments(text).split("\n") if line.strip()]
    indents = [_indent_of(line) for line in lines]
    if sum(indent.startswith("\t") for indent in indents) * 2 > sum(map(bool, indents)):
        return "\t"
    blocks, all_steps = Counter[int](), Counter[int]()
    for number in range(1, len(lines)):
        step = len(indents[number]) - len(indents[number - 1])
        if step > 1:  # one space aligns, it does not indent
            all_steps[step] += 1
            if lines[number - 1].rstrip().endswith("{"):
                blocks[step] += 1
    common = (blocks or all_steps).most_common(1)
    return " " * common[0][0] if common else DEFAULT_STEP


def new_line(before: str, after: str, step: str) -> tuple[str, str]:
    """Return what the Enter key inserts around the cursor: before it, and after it.

    ``before`` and ``after`` are the line to the left and to the right of the cursor.
    """
    indent = _indent_of(before)
    code = without_comments(before).rstrip()
    if not code.endswith(tuple(_PAIRS.values())):
        return f"\n{indent}", ""
    closes = _PAIRS.get(after.strip()[:1]) == code[-1]
    return f"\n{indent}{step}", f"\n{indent}" if closes else ""


def closing_indent(before: str, bracket: str) -> str | None:
    """Return the indentation of a closing bracket that begins a line: that of the line which opens it.

    ``before`` is the text up to the cursor. None where the bracket begins no line, or closes nothing.
    """
    code = without_comments(before)
    line = before.rpartition("\n")[2]
    if bracket not in _PAIRS or line.strip():
        return None
    depth = 0
    for at in range(len(code) - 1, -1, -1):
        depth += (code[at] == bracket) - (code[at] == _PAIRS[bracket])
        if depth < 0:
            return _indent_of(before[before.rfind("\n", 0, at) + 1 :])
    return None


def _indent_of(line: str) -> str:
    match = _BLANK.match(line)
    return match[0] if match else ""


# ── one text ──────────────────────────────────────────────────────────────────


_PAUSE = 0.8  # [s] after which what is typed is a step of undo of its own
Pos = text_edit.TextEditor.DocPos
"""A place in a text: line and column, from 0."""


@dataclass
class Completion:
    """What may stand where something is being typed."""

    found: list[Suggestion] = field(default_factory=list)
    at: int = 0  # which is chosen
    prefix: str = ""  # what is typed of it
    end: text_edit.TextEditor.DocPos = field(default_factory=text_edit.TextEditor.DocPos)  # behind that
    is_closed: bool = True  # until the next letter of a word

    def close(self) -> None:
        """Show nothing until something else is typed."""
        self.found, self.is_closed = [], True


@dataclass
class Renaming:
    """The field that takes a new name."""

    at: int  # where the name begins in the text
    new: str
    message: str = ""  # why the last one was refused
    is_open: bool = False


class UndoSteps:
    """The steps of undo of one editor: words, pauses and other changes, each with its time.

    A place among them is the editor's undo index.
    """

    def __init__(self, editor: text_edit.TextEditor, clock: Callable[[], float]) -> None:
        self.editor, self.clock = editor, clock  # [s]
        self.at = editor.get_undo_index()  # in the last frame
        self._ends: list[int] = []  # between two steps, in order
        self._made: dict[int, float] = {}  # [s] when the text at a place was made
        self._own: set[int] = set()  # places of texts that the window wrote itself

    def time(self, by: int) -> float | None:
        """Return when what is undone (-1) or redone (1) next was made; see ``Typed``."""
        if not (self.editor.can_redo() if by > 0 else self.editor.can_undo()):
            return None
        at = self._goal(1) if by > 0 else self.editor.get_undo_index()
        return math.inf if by > 0 and at in self._own else self._made.get(at, 0.0)

    def go(self, by: int) -> None:
        """Undo (-1) or redo (1) a step."""
        self._go_to(self._goal(by))

    def goes_to(self, text: str) -> bool:
        """Go a step that the window made itself back or on, where that leads to a text; return whether so."""
        before = self.editor.get_undo_index()
        for goal, written in ((self._goal(-1), before), (self._goal(1), self._goal(1))):
            if written in self._own:
                self._go_to(goal)
                if self.editor.get_text() == text:
                    return True
                self._go_to(before)
        return False

    def _go_to(self, goal: int) -> None:
        while self.editor.can_undo() and self.editor.get_undo_index() > goal:
            self.editor.undo()
        while self.editor.can_redo() and self.editor.get_undo_index() < goal:
            self.editor.redo()
        self.at = self.editor.get_undo_index()

    def _goal(self, by: int) -> int:
        """Return the last end of a word, pause or other change, or with 1 the next."""
        at = self.editor.get_undo_index()
        if by < 0:
            number = bisect_left(self._ends, at)
            return self._ends[number - 1] if number else 0
        number = bisect_right(self._ends, at)
        return self._ends[number] if number < len(self._ends) else max(self._made, default=at)

    def take_typed(self, now: int, *, paused: bool) -> None:
        """Take in what was typed until a place; ``paused``: after a pause."""
        begins = [at for at in range(self.at, now) if self._begins_word(now - at - 1)]
        if paused and self.at not in begins:
            begins.insert(0, self.at)
        self._forget_after(self.at)
        self._ends = [*(end for end in self._ends if end < min(begins, default=now)), *begins]
        self._made |= dict.fromkeys(range(self.at + 1, now + 1), self.clock())
        self.at = now

    def take_change(self, before: int, *, is_own: bool) -> None:
        """Take in what changed since a place as one step; ``is_own``: the window wrote it itself."""
        self.at = self.editor.get_undo_index()
        self._forget_after(before)
        self._ends = [*(end for end in self._ends if end < before), before, self.at]
        self._made[self.at] = self._made.get(before, 0.0) if is_own else self.clock()
        self._own |= {self.at} if is_own else set()

    def _forget_after(self, at: int) -> None:
        """Forget what could be redone after a place: something else was done."""
        self._made = {place: time for place, time in self._made.items() if place <= at}
        self._own = {place for place in self._own if place <= at}

    def _begins_word(self, since: int) -> bool:
        """Return whether the letter typed before the last ``since`` begins a line or a word.

        So does the blank before a word.
        """
        at = self.editor.get_main_cursor_position()
        before = self.editor.get_line_text(at.line)[: max(at.index - since, 0)]
        return not before.strip() or re.search(r"\S\s$|[^\w\s]\w$", before) is not None


@dataclass(eq=False)
class TextView:
    """The editor of one open file."""

    editor: text_edit.TextEditor
    step: str  # one step of indentation
    steps: UndoSteps
    saved_at: int = 0  # the editor's undo index when its text was that of the file
    typed_at: float = 0.0  # [s]
    waits: bool = False  # what is typed is not drawn yet
    marked: tuple[object, tuple[Diagnostic, ...]] = (None, ())
    closing: bool = False  # a question is shown: save or not
    is_light: bool | None = None  # its colours
    focused_for: int = 0  # frames for which it has had the keys
    completion: Completion = field(default_factory=Completion)
    renaming: Renaming | None = None
    shared: list[dict[TextView, tuple[int, int]]] = field(default_factory=list)
    """Steps that changed several files: each one's undo index before and after."""
    sliders: list[Area] = field(default_factory=list)  # over the text: left, top, right, bottom

    @property
    def changed(self) -> bool:
        """Whether anything is not saved."""
        return self.editor.get_undo_index() != self.saved_at

    def written(self) -> str:
        """Return the text as it is typed."""
        return self.editor.get_text()

    def replace(self, text: str, *, is_own: bool = False) -> None:
        """Replace the whole text as one step; ``is_own``: the window wrote it itself."""
        if is_own and self.steps.goes_to(text):
            return
        is_fixed = self.editor.is_read_only_enabled()
        self.editor.set_read_only_enabled(False)
        at = self.editor.get_main_cursor_position()
        before = self.editor.get_undo_index()
        self.editor.select_all()
        insert_text(self, text)
        line = min(at.line, self.editor.get_line_count() - 1)
        self.editor.set_cursor(Pos(line, min(at.index, len(self.editor.get_line_text(line)))))
        self.editor.set_read_only_enabled(is_fixed)
        self.note_step(before, is_own=is_own)

    def apply(self, edits: Sequence[tuple[int, int, str]]) -> tuple[int, int]:
        """Replace parts of the text as one step; return its undo index before and after."""
        text, at = self.written(), self.editor.get_main_cursor_position()
        before = self.editor.get_undo_index()
        for start, end, new in sorted(edits, reverse=True):
            self.editor.replace_section_text(place_of(text, start), place_of(text, end), new)
        length = len(self.editor.get_line_text(at.line))
        self.editor.set_cursor(Pos(at.line, min(at.index, length)))
        self.note_step(before)
        self.marked = (None, self.marked[1])  # what is replaced has lost its markers
        self.waits, self.typed_at = True, self.steps.clock()
        return before, self.steps.at

    def note_saved(self) -> None:
        """Take in that the text is what the file holds."""
        self.saved_at = self.editor.get_undo_index()
        self.waits = False

    def time(self, by: int) -> float | None:
        """Return when what is undone (-1) or redone (1) next was made; see ``Typed``."""
        return self.steps.time(by)

    def go(self, by: int) -> None:
        """Undo (-1) what was typed since the last end of a word, pause or other change; or redo it (1).

        What changed other files with this one is undone in those, too, where nothing was typed since.
        """
        now, end = self.editor.get_undo_index(), 1 if by < 0 else 0
        step = next((step for step in self.shared if step[self][end] == now), {self: (now, now)})
        for view, places in step.items():
            if view.editor.get_undo_index() == places[end]:
                view.steps.go(by)
                view.waits, view.typed_at = True, view.steps.clock()
                view.completion.close()

    def offset(self, place: text_edit.TextEditor.DocPos) -> int:
        """Return where a place is in the text."""
        lines = self.written().split("\n")[: place.line]
        return sum(len(line) + 1 for line in lines) + place.index

    def follow(self) -> bool:
        """Take in what was typed in the last frame; return whether there was anything."""
        at, now = self.editor.get_undo_index(), self.steps.clock()
        if at == self.steps.at:
            return False
        if at > self.steps.at:
            self._forget_shared(self.steps.at)
            self.steps.take_typed(at, paused=now - self.typed_at > _PAUSE)
        self.steps.at, self.typed_at = at, now  # the editor's own undo leads back
        return True

    def note_step(self, before: int, *, is_own: bool = False) -> None:
        """Make what changed since an undo index a step of undo of its own."""
        self._forget_shared(before)
        self.steps.take_change(before, is_own=is_own)

    def _forget_shared(self, index: int) -> None:
        """Forget the steps of several files that were undone: what is typed takes their place."""
        self.shared = [step for step in self.shared if step[self][1] <= index]


def place_of(text: str, offset: int) -> text_edit.TextEditor.DocPos:
    """Return the place of a letter of a text."""
    start = text.rfind("\n", 0, offset) + 1
    return Pos(text.count("\n", 0, offset), offset - start)


def view_of(editing: Editing, files: OpenFiles) -> TextView:
    """Return the editor of an open file; it is made when it is first asked for."""
    if not isinstance(editing.view, TextView):
        editor, language = text_edit.TextEditor(), text_edit.TextEditor.Language
        # It has none for TOML: what Python's colours are comments, strings, numbers.
        editor.set_language(language.python() if editing.text.path.suffix == ".toml" else language.glsl())
        step = step_of(editing.text.base)
        editor.set_tab_size(len(step.expandtabs(4)))
        editor.set_insert_spaces_on_tabs(False)  # else the text's own tabs would become spaces
        editor.set_show_whitespaces_enabled(False)
        editor.set_complete_paired_glyphs(False)  # it would add a second one to each that is typed
        editor.set_show_matching_brackets(True)
        editor.set_find_replace_enabled(False)  # its box is cut off in a narrow pane, and text shines through
        editor.set_text(editing.text.base)
        editor.set_insert_spaces_on_tabs(step != "\t")
        steps = UndoSteps(editor, files.notices.now)
        view = editing.view = TextView(editor, step, steps, saved_at=steps.at)
        if editing.typed_before is not None:
            view.replace(editing.typed_before)
        if editing.is_older:
            view.replace(editing.text.base)
            view.note_saved()
        editor.set_read_only_enabled(bool(editing.belongs_to))
    return editing.view


def insert_text(view: TextView, left: str, right: str = "") -> None:
    """Replace the selection as one step that can be undone, tabs as they are; the cursor stays between."""
    view.editor.set_insert_spaces_on_tabs(False)
    view.editor.replace_text_in_current_cursor(left + right)
    view.editor.set_insert_spaces_on_tabs(view.step != "\t")
    if right:
        line = view.editor.get_main_cursor_position().line - 1
        view.editor.set_cursor(Pos(line, len(left) - 1))

"""The code pane: tabs with the texts of the sketch, which are drawn as they are typed.

A quarter of a second after the last key what is typed goes to the sandbox, without being saved; the last
good picture stays until it has proved good. A text is indented as its own lines are; undo goes by words and
pauses.
"""

from __future__ import annotations

import math
import re
import textwrap
from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from imgui_bundle import ImVec2, imgui
from imgui_bundle import imgui_color_text_edit as text_edit

from playground.errors import Diagnostic, PlaygroundError
from playground.paths import shown, without_part
from playground.shader.syntax.tokens import without_comments
from playground.studio import focus, theme
from playground.studio.code.open_files import Editing, Find, OpenFiles, library_files
from playground.studio.draw import (
    QUIET,
    Area,
    button,
    buttons,
    ctrl_held,
    inked,
    left_a_field,
    styled,
    window,
)
from playground.studio.language import tr
from playground.studio.problems.problems import Problems
from playground.studio.reload.dependencies import path_named
from playground.studio.theme import Theme
from playground.studio.trace.values_panel import draw_values, follow_caret

if TYPE_CHECKING:
    from playground.sketch.suggestions import Suggestion
    from playground.studio.trace.tracing import Tracing

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


PATIENCE = 0.25
"""[s] after the last key until what is typed is drawn."""

_PAUSE = 0.8  # [s] after which what is typed is a step of undo of its own
_ENTER = (imgui.Key.enter, imgui.Key.keypad_enter)
_OWNER = 1  # of keys, while they are taken from the library: any number but 0
_BOX = imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_saved_settings
_TEXT = "##text"  # the editor's own window
_Pos = text_edit.TextEditor.DocPos


@dataclass
class _Completion:
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
class _Renaming:
    """The field that takes a new name."""

    at: int  # where the name begins in the text
    new: str
    message: str = ""  # why the last one was refused
    is_open: bool = False


class _Steps:
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
class _View:
    """The editor of one open file."""

    editor: text_edit.TextEditor
    step: str  # one step of indentation
    steps: _Steps
    saved_at: int = 0  # the editor's undo index when its text was that of the file
    typed_at: float = 0.0  # [s]
    waits: bool = False  # what is typed is not drawn yet
    marked: tuple[object, tuple[Diagnostic, ...]] = (None, ())
    closing: bool = False  # a question is shown: save or not
    is_light: bool | None = None  # its colours
    focused_for: int = 0  # frames for which it has had the keys
    completion: _Completion = field(default_factory=_Completion)
    renaming: _Renaming | None = None
    shared: list[dict[_View, tuple[int, int]]] = field(default_factory=list)
    """Steps that changed several files: each one's undo index before and after."""
    sliders: list[Area] = field(default_factory=list)  # over the text: left, top, right, bottom

    @property
    def changed(self) -> bool:
        return self.editor.get_undo_index() != self.saved_at

    def written(self) -> str:
        return self.editor.get_text()

    def replace(self, text: str, *, is_own: bool = False) -> None:
        if is_own and self.steps.goes_to(text):
            return
        is_fixed = self.editor.is_read_only_enabled()
        self.editor.set_read_only_enabled(False)
        at = self.editor.get_main_cursor_position()
        before = self.editor.get_undo_index()
        self.editor.select_all()
        _insert(self, text)
        line = min(at.line, self.editor.get_line_count() - 1)
        self.editor.set_cursor(_Pos(line, min(at.index, len(self.editor.get_line_text(line)))))
        self.editor.set_read_only_enabled(is_fixed)
        self.note_step(before, is_own=is_own)

    def apply(self, edits: Sequence[tuple[int, int, str]]) -> tuple[int, int]:
        """Replace parts of the text as one step; return its undo index before and after."""
        text, at = self.written(), self.editor.get_main_cursor_position()
        before = self.editor.get_undo_index()
        for start, end, new in sorted(edits, reverse=True):
            self.editor.replace_section_text(_place_of(text, start), _place_of(text, end), new)
        length = len(self.editor.get_line_text(at.line))
        self.editor.set_cursor(_Pos(at.line, min(at.index, length)))
        self.note_step(before)
        self.marked = (None, self.marked[1])  # what is replaced has lost its markers
        self.waits, self.typed_at = True, self.steps.clock()
        return before, self.steps.at

    def note_saved(self) -> None:
        self.saved_at = self.editor.get_undo_index()
        self.waits = False

    def time(self, by: int) -> float | None:
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


def _place_of(text: str, offset: int) -> text_edit.TextEditor.DocPos:
    start = text.rfind("\n", 0, offset) + 1
    return _Pos(text.count("\n", 0, offset), offset - start)


def _view_of(editing: Editing, files: OpenFiles) -> _View:
    if not isinstance(editing.view, _View):
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
        steps = _Steps(editor, files.notices.now)
        view = editing.view = _View(editor, step, steps, saved_at=steps.at)
        if editing.typed_before is not None:
            view.replace(editing.typed_before)
        if editing.is_older:
            view.replace(editing.text.base)
            view.note_saved()
        editor.set_read_only_enabled(bool(editing.belongs_to))
    return editing.view


def typing(files: OpenFiles) -> list[str]:
    """Return the name of the open file that has the keys, once it does; none where no file does."""
    return [e.text.path.name for e in files.editing if isinstance(e.view, _View) and e.view.focused_for > 1]


# ── the pane ──────────────────────────────────────────────────────────────────


_TABS = imgui.TabBarFlags_.reorderable | imgui.TabBarFlags_.fitting_policy_scroll


def draw_code(files: OpenFiles, problems: Problems, look: Theme, tracing: Tracing | None = None) -> None:
    """Draw the code pane's contents into the current window; the values of ``tracing`` behind their lines."""
    _take_or_leave_keys(files)
    seen: Editing | None = None
    if imgui.begin_tab_bar("files", _TABS):
        for editing in list(files.editing):
            if _draw_tab(editing, files):
                seen = editing
        if imgui.tab_item_button("+###other files", imgui.TabItemFlags_.trailing):
            imgui.open_popup("other files")
        imgui.set_item_tooltip(tr("Another file of the sketch, or of the library that it uses"))
        _draw_others(files)
        imgui.end_tab_bar()
    for editing in files.editing:
        if editing is not seen and isinstance(editing.view, _View):
            editing.view.focused_for = 0
    if seen is not None:
        files.current = seen
        _draw_text(seen, files, problems, look, tracing if tracing is not None and tracing.on else None)
    waiting = [e for e in files.editing if isinstance(e.view, _View) and e.view.waits]
    for editing in waiting:
        view = _view_of(editing, files)
        if files.notices.now() - view.typed_at >= PATIENCE:
            view.waits = False
            files.draw_typed(editing)
    left = [
        PATIENCE - files.notices.now() + view.typed_at for e in waiting if (view := _view_of(e, files)).waits
    ]
    files.pane.draws_in = max(min(left), 0.0) if left else None


_JUST = 4  # frames that a click or a request takes to give the pane the keys


def _take_or_leave_keys(files: OpenFiles) -> None:
    """Take the keys by a click or where it was asked for, not because another window has closed."""
    now, all_of_it = imgui.get_frame_count(), imgui.HoveredFlags_.root_and_child_windows
    hovered = imgui.is_window_hovered(all_of_it | imgui.HoveredFlags_.allow_when_blocked_by_active_item)
    asked = any(editing.focus and editing.takes_keys for editing in files.editing)
    is_clicked = hovered and (imgui.is_mouse_clicked(0) or imgui.is_mouse_clicked(1))
    if asked or is_clicked:
        files.pane.asked_at = now
    if is_clicked and not files.pane.has_keys and files.current is not None:
        _view_of(files.current, files).editor.set_focus()  # a right click alone does not
    is_new = now - files.pane.asked_at <= _JUST
    if not imgui.is_window_focused(imgui.FocusedFlags_.root_and_child_windows) or focus.is_shown():
        files.pane.has_keys = files.pane.has_keys and is_new
    elif files.pane.has_keys or is_new:
        files.pane.has_keys = True
        files.names.prepare()
    else:
        imgui.set_window_focus(None)


def draw_questions(files: OpenFiles) -> None:
    """Draw the question on a file that is to be closed with changes that are not saved."""
    for editing in list(files.editing):
        if isinstance(editing.view, _View) and editing.view.closing:
            _ask_to_close(editing, editing.view, files)


def ask_to_close(editing: Editing, files: OpenFiles) -> None:
    """Close an open file; one with changes that are not saved needs an answer first."""
    view = _view_of(editing, files)
    if view.changed and editing.text.needs_saving:
        view.closing = True
    else:
        files.close(editing)


def stay(files: OpenFiles) -> None:
    """Dismiss every question; nothing is saved or closed."""
    for editing in files.editing:
        if isinstance(editing.view, _View):
            editing.view.closing = False


def close_smaller(files: OpenFiles) -> bool:
    """Close the list of what may stand at the cursor, or what finds; return whether one was open."""
    views = [e.view for e in files.editing if isinstance(e.view, _View) and e.view.completion.found]
    for view in views:
        view.completion.close()
    if views:
        return True
    was_open = files.pane.find.is_open and files.pane.has_keys
    files.pane.find.is_open = files.pane.find.is_open and not was_open
    return was_open


def give_back_keys(files: OpenFiles) -> None:
    """Give the keys back to the picture."""
    imgui.set_window_focus(None)
    files.pane.has_keys, files.pane.asked_at = False, -_JUST - 1
    for editing in files.editing:
        if isinstance(editing.view, _View):
            editing.view.focused_for = 0


def _draw_tab(editing: Editing, files: OpenFiles) -> bool:
    """Draw the tab of one file; return whether it is the one that is seen."""
    view, flags = _view_of(editing, files), 0
    if view.changed and editing.text.needs_saving:
        flags |= imgui.TabItemFlags_.unsaved_document
    if editing.focus or (files.current is editing and files.pane.jumps):
        flags |= imgui.TabItemFlags_.set_selected
        files.pane.jumps = False
    label = editing.text.path.name if editing.text.needs_saving else editing.text.title
    name = f"{label}###{editing.text.title} {int(editing.text.needs_saving)}"
    is_seen, stays = imgui.begin_tab_item(name, True, flags)
    if imgui.is_item_hovered(imgui.HoveredFlags_.for_tooltip):
        imgui.set_tooltip(editing.text.title)
    if is_seen:
        imgui.end_tab_item()
    if stays is False:
        ask_to_close(editing, files)
    return bool(is_seen)


def _draw_others(files: OpenFiles) -> None:
    """Draw the list of the sketch's files that have no tab."""
    if not imgui.begin_popup("other files"):
        return
    sketch = files.sketch
    others = [] if sketch is None else [*files.own(), *library_files(sketch)]
    for path in others:
        if files.at(path) is None and imgui.menu_item_simple(shown(path)):
            files.open(path, here=True)
    imgui.end_popup()


def _draw_text(
    editing: Editing, files: OpenFiles, problems: Problems, look: Theme, tracing: Tracing | None
) -> None:
    view = _view_of(editing, files)
    if view.is_light is not theme.palette.is_light:
        view.is_light = theme.palette.is_light
        of = text_edit.TextEditor
        view.editor.set_palette(of.get_light_palette() if view.is_light else of.get_dark_palette())
    focused = imgui.is_window_focused(imgui.FocusedFlags_.root_and_child_windows) and not focus.is_shown()
    view.focused_for = view.focused_for + 1 if focused and not editing.focus else 0
    _mark(editing, view, problems)
    _draw_bar(editing, view, files, look)
    if files.pane.find.is_open:
        _draw_find(editing, view, files.pane.find, look)
    if focused and view.renaming is None:
        _take_keys(editing, view, files)
        _choose_completion(view)
    if editing.focus:
        editing.focus = False
        if editing.takes_keys:
            imgui.set_window_focus()
            focus.hide()
        view.editor.set_cursor(_Pos(editing.line - 1, editing.column - 1))
        view.editor.scroll_to_line(editing.line - 1, text_edit.TextEditor.Scroll.align_middle)
        if editing.takes_keys:
            view.editor.set_focus()
    find = files.pane.find
    in_field = imgui.is_any_item_active() or find.settles > 0
    find.settles = max(find.settles - 1, 0)
    if focused and imgui.is_window_focused() and not in_field:
        view.editor.set_focus()  # after a click on a tab or a button
    if focused and not in_field:  # Enter in a field finds
        _indent(view)
    menu = partial(_draw_menu, editing, view, files, look)
    view.editor.set_text_context_menu_callback(lambda asked: menu(asked.pos))
    below = imgui.get_text_line_height_with_spacing() if view.marked[1] else 0.0
    with look.font(look.code), styled({imgui.Col_.child_bg: theme.colour(theme.palette.ground)}):
        mouse = imgui.get_mouse_pos()
        if any(x0 <= mouse.x < x1 and y0 <= mouse.y < y1 for x0, y0, x1, y1 in view.sliders):
            imgui.get_io().mouse_pos = ImVec2(-9e5, -9e5)  # the editor does not see the mouse on a slider
        view.editor.render(_TEXT, ImVec2(0, -below))
        imgui.get_io().mouse_pos = mouse
        if focus.is_shown() and imgui.get_item_id() == imgui.get_current_context().nav_id:
            focus.hide()  # Tab came to the text, which has Tab for itself
            view.editor.set_focus()
            files.pane.asked_at = imgui.get_frame_count()
        if imgui.is_item_hovered():
            _explain(editing, view, files, look)
        _draw_behind(view, look)
        view.sliders = _draw_values(editing, view, look, tracing) if tracing is not None else []
    if tracing is not None and not any(other.focus for other in files.editing):
        follow_caret(tracing, str(editing.text.path), view.editor)
    if below:
        _draw_mistake(view, look)
    if view.follow():
        view.waits = True
        _complete(editing, view, files)
    _draw_completion(view, look)
    _draw_renaming(editing, view, files, look)


def _take_keys(editing: Editing, view: _View, files: OpenFiles) -> None:
    if ctrl_held():
        if imgui.is_key_pressed(imgui.Key.s, False):
            files.save(editing)
        if imgui.is_key_pressed(imgui.Key.f, False):
            _open_find(view, files)
        in_field = imgui.is_any_item_active()
        for key, by in ((imgui.Key.z, -1), (imgui.Key.y, 1)):
            if imgui.is_key_pressed(key) and not in_field:
                imgui.internal.set_key_owner(key, _OWNER, imgui.internal.InputFlagsPrivate_.lock_this_frame)
                files.step(1 if imgui.get_io().key_shift else by)
    if imgui.is_key_pressed(imgui.Key.f3) and files.pane.find.text:
        _find_next(view, files.pane.find)
    if imgui.is_key_pressed(imgui.Key.f12, False):
        _open_declaration(editing, view, files)
    if imgui.is_key_pressed(imgui.Key.f2, False):
        _begin_renaming(editing, view, files)
    imgui.get_io().want_text_input = True  # keys are this editor's, not the picture's


def _indent(view: _View) -> None:
    """Take Enter and closing brackets from the library, which indents by one letter, and no bracket.

    With several cursors they stay the library's.
    """
    editor, io = view.editor, imgui.get_io()
    if editor.get_number_of_cursors() != 1:
        return
    selection = editor.get_main_cursor_selection()
    first = _Pos(selection.start.line, 0)
    typed = [chr(code) for code in io.input_queue_characters]
    if any(imgui.is_key_pressed(key) for key in _ENTER) and not (io.key_ctrl or io.key_shift or io.key_alt):
        for key in _ENTER:
            imgui.internal.set_key_owner(key, _OWNER, imgui.internal.InputFlagsPrivate_.lock_this_frame)
        io.input_queue_characters.clear()
        end = selection.end
        rest = editor.get_line_text(end.line)
        rest = editor.get_section_text(end, _Pos(end.line, len(rest)))
        blanks = len(rest) - len(rest.lstrip())
        editor.select_region(selection.start, _Pos(end.line, end.index + blanks))
        left, right = new_line(editor.get_section_text(first, selection.start), rest, view.step)
        _insert(view, left, right)
    elif len(typed) == 1 and selection.start == selection.end:
        start = _Pos(0, 0)
        indent = closing_indent(editor.get_section_text(start, selection.start), typed[0])
        if indent is not None:
            io.input_queue_characters.clear()
            editor.select_region(first, selection.start)
            _insert(view, indent + typed[0])


def _insert(view: _View, left: str, right: str = "") -> None:
    """Replace the selection as one step that can be undone, tabs as they are; the cursor stays between."""
    view.editor.set_insert_spaces_on_tabs(False)
    view.editor.replace_text_in_current_cursor(left + right)
    view.editor.set_insert_spaces_on_tabs(view.step != "\t")
    if right:
        line = view.editor.get_main_cursor_position().line - 1
        view.editor.set_cursor(_Pos(line, len(left) - 1))


def _draw_bar(editing: Editing, view: _View, files: OpenFiles, look: Theme) -> None:
    belongs_to = editing.belongs_to
    if belongs_to:
        with look.font(look.text, theme.SMALL):
            imgui.align_text_to_frame_padding()
            words = tr("of the library") if belongs_to == "library" else tr("a shipped sketch")
            imgui.text_disabled(words)
        imgui.same_line()
        label = tr("Copy into this sketch") if belongs_to == "library" else tr("Edit a copy")
        note = tr("A file of your own in its place, which can be changed")
        if button(f"{label}###copy in", note, small=True):
            files.copy_in(editing.text.path)
        return
    note = tr("Ctrl+S; what is typed is drawn at once, and kept here until it is saved")
    buttons(
        (f"{tr('Save')}###save code", note, lambda: files.save(editing), view.changed),
        (f"{tr('Undo')}###undo code", "Ctrl+Z", partial(files.step, -1), view.editor.can_undo()),
        (f"{tr('Redo')}###redo code", "Ctrl+Y", partial(files.step, 1), view.editor.can_redo()),
        (f"{tr('Find')}###find code", "Ctrl+F", partial(_open_find, view, files), True),
        small=True,
    )
    imgui.same_line()
    cursor = view.editor.get_main_cursor_position()
    with look.font(look.text, theme.SMALL):
        imgui.text_disabled(tr("line {line}, column {column}", line=cursor.line + 1, column=cursor.index + 1))


def _mark(editing: Editing, view: _View, problems: Problems) -> None:
    """Mark the lines that have diagnostics."""
    mine = tuple(
        d
        for d in problems.all
        if d.file and d.line and d.file == without_part(d.file) and path_named(d.file) == editing.text.path
    )
    if mine == view.marked[1] and view.marked[0] is problems.errors:
        return
    view.marked = problems.errors, mine
    view.editor.clear_markers()
    for diagnostic in reversed(mine):
        rgb = theme.palette.alarm if diagnostic.severity == "error" else theme.palette.warm
        note = textwrap.fill(diagnostic.message, 60)
        view.editor.add_marker(
            diagnostic.line - 1, theme.packed(rgb, 0.8), theme.packed(rgb, 0.22), note, note
        )


def _draw_behind(view: _View, look: Theme) -> None:
    """Write mistakes behind their lines, cut where there is no room; the whole is their tooltip."""
    if not view.marked[1]:
        return
    editor = view.editor
    imgui.begin_child(_TEXT)  # the editor's own window: what is drawn scrolls and is clipped with it
    corner, size, wide = imgui.get_window_pos(), imgui.get_window_size(), editor.get_glyph_width()
    draw, right = imgui.get_window_draw_list(), corner.x + size.x - 16 * look.scale
    first, last = editor.get_first_visible_row(), editor.get_last_visible_row()
    done: set[int] = set()
    for diagnostic in view.marked[1]:
        line = diagnostic.line - 1
        if line in done or line >= editor.get_line_count() or editor.is_line_hidden(line):
            continue
        done.add(line)
        end = _Pos(line, len(editor.get_line_text(line)))
        if not first <= editor.doc_pos2_vis_pos(end).row <= last:
            continue
        place = editor.doc_pos2_screen_pos(end)
        x = place.x + 3 * wide
        room = int((right - x) / wide)
        text = " ".join(diagnostic.message.split())
        rgb = theme.palette.alarm if diagnostic.severity == "error" else theme.palette.warm
        if room > 5:
            cut = text if len(text) <= room else f"{text[: room - 1]}…"
            draw.add_text(ImVec2(x, place.y), theme.packed(rgb), cut)
    imgui.end_child()


def _draw_values(editing: Editing, view: _View, look: Theme, tracing: Tracing) -> list[Area]:
    """Draw what a traced texel gave behind the lines that gave it; return where that takes the mouse."""
    imgui.begin_child(_TEXT)  # as in ``_draw_behind``
    wrong = {diagnostic.line for diagnostic in view.marked[1]}
    path = str(editing.text.path)
    places = draw_values(tracing, path, view.editor, wrong, view.waits, look)
    imgui.end_child()
    return places


def _draw_mistake(view: _View, look: Theme) -> None:
    """Write the mistake of the cursor's line below the text, or the first; a click leads there."""
    mine = view.marked[1]
    line = view.editor.get_main_cursor_position().line + 1
    diagnostic = next((d for d in mine if d.line == line), mine[0])
    is_error = diagnostic.severity == "error"
    words = f"{diagnostic.line}: {' '.join(diagnostic.message.split())}"
    with inked(theme.palette.alarm if is_error else theme.palette.warm), look.font(look.text, theme.SMALL):
        room = imgui.get_content_region_avail().x
        most = max(int(room / max(imgui.calc_text_size("n").x, 1.0)), 8)
        if imgui.selectable(f"{_cut(words, most)}###mistake", False)[0]:
            at = _Pos(diagnostic.line - 1, max(diagnostic.column - 1, 0))
            view.editor.set_cursor(at)
            view.editor.scroll_to_line(at.line, text_edit.TextEditor.Scroll.align_middle)
            view.editor.set_focus()
    if imgui.is_item_hovered(imgui.HoveredFlags_.for_tooltip):
        imgui.set_tooltip(textwrap.fill(diagnostic.message, 70))


# ── find and replace ──────────────────────────────────────────────────────────


def _open_find(view: _View, files: OpenFiles) -> None:
    """Open what finds, with the selected text in its field where that is of one line."""
    find, editor = files.pane.find, view.editor
    find.is_open = True
    find.focus("##find")
    selection = editor.get_main_cursor_selection()
    if selection.start != selection.end and selection.start.line == selection.end.line:
        find.text = editor.get_section_text(selection.start, selection.end)


def _find_next(view: _View, find: Find) -> None:
    view.editor.select_next_occurrence_of(find.text, find.case, find.words)


def _draw_find(editing: Editing, view: _View, find: Find, look: Theme) -> None:
    """Draw the fields and buttons that find, and replace in a text that can be changed."""
    pattern = re.escape(find.text)
    pattern = rf"\b{pattern}\b" if find.words else pattern
    count = len(re.findall(pattern, view.written(), 0 if find.case else re.IGNORECASE)) if find.text else 0
    room = imgui.get_content_region_avail().x
    field_wide, closer = 0.38 * room, {imgui.StyleVar_.item_spacing: ImVec2(4 * look.scale, 4 * look.scale)}
    with look.font(look.text, theme.SMALL), styled(sizes=closer):
        entered, find.text = _draw_field(find, "##find", tr("Find"), find.text, field_wide)
        imgui.same_line()
        if button(f"{tr('Next')}##find next", "F3", enabled=count > 0) or (entered and count):
            _find_next(view, find)
        imgui.same_line()
        _, find.case = imgui.checkbox("Aa", find.case)
        imgui.set_item_tooltip(tr("Letters count as they are written"))
        imgui.same_line()
        _, find.words = imgui.checkbox("[ ]", find.words)
        imgui.set_item_tooltip(tr("Whole words alone"))
        imgui.same_line()
        imgui.text_disabled(str(count))
        imgui.set_item_tooltip(tr("{count} found", count=count))
        imgui.same_line()
        if button("×##close find", tr("Esc closes it")) or (
            left_a_field() and imgui.is_key_pressed(imgui.Key.escape, False)
        ):
            find.is_open = False
        if editing.belongs_to:
            return
        entered, find.new = _draw_field(find, "##replace", tr("Replace by"), find.new, field_wide)
        imgui.same_line()
        if button(f"{tr('Replace')}##replace one", enabled=count > 0) or (entered and count):
            _replace(view, find)
        imgui.same_line()
        if button(f"{tr('All')}##replace all", tr("As one step"), enabled=count > 0):
            _replace(view, find, all_of_them=True)


def _draw_field(find: Find, label: str, hint: str, text: str, wide: float) -> tuple[bool, str]:
    """Draw a field that keeps the keys at Enter; return whether that was pressed, and its text."""
    if find.asks == label:
        find.asks = ""
        imgui.set_keyboard_focus_here()
    imgui.set_next_item_width(wide)
    flags = imgui.InputTextFlags_.enter_returns_true | imgui.InputTextFlags_.auto_select_all
    entered, text = imgui.input_text_with_hint(label, hint, text, flags)
    if entered:
        find.focus(label)
    return entered, text


def _replace(view: _View, find: Find, *, all_of_them: bool = False) -> None:
    """Replace what is selected, where that is what is looked for, and go on; or all of it."""
    editor, before = view.editor, view.editor.get_undo_index()
    selection = editor.get_main_cursor_selection()
    found = editor.get_section_text(selection.start, selection.end)
    if all_of_them:
        editor.select_all_occurrences_of(find.text, find.case, find.words)
        editor.replace_text_in_all_cursors(find.new)
        editor.set_cursor(editor.get_main_cursor_position())
    elif found == find.text or (not find.case and found.lower() == find.text.lower()):
        editor.replace_text_in_current_cursor(find.new)
    if editor.get_undo_index() != before:
        view.note_step(before)
        view.waits, view.typed_at = True, view.steps.clock()
        view.marked = (None, view.marked[1])
    if not all_of_them:
        _find_next(view, find)


# ── completion ───────────────────────────────────────────────────────────────


_MOST = 9  # rows of what may stand there
_PREFIX = re.compile(r"[A-Za-z_]\w*$")
_OPENS = (re.compile(r"\.$|#.*[\"</]$"), re.compile(r"[\"'./=\[{]$"))
"""What opens the list before a name is begun, in a kernel and in TOML."""
_CHOOSE = (imgui.Key.up_arrow, imgui.Key.down_arrow, imgui.Key.enter, imgui.Key.keypad_enter, imgui.Key.tab)


def _complete(editing: Editing, view: _View, files: OpenFiles) -> None:
    """Look for what may stand where something was typed."""
    shown, editor = view.completion, view.editor
    at = editor.get_main_cursor_position()
    before = editor.get_line_text(at.line)[: at.index]
    word = _PREFIX.search(before)
    prefix = word[0] if word else ""
    opens = _OPENS[editing.text.path.suffix == ".toml"].search(before) is not None
    is_shorter = at.line == shown.end.line and at.index < shown.end.index
    shown.end = at
    if not (len(prefix) > 1 or opens) or (is_shorter and shown.is_closed):
        shown.close()
        return
    offset = view.offset(at)
    names = files.names.suggest(editing.text.path, view.written(), offset)
    start = next((s.start for s in names if s.start >= 0), offset - len(prefix))
    shown.prefix = before[len(before) - (offset - start) :] if offset > start else ""
    lower = shown.prefix.lower()

    def fits(s: Suggestion) -> bool:
        at = s.label.lower().find(lower)  # of a path or a value any part
        return s.label != shown.prefix and (at == 0 or (at > 0 and s.start >= 0))

    fitting = [s for s in names if fits(s)]
    fitting.sort(key=lambda s: (not s.label.startswith(shown.prefix), s.order, s.label.lower()))
    shown.found, shown.at, shown.is_closed = fitting[:_MOST], 0, not fitting


def _choose_completion(view: _View) -> None:
    """Take the keys of an open list before the editor sees them."""
    shown = view.completion
    if not shown.found:
        return
    if imgui.is_key_pressed(imgui.Key.left_arrow) or imgui.is_key_pressed(imgui.Key.right_arrow):
        shown.close()
        return
    pressed = [key for key in _CHOOSE if imgui.is_key_pressed(key)]
    for key in _CHOOSE:
        imgui.internal.set_key_owner(key, _OWNER, imgui.internal.InputFlagsPrivate_.lock_this_frame)
    for key in pressed:
        if key in _CHOOSE[:2]:
            shown.at = (shown.at + (1 if key == imgui.Key.down_arrow else -1)) % len(shown.found)
        else:
            _accept(view, shown.found[shown.at])
            return


def _accept(view: _View, suggestion: Suggestion) -> None:
    """Put what is chosen in the place of what is typed, and above it the include that it needs."""
    editor, shown = view.editor, view.completion
    at = editor.get_main_cursor_position()
    start = _Pos(at.line, at.index - len(shown.prefix))
    before, label = editor.get_undo_index(), suggestion.label
    line = editor.get_line_text(at.line)
    quote = line[start.index - 1 : start.index]
    if quote in ('"', "'") and suggestion.start >= 0 and line[at.index : at.index + 1] != quote:
        label += quote
    editor.replace_section_text(start, at, label)
    from playground.sketch.suggestions import include_row

    row = include_row(view.written())
    lines = 0
    if suggestion.include:
        include = f'#include "{suggestion.include}"\n'
        editor.replace_section_text(_Pos(row, 0), _Pos(row, 0), include)
        lines = int(row <= at.line)
    editor.set_cursor(_Pos(at.line + lines, start.index + len(label)))
    view.note_step(before)
    view.waits, view.typed_at = True, view.steps.clock()
    shown.close()


def _draw_completion(view: _View, look: Theme) -> None:
    """Draw the list of what may stand at the cursor, and a line on the one that is chosen."""
    shown, editor = view.completion, view.editor
    if not shown.found or not view.focused_for:
        return
    at = editor.get_main_cursor_position()
    place = editor.doc_pos2_screen_pos(_Pos(at.line, max(at.index - len(shown.prefix), 0)))
    room, scale = imgui.get_main_viewport().size, look.scale
    high = editor.get_line_height() * (len(shown.found) + 2)
    below = place.y + editor.get_line_height() + high < room.y
    imgui.set_next_window_pos(
        ImVec2(min(place.x, room.x - 420 * scale), place.y + (editor.get_line_height() + 2 if below else -2)),
        imgui.Cond_.always,
        ImVec2(0, 0 if below else 1),
    )
    flags = imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.always_auto_resize | QUIET
    flags |= imgui.WindowFlags_.tooltip | imgui.WindowFlags_.no_focus_on_appearing | imgui.WindowFlags_.no_nav
    with window("completion", flags, ground=theme.colour(theme.palette.popup)), look.font(look.code):
        for number, suggestion in enumerate(shown.found):
            imgui.selectable(_cut(suggestion.label, 22), number == shown.at, 0, ImVec2(160 * scale, 0))
            imgui.same_line(180 * scale)
            imgui.text_disabled(_cut(suggestion.detail, 28))
        chosen = shown.found[shown.at]
        about = _about(chosen)
        if chosen.include:
            about = tr("adds #include {file}", file=chosen.include) + (f"; {about}" if about else "")
        if about or chosen.detail:
            imgui.separator()
            with look.font(look.text, theme.SMALL):
                imgui.text_disabled(_cut(about, 64) or chosen.detail)


def _about(suggestion: Suggestion) -> str:
    """Return what is known of a name, on one line."""
    from playground.sketch.model import Parameter

    about, origin = suggestion.about, suggestion.origin
    if isinstance(origin, tuple):
        about = origin[1].comment
    elif isinstance(origin, Parameter):
        about = origin.tooltip
    elif origin is not None:
        about = shown(origin.path)
    return " ".join(about.split())


_RESTS = 0.5  # [s] the mouse rests on a name until its explanation is shown


def _explain(editing: Editing, view: _View, files: OpenFiles, look: Theme) -> None:
    """Show what the name under the mouse is, once the mouse rests."""
    editor, mouse = view.editor, imgui.get_mouse_pos()
    if imgui.get_current_context().mouse_stationary_timer < _RESTS or view.completion.found:
        return
    if not editor.is_mouse_pos_over_glyph(mouse):
        return
    known = files.names.meaning(
        editing.text.path, view.written(), view.offset(editor.get_doc_pos_at_mouse_pos(mouse))
    )
    if known is not None:
        with look.font(look.code, theme.SMALL):
            text = "\n".join(filter(None, [known.detail, textwrap.fill(_about(known), 60)]))
            imgui.set_tooltip(f"{known.label}: {text}" if known.kind != "function" else text)


def _cut(text: str, most: int) -> str:
    return text if len(text) <= most else f"{text[: most - 1]}…"


# ── names ────────────────────────────────────────────────────────────────────


def _draw_menu(
    editing: Editing, view: _View, files: OpenFiles, look: Theme, at: text_edit.TextEditor.DocPos
) -> None:
    """Draw what a right click offers at a place of the text."""
    spacing = {imgui.StyleVar_.item_spacing: ImVec2(16 * look.scale, 6 * look.scale)}
    with styled(sizes=spacing), look.font(look.text):
        _draw_menu_items(editing, view, files, at)


def _draw_menu_items(
    editing: Editing, view: _View, files: OpenFiles, at: text_edit.TextEditor.DocPos
) -> None:
    editor, is_free = view.editor, not editing.belongs_to
    if imgui.menu_item_simple(f"{tr('Rename')}###rename", "F2", False, is_free):
        editor.set_cursor(at)
        _begin_renaming(editing, view, files)
    if imgui.menu_item_simple(f"{tr('Go to the declaration')}    ###declaration", "F12"):
        editor.set_cursor(at)
        _open_declaration(editing, view, files)
    imgui.separator()
    has_selection = editor.any_cursor_has_selection()
    if imgui.menu_item_simple(f"{tr('Cut')}###cut", "Ctrl+X", False, is_free and has_selection):
        editor.cut()
    if imgui.menu_item_simple(f"{tr('Copy')}###copy", "Ctrl+C", False, has_selection):
        editor.copy()
    if imgui.menu_item_simple(f"{tr('Paste')}###paste", "Ctrl+V", False, is_free):
        editor.paste()


def _open_declaration(editing: Editing, view: _View, files: OpenFiles) -> None:
    at = view.offset(view.editor.get_main_cursor_position())
    files.open_declaration(editing.text.path, view.written(), at)


def _begin_renaming(editing: Editing, view: _View, files: OpenFiles) -> None:
    """Open the field for a new name at the name that the cursor is in, or say why it has to stay."""
    if editing.belongs_to:
        note = tr("{file} is not the sketch's own, so its names stay", file=editing.text.path.name)
        files.notices.say(note)
        return
    text, at = view.written(), view.offset(view.editor.get_main_cursor_position())
    try:
        start, end = files.names.rename_span(editing.text.path, text, at)
    except PlaygroundError as error:
        files.notices.say(str(error))
        return
    view.completion.close()
    view.renaming = _Renaming(start, text[start:end])


def _draw_renaming(editing: Editing, view: _View, files: OpenFiles, look: Theme) -> None:
    """Draw the field for a new name, and below it why the last one was refused."""
    asked, editor = view.renaming, view.editor
    if asked is None:
        return
    if not asked.is_open:
        asked.is_open = True
        imgui.open_popup("rename")
    place = editor.doc_pos2_screen_pos(_place_of(view.written(), asked.at))
    imgui.set_next_window_pos(ImVec2(place.x, place.y + editor.get_line_height() + 2))
    if not imgui.begin_popup("rename"):
        view.renaming = None
        editor.set_focus()
        return
    if imgui.is_window_appearing():
        imgui.set_keyboard_focus_here()
    flags = imgui.InputTextFlags_.enter_returns_true | imgui.InputTextFlags_.auto_select_all
    with look.font(look.code):
        imgui.set_next_item_width(240 * look.scale)
        entered, asked.new = imgui.input_text("##new name", asked.new, flags)
    if entered:
        asked.message = _rename(editing, view, files, asked)
        imgui.set_keyboard_focus_here(-1)
    if (entered and not asked.message) or imgui.is_key_pressed(imgui.Key.escape, False):
        imgui.close_current_popup()
    with look.font(look.text, theme.SMALL):
        if asked.message:
            with inked(theme.palette.alarm):
                imgui.text_unformatted(textwrap.fill(asked.message, 48))
        else:
            imgui.text_disabled(tr("Enter renames it wherever it is seen"))
    imgui.end_popup()


def _rename(editing: Editing, view: _View, files: OpenFiles, asked: _Renaming) -> str:
    """Give a name its new one in every file, as one step; return why not, or nothing."""
    path, sketch = editing.text.path, files.sketch
    folder = Path(sketch.folder) if sketch is not None else path.parent
    try:
        edits = files.names.rename(path, view.written(), asked.at, asked.new.strip(), folder)
        changes = {_view_of(files.tab_of(file), files): some for file, some in edits.items()}
    except PlaygroundError as error:
        return error.diagnostics[0].message
    step = {each: each.apply(some) for each, some in changes.items()}
    for each in step:
        each.shared.append(step)
    return ""


# ── questions ────────────────────────────────────────────────────────────────


def _question(title: str, text: str, answers: Sequence[tuple[str, str]]) -> str:
    """Ask in a box over the window; return the answer that is clicked on, which closes it, else nothing.

    ``answers``: what each is called here, and what it reads on the screen.
    """
    if not imgui.is_popup_open(title):
        imgui.open_popup(title)
    chosen = ""
    with styled({imgui.Col_.modal_window_dim_bg: theme.colour((0.0, 0.0, 0.0), 0.45)}):
        if imgui.begin_popup_modal(title, None, _BOX)[0]:
            imgui.text_unformatted(text)
            for number, (answer, words) in enumerate(answers):
                if number:
                    imgui.same_line()
                if button(f"{words}###{answer}"):
                    chosen = answer
            if chosen:
                imgui.close_current_popup()
            imgui.end_popup()
    return chosen


def _ask_to_close(editing: Editing, view: _View, files: OpenFiles) -> None:
    """Ask what becomes of changes that are not saved."""
    name = editing.text.path.name
    answers = (
        ("save and close", tr("Save and close")),
        ("close", tr("Close without saving")),
        ("stay", tr("Stay")),
    )
    title = f"{tr('Close without saving?')}###close code"
    answer = _question(title, tr("{file} has changes that are not saved.", file=name), answers)
    view.closing = not answer
    if answer == "close" or (answer == "save and close" and files.save(editing)):
        files.close(editing)

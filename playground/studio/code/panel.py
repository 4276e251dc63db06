"""A small text editor in the window: for a quick repair, or where there is no other.

A text is indented as its own lines are.
"""

from __future__ import annotations

import re
import textwrap
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass

from imgui_bundle import ImVec2, imgui
from imgui_bundle import imgui_color_text_edit as text_edit

from playground.errors import Diagnostic, PlaygroundError
from playground.paths import without_part
from playground.studio import theme
from playground.studio.code.open_files import Editing, OpenFiles, OpenText, unsaved
from playground.studio.draw import QUIET, Area, button, buttons, ctrl_held, styled
from playground.studio.notices import Notices
from playground.studio.problems.problems import Problems
from playground.studio.reload.dependencies import path_named
from playground.studio.theme import Theme

# ── indentation ───────────────────────────────────────────────────────────────


DEFAULT_STEP = " " * 4
_PAIRS = {"}": "{", "]": "[", ")": "("}
_COMMENT = re.compile(r"//[^\n]*|/\*.*?(?:\*/|\Z)", re.DOTALL)
_BLANK = re.compile(r"[ \t]*")


def step_of(text: str) -> str:
    """Return one step of indentation: that of most lines after an open brace, else of most lines."""
    lines = [line for line in _COMMENT.sub(" ", text).split("\n") if line.strip()]
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
    code = _COMMENT.sub(" ", before).rstrip()
    if not code.endswith(tuple(_PAIRS.values())):
        return f"\n{indent}", ""
    closes = _PAIRS.get(after.strip()[:1]) == code[-1]
    return f"\n{indent}{step}", f"\n{indent}" if closes else ""


def closing_indent(before: str, bracket: str) -> str | None:
    """Return the indentation of a closing bracket that begins a line: that of the line which opens it.

    ``before`` is the text up to the cursor. None where the bracket begins no line, or closes nothing.
    """
    code = _COMMENT.sub(lambda comment: re.sub(r"[^\n]", " ", comment[0]), before)
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


# ── the editor ────────────────────────────────────────────────────────────────


_MAX_HEIGHT = 0.46  # fraction of the picture's height, so that the list below stays visible
_CLASH = "Saved by others meanwhile"
_CLOSING = "Close without saving?"
_LEAVING = "Quit without saving?"
_CLASH_ANSWERS = (
    ("Take theirs", "Reads the file again; Undo brings back what was typed here"),
    ("Save mine", "Overwrites what others saved; Undo brings that back"),
    ("Go on typing", ""),
)
_ENTER = (imgui.Key.enter, imgui.Key.keypad_enter)
_OWNER = 1  # of these keys, while they are taken from the library: any number but 0
_BOX = imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_saved_settings


@dataclass
class _View:
    """The editor of one open file."""

    editor: text_edit.TextEditor
    step: str  # one step of indentation
    saved_at: int = 0  # the editor's undo index when its text was that of the file
    marked: tuple[Diagnostic, ...] = ()
    clash: str = ""  # why it could not be saved; the user decides what to do
    closing: bool = False  # a question is shown: save or discard
    focused_for: int = 0  # frames for which it has had the keys

    @property
    def changed(self) -> bool:
        return self.editor.get_undo_index() != self.saved_at

    def written(self) -> str:
        return self.editor.get_text()


def draw_code(
    files: OpenFiles, problems: Problems, quit_window: Callable[[], None], look: Theme, area: Area
) -> None:
    """Draw every file that is open in the window, and the questions about those that are not saved."""
    with styled({imgui.Col_.modal_window_dim_bg: theme.colour((0.0, 0.0, 0.0), 0.45)}):
        for at, editing in enumerate(list(files.editing)):
            if not _draw(editing, files.notices, problems, look, window_place(area, at, look.scale)):
                files.editing.remove(editing)
        if files.leaving:
            _ask_to_leave(files, quit_window)


def ask_to_close(editing: Editing, files: OpenFiles) -> None:
    """Close an open file; one with changes that are not saved needs an answer first."""
    view = _view_of(editing)
    if view.changed and editing.text.needs_saving:
        view.closing = True
    else:
        files.editing.remove(editing)


def stay(files: OpenFiles) -> None:
    """Dismiss every question about unsaved changes; nothing is saved or closed."""
    files.leaving = False
    for editing in files.editing:
        view = _view_of(editing)
        view.clash, view.closing = "", False


def typing(open_files: Iterable[Editing]) -> list[str]:
    """Return the name of the open file that has the keys, once it does; none where no file does."""
    return [e.text.path.name for e in open_files if _view_of(e).focused_for > 1]


def save(editing: Editing, notices: Notices, *, over: bool = False) -> bool:
    """Save an open file; return whether that worked. Where others saved it meanwhile, the user decides."""
    view = _view_of(editing)
    try:
        if not editing.text.save(view.written(), over=over):
            view.clash = "The file is another than when it was opened here."
            return False
    except PlaygroundError as error:
        notices.say(str(error))
        return False
    view.saved_at = view.editor.get_undo_index()
    notices.say(editing.text.saved())
    return True


def _view_of(editing: Editing) -> _View:
    if not isinstance(editing.view, _View):
        editor = text_edit.TextEditor()
        if editing.text.path.suffix != ".toml":
            editor.set_language(text_edit.TextEditor.Language.glsl())
        step = step_of(editing.text.base)
        editor.set_tab_size(len(step.expandtabs(4)))
        editor.set_insert_spaces_on_tabs(False)  # else the text's own tabs would become spaces
        editor.set_show_whitespaces_enabled(False)
        editor.set_complete_paired_glyphs(False)  # it would add a second one to each that is typed
        editor.set_text(editing.text.base)
        editor.set_insert_spaces_on_tabs(step != "\t")
        editing.view = _View(editor, step, editor.get_undo_index())
    return editing.view


def window_place(area: Area, at: int, scale: float) -> Area:
    """Return where the window of one of several files appears."""
    x, y, wide, high = area
    size = min(wide * 0.7, 720 * scale), min(high * _MAX_HEIGHT, 640 * scale)
    step = at * 24 * scale
    return x + max(wide - size[0] - 14 * scale - step, 0.0), y + 14 * scale + step, *size


def _draw(editing: Editing, notices: Notices, problems: Problems, look: Theme, area: Area) -> bool:
    """Draw one file; return False once it is closed."""
    view = _view_of(editing)
    imgui.set_next_window_size(ImVec2(*area[2:]), imgui.Cond_.appearing)
    imgui.set_next_window_pos(ImVec2(*area[:2]), imgui.Cond_.appearing)
    if editing.focus:
        imgui.set_next_window_focus()
    flags = QUIET | imgui.WindowFlags_.no_collapse
    if view.changed:
        flags |= imgui.WindowFlags_.unsaved_document
    colours = {
        imgui.Col_.window_bg: theme.colour(theme.palette.ground, 0.98),
        imgui.Col_.title_bg_active: theme.colour(theme.palette.raised),
    }
    with styled(colours):
        star = " *" if view.changed else ""
        _, stays = imgui.begin(f"{editing.text.title}{star}###{editing.text.title}", True, flags)
        focused = imgui.is_window_focused(imgui.FocusedFlags_.root_and_child_windows)
        view.focused_for = view.focused_for + 1 if focused and not editing.focus else 0
        if focused:
            _take_keys(editing, notices)
        _mark(editing, view, problems)
        _bar(editing, view, notices, look)
        if editing.focus:
            editing.focus = False
            view.editor.set_cursor(text_edit.TextEditor.DocPos(editing.line - 1, editing.column - 1))
            view.editor.scroll_to_line(editing.line - 1, text_edit.TextEditor.Scroll.align_middle)
            view.editor.set_focus()
        if focused and not imgui.is_any_item_active():  # Enter in the search field finds
            _indent(view)
        with look.font(look.code):
            view.editor.render("##text", ImVec2(0, 0))
        if stays is False and view.changed and editing.text.needs_saving:
            view.closing, stays = True, True
        stays = _ask(editing, view, notices) and stays is not False
        imgui.end()
    return stays


def _take_keys(editing: Editing, notices: Notices) -> None:
    if ctrl_held() and imgui.is_key_pressed(imgui.Key.s, False):
        save(editing, notices)
    imgui.get_io().want_text_input = True  # keys are this editor's, not the picture's


def _indent(view: _View) -> None:
    """Take Enter and closing brackets from the library, which indents by one letter, and no bracket.

    With several cursors they stay the library's.
    """
    editor, io = view.editor, imgui.get_io()
    if editor.get_number_of_cursors() != 1:
        return
    selection = editor.get_main_cursor_selection()
    first = text_edit.TextEditor.DocPos(selection.start.line, 0)
    typed = [chr(code) for code in io.input_queue_characters]
    if any(imgui.is_key_pressed(key) for key in _ENTER) and not (io.key_ctrl or io.key_shift or io.key_alt):
        for key in _ENTER:
            imgui.internal.set_key_owner(key, _OWNER, imgui.internal.InputFlagsPrivate_.lock_this_frame)
        io.input_queue_characters.clear()
        end = selection.end
        rest = editor.get_line_text(end.line)
        rest = editor.get_section_text(end, text_edit.TextEditor.DocPos(end.line, len(rest)))
        blanks = len(rest) - len(rest.lstrip())
        editor.select_region(selection.start, text_edit.TextEditor.DocPos(end.line, end.index + blanks))
        left, right = new_line(editor.get_section_text(first, selection.start), rest, view.step)
        _insert(view, left, right)
    elif len(typed) == 1 and selection.start == selection.end:
        start = text_edit.TextEditor.DocPos(0, 0)
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
        view.editor.set_cursor(text_edit.TextEditor.DocPos(line, len(left) - 1))


def _bar(editing: Editing, view: _View, notices: Notices, look: Theme) -> None:
    note = "Ctrl+S; a save is checked at once, as from any editor"
    buttons(
        ("Save", note, lambda: save(editing, notices), view.changed),
        ("Undo", "", view.editor.undo, view.editor.can_undo()),
        ("Redo", "", view.editor.redo, view.editor.can_redo()),
        small=True,
    )
    imgui.same_line()
    cursor = view.editor.get_main_cursor_position()
    with look.font(look.text, theme.SMALL):
        imgui.text_disabled(f"line {cursor.line + 1}, column {cursor.index + 1}   Ctrl+F finds")


def _mark(editing: Editing, view: _View, problems: Problems) -> None:
    """Mark the lines that have diagnostics."""
    mine = tuple(
        d
        for d in problems.all
        if d.file and d.line and d.file == without_part(d.file) and path_named(d.file) == editing.text.path
    )
    if mine == view.marked:
        return
    view.marked = mine
    view.editor.clear_markers()
    for diagnostic in reversed(mine):
        rgb = theme.palette.alarm if diagnostic.severity == "error" else theme.palette.warm
        note = textwrap.fill(diagnostic.message, 60)
        view.editor.add_marker(
            diagnostic.line - 1, theme.packed(rgb, 0.8), theme.packed(rgb, 0.22), note, note
        )


# ── questions ────────────────────────────────────────────────────────────────


def _question(title: str, text: str, answers: Sequence[tuple[str, str]]) -> str:
    """Ask in a box over the window; return the answer that is clicked on, which closes it, else nothing."""
    if not imgui.is_popup_open(title):
        imgui.open_popup(title)
    chosen = ""
    if imgui.begin_popup_modal(title, None, _BOX)[0]:
        imgui.text_unformatted(text)
        for number, (answer, note) in enumerate(answers):
            if number:
                imgui.same_line()
            if button(answer, note):
                chosen = answer
        if chosen:
            imgui.close_current_popup()
        imgui.end_popup()
    return chosen


def _ask_to_leave(files: OpenFiles, quit_window: Callable[[], None]) -> None:
    """Ask whether to save unsaved files before the window closes."""
    answers = [("Save and quit", ""), ("Quit", ""), ("Stay", "")]
    answer = _question(_LEAVING, f"Not saved: {', '.join(unsaved(files.editing))}", answers)
    if not answer:
        return
    files.leaving = False
    if answer == "Quit":
        files.editing.clear()
    open_ones = [e for e in files.editing if e.text.needs_saving and _view_of(e).changed]
    if answer == "Quit" or (answer != "Stay" and all([save(e, files.notices) for e in open_ones])):
        quit_window()


def _ask(editing: Editing, view: _View, notices: Notices) -> bool:
    """Ask about a clash, or about closing with unsaved changes; return False to close the file."""
    if view.clash:
        answer = _question(_CLASH, view.clash, _CLASH_ANSWERS)
        try:
            if answer == "Take theirs":
                _reload(editing, view)
            elif answer == "Save mine":
                _save_over(editing, view, notices)
            elif answer:
                view.clash = ""
        except PlaygroundError as error:
            notices.say(str(error))
    if view.closing:
        answers = [("Save and close", ""), ("Close", ""), ("Stay", "")]
        answer = _question(_CLOSING, f"{editing.text.path.name} has changes that are not saved.", answers)
        view.closing = not answer
        return not (answer == "Close" or (answer == "Save and close" and save(editing, notices)))
    return True


def _save_over(editing: Editing, view: _View, notices: Notices) -> None:
    """Save over what others saved; that becomes the step of the text's history before the last."""
    mine, view.clash = view.written(), ""
    with suppress(PlaygroundError):  # the file may be gone
        _replace(view, OpenText.read(editing.text.path).base)
        _replace(view, mine)
    save(editing, notices, over=True)


def _reload(editing: Editing, view: _View) -> None:
    text = editing.text.reload()
    view.clash = ""
    _replace(view, text)
    view.saved_at = view.editor.get_undo_index()


def _replace(view: _View, text: str) -> None:
    """Replace the text as one step that can be undone."""
    view.editor.select_all()
    _insert(view, text)

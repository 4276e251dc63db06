"""The code pane: tabs with the texts of the sketch, which are drawn as they are typed.

A quarter of a second after the last key what is typed goes to the sandbox, without being saved; the last
good picture stays until it has proved good.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from imgui_bundle import ImVec2, imgui
from imgui_bundle import imgui_color_text_edit as text_edit

from playground.paths import shown, without_part
from playground.studio import focus, theme
from playground.studio.code.find_panel import draw_find, find_next, open_find
from playground.studio.code.names_panel import (
    KEY_OWNER,
    begin_renaming,
    choose_completion,
    complete,
    cut_short,
    draw_completion,
    draw_menu,
    draw_renaming,
    explain_name,
    open_declaration,
)
from playground.studio.code.open_files import Editing, OpenFiles, library_files
from playground.studio.code.text_panel import Pos, TextView, closing_indent, insert_text, new_line, view_of
from playground.studio.draw import Area, button, buttons, ctrl_held, inked, styled
from playground.studio.language import tr
from playground.studio.problems.problems import Problems
from playground.studio.reload.dependencies import path_named
from playground.studio.theme import Theme
from playground.studio.trace.values_panel import draw_values, follow_caret

if TYPE_CHECKING:
    from playground.studio.trace.tracing import Tracing

PATIENCE = 0.25
"""[s] after the last key until what is typed is drawn."""

_ENTER = (imgui.Key.enter, imgui.Key.keypad_enter)
_BOX = imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_saved_settings
_TEXT = "##text"  # the editor's own window


def typing(files: OpenFiles) -> list[str]:
    """Return the name of the open file that has the keys, once it does; none where no file does."""
    return [
        e.text.path.name for e in files.editing if isinstance(e.view, TextView) and e.view.focused_for > 1
    ]


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
        if editing is not seen and isinstance(editing.view, TextView):
            editing.view.focused_for = 0
    if seen is not None:
        files.current = seen
        _draw_text(seen, files, problems, look, tracing if tracing is not None and tracing.on else None)
    waiting = [e for e in files.editing if isinstance(e.view, TextView) and e.view.waits]
    for editing in waiting:
        view = view_of(editing, files)
        if files.notices.now() - view.typed_at >= PATIENCE:
            view.waits = False
            files.draw_typed(editing)
    left = [
        PATIENCE - files.notices.now() + view.typed_at for e in waiting if (view := view_of(e, files)).waits
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
        view_of(files.current, files).editor.set_focus()  # a right click alone does not
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
        if isinstance(editing.view, TextView) and editing.view.closing:
            _ask_to_close(editing, editing.view, files)


def ask_to_close(editing: Editing, files: OpenFiles) -> None:
    """Close an open file; one with changes that are not saved needs an answer first."""
    view = view_of(editing, files)
    if view.changed and editing.text.needs_saving:
        view.closing = True
    else:
        files.close(editing)


def stay(files: OpenFiles) -> None:
    """Dismiss every question; nothing is saved or closed."""
    for editing in files.editing:
        if isinstance(editing.view, TextView):
            editing.view.closing = False


def close_smaller(files: OpenFiles) -> bool:
    """Close the list of what may stand at the cursor, or what finds; return whether one was open."""
    views = [e.view for e in files.editing if isinstance(e.view, TextView) and e.view.completion.found]
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
        if isinstance(editing.view, TextView):
            editing.view.focused_for = 0


def _draw_tab(editing: Editing, files: OpenFiles) -> bool:
    """Draw the tab of one file; return whether it is the one that is seen."""
    view, flags = view_of(editing, files), 0
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
    view = view_of(editing, files)
    if view.is_light is not theme.palette.is_light:
        view.is_light = theme.palette.is_light
        of = text_edit.TextEditor
        view.editor.set_palette(of.get_light_palette() if view.is_light else of.get_dark_palette())
    focused = imgui.is_window_focused(imgui.FocusedFlags_.root_and_child_windows) and not focus.is_shown()
    view.focused_for = view.focused_for + 1 if focused and not editing.focus else 0
    _mark(editing, view, problems)
    _draw_bar(editing, view, files, look)
    if files.pane.find.is_open:
        draw_find(editing, view, files.pane.find, look)
    if focused and view.renaming is None:
        _take_keys(editing, view, files)
        choose_completion(view)
    if editing.focus:
        editing.focus = False
        if editing.takes_keys:
            imgui.set_window_focus()
            focus.hide()
        view.editor.set_cursor(Pos(editing.line - 1, editing.column - 1))
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
    menu = partial(draw_menu, editing, view, files, look)
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
            explain_name(editing, view, files, look)
        _draw_behind(view, look)
        view.sliders = _draw_values(editing, view, look, tracing) if tracing is not None else []
    if tracing is not None and not any(other.focus for other in files.editing):
        follow_caret(tracing, str(editing.text.path), view.editor)
    if below:
        _draw_mistake(view, look)
    if view.follow():
        view.waits = True
        complete(editing, view, files)
    draw_completion(view, look)
    draw_renaming(editing, view, files, look)


def _take_keys(editing: Editing, view: TextView, files: OpenFiles) -> None:
    if ctrl_held():
        if imgui.is_key_pressed(imgui.Key.s, False):
            files.save(editing)
        if imgui.is_key_pressed(imgui.Key.f, False):
            open_find(view, files)
        in_field = imgui.is_any_item_active()
        for key, by in ((imgui.Key.z, -1), (imgui.Key.y, 1)):
            if imgui.is_key_pressed(key) and not in_field:
                imgui.internal.set_key_owner(
                    key, KEY_OWNER, imgui.internal.InputFlagsPrivate_.lock_this_frame
                )
                files.step(1 if imgui.get_io().key_shift else by)
    if imgui.is_key_pressed(imgui.Key.f3) and files.pane.find.text:
        find_next(view, files.pane.find)
    if imgui.is_key_pressed(imgui.Key.f12, False):
        open_declaration(editing, view, files)
    if imgui.is_key_pressed(imgui.Key.f2, False):
        begin_renaming(editing, view, files)
    imgui.get_io().want_text_input = True  # keys are this editor's, not the picture's


def _indent(view: TextView) -> None:
    """Take Enter and closing brackets from the library, which indents by one letter, and no bracket.

    With several cursors they stay the library's.
    """
    editor, io = view.editor, imgui.get_io()
    if editor.get_number_of_cursors() != 1:
        return
    selection = editor.get_main_cursor_selection()
    first = Pos(selection.start.line, 0)
    typed = [chr(code) for code in io.input_queue_characters]
    if any(imgui.is_key_pressed(key) for key in _ENTER) and not (io.key_ctrl or io.key_shift or io.key_alt):
        for key in _ENTER:
            imgui.internal.set_key_owner(key, KEY_OWNER, imgui.internal.InputFlagsPrivate_.lock_this_frame)
        io.input_queue_characters.clear()
        end = selection.end
        rest = editor.get_line_text(end.line)
        rest = editor.get_section_text(end, Pos(end.line, len(rest)))
        blanks = len(rest) - len(rest.lstrip())
        editor.select_region(selection.start, Pos(end.line, end.index + blanks))
        left, right = new_line(editor.get_section_text(first, selection.start), rest, view.step)
        insert_text(view, left, right)
    elif len(typed) == 1 and selection.start == selection.end:
        start = Pos(0, 0)
        indent = closing_indent(editor.get_section_text(start, selection.start), typed[0])
        if indent is not None:
            io.input_queue_characters.clear()
            editor.select_region(first, selection.start)
            insert_text(view, indent + typed[0])


def _draw_bar(editing: Editing, view: TextView, files: OpenFiles, look: Theme) -> None:
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
        (f"{tr('Find')}###find code", "Ctrl+F", partial(open_find, view, files), True),
        small=True,
    )
    imgui.same_line()
    cursor = view.editor.get_main_cursor_position()
    with look.font(look.text, theme.SMALL):
        imgui.text_disabled(tr("line {line}, column {column}", line=cursor.line + 1, column=cursor.index + 1))


def _mark(editing: Editing, view: TextView, problems: Problems) -> None:
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


def _draw_behind(view: TextView, look: Theme) -> None:
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
        end = Pos(line, len(editor.get_line_text(line)))
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


def _draw_values(editing: Editing, view: TextView, look: Theme, tracing: Tracing) -> list[Area]:
    """Draw what a traced texel gave behind the lines that gave it; return where that takes the mouse."""
    imgui.begin_child(_TEXT)  # as in ``_draw_behind``
    wrong = {diagnostic.line for diagnostic in view.marked[1]}
    path = str(editing.text.path)
    places = draw_values(tracing, path, view.editor, wrong, view.waits, look)
    imgui.end_child()
    return places


def _draw_mistake(view: TextView, look: Theme) -> None:
    """Write the mistake of the cursor's line below the text, or the first; a click leads there."""
    mine = view.marked[1]
    line = view.editor.get_main_cursor_position().line + 1
    diagnostic = next((d for d in mine if d.line == line), mine[0])
    is_error = diagnostic.severity == "error"
    words = f"{diagnostic.line}: {' '.join(diagnostic.message.split())}"
    with inked(theme.palette.alarm if is_error else theme.palette.warm), look.font(look.text, theme.SMALL):
        room = imgui.get_content_region_avail().x
        most = max(int(room / max(imgui.calc_text_size("n").x, 1.0)), 8)
        if imgui.selectable(f"{cut_short(words, most)}###mistake", False)[0]:
            at = Pos(diagnostic.line - 1, max(diagnostic.column - 1, 0))
            view.editor.set_cursor(at)
            view.editor.scroll_to_line(at.line, text_edit.TextEditor.Scroll.align_middle)
            view.editor.set_focus()
    if imgui.is_item_hovered(imgui.HoveredFlags_.for_tooltip):
        imgui.set_tooltip(textwrap.fill(diagnostic.message, 70))


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


def _ask_to_close(editing: Editing, view: TextView, files: OpenFiles) -> None:
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

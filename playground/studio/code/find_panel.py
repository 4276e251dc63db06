"""Find and replace in an open text: a bar above it."""

from __future__ import annotations

import re

from imgui_bundle import ImVec2, imgui

from playground.studio import theme
from playground.studio.code.open_files import Editing, Find, OpenFiles
from playground.studio.code.text_panel import TextView
from playground.studio.draw import button, left_a_field, styled
from playground.studio.language import tr
from playground.studio.theme import Theme


def open_find(view: TextView, files: OpenFiles) -> None:
    """Open what finds, with the selected text in its field where that is of one line."""
    find, editor = files.pane.find, view.editor
    find.is_open = True
    find.focus("##find")
    selection = editor.get_main_cursor_selection()
    if selection.start != selection.end and selection.start.line == selection.end.line:
        find.text = editor.get_section_text(selection.start, selection.end)


def find_next(view: TextView, find: Find) -> None:
    """Select the next place of what is looked for."""
    view.editor.select_next_occurrence_of(find.text, find.case, find.words)


def draw_find(editing: Editing, view: TextView, find: Find, look: Theme) -> None:
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
            find_next(view, find)
        imgui.same_line()
        _, find.case = imgui.checkbox("Aa", find.case)
        imgui.set_item_tooltip(tr("Match case"))
        imgui.same_line()
        _, find.words = imgui.checkbox("[ ]", find.words)
        imgui.set_item_tooltip(tr("Whole words only"))
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


def _replace(view: TextView, find: Find, *, all_of_them: bool = False) -> None:
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
        find_next(view, find)

"""Names in an open text: what may stand where one types, what a name is, and a new one for it."""

from __future__ import annotations

import re
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING

from imgui_bundle import ImVec2, imgui
from imgui_bundle import imgui_color_text_edit as text_edit

from playground.errors import PlaygroundError
from playground.paths import shown
from playground.studio import theme
from playground.studio.code.open_files import Editing, OpenFiles
from playground.studio.code.text_panel import Pos, Renaming, TextView, place_of, view_of
from playground.studio.draw import QUIET, inked, styled, window
from playground.studio.language import tr
from playground.studio.theme import Theme

if TYPE_CHECKING:
    from playground.sketch.suggestions import Suggestion

KEY_OWNER = 1
"""Of keys, while they are taken from the editor's library: any number but 0."""

# ── completion ───────────────────────────────────────────────────────────────


_MOST = 9  # rows of what may stand there
_PREFIX = re.compile(r"[A-Za-z_]\w*$")
_OPENS = (re.compile(r"\.$|#.*[\"</]$"), re.compile(r"[\"'./=\[{]$"))
"""What opens the list before a name is begun, in a kernel and in TOML."""
_CHOOSE = (imgui.Key.up_arrow, imgui.Key.down_arrow, imgui.Key.enter, imgui.Key.keypad_enter, imgui.Key.tab)


def complete(editing: Editing, view: TextView, files: OpenFiles) -> None:
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


def choose_completion(view: TextView) -> None:
    """Take the keys of an open list before the editor sees them."""
    shown = view.completion
    if not shown.found:
        return
    if imgui.is_key_pressed(imgui.Key.left_arrow) or imgui.is_key_pressed(imgui.Key.right_arrow):
        shown.close()
        return
    pressed = [key for key in _CHOOSE if imgui.is_key_pressed(key)]
    for key in _CHOOSE:
        imgui.internal.set_key_owner(key, KEY_OWNER, imgui.internal.InputFlagsPrivate_.lock_this_frame)
    for key in pressed:
        if key in _CHOOSE[:2]:
            shown.at = (shown.at + (1 if key == imgui.Key.down_arrow else -1)) % len(shown.found)
        else:
            _accept(view, shown.found[shown.at])
            return


def _accept(view: TextView, suggestion: Suggestion) -> None:
    """Put what is chosen in the place of what is typed, and above it the include that it needs."""
    editor, shown = view.editor, view.completion
    at = editor.get_main_cursor_position()
    start = Pos(at.line, at.index - len(shown.prefix))
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
        editor.replace_section_text(Pos(row, 0), Pos(row, 0), include)
        lines = int(row <= at.line)
    editor.set_cursor(Pos(at.line + lines, start.index + len(label)))
    view.note_step(before)
    view.waits, view.typed_at = True, view.steps.clock()
    shown.close()


def draw_completion(view: TextView, look: Theme) -> None:
    """Draw the list of what may stand at the cursor, and a line on the one that is chosen."""
    shown, editor = view.completion, view.editor
    if not shown.found or not view.focused_for:
        return
    at = editor.get_main_cursor_position()
    place = editor.doc_pos2_screen_pos(Pos(at.line, max(at.index - len(shown.prefix), 0)))
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
            imgui.selectable(cut_short(suggestion.label, 22), number == shown.at, 0, ImVec2(160 * scale, 0))
            imgui.same_line(180 * scale)
            imgui.text_disabled(cut_short(suggestion.detail, 28))
        chosen = shown.found[shown.at]
        about = _about(chosen)
        if chosen.include:
            about = tr("adds #include {file}", file=chosen.include) + (f"; {about}" if about else "")
        if about or chosen.detail:
            imgui.separator()
            with look.font(look.text, theme.SMALL):
                imgui.text_disabled(cut_short(about, 64) or chosen.detail)


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


def explain_name(editing: Editing, view: TextView, files: OpenFiles, look: Theme) -> None:
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


def cut_short(text: str, most: int) -> str:
    """Return a text of at most so many letters, its end cut."""
    return text if len(text) <= most else f"{text[: most - 1]}…"


# ── names ────────────────────────────────────────────────────────────────────


def draw_menu(
    editing: Editing, view: TextView, files: OpenFiles, look: Theme, at: text_edit.TextEditor.DocPos
) -> None:
    """Draw what a right click offers at a place of the text."""
    spacing = {imgui.StyleVar_.item_spacing: ImVec2(16 * look.scale, 6 * look.scale)}
    with styled(sizes=spacing), look.font(look.text):
        _draw_items(editing, view, files, at)


def _draw_items(editing: Editing, view: TextView, files: OpenFiles, at: text_edit.TextEditor.DocPos) -> None:
    editor, is_free = view.editor, not editing.belongs_to
    if imgui.menu_item_simple(f"{tr('Rename')}###rename", "F2", False, is_free):
        editor.set_cursor(at)
        begin_renaming(editing, view, files)
    if imgui.menu_item_simple(f"{tr('Go to the declaration')}    ###declaration", "F12"):
        editor.set_cursor(at)
        open_declaration(editing, view, files)
    imgui.separator()
    has_selection = editor.any_cursor_has_selection()
    if imgui.menu_item_simple(f"{tr('Cut')}###cut", "Ctrl+X", False, is_free and has_selection):
        editor.cut()
    if imgui.menu_item_simple(f"{tr('Copy')}###copy", "Ctrl+C", False, has_selection):
        editor.copy()
    if imgui.menu_item_simple(f"{tr('Paste')}###paste", "Ctrl+V", False, is_free):
        editor.paste()


def open_declaration(editing: Editing, view: TextView, files: OpenFiles) -> None:
    """Open the file that declares the name at the cursor, there."""
    at = view.offset(view.editor.get_main_cursor_position())
    files.open_declaration(editing.text.path, view.written(), at)


def begin_renaming(editing: Editing, view: TextView, files: OpenFiles) -> None:
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
    view.renaming = Renaming(start, text[start:end])


def draw_renaming(editing: Editing, view: TextView, files: OpenFiles, look: Theme) -> None:
    """Draw the field for a new name, and below it why the last one was refused."""
    asked, editor = view.renaming, view.editor
    if asked is None:
        return
    if not asked.is_open:
        asked.is_open = True
        imgui.open_popup("rename")
    place = editor.doc_pos2_screen_pos(place_of(view.written(), asked.at))
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


def _rename(editing: Editing, view: TextView, files: OpenFiles, asked: Renaming) -> str:
    """Give a name its new one in every file, as one step; return why not, or nothing."""
    path, sketch = editing.text.path, files.sketch
    folder = Path(sketch.folder) if sketch is not None else path.parent
    try:
        edits = files.names.rename(path, view.written(), asked.at, asked.new.strip(), folder)
        changes = {view_of(files.tab_of(file), files): some for file, some in edits.items()}
    except PlaygroundError as error:
        return error.diagnostics[0].message
    step = {each: each.apply(some) for each, some in changes.items()}
    for each in step:
        each.shared.append(step)
    return ""

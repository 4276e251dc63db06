"""A small text editor in the window: for a quick repair, or where there is no other."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass

from imgui_bundle import ImVec2, imgui
from imgui_bundle import imgui_color_text_edit as text_edit

from playground.errors import Diagnostic, PlaygroundError
from playground.live import theme
from playground.live.overlay import Area
from playground.live.theme import Theme
from playground.workbench.actions import Actions
from playground.workbench.dependencies import path_named
from playground.workbench.text_file import Editing, unsaved

_TALLEST = 0.46  # share of the picture's height, so that the list below stays in sight
_CLASH = "Saved by others meanwhile"
_CLOSING = "Close without saving?"
_LEAVING = "Quit without saving?"
_BOX = imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_saved_settings


@dataclass
class _View:
    """What belongs to one open file besides its text."""

    editor: text_edit.TextEditor
    saved_at: int = 0  # the editor's count of steps when its text was that of the file
    marked: tuple[Diagnostic, ...] = ()
    clash: str = ""  # why it could not be saved; the question is asked
    closing: bool = False  # whether to save is asked
    held: int = 0  # turns for which the keys have been its own

    @property
    def changed(self) -> bool:
        return self.editor.get_undo_index() != self.saved_at

    def written(self) -> str:
        return self.editor.get_text()


def draw_code(actions: Actions, look: Theme, area: Area) -> None:
    """Draw every file that is open in the window, and the questions about those that are not saved."""
    imgui.push_style_color(imgui.Col_.modal_window_dim_bg, theme.colour((0.0, 0.0, 0.0), 0.45))
    for at, editing in enumerate(list(actions.editing)):
        view = _view_of(editing)
        if not _draw(editing, view, actions, look, area, at):
            actions.editing.remove(editing)
    _ask_to_leave(actions)
    imgui.pop_style_color()


def _ask_to_leave(actions: Actions) -> None:
    """Ask what is to become of all that is not saved, when the whole window is to close."""
    if not actions.leaving:
        return
    if not imgui.is_popup_open(_LEAVING):
        imgui.open_popup(_LEAVING)
    if imgui.begin_popup_modal(_LEAVING, None, _BOX)[0]:
        imgui.text_unformatted(f"Not saved: {', '.join(unsaved(actions.editing))}")
        if imgui.button("Save and quit"):
            actions.leaving = False
            if all([save(e, actions) for e in actions.editing if e.text.kept and _view_of(e).changed]):
                actions.quit()
        imgui.same_line()
        if imgui.button("Quit"):
            actions.leaving = False
            actions.editing.clear()
            actions.quit()
        imgui.same_line()
        if imgui.button("Stay"):
            actions.leaving = False
        if not actions.leaving:
            imgui.close_current_popup()
        imgui.end_popup()


def ask_to_close(editing: Editing, actions: Actions) -> None:
    """Close an open file; one with changes that are not saved is asked about first."""
    view = _view_of(editing)
    if view.changed and editing.text.kept:
        view.closing = True
    else:
        actions.editing.remove(editing)


def stay(actions: Actions) -> None:
    """Answer every question about what is not saved by leaving all as it is."""
    actions.leaving = False
    for editing in actions.editing:
        view = _view_of(editing)
        view.clash, view.closing = "", False


def typing(actions: Actions) -> list[str]:
    """Return the name of the open file that takes what is typed, once it does; none where no file does."""
    return [e.text.path.name for e in actions.editing if _view_of(e).held > 1]


def _view_of(editing: Editing) -> _View:
    if not isinstance(editing.view, _View):
        editor = text_edit.TextEditor()
        toml = editing.text.path.suffix == ".toml"
        if not toml:
            editor.set_language(text_edit.TextEditor.Language.glsl())
        editor.set_tab_size(4)
        editor.set_insert_spaces_on_tabs(True)
        editor.set_show_whitespaces_enabled(False)
        editor.set_complete_paired_glyphs(False)  # it would put a second one beside each that is typed
        editor.set_text(editing.text.base)
        editing.view = _View(editor, editor.get_undo_index())
    return editing.view


def _draw(editing: Editing, view: _View, actions: Actions, look: Theme, area: Area, at: int) -> bool:
    """Draw one file; return False once it is closed."""
    x, y, wide, high = area
    scale = look.scale
    size = ImVec2(min(wide * 0.7, 720 * scale), min(high * _TALLEST, 640 * scale))
    imgui.set_next_window_size(size, imgui.Cond_.appearing)
    step = at * 24 * scale
    imgui.set_next_window_pos(
        ImVec2(x + max(wide - size.x - 14 * scale - step, 0.0), y + 14 * scale + step), imgui.Cond_.appearing
    )
    if editing.asked:
        imgui.set_next_window_focus()
    flags = imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_collapse
    flags |= imgui.WindowFlags_.no_nav_inputs
    if view.changed:
        flags |= imgui.WindowFlags_.unsaved_document
    imgui.push_style_color(imgui.Col_.window_bg, theme.colour(theme.GROUND, 0.98))
    imgui.push_style_color(imgui.Col_.title_bg_active, theme.colour(theme.RAISED))
    star = " *" if view.changed else ""
    _, stays = imgui.begin(f"{editing.text.title}{star}###{editing.text.title}", True, flags)
    focused = imgui.is_window_focused(imgui.FocusedFlags_.root_and_child_windows) and not editing.asked
    view.held = view.held + 1 if focused else 0
    if imgui.is_window_focused(imgui.FocusedFlags_.root_and_child_windows):
        io = imgui.get_io()
        # In a slow turn Ctrl may come up again together with the key that it was held for.
        ctrl = io.key_ctrl or io.key_super or imgui.is_key_released(imgui.Key.mod_ctrl)
        if ctrl and imgui.is_key_pressed(imgui.Key.s, False):
            save(editing, actions)
        io.want_text_input = True  # keys are this editor's, not the picture's
    _mark(editing, view, actions)
    _bar(editing, view, actions, look)
    if editing.asked:
        editing.asked = False
        place = text_edit.TextEditor.DocPos(editing.line - 1, editing.column - 1)
        view.editor.set_cursor(place)
        view.editor.scroll_to_line(editing.line - 1, text_edit.TextEditor.Scroll.align_middle)
        view.editor.set_focus()
    with look.font(look.code):
        view.editor.render("##text", ImVec2(0, 0))
    if stays is False and view.changed and editing.text.kept:
        view.closing, stays = True, True
    stays = _ask(editing, view, actions) and stays is not False
    imgui.end()
    imgui.pop_style_color(2)
    return stays


def save(editing: Editing, actions: Actions, *, over: bool = False) -> bool:
    """Save an open file; say whether that was done. Where others saved it meanwhile, it is asked for."""
    view = _view_of(editing)
    text = view.editor.get_text()
    try:
        if not editing.text.save(text, over=over):
            view.clash = "The file is another than when it was opened here."
            return False
    except PlaygroundError as error:
        actions.say(str(error))
        return False
    view.saved_at = view.editor.get_undo_index()
    actions.say(editing.text.saved())
    return True


def _bar(editing: Editing, view: _View, actions: Actions, look: Theme) -> None:
    imgui.begin_disabled(not view.changed)
    if imgui.small_button("Save"):
        save(editing, actions)
    imgui.end_disabled()
    imgui.set_item_tooltip("Ctrl+S; what is saved is tried at once, as from any editor")
    imgui.same_line()
    imgui.begin_disabled(not view.editor.can_undo())
    if imgui.small_button("Undo"):
        view.editor.undo()
    imgui.end_disabled()
    imgui.same_line()
    imgui.begin_disabled(not view.editor.can_redo())
    if imgui.small_button("Redo"):
        view.editor.redo()
    imgui.end_disabled()
    imgui.same_line()
    place = view.editor.get_main_cursor_position()
    with look.font(look.text, theme.SMALL):
        imgui.text_disabled(f"line {place.line + 1}, column {place.index + 1}   Ctrl+F finds")


def _mark(editing: Editing, view: _View, actions: Actions) -> None:
    """Mark the lines that are wrong."""
    mine = tuple(
        d for d in actions.problems.all if d.file and d.line and path_named(d.file) == editing.text.path
    )
    if mine == view.marked:
        return
    view.marked = mine
    view.editor.clear_markers()
    for diagnostic in reversed(mine):
        rgb = theme.ALARM if diagnostic.severity == "error" else theme.WARM
        colour, behind = theme.packed(rgb, 0.8), theme.packed(rgb, 0.22)
        note = textwrap.fill(diagnostic.message, 60)
        view.editor.add_marker(diagnostic.line - 1, colour, behind, note, note)


def _ask(editing: Editing, view: _View, actions: Actions) -> bool:
    """Ask what is to become of changes that cannot just be saved; return False to close the file."""
    stays = True
    for title, wanted in ((_CLASH, bool(view.clash)), (_CLOSING, view.closing)):
        if wanted and not imgui.is_popup_open(title):
            imgui.open_popup(title)
    if imgui.begin_popup_modal(_CLASH, None, _BOX)[0]:
        imgui.text_unformatted(view.clash)
        if imgui.button("Merge both"):
            _merge(editing, view, actions)
        imgui.set_item_tooltip("Takes in the lines that others changed, where yours are others")
        imgui.same_line()
        if imgui.button("Take theirs"):
            _reload(editing, view, actions)
        imgui.set_item_tooltip("Reads the file again; what was typed here can be brought back by Undo")
        imgui.same_line()
        if imgui.button("Save mine"):
            view.clash = ""
            save(editing, actions, over=True)
        imgui.set_item_tooltip("Overwrites what others saved")
        imgui.same_line()
        if imgui.button("Go on typing"):
            view.clash = ""
        if not view.clash:
            imgui.close_current_popup()
        imgui.end_popup()
    if imgui.begin_popup_modal(_CLOSING, None, _BOX)[0]:
        imgui.text_unformatted(f"{editing.text.path.name} has changes that are not saved.")
        if imgui.button("Save and close"):
            view.closing, stays = False, not save(editing, actions)
        imgui.same_line()
        if imgui.button("Close"):
            view.closing = stays = False
        imgui.same_line()
        if imgui.button("Stay"):
            view.closing = False
        if not view.closing:
            imgui.close_current_popup()
        imgui.end_popup()
    return stays


def _merge(editing: Editing, view: _View, actions: Actions) -> None:
    try:
        found = editing.text.merged(view.editor.get_text())
    except PlaygroundError as error:
        actions.say(str(error))
        return
    if found is None:
        view.clash = "Both changed the same lines, or lines side by side: choose one of the two."
        return
    view.clash = ""
    _replace(view.editor, found)
    save(editing, actions)


def _reload(editing: Editing, view: _View, actions: Actions) -> None:
    try:
        text = editing.text.reload()
    except PlaygroundError as error:
        actions.say(str(error))
        return
    view.clash = ""
    _replace(view.editor, text)
    view.saved_at = view.editor.get_undo_index()


def _replace(editor: text_edit.TextEditor, text: str) -> None:
    """Put another text in, so that it can be undone."""
    editor.select_all()
    editor.replace_text_in_current_cursor(text)

"""One parameter in the panel: its label, its widget, its lock and reset, its menu, a field to type in."""

from __future__ import annotations

from pathlib import Path

from imgui_bundle import ImVec2, imgui

from playground.errors import ParameterError
from playground.live import theme
from playground.live.panel_memory import Memory
from playground.live.panel_rows import cross, row, slot
from playground.live.text_field import await_field, letters, with_typed_ahead
from playground.live.theme import Theme
from playground.live.widgets import Place, draw_value, explanation
from playground.sketch.values import write
from playground.workbench.actions import Actions
from playground.workbench.parameter_list import Item, Values
from playground.workbench.typed_values import read_typed

TYPED = frozenset({"number", "slider", "log_slider", "angle", "divider"})
"""Widgets that turn into a field at a double click, or a click with Ctrl."""

_MENU = "parameter"
_PRESSED = imgui.HoveredFlags_.allow_when_blocked_by_active_item.value  # as while the lock is pressed


def draw_parameter(
    item: Item, values: Values, folder: Path, memory: Memory, actions: Actions, look: Theme
) -> None:
    """Draw a parameter, and hand on what a hand made of it; ``folder`` is the sketch's own."""
    session, path, parameter = actions.session, item.path, item.parameter
    value, changed = values.of[path], path in values.changed
    end = imgui.get_cursor_pos_x() + imgui.get_content_region_avail().x
    top = imgui.get_cursor_screen_pos()
    with row(item.title, lambda: explanation(parameter, path), edited=changed):
        if memory.entry == item.label:
            _entry(item, memory, actions)
        else:
            new = draw_value(parameter, value, Place(item.label, look.scale, folder))
            if parameter.widget.kind in TYPED and imgui.is_item_hovered() and imgui.is_mouse_clicked(0):
                if _typing(item, values, memory, actions):
                    new = None
            if new is not None:
                session.drafts.set(path, new)
    locked = path in values.locked
    mouse = imgui.get_mouse_pos()
    here = top.y <= mouse.y < top.y + imgui.get_frame_height() and imgui.is_window_hovered(_PRESSED)
    if locked or here:
        imgui.same_line(end - 2 * slot() - 2)
        if _lock(path, locked, look):
            session.drafts.lock(path, not locked)
    if changed:
        imgui.same_line(end - slot())
        if cross(f"{item.label}-reset", "Back to the file's value"):
            session.drafts.unset(path)
    if here and imgui.is_mouse_clicked(1):
        memory.menu, memory.menu_opens = item.label, True


def draw_menu(items: dict[str, Item], values: Values, memory: Memory, actions: Actions) -> None:
    """Draw the menu of the parameter that was clicked on with the right button; ``items`` by their labels."""
    if memory.menu_opens:
        memory.menu_opens = False
        imgui.open_popup(_MENU)
    item = items.get(memory.menu)
    if not imgui.begin_popup(_MENU):
        return
    if item is not None:
        session, path = actions.session, item.path
        locked = path in values.locked
        imgui.text_disabled(path)
        if imgui.menu_item_simple("Type a value", "double click"):
            open_entry(item, values, memory, actions)
        if imgui.menu_item_simple("Reset", "", False, path in values.changed):
            session.drafts.unset(path)
        if imgui.menu_item_simple("Unlock" if locked else "Lock"):
            session.drafts.lock(path, not locked)
        if imgui.menu_item_simple("Copy as --set"):
            text = write(item.parameter, values.of[path])
            imgui.set_clipboard_text(f"--set {path}={text}")
            actions.say(f"copied --set {path}={text}")
    imgui.end_popup()


def open_entry(item: Item, values: Values, memory: Memory, actions: Actions) -> None:
    """Begin to type a parameter's value."""
    await_field(actions)
    memory.entry, memory.entry_opens = item.label, True
    memory.entry_text = write(item.parameter, values.of[item.path])


def _typing(item: Item, values: Values, memory: Memory, actions: Actions) -> bool:
    """Take in a click on a widget; say whether it asks for a field to type in.

    The first click of a double click has moved the slider already: that is taken back.
    """
    session, path = actions.session, item.path
    if not imgui.get_io().key_ctrl and not imgui.is_mouse_double_clicked(0):
        by_hand = session.shown is not None and session.shown.edits.has(path)
        memory.held = path, by_hand, values.of[path]
        return False
    held, by_hand, before = memory.held
    open_entry(item, values, memory, actions)
    if not imgui.get_io().key_ctrl and held == path:
        if by_hand:
            session.drafts.set(path, before)
        else:
            session.drafts.unset(path)
        memory.entry_text = write(item.parameter, before)
    return True


def _entry(item: Item, memory: Memory, actions: Actions) -> None:
    """Draw the field; Enter takes the value, Esc leaves it."""
    if memory.entry_opens:
        imgui.set_keyboard_focus_here()
    flags = imgui.InputTextFlags_.enter_returns_true | imgui.InputTextFlags_.auto_select_all
    imgui.set_next_item_width(imgui.calc_item_width())
    typed = letters()
    entered, text = imgui.input_text(f"{item.label}-typed", memory.entry_text, flags)
    memory.entry_text = with_typed_ahead(actions, text, memory.entry_text, typed)
    opened, memory.entry_opens = memory.entry_opens, False
    if opened:
        return
    left = imgui.is_item_deactivated()
    if entered or (left and not imgui.is_key_pressed(imgui.Key.escape)):
        try:
            actions.session.drafts.set(item.path, read_typed(item.parameter, memory.entry_text, item.path))
        except ParameterError as error:
            actions.say(str(error))
    if entered or left:
        memory.entry = ""


def _lock(path: str, locked: bool, look: Theme) -> bool:
    """Draw a padlock, open or closed; return whether it is clicked on."""
    side, high = slot(), imgui.get_frame_height()
    corner = imgui.get_cursor_screen_pos()
    clicked = imgui.invisible_button(f"lock {path}", ImVec2(side, high))
    hovered = imgui.is_item_hovered()
    if hovered:
        what = "Locked: chance, presets, resets and reloads leave it. Click to unlock"
        imgui.set_tooltip(what if locked else "Lock: chance, presets, resets and reloads leave it")
    ink = theme.WARM if locked else theme.INK if hovered else theme.DIM
    unit, draw = look.scale, imgui.get_window_draw_list()
    x, y = corner.x + side / 2, corner.y + high / 2
    body = ImVec2(x - 4 * unit, y - unit), ImVec2(x + 4 * unit, y + 5 * unit)
    draw.add_rect_filled(*body, theme.packed(ink), unit)
    shift = 0.0 if locked else 3 * unit
    draw.path_arc_to(ImVec2(x + shift, y - unit), 2.5 * unit, 3.1416, 6.2832, 10)
    draw.path_stroke(theme.packed(ink), 1.5 * unit)
    return bool(clicked)

"""One parameter in the panel: its label, its widget, its lock and reset, its menu, a field to type in."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from imgui_bundle import ImVec2, imgui

from playground.errors import ParameterError
from playground.shader.parameter import write
from playground.studio import theme
from playground.studio.input.text_field import await_field, letters, with_typed_ahead
from playground.studio.interface import TypedAhead
from playground.studio.notices import Notices
from playground.studio.panel.memory import Memory
from playground.studio.panel.parameter_list import Item, Values
from playground.studio.panel.rows import cross, row, slot, slot_button
from playground.studio.panel.typed_values import read_typed
from playground.studio.panel.widgets import WidgetSlot, draw_value, explanation
from playground.studio.remote.controllers import Controllers
from playground.studio.remote.panel import draw_controllers
from playground.studio.session import Session
from playground.studio.theme import Theme

_TYPED = "numbers"  # the control that becomes a field at a double click, or a click with Ctrl
_MENU = "parameter"
_PRESSED = imgui.HoveredFlags_.allow_when_blocked_by_active_item.value  # as while the lock is pressed


@dataclass(frozen=True)
class Rows:
    """What every row of parameters in one frame uses."""

    session: Session
    notices: Notices
    memory: Memory
    ahead: TypedAhead
    values: Values
    look: Theme
    controllers: Controllers | None = None  # that may be learned

    def draw(self, item: Item, folder: Path) -> None:
        """Draw a parameter, and set what the user makes of it; ``folder`` is the sketch's own."""
        drafts, path, parameter = self.session.drafts, item.path, item.parameter
        value, changed = self.values.of[path], path in self.values.changed
        end = imgui.get_cursor_pos_x() + imgui.get_content_region_avail().x
        top = imgui.get_cursor_screen_pos()
        with row(item.title, lambda: explanation(parameter, path), edited=changed):
            if self.memory.entry == item.label:
                self._entry(item)
            else:
                new = draw_value(parameter, value, WidgetSlot(item.label, self.look.scale, folder))
                clicked = imgui.is_item_hovered() and imgui.is_mouse_clicked(0)
                if parameter.widget.facts.control == _TYPED and clicked and self._is_typing(item):
                    new = None
                if new is not None and parameter.widget.kind == "button":
                    self.session.press(path)
                elif new is not None:
                    drafts.set(path, new)
        locked = path in self.values.locked
        mouse = imgui.get_mouse_pos()
        inside = top.y <= mouse.y < imgui.get_cursor_screen_pos().y and imgui.is_window_hovered(_PRESSED)
        here = inside and mouse.y < top.y + imgui.get_frame_height()
        if locked or here:
            imgui.same_line(end - 2 * slot() - 2)
            if _lock(path, locked, self.look):
                drafts.lock(path, not locked)
        if changed:
            imgui.same_line(end - slot())
            if cross(f"{item.label}-reset", "Back to the file's value"):
                drafts.unset(path)
        if inside and imgui.is_mouse_clicked(1):
            self.memory.menu, self.memory.menu_opens = item.label, True

    def draw_menu(self, items: dict[str, Item]) -> None:
        """Draw the menu of the parameter that was right-clicked; ``items`` by their labels."""
        if self.memory.menu_opens:
            self.memory.menu_opens = False
            imgui.open_popup(_MENU)
        item = items.get(self.memory.menu)
        if not imgui.begin_popup(_MENU):
            return
        if item is not None:
            drafts, path = self.session.drafts, item.path
            locked = path in self.values.locked
            imgui.text_disabled(path)
            if imgui.menu_item_simple("Type a value", "double click"):
                self.open_entry(item)
            if imgui.menu_item_simple("Reset", "", False, path in self.values.changed):
                drafts.unset(path)
            if imgui.menu_item_simple("Unlock" if locked else "Lock"):
                drafts.lock(path, not locked)
            if imgui.menu_item_simple("Copy as --set"):
                text = f"--set {path}={write(item.parameter, self.values.of[path])}"
                imgui.set_clipboard_text(text)
                self.notices.say(f"copied {text}")
            if self.controllers is not None:
                draw_controllers(self.controllers, item)
        imgui.end_popup()

    def open_entry(self, item: Item) -> None:
        """Begin to type a parameter's value."""
        await_field(self.ahead)
        self.memory.entry, self.memory.entry_opens = item.label, True
        self.memory.entry_text = write(item.parameter, self.values.of[item.path])

    def _is_typing(self, item: Item) -> bool:
        """Handle a click on a widget; return whether it opens a field to type in.

        The first click of a double click has moved the slider already: that is undone.
        """
        session, path, ctrl = self.session, item.path, imgui.get_io().key_ctrl
        if not ctrl and not imgui.is_mouse_double_clicked(0):
            edited = session.shown is not None and session.shown.edits.has(path)
            self.memory.clicked = path, edited, self.values.of[path]
            return False
        clicked, edited, before = self.memory.clicked
        self.open_entry(item)
        if not ctrl and clicked == path:
            if edited:
                session.drafts.set(path, before)
            else:
                session.drafts.unset(path)
            self.memory.entry_text = write(item.parameter, before)
        return True

    def _entry(self, item: Item) -> None:
        """Draw the field; Enter takes the value, Esc leaves it."""
        memory = self.memory
        if memory.entry_opens:
            imgui.set_keyboard_focus_here()
        flags = imgui.InputTextFlags_.enter_returns_true | imgui.InputTextFlags_.auto_select_all
        imgui.set_next_item_width(imgui.calc_item_width())
        typed = letters()
        entered, text = imgui.input_text(f"{item.label}-typed", memory.entry_text, flags)
        memory.entry_text = with_typed_ahead(self.ahead, text, memory.entry_text, typed)
        opened, memory.entry_opens = memory.entry_opens, False
        if opened:
            return
        left = imgui.is_item_deactivated()
        if entered or (left and not imgui.is_key_pressed(imgui.Key.escape)):
            try:
                value = read_typed(item.parameter, memory.entry_text, item.path)
                self.session.drafts.set(item.path, value)
            except ParameterError as error:
                self.notices.say(str(error))
        if entered or left:
            memory.entry = ""


def _lock(path: str, locked: bool, look: Theme) -> bool:
    """Draw a padlock, open or closed; return whether it is clicked on."""
    note = "randomising, presets, resets and reloads leave it"
    note = f"Locked: {note}. Click to unlock" if locked else f"Lock: {note}"
    clicked, hovered, middle = slot_button(f"lock {path}", note)
    ink = theme.WARM if locked else theme.INK if hovered else theme.DIM
    unit, draw = look.scale, imgui.get_window_draw_list()
    x, y = middle.x, middle.y
    body = ImVec2(x - 4 * unit, y - unit), ImVec2(x + 4 * unit, y + 5 * unit)
    draw.add_rect_filled(*body, theme.packed(ink), unit)
    shift = 0.0 if locked else 3 * unit
    draw.path_arc_to(ImVec2(x + shift, y - unit), 2.5 * unit, 3.1416, 6.2832, 10)
    draw.path_stroke(theme.packed(ink), 1.5 * unit)
    return clicked

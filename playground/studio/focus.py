"""The keyboard's focus: Tab walks through the controls of a pane and on into the next one.

imgui's own keys for controls (arrows, Space, Enter) are on only while a control shows that it has the focus:
from Tab or Ctrl+Tab to Esc or a click, in menus, and on the start page. Else they are the picture's or the
graph's. Its list of windows, which Ctrl+Tab opens, is replaced by the panes in their order.
"""

from __future__ import annotations

from imgui_bundle import imgui

from playground.studio.interface import KeyFocus

_LAST = ("code pane", "strip")  # after all else, which goes by its place
_NO_FOCUS = imgui.WindowFlags_.no_nav_inputs | imgui.WindowFlags_.no_nav_focus | imgui.WindowFlags_.tooltip
_NO_FOCUS |= imgui.WindowFlags_.child_window | imgui.WindowFlags_.popup
_NAV = imgui.ConfigFlags_.nav_enable_keyboard.value


def is_shown() -> bool:
    """Return whether a control shows that it has the keyboard's focus."""
    context = imgui.get_current_context()
    comes = context.nav_init_request or context.nav_init_result.id_
    return bool(context.nav_cursor_visible and (context.nav_id or comes))


def has(*labels: str) -> bool:
    """Return whether the focus is shown on one of the controls with these labels, of the present window."""
    nav = imgui.get_current_context().nav_id
    return is_shown() and any(imgui.get_id(label) == nav for label in labels)


def hide() -> None:
    """Give the keys back to the picture; Tab goes on from the same control."""
    imgui.set_nav_cursor_visible(False)


def panes() -> list[str]:
    """Return the names of the windows that can have the focus, in the order of Ctrl+Tab."""
    shown = [w for w in imgui.get_current_context().windows if w.was_active and not w.flags & _NO_FOCUS]
    shown = [w for w in shown if not w.hidden and w.dc.nav_layers_active_mask & 1]
    ranks = {name: rank for rank, name in enumerate(_LAST, 1)}
    return [w.name for w in sorted(shown, key=lambda w: (ranks.get(w.name, 0), w.pos.x, w.pos.y))]


def current_pane() -> str:
    """Return the pane that has the focus, "" for none."""
    window = imgui.get_current_context().nav_window
    return window.root_window.name if window is not None else ""


def enter(focus: KeyFocus, name: str, item: int = 0) -> None:
    """Give a pane the focus, at one of its controls or at its first, from the next frame on."""
    imgui.internal.nav_move_request_cancel()
    focus.enters, focus.goal = name, item


def begin(focus: KeyFocus) -> None:
    """Begin a frame: imgui looks for a pane's first control while that is drawn."""
    name, focus.enters = focus.enters, ""
    window = imgui.internal.find_window_by_name(name) if name else None
    if window is None:
        return
    imgui.internal.clear_active_id()
    imgui.set_window_focus(name)
    if focus.goal:
        imgui.internal.set_nav_id(focus.goal, imgui.internal.NavLayer.main, 0, imgui.internal.ImRect())
    else:
        imgui.internal.nav_init_window(window, True)
        focus.inits = name
    imgui.set_nav_cursor_visible(True)


def update(focus: KeyFocus, *, always: bool, barred: bool) -> None:
    """Move the focus as Tab and Ctrl+Tab say.

    ``always``: it is on without having been asked for. ``barred``: the keys are an editor's or the graph's.
    """
    context, io = imgui.get_current_context(), imgui.get_io()
    context.config_nav_windowing_key_next = context.config_nav_windowing_key_prev = 0
    context.config_nav_enable_tabbing = not barred
    io.config_nav_escape_clear_focus_item = io.config_nav_capture_keyboard = False
    if focus.was_always and not always:
        hide()  # the start page has closed: the keys are the picture's
    focus.was_always = always
    in_popup = len(context.open_popup_stack) > 0
    is_on = is_shown() or always or in_popup or io.want_text_input
    io.config_flags = (io.config_flags & ~_NAV) | (_NAV if is_on and not barred else 0)
    tab = imgui.is_key_pressed(imgui.Key.tab)
    by = -1 if io.key_shift else 1
    if in_popup or not (names := panes()):
        focus.tabbed = 0
        return
    now = current_pane()
    if focus.inits and context.nav_id and now == focus.inits:
        focus.firsts[now], focus.inits = context.nav_id, ""
    if tab and io.key_ctrl:
        comes_from_one = now in names and (is_shown() or barred)
        at = names.index(now) if comes_from_one else (-1 if by > 0 else 0)
        enter(focus, names[(at + by) % len(names)])
        tab = False
    elif barred:
        tab = False
        if is_shown():
            hide()
    elif focus.tabbed and focus.pane in names:
        _leave(focus, names)
    elif tab and not is_shown() and not io.want_text_input and not always:
        enter(focus, now if now in names and context.nav_id else names[0], context.nav_id if now else 0)
        tab = False
    focus.tabbed = by * (tab and not io.key_ctrl and (is_shown() or io.want_text_input))
    focus.item, focus.pane = context.nav_id, current_pane()


def _leave(focus: KeyFocus, names: list[str]) -> None:
    """Go on into the next pane, where Tab went beyond the end of one."""
    context = imgui.get_current_context()
    first = context.nav_tabbing_result_first.id_ if focus.tabbed > 0 else focus.firsts.get(focus.pane, 0)
    if focus.tabbed > 0 and first:
        focus.firsts[focus.pane] = first
    passed = context.nav_id == first if focus.tabbed > 0 else focus.item == first
    if not passed or len(names) == 1:
        return
    goal = names[(names.index(focus.pane) + focus.tabbed) % len(names)]
    if focus.tabbed > 0:
        focus.lasts[focus.pane] = focus.item
    enter(focus, goal, focus.lasts.get(goal, 0) if focus.tabbed < 0 else 0)

"""What each key does: one table, which the key map shows as well."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from imgui_bundle import imgui

from playground.live.escape_layers import close_one
from playground.live.text_field import keeps_keys, left_a_field
from playground.workbench.actions import Actions
from playground.workbench.open_source import edit_problem
from playground.workbench.save_commands import save_values


def toggle_capture(actions: Actions) -> None:
    """Show the capture's window, or no longer."""
    actions.capture.shown = not actions.capture.shown


@dataclass(frozen=True)
class Key:
    """A key and its meaning."""

    key: imgui.Key
    name: str
    meaning: str
    brief: str  # in the panel's last line; empty: not there
    act: Callable[[Actions], None]
    ctrl: bool = False
    shift: bool = False
    sign: str = ""  # "+" or "-", with Ctrl: on the keypad, and wherever else the keyboard has it
    letter: str = ""  # what it types, for one that is elsewhere on every keyboard


_SIZE_KEYS = "text and panels larger, smaller, at their first size"

KEYS: tuple[Key, ...] = (
    Key(imgui.Key.space, "Space", "play or pause", "", lambda a: a.session.clock.toggle()),
    Key(imgui.Key.none, ",", "a frame of time back", "", lambda a: a.step_time(-1), letter=","),
    Key(imgui.Key.none, ".", "a frame of time on", "", lambda a: a.step_time(1), letter="."),
    Key(imgui.Key.l, "L", "time goes round, or no longer", "", lambda a: a.toggle_loop()),
    Key(imgui.Key._0, "0", "time to 0", "", lambda a: a.rewind()),
    Key(imgui.Key.r, "R", "reset the view", "view", lambda a: a.session.drafts.set_camera(None)),
    Key(imgui.Key.m, "M", "map from above", "map", lambda a: a.toggle_map()),
    Key(
        imgui.Key.i,
        "I",
        "every pass's number at a pixel; Shift: of those inside, too",
        "",
        lambda a: a.see.inspector.toggle(),
    ),
    Key(imgui.Key.a, "A", "keep this as A and compare; or no longer", "", lambda a: a.see.compare.toggle()),
    Key(imgui.Key.g, "G", "the passes as a graph, or no longer", "", lambda a: a.see.graph.toggle()),
    Key(imgui.Key.b, "B", "take the brush, or put it down", "", lambda a: a.painting.toggle()),
    Key(imgui.Key.s, "S", "save a PNG", "save", lambda a: a.save_picture()),
    Key(imgui.Key.c, "C", "capture: large pictures, films, sheets", "", toggle_capture),
    Key(imgui.Key.tab, "Tab", "hide the panel", "hide", lambda a: a.toggle_panel()),
    Key(imgui.Key.f2, "F2", "show the lessons, or no longer", "", lambda a: a.toggle_lessons()),
    Key(imgui.Key.page_down, "PgDn", "a page of the lesson on", "", lambda a: a.turn_page(1)),
    Key(imgui.Key.page_up, "PgUp", "a page of the lesson back", "", lambda a: a.turn_page(-1)),
    Key(imgui.Key.none, "/", "search the parameters", "", lambda a: a.search(), letter="/"),
    Key(imgui.Key.f11, "F11", "fill the screen, or no longer", "", lambda a: a.full_screen()),
    Key(imgui.Key.none, "?", "show or hide these keys", "keys", lambda a: a.toggle_keymap(), letter="?"),
    Key(imgui.Key.f1, "F1", "show or hide these keys", "", lambda a: a.toggle_keymap()),
    Key(imgui.Key.f8, "F8, Shift+F8", "next error, previous error", "", lambda a: _step(a)),
    Key(imgui.Key.e, "E", "edit the file of the error looked at", "", edit_problem),
    Key(imgui.Key.z, "Ctrl+Z", "undo", "", lambda a: a.undo(), ctrl=True),
    Key(imgui.Key.z, "Ctrl+Shift+Z", "redo", "", lambda a: a.redo(), ctrl=True, shift=True),
    Key(imgui.Key.y, "Ctrl+Y", "redo", "", lambda a: a.redo(), ctrl=True),
    Key(imgui.Key.s, "Ctrl+S", "save values into the sketch", "", save_values, ctrl=True),
    Key(imgui.Key.none, "Ctrl++", _SIZE_KEYS, "", lambda a: a.resize(1), ctrl=True, sign="+"),
    Key(imgui.Key.none, "Ctrl+-", _SIZE_KEYS, "", lambda a: a.resize(-1), ctrl=True, sign="-"),
    Key(imgui.Key._0, "Ctrl+0", _SIZE_KEYS, "", lambda a: a.resize(0), ctrl=True),
    Key(imgui.Key.escape, "Esc", "close what is open, one thing at a time", "", close_one),
    Key(imgui.Key.q, "Ctrl+Q", "quit", "quit", lambda a: a.quit(), ctrl=True),
)


def _sign(actions: Actions) -> str:
    """Return "+" or "-" where a key for it was pressed since the last frame; else nothing."""
    for key in _SIGN_KEYS:
        if imgui.is_key_pressed(key, repeat=True):
            # In a slow turn it may be up again: then it is taken for what it is on an English keyboard.
            return actions.sign_held() or _SIGN_KEYS[key]
    return ""


_SIGN_KEYS: dict[imgui.Key, str] = {
    imgui.Key.keypad_add: "+",
    imgui.Key.keypad_subtract: "-",
    imgui.Key.equal: "+",
    imgui.Key.minus: "-",
    imgui.Key.right_bracket: "",
    imgui.Key.slash: "",
    imgui.Key.backslash: "",
}


def _step(actions: Actions) -> None:
    io = imgui.get_io()
    actions.problems.step(-1 if io.key_shift or imgui.is_key_released(imgui.Key.mod_shift) else 1)


def act_on_keys(actions: Actions) -> None:
    """Do what the keys pressed since the last frame mean, unless they belong to a text field or a menu.

    Two belong to neither: Esc, unless it leaves the field itself, and what quits.
    """
    io = imgui.get_io()
    # In a slow turn Ctrl may come up again together with the key that it was held for.
    ctrl = io.key_ctrl or io.key_super or imgui.is_key_released(imgui.Key.mod_ctrl)
    shift = io.key_shift or imgui.is_key_released(imgui.Key.mod_shift)
    if ctrl and imgui.is_key_pressed(imgui.Key.q, repeat=False):
        actions.quit()
        return
    if imgui.is_key_pressed(imgui.Key.escape, repeat=False):
        if not left_a_field():
            close_one(actions)
        return
    if keeps_keys(actions) or io.want_text_input or io.key_alt:
        return
    if imgui.is_popup_open("", imgui.PopupFlags_.any_popup):
        return
    typed = {chr(letter) for letter in io.input_queue_characters}
    sign = _sign(actions) if ctrl else ""
    for key in KEYS:
        if key.sign:
            if key.sign == sign:
                key.act(actions)
            continue
        if key.letter:
            if key.letter in typed and not ctrl:
                key.act(actions)
            continue
        fits = key.ctrl == ctrl and (key.shift == shift or not ctrl)
        if fits and imgui.is_key_pressed(key.key, repeat=key.ctrl and key.key != imgui.Key.s):
            key.act(actions)

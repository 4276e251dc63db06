"""What each key does: one table, which the key map shows as well."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from imgui_bundle import imgui

from playground import rooms
from playground.studio.bench import Workbench
from playground.studio.input.escape_layers import close_one
from playground.studio.input.key import Key
from playground.studio.input.text_field import ctrl_held, keeps_keys, left_a_field, letters
from playground.studio.interface import resize
from playground.studio.paint.brush import TOOLS, Tool

_K = imgui.Key
_INSPECT = "every pass's number at a pixel; Shift: of those inside, too"
_TOOLS = f"the brush's tool: {', '.join(TOOLS)}"
_HELP = "show or hide these keys"
_VISITS = "the sketch that was open before, and forward again"
_BRUSH = "the brush: narrower, wider, weaker, stronger, harder, softer"
_SIZE_KEYS = "text and panels larger, smaller, at their first size"


def _take(bench: Workbench, tool: Tool) -> None:
    bench.painting.take_tool(tool)


KEYS: tuple[Key, ...] = (
    Key(_K.space, "Space", "play or pause", lambda b: b.session.clock.toggle()),
    Key(_K.none, ",", "a frame of time back", lambda b: b.undo.step_time(-1), letter=","),
    Key(_K.none, ".", "a frame of time on", lambda b: b.undo.step_time(1), letter="."),
    Key(_K.l, "L", "loop time, or no longer", lambda b: b.undo.toggle_loop()),
    Key(_K._0, "0", "time to 0", lambda b: b.undo.seek(0.0)),
    Key(_K.r, "R", "reset the view", lambda b: b.session.drafts.set_camera(None), brief="view"),
    Key(_K.m, "M", "map from above", lambda b: b.session.toggle_map(), brief="map"),
    Key(_K.i, "I", _INSPECT, lambda b: b.inspection.inspector.toggle()),
    Key(_K.a, "A", "keep this as A and compare; or no longer", lambda b: b.inspection.compare.toggle()),
    Key(_K.g, "G", "the passes as a graph, or no longer", lambda b: b.inspection.graph.toggle()),
    Key(_K.b, "B", "take the brush, or put it down", lambda b: b.painting.toggle()),
    Key(_K.none, "[", _BRUSH, lambda b: b.painting.resize(-1), letter="[", brush=True),
    Key(_K.none, "]", _BRUSH, lambda b: b.painting.resize(1), letter="]", brush=True),
    Key(_K.none, "{", _BRUSH, lambda b: b.painting.strengthen(-1), letter="{", brush=True),
    Key(_K.none, "}", _BRUSH, lambda b: b.painting.strengthen(1), letter="}", brush=True),
    Key(_K.none, "<", _BRUSH, lambda b: b.painting.soften(-1), letter="<", brush=True),
    Key(_K.none, ">", _BRUSH, lambda b: b.painting.soften(1), letter=">", brush=True),
    *(
        Key(_K.none, str(n), _TOOLS, partial(_take, tool=tool), letter=str(n), brush=True)
        for n, tool in enumerate(TOOLS, 1)
    ),
    Key(_K.s, "S", "save a PNG", lambda b: b.commands.save_picture(), brief="save"),
    Key(_K.tab, "Tab", "hide the panel", lambda b: b.interface.toggle_panel(), brief="hide"),
    *(key for module in rooms.modules("addition") for key in module.KEYS),
    Key(_K.none, "/", "search the parameters", lambda b: b.interface.search(), letter="/"),
    Key(_K.f11, "F11", "fill the screen, or no longer", lambda b: b.window.toggle_full()),
    Key(_K.none, "?", _HELP, lambda b: b.interface.toggle_keymap(), letter="?", brief="keys"),
    Key(_K.f1, "F1", _HELP, lambda b: b.interface.toggle_keymap()),
    Key(_K.f8, "F8, Shift+F8", "next error, previous error", lambda b: _step(b)),
    Key(_K.e, "E", "edit the file of the current error", lambda b: b.files.open_current(b.problems)),
    Key(_K.z, "Ctrl+Z", "undo", lambda b: b.undo.undo(), ctrl=True),
    Key(_K.z, "Ctrl+Shift+Z", "redo", lambda b: b.undo.redo(), ctrl=True, shift=True),
    Key(_K.y, "Ctrl+Y", "redo", lambda b: b.undo.redo(), ctrl=True),
    Key(_K.s, "Ctrl+S", "save values into the sketch", lambda b: b.commands.save_values(), ctrl=True),
    Key(_K.v, "Ctrl+V", "open the shader's text on the clipboard", lambda b: _paste(b), ctrl=True),
    Key(_K.backspace, "Backspace, Shift+Backspace", _VISITS, lambda b: _visit(b)),
    Key(_K.none, "Ctrl++", _SIZE_KEYS, lambda b: _resize(b, 1), ctrl=True, sign="+"),
    Key(_K.none, "Ctrl+-", _SIZE_KEYS, lambda b: _resize(b, -1), ctrl=True, sign="-"),
    Key(_K._0, "Ctrl+0", _SIZE_KEYS, lambda b: _resize(b, 0), ctrl=True),
    Key(_K.escape, "Esc", "close open panels, one at a time", close_one),
    Key(_K.q, "Ctrl+Q", "quit", lambda b: b.window.quit(), ctrl=True, brief="quit"),
)


_ONCE = (_K.s, _K.v)
"""With Ctrl, keys that do not repeat while they are held."""


def pressed_sign(sign_held: Callable[[], str]) -> str:
    """Return "+" or "-" where a key for it was pressed since the last frame; else nothing.

    ``sign_held`` says which of the two a key that is down types on this keyboard.
    """
    for key, sign in _SIGN_KEYS.items():
        if imgui.is_key_pressed(key, repeat=True):
            # In a slow frame it may be up again: then it is taken for what it is on an English keyboard.
            return sign_held() or sign
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


def _resize(bench: Workbench, by: int) -> None:
    resize(bench.interface.size, by, bench.notices)


def _step(bench: Workbench) -> None:
    bench.problems.step(-1 if _shift_held() else 1)


def _paste(bench: Workbench) -> None:
    bench.commands.paste(imgui.get_clipboard_text() or "")


def _visit(bench: Workbench) -> None:
    bench.commands.visit(1 if _shift_held() else -1)


def _shift_held() -> bool:
    return imgui.get_io().key_shift or imgui.is_key_released(imgui.Key.mod_shift)


def act_on_keys(bench: Workbench) -> None:
    """Act on the keys pressed since the last frame, unless they belong to a text field or a menu.

    Two belong to neither: Esc, unless it leaves the field itself, and what quits.
    """
    io = imgui.get_io()
    ctrl, shift = ctrl_held(), _shift_held()
    if ctrl and imgui.is_key_pressed(imgui.Key.q, repeat=False):
        bench.window.quit()
        return
    if imgui.is_key_pressed(imgui.Key.escape, repeat=False):
        if not left_a_field():
            close_one(bench)
        return
    if keeps_keys(bench.interface.ahead) or io.want_text_input or io.key_alt:
        return
    if imgui.is_popup_open("", imgui.PopupFlags_.any_popup):
        return
    typed = letters()
    sign = pressed_sign(bench.window.sign_held) if ctrl else ""
    for key in KEYS:
        if key.sign:
            pressed = key.sign == sign
        elif key.letter:
            pressed = key.letter in typed and not ctrl
        else:
            fits = key.ctrl == ctrl and (key.shift == shift or not ctrl)
            pressed = fits and imgui.is_key_pressed(key.key, repeat=key.ctrl and key.key not in _ONCE)
        if pressed and (bench.painting.on or not key.brush):
            key.act(bench)

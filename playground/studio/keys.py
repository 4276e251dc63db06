"""What each key does: one table, which the key map shows as well.

Esc closes what lies over the picture, one layer at a time, and never quits. Where its sketch reads the
keyboard, a picture gets the keys that are no shortcut of the window always; all of them after a click on the
picture, until Esc or a click on a panel. What is pressed together with Ctrl or Alt is the window's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, partial
from itertools import chain

from imgui_bundle import imgui

from playground import rooms
from playground.sketch.traits import traits_of
from playground.studio import cursor, focus
from playground.studio.addition import Layer
from playground.studio.bench import Workbench
from playground.studio.code.panel import close_smaller, give_back_keys, stay, typing
from playground.studio.draw import arrows, ctrl_held, keeps_keys, left_a_field, letters
from playground.studio.interface import resize
from playground.studio.language import tr
from playground.studio.mouse import steer
from playground.studio.paint.brush import TOOLS, Tool
from playground.studio.picture.gestures import Gesture


@dataclass(frozen=True)
class Key:
    """A key and its meaning."""

    key: imgui.Key
    name: str
    meaning: str
    act: Callable[[Workbench], None]
    ctrl: bool = False
    shift: bool = False
    sign: str = ""  # "+" or "-", with Ctrl: on the keypad, and wherever else the keyboard has it
    brief: str = ""  # in the panel's last line; empty: not there
    letter: str = ""  # what it types, for one that is elsewhere on every keyboard
    brush: bool = False  # only while the brush is taken


# ── layers that Esc closes ────────────────────────────────────────────────────


def close_one(bench: Workbench) -> None:
    """Close what is topmost; where nothing is open, say how to quit."""
    for _, close in _open(bench):
        close()
        return
    bench.notices.say(tr("nothing is open that Esc could close; Ctrl+Q quits"))


def open_layers(bench: Workbench) -> list[str]:
    """Return the names of what is open, topmost first."""
    return [name for name, _ in _open(bench)]


def _open(bench: Workbench) -> Iterator[Layer]:
    inspection = bench.inspection
    if imgui.is_popup_open("", imgui.PopupFlags_.any_popup):
        yield "popup", lambda: _close_popup(bench)
    if bench.start.shown:
        yield "start page", bench.start.close
    if bench.interface.keymap_shown:
        yield "keys", bench.interface.toggle_keymap
    for addition in bench.additions:
        yield from addition.popups()
    if focus.is_shown() and not bench.start.shown:
        yield "focus", focus.hide
    for name in typing(bench.files):
        yield f"editor {name}", partial(give_back_keys, bench.files)
    if bench.interface.cursor.on:
        yield "cursor", bench.interface.cursor.leave
    if bench.tracing.on:
        yield "trace", bench.tracing.toggle
    if inspection.graph.has_keys:
        yield "passes", inspection.graph.leave
    if inspection.inspector.on:
        yield "inspector", inspection.inspector.toggle
    if bench.painting.on:
        yield "brush", bench.painting.toggle
    if bench.walk.on:
        yield "walk", bench.walk.end
    if inspection.compare.on:
        yield "A/B", inspection.compare.toggle
    if bench.versions.is_looking:
        yield "version", bench.versions.leave
    if bench.window.is_full():
        yield "full screen", bench.window.toggle_full
    for addition in bench.additions:
        yield from addition.layers()


def _close_popup(bench: Workbench) -> None:
    """Close the innermost popup; a question in it is dismissed."""
    stay(bench.files)
    depth = len(imgui.get_current_context().open_popup_stack)
    imgui.internal.close_popup_to_level(max(depth - 1, 0), True)


# ── the table ─────────────────────────────────────────────────────────────────


_K = imgui.Key
_CURSOR = "a cursor over the picture that keys move, in the mouse's place"
_INSPECT = "every pass's number at a pixel; Shift: of those inside, too"
_TRACE = "every value of a texel beside the code; a click pins it, Shift: compares"
_TOOLS = f"the brush's tool: {', '.join(TOOLS)}"
_EDIT = "edit the file of the current error here, or in your own editor"
_HELP = "show or hide these keys"
_VISITS = "the sketch that was open before, and forward again"
_BRUSH = "the brush: narrower, wider, weaker, stronger, harder, softer"
_VERSIONS = "look at the version before, after; F7: while the key is held"
_SIZE_KEYS = "text and panels larger, smaller, at their first size"


def _take(bench: Workbench, tool: Tool) -> None:
    bench.painting.take_tool(tool)


@cache
def all_keys() -> tuple[Key, ...]:
    """Return the keys of the window and those that rooms add, in the order of the key map."""
    added = tuple(key for module in rooms.modules("addition") for key in module.KEYS)
    return tuple(chain.from_iterable(added if key is None else (key,) for key in _KEYS))


_KEYS: tuple[Key | None, ...] = (
    Key(_K.space, "Space", "play or pause", lambda b: b.session.clock.toggle()),
    Key(_K.none, ",", "a frame back", lambda b: b.undo.step_time(-1), letter=","),
    Key(_K.none, ".", "a frame on", lambda b: b.undo.step_time(1), letter="."),
    Key(_K.l, "L", "loop time, or not", lambda b: b.undo.toggle_loop()),
    Key(_K._0, "0", "time to 0", lambda b: b.undo.seek(0.0)),
    Key(_K.r, "R", "reset the view", lambda b: b.session.drafts.set_camera(None), brief="view"),
    Key(_K.m, "M", "map from above", lambda b: b.session.toggle_map(), brief="map"),
    Key(_K.w, "W", "walk on the terrain: W A S D, arrows, drag, wheel", lambda b: b.walk.toggle()),
    Key(_K.x, "X", _CURSOR, lambda b: b.toggle_cursor()),
    Key(_K.i, "I", _INSPECT, lambda b: b.inspection.inspector.toggle()),
    Key(_K.t, "T", _TRACE, lambda b: b.tracing.toggle()),
    Key(_K.a, "A", "keep this as A and compare, or end that", lambda b: b.inspection.compare.toggle()),
    Key(_K.g, "G", "show or hide the passes as a graph", lambda b: b.toggle_passes()),
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
    Key(_K.s, "S", "save a PNG", lambda b: b.actions.save_picture(), brief="save"),
    Key(_K.h, "H", "hide the panel", lambda b: b.interface.toggle_panel(), brief="hide"),
    Key(_K.o, "O", "start page: new, open, recent, shipped", lambda b: b.start.toggle(), brief="open"),
    None,  # the place of those of rooms
    Key(_K.none, "/", "search the parameters", lambda b: b.interface.search(), letter="/"),
    Key(_K.f11, "F11", "fill the screen, or leave full screen", lambda b: b.window.toggle_full()),
    Key(_K.none, "?", _HELP, lambda b: b.interface.toggle_keymap(), letter="?", brief="keys"),
    Key(_K.f1, "F1", _HELP, lambda b: b.interface.toggle_keymap()),
    Key(_K.f4, "F4", "show or hide frames a second in the corner", lambda b: _toggle_readout(b)),
    Key(_K.f10, "F10", "language, colours, size of text, panes", lambda b: b.interface.ask_settings()),
    Key(_K.f6, "F6, Shift+F6", _VERSIONS, lambda b: _look(b)),
    Key(_K.f7, "F7", _VERSIONS, lambda b: b.versions.hold()),
    Key(_K.f6, "Ctrl+F6", "go back to the version that is looked at", lambda b: _go_back(b), ctrl=True),
    Key(_K.v, "V", "show or hide the versions", lambda b: b.panes.toggle_strip("versions")),
    Key(_K.f8, "F8, Shift+F8", "next error, previous error", lambda b: _step(b)),
    Key(_K.e, "E, Shift+E", _EDIT, lambda b: b.files.open_current(b.problems, here=not _shift_held())),
    Key(_K.e, "Ctrl+E", "show or hide the code pane", lambda b: b.toggle_code(), ctrl=True),
    Key(_K.z, "Ctrl+Z", "undo", lambda b: b.undo.undo(), ctrl=True),
    Key(_K.z, "Ctrl+Shift+Z", "redo", lambda b: b.undo.redo(), ctrl=True, shift=True),
    Key(_K.y, "Ctrl+Y", "redo", lambda b: b.undo.redo(), ctrl=True),
    Key(_K.s, "Ctrl+S", "save values into the sketch", lambda b: b.actions.save_values(), ctrl=True),
    Key(_K.v, "Ctrl+V", "open the shader's text on the clipboard", lambda b: _paste(b), ctrl=True),
    Key(_K.backspace, "Backspace, Shift+Backspace", _VISITS, lambda b: _visit(b)),
    Key(_K.none, "Ctrl++", _SIZE_KEYS, lambda b: _resize(b, 1), ctrl=True, sign="+"),
    Key(_K.none, "Ctrl+-", _SIZE_KEYS, lambda b: _resize(b, -1), ctrl=True, sign="-"),
    Key(_K._0, "Ctrl+0", _SIZE_KEYS, lambda b: _resize(b, 0), ctrl=True),
    Key(_K.escape, "Esc", "close open panels, one at a time", close_one),
    Key(_K.q, "Ctrl+Q", "quit", lambda b: b.window.quit(), ctrl=True, brief="quit"),
)


def _look(bench: Workbench) -> None:
    bench.panes.show_strip("versions")
    bench.versions.step(1 if imgui.get_io().key_shift else -1)


def _go_back(bench: Workbench) -> None:
    if bench.versions.looked is not None:
        bench.versions.go_back(bench.versions.looked)


def _toggle_readout(bench: Workbench) -> None:
    preferences = bench.interface.preferences
    preferences.choose(shows_readout=not preferences.shows_readout)


_WALK: dict[imgui.Key, tuple[float, float]] = {
    _K.w: (0.0, 1.0),
    _K.up_arrow: (0.0, 1.0),
    _K.s: (0.0, -1.0),
    _K.down_arrow: (0.0, -1.0),
    _K.a: (-1.0, 0.0),
    _K.left_arrow: (-1.0, 0.0),
    _K.d: (1.0, 0.0),
    _K.right_arrow: (1.0, 0.0),
}
"""What a key does while one walks: to the right, and forward."""

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
    resize(bench.interface.preferences, by, bench.notices)


def _step(bench: Workbench) -> None:
    bench.problems.step(-1 if _shift_held() else 1)


def _paste(bench: Workbench) -> None:
    bench.actions.paste(imgui.get_clipboard_text() or "")


def _visit(bench: Workbench) -> None:
    bench.actions.visit(1 if _shift_held() else -1)


def _shift_held() -> bool:
    return imgui.get_io().key_shift or imgui.is_key_released(imgui.Key.mod_shift)


def act_on_keys(bench: Workbench) -> None:
    """Act on the keys pressed since the last frame, unless they belong to a text field or a menu.

    Three belong to neither: Esc, unless it leaves the field itself, F10, and what quits.
    """
    io = imgui.get_io()
    ctrl, shift = ctrl_held(), _shift_held()
    closed_popup = _move_focus(bench)
    bench.walk.head(0.0, 0.0)
    bench.interface.cursor.pressed = bench.interface.cursor.latched
    if imgui.is_key_down(_K.f7):
        bench.versions.hold()
    elif imgui.is_key_released(_K.f7):
        bench.versions.let_go()
    if ctrl and imgui.is_key_pressed(imgui.Key.q, repeat=False):
        bench.window.quit()
        return
    if imgui.is_key_pressed(imgui.Key.escape, repeat=False):
        if not left_a_field() and not close_smaller(bench.files) and not closed_popup:
            close_one(bench)
        return
    if imgui.is_key_pressed(_K.f10, repeat=False) and not shift:
        bench.interface.ask_settings()
        return
    if typing(bench.files) and ctrl and imgui.is_key_pressed(imgui.Key.e, repeat=False):
        bench.panes.show_code(False)
        give_back_keys(bench.files)
        bench.interface.preferences.use_key("Ctrl+E")
        return
    if keeps_keys(bench.interface.ahead) or io.want_text_input:
        return
    if bench.inspection.graph.took_key or any(addition.has_keys for addition in bench.additions):
        return
    if imgui.is_popup_open("", imgui.PopupFlags_.any_popup):
        return
    if bench.start.shown:
        if imgui.is_key_pressed(_K.o, repeat=False) and not ctrl:
            bench.start.close()
        return
    if io.key_alt:
        _stretch(bench)
        return
    has_focus = focus.is_shown()
    if bench.walk.on and not ctrl and not has_focus:
        down = [way for key, way in _WALK.items() if imgui.is_key_down(key)]
        bench.walk.head(sum(way[0] for way in down), sum(way[1] for way in down), fast=shift)
    typed = letters()
    sign = pressed_sign(bench.window.sign_held) if ctrl else ""
    for key in all_keys():
        if key.sign:
            pressed = key.sign == sign
        elif key.letter:
            pressed = key.letter in typed and not ctrl
        else:
            fits = key.ctrl == ctrl and (key.shift == shift or not ctrl)
            pressed = fits and imgui.is_key_pressed(key.key, repeat=key.ctrl and key.key not in _ONCE)
        if key.key == _K.space and (has_focus or bench.interface.cursor.on):
            continue  # it presses the control, or the cursor's button
        walks = bench.walk.on and not ctrl and key.key in _WALK
        if pressed and not walks and (bench.painting.on or not key.brush):
            key.act(bench)
            bench.interface.preferences.use_key(key.name)
    if not (has_focus or bench.interface.keymap_shown or (bench.walk.on and not ctrl)):
        _steer(bench, ctrl=ctrl, shift=shift)
        if bench.interface.cursor.on:
            cursor.act(bench.interface.cursor)


def _stretch(bench: Workbench) -> None:
    """Make the pane that has the focus, or had it last, larger or smaller."""
    sign, pane = pressed_sign(bench.window.sign_held), focus.current_pane()
    if sign and pane:
        bench.panes.stretches = pane, 1 if sign == "+" else -1
    elif sign:
        bench.notices.say(tr("no pane has the focus: Ctrl+Tab gives it to one"))


_STEP = 0.025  # of the picture's height: so far an arrow key drags the terrain, or the sun


def _steer(bench: Workbench, *, ctrl: bool, shift: bool) -> None:
    """Do with the arrows what drags do, and with + and - what the wheel does."""
    session = bench.session
    if session.sketch is None or traits_of(session.sketch).keys:
        return  # a picture that reads the keyboard reads these
    across, down = (0, 0) if bench.interface.cursor.on else arrows()
    wheel = 0 if ctrl else letters().count("+") - letters().count("-")
    if ctrl and (across or down):
        session.move_suns(across * _STEP, -down * _STEP)
    elif across or down or wheel:
        moved = Gesture(1.0, across * _STEP, down * _STEP, wheel, orbiting=not shift, panning=shift)
        steer(session, moved)


def _move_focus(bench: Workbench) -> bool:
    """Move the focus by Tab; return whether imgui itself has just closed a popup."""
    state = bench.interface.focus
    barred = bool(typing(bench.files)) or bench.inspection.graph.has_keys
    focus.update(state, always=bench.start.shown, barred=barred)
    popups = len(imgui.get_current_context().open_popup_stack)
    closed, state.popups = popups < state.popups, popups
    if closed:
        stay(bench.files)
    return closed


# ── the key map ───────────────────────────────────────────────────────────────


GESTURES = (
    ("drag", "orbit the terrain"),
    ("Shift+drag, right drag", "move along the ground"),
    ("Ctrl+drag", "move the sun"),
    ("wheel", "nearer, farther"),
    ("Ctrl, Shift, Ctrl+Shift+wheel", "the brush: wider, stronger, softer"),
    ("double click, Ctrl+click", "type a value; pi/4 will do"),
    ("right click", "a parameter's menu"),
    ("drop a file", "open a sketch, or choose what reads an image, a video or a sound"),
)
"""What a mouse does."""


CONTROL_KEYS = (
    ("Tab, Shift+Tab", "the next control, the one before"),
    ("Ctrl+Tab, Ctrl+Shift+Tab", "the next pane, the one before"),
    ("Space, Enter", "press the control; Enter types a number, arrows move a slider that was pressed"),
    ("Menu, Shift+F10", "a parameter's menu"),
    ("Alt++, Alt+-", "the pane with the focus larger, smaller"),
)
"""What the keyboard does with the controls of a pane."""
STEERING_KEYS = (
    ("Arrows", "orbit the terrain"),
    ("Shift+Arrows", "move along the ground"),
    ("Ctrl+Arrows", "move the sun"),
    ("+, -", "nearer, farther"),
)
"""What it does with the picture, while no control shows the focus."""
CURSOR_KEYS = (
    ("Arrows", "the cursor a texel on, faster while they are held; Shift: 10, Ctrl: 100"),
    ("Space, Enter", "the cursor's button, as the mouse's left one; Enter holds it down, or lets it go"),
)
"""What it does while the picture's cursor is on."""

_SUBJECTS = {
    "Picture": ("R", "M", "W", "A", "I", "T", "S", "C", "F4", "F11"),
    "Cursor": ("X",),
    "Time": ("Space", ",", ".", "L", "0"),
    "Sketch and versions": (
        *("O", "Backspace, Shift+Backspace", "Ctrl+Z", "Ctrl+Shift+Z", "Ctrl+Y", "Ctrl+S", "Ctrl+V", "V"),
        *("F6, Shift+F6", "Ctrl+F6"),
    ),
    "Code and passes": ("Ctrl+E", "E, Shift+E", "F8, Shift+F8", "G"),
    "Window": ("H", "/", "?", "F1", "F10", "Ctrl++", "Ctrl+-", "Ctrl+0", "Esc", "Ctrl+Q"),
    "Brush": ("B",),
}
"""The subjects of the key map, in its order, and the names of their keys; those of rooms are "More"."""


def keys_by_subject() -> dict[str, list[tuple[str, str]]]:
    """Return the rows of the key map, keys and meaning in English, by subject."""
    subjects = {name: subject for subject, names in _SUBJECTS.items() for name in names}
    rows: dict[str, list[tuple[str, str]]] = {subject: [] for subject in _SUBJECTS}
    brush = {key.meaning for key in all_keys() if key.brush}
    for meaning, names in keys_by_meaning().items():
        subject = "Brush" if meaning in brush else subjects.get(names[0], "More")
        rows.setdefault(subject, []).append((", ".join(names), meaning))
    rows["Picture"] = [*STEERING_KEYS, *rows["Picture"]]
    rows["Cursor"] += CURSOR_KEYS
    rows["Window"] = [*CONTROL_KEYS, *rows["Window"]]
    rows["Mouse"] = list(GESTURES)
    return rows


def keys_by_meaning() -> dict[str, list[str]]:
    """Return the names of the keys by what they do, in the order of the key map."""
    names: dict[str, list[str]] = {}
    for key in all_keys():
        names.setdefault(key.meaning, []).append(key.name)
    return names


# ── keys of a picture ─────────────────────────────────────────────────────────


def _codes() -> Iterator[tuple[imgui.Key, int]]:
    """Yield each key with its code in JavaScript (``KeyboardEvent.keyCode``)."""
    yield from ((getattr(_K, chr(letter).lower()), letter) for letter in range(ord("A"), ord("Z") + 1))
    yield from ((getattr(_K, f"_{digit}"), 48 + digit) for digit in range(10))
    yield from ((getattr(_K, f"keypad{digit}"), 96 + digit) for digit in range(10))
    yield from ((getattr(_K, f"f{number}"), 111 + number) for number in range(1, 13))
    yield from (
        (_K.backspace, 8), (_K.tab, 9), (_K.enter, 13), (_K.keypad_enter, 13), (_K.left_shift, 16),
        (_K.right_shift, 16), (_K.left_ctrl, 17), (_K.right_ctrl, 17), (_K.left_alt, 18), (_K.right_alt, 18),
        (_K.pause, 19), (_K.caps_lock, 20), (_K.space, 32), (_K.page_up, 33), (_K.page_down, 34),
        (_K.end, 35), (_K.home, 36), (_K.left_arrow, 37), (_K.up_arrow, 38), (_K.right_arrow, 39),
        (_K.down_arrow, 40), (_K.insert, 45), (_K.delete, 46), (_K.left_super, 91), (_K.right_super, 92),
        (_K.menu, 93), (_K.keypad_multiply, 106), (_K.keypad_add, 107), (_K.keypad_subtract, 109),
        (_K.keypad_decimal, 110), (_K.keypad_divide, 111), (_K.num_lock, 144), (_K.scroll_lock, 145),
        (_K.semicolon, 186), (_K.equal, 187), (_K.comma, 188), (_K.minus, 189), (_K.period, 190),
        (_K.slash, 191), (_K.grave_accent, 192), (_K.left_bracket, 219), (_K.backslash, 220),
        (_K.right_bracket, 221), (_K.apostrophe, 222),
    )  # fmt: skip


CODES: dict[imgui.Key, int] = dict(_codes())
"""Key → its code in JavaScript, which is its column in the keyboard's texture."""

_MODIFIERS = (16, 17, 18, 91, 92)
_TYPED = {",": _K.comma, ".": _K.period, "/": _K.slash, "?": _K.slash, "<": _K.comma, ">": _K.period}
_TYPED |= {"[": _K.left_bracket, "{": _K.left_bracket, "]": _K.right_bracket, "}": _K.right_bracket}
_TYPED |= {str(digit): getattr(_K, f"_{digit}") for digit in range(10)}


def _keys_of(*, brush: bool) -> set[imgui.Key]:
    """Return the keys of the shortcuts without Ctrl, of the brush or of all else."""
    keys = [key for key in all_keys() if not key.ctrl and key.brush == brush]
    return {_TYPED[key.letter] if key.letter else key.key for key in keys}


class PictureKeys:
    """What the picture of one bench's session gets of the keyboard."""

    def __init__(self, bench: Workbench) -> None:
        self.bench = bench
        self.has_keyboard = False  # all keys are its own
        self._shortcuts, self._of_brush = _keys_of(brush=False), _keys_of(brush=True)

    def act(self) -> bool:
        """Give the picture its keys of this frame; return whether none of them is for the window."""
        session, io = self.bench.session, imgui.get_io()
        taken = self.bench.walk.on or self.bench.interface.cursor.on
        if session.sketch is None or not traits_of(session.sketch).keys or taken:
            self.has_keyboard = False
            session.hold_keys(())
            return False
        if imgui.is_mouse_clicked(0):
            self._take(not io.want_capture_mouse)
        if keeps_keys(self.bench.interface.ahead) or io.want_text_input:
            session.hold_keys(())
            return False
        if self.has_keyboard and imgui.is_key_pressed(_K.escape, repeat=False):
            self._take(False)
            session.hold_keys(())
            return True
        held = {CODES[key] for key in CODES if imgui.is_key_down(key) and self._is_own(key)}
        is_window_s = ctrl_held() or io.key_alt
        session.hold_keys(held.intersection(_MODIFIERS) if is_window_s else held)
        return self.has_keyboard and not is_window_s

    def _take(self, takes: bool) -> None:
        if takes and not self.has_keyboard:
            self.bench.notices.say(tr("the picture has the keyboard; Esc gives it back"))
        self.has_keyboard = takes

    def _is_own(self, key: imgui.Key) -> bool:
        taken = key in self._shortcuts or (self.bench.painting.on and key in self._of_brush)
        return self.has_keyboard or not taken

"""The keys that a picture gets, where its sketch reads the keyboard.

Those that are no shortcut of the window always; all of them after a click on the picture, until Esc or a
click on a panel. What is pressed together with Ctrl or Alt is the window's.
"""

from __future__ import annotations

from collections.abc import Iterator

from imgui_bundle import imgui

from playground.sketch.traits import traits_of
from playground.studio.bench import Workbench
from playground.studio.input.keys import KEYS
from playground.studio.input.text_field import ctrl_held, keeps_keys

_K = imgui.Key


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
    keys = [key for key in KEYS if not key.ctrl and key.brush == brush]
    return {_TYPED[key.letter] if key.letter else key.key for key in keys}


_SHORTCUTS, _OF_BRUSH = _keys_of(brush=False), _keys_of(brush=True)


class PictureKeys:
    """What the picture of one bench's session gets of the keyboard."""

    def __init__(self, bench: Workbench) -> None:
        self.bench = bench
        self.has_keyboard = False  # all keys are its own

    def act(self) -> bool:
        """Give the picture its keys of this frame; return whether none of them is for the window."""
        session, io = self.bench.session, imgui.get_io()
        if session.sketch is None or not traits_of(session.sketch).keys:
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
            self.bench.notices.say("the picture has the keyboard; Esc gives it back")
        self.has_keyboard = takes

    def _is_own(self, key: imgui.Key) -> bool:
        taken = key in _SHORTCUTS or (self.bench.painting.on and key in _OF_BRUSH)
        return self.has_keyboard or not taken

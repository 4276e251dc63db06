"""Keys one by one: none is lost that comes in the frame after another one.

The text editor asks imgui for its shortcuts in one chain. In the frame in which one is obeyed those further
down are not asked, and imgui routes none to who did not ask in the frame before: Enter right after End does
nothing. So a key that types no letter gets a frame, and an empty one after it. imgui itself puts off events
of a frame, as a press after the release of the same key: the empty frame comes when it has none left. Each
key brings the modifiers that its event carried: Ctrl+Z counts where both keys are up again before the frame,
and what is pressed after that waits for the next one, or it would count as pressed with Ctrl.
"""

from __future__ import annotations

from collections import deque
from typing import Any, NamedTuple

from imgui_bundle import imgui

# isort: split
import glfw

from playground.studio import focus

_MOUSE_POSITION = imgui.internal.InputEventType.mouse_pos.value  # of which each frame may have one
_MODIFIER_KEYS = range(glfw.KEY_LEFT_SHIFT, glfw.KEY_RIGHT_SUPER + 1)
_MODIFIERS = (
    (glfw.MOD_SHIFT, imgui.Key.mod_shift, glfw.KEY_LEFT_SHIFT, glfw.KEY_RIGHT_SHIFT),
    (glfw.MOD_CONTROL, imgui.Key.mod_ctrl, glfw.KEY_LEFT_CONTROL, glfw.KEY_RIGHT_CONTROL),
    (glfw.MOD_ALT, imgui.Key.mod_alt, glfw.KEY_LEFT_ALT, glfw.KEY_RIGHT_ALT),
    (glfw.MOD_SUPER, imgui.Key.mod_super, glfw.KEY_LEFT_SUPER, glfw.KEY_RIGHT_SUPER),
)
_OTHER_NAMES = {
    "left": "left_arrow",
    "right": "right_arrow",
    "up": "up_arrow",
    "down": "down_arrow",
    "left_control": "left_ctrl",
    "right_control": "right_ctrl",
}


class _Press(NamedTuple):
    key: int
    scan: int
    action: int
    held: int  # modifiers


class KeyQueue:
    """The keys and letters of one window that imgui has not had yet."""

    def __init__(self) -> None:
        self._waiting: deque[_Press | str] = deque()
        self._sent: set[int] = set()  # keys that imgui holds to be down
        self._rests = False  # the frame that begins is the empty one after a key

    @property
    def waits(self) -> bool:
        """Whether keys wait for a frame of their own."""
        return bool(self._waiting) or self._rests

    def listen(self, handle: Any) -> None:
        """Take the keys of a GLFW window in imgui's place."""
        key: Any = self._take_key
        letter: Any = self._take_letter
        glfw.set_key_callback(handle, key)
        glfw.set_char_callback(handle, letter)

    def _take_key(self, _: Any, key: int, scan: int, action: int, held: int) -> None:
        self._waiting.append(_Press(key, scan, action, held))

    def _take_letter(self, _: Any, letter: int) -> None:
        self._waiting.append(chr(letter))

    def feed(self) -> None:
        """Give imgui what belongs to the frame that begins: letters in a row, or one key that types none."""
        if self._rests:
            left = imgui.get_current_context().input_events_queue
            self._rests = any(event.type != _MOUSE_POSITION for event in left)
            return
        io, letters, let_go = imgui.get_io(), 0, False
        in_field = _is_typed()
        while self._waiting:
            first = self._waiting[0]
            if isinstance(first, str):
                self._waiting.popleft()
                io.add_input_character(ord(first))
                letters += 1
                continue
            # GLFW reports a key, then the letter that it types.
            types = len(self._waiting) > 1 and isinstance(self._waiting[1], str)
            is_modifier = first.key in _MODIFIER_KEYS
            alone = first.action != glfw.RELEASE and not is_modifier and not types
            self._rests = let_go and first.action != glfw.RELEASE and not in_field
            if self._rests or (alone and letters):
                return
            self._waiting.popleft()
            if first.action == glfw.RELEASE and first.key not in self._sent:
                continue
            if types and in_field:
                continue  # the letter is enough
            self._send(first, is_modifier=is_modifier)
            let_go = let_go or (is_modifier and first.action == glfw.RELEASE)
            if alone:
                self._rests = True
                return

    def _send(self, press: _Press, *, is_modifier: bool) -> None:
        io, is_down = imgui.get_io(), press.action != glfw.RELEASE
        (self._sent.add if is_down else self._sent.discard)(press.key)
        for bit, modifier, left, right in _MODIFIERS:
            held = bool(press.held & bit)
            if is_modifier:  # whether its own bit is set differs from system to system
                held = left in self._sent or right in self._sent
            io.add_key_event(modifier, held)
        if press.action != glfw.REPEAT:
            io.add_key_event(_named(press.key, press.scan), is_down)


def _is_typed() -> bool:
    """Return whether letters go into a text; one that Tab has just left still claims them for a frame."""
    context = imgui.get_current_context()
    has_left = focus.is_shown() and context.active_id != context.input_text_state.id_
    return bool(imgui.get_io().want_text_input and not has_left)


def _named(key: int, scan: int) -> imgui.Key:
    """Return imgui's key; of a letter or digit by what this keyboard has there."""
    if key not in _NAMES or key <= glfw.KEY_GRAVE_ACCENT:
        letter = (glfw.get_key_name(key, scan) or "").lower()
        if len(letter) == 1 and letter.isascii() and letter.isalnum():
            named: imgui.Key = getattr(imgui.Key, letter if letter.isalpha() else f"_{letter}")
            return named
    return _NAMES.get(key, imgui.Key.none)


def _names() -> dict[int, imgui.Key]:
    names = {}
    for name in dir(glfw):
        if name.startswith("KEY_"):
            own = name.removeprefix("KEY_").lower()
            own = own.replace("kp_", "keypad_") if own.startswith("kp_") else _OTHER_NAMES.get(own, own)
            own = f"_{own}" if own.isdigit() else own.replace("keypad_", "keypad")
            key = getattr(imgui.Key, own, None) or getattr(imgui.Key, own.replace("keypad", "keypad_"), None)
            if key is not None:
                names[getattr(glfw, name)] = key
    return names


_NAMES = _names()

"""A text field that is about to open: what is typed until it takes the keys is its own, and no shortcut.

imgui gives a field the keys some frames after it was opened, and where a picture takes long, a
person has typed by then. While a field is awaited the letters are stored; it begins with them.
"""

from __future__ import annotations

from imgui_bundle import imgui

from playground.studio.interface import TypedAhead

_FRAMES = 6
"""That a field may take to open; one that never does, since it is not visible, takes no key longer."""


def await_field(ahead: TypedAhead) -> None:
    """Begin to store what is typed: a field was opened."""
    ahead.frames, ahead.text = _FRAMES, ""


def keeps_keys(ahead: TypedAhead) -> bool:
    """Return whether this frame's keys are for a field that is about to open, and store its letters."""
    if not ahead.frames:
        return False
    if _is_active():
        ahead.frames = 0
        return True
    ahead.frames -= 1
    ahead.text += letters()
    return True


def with_typed_ahead(ahead: TypedAhead, text: str, before: str, typed: str) -> str:
    """Return the text of the field that was drawn last, after what was typed before it took the keys.

    ``before``: its text before this frame, which what is typed replaces; ``typed``: this frame's letters,
    of which the field took those itself that came once it had the keys.
    """
    if not imgui.is_item_active():
        return text
    before_field, ahead.text = ahead.text, ""
    if ahead.frames and imgui.is_item_activated():
        before_field += typed  # imgui drops those of the frame in which a field gets the keys
    if not before_field:
        return text
    imgui.get_current_context().input_text_state.reload_user_buf_and_move_to_end()
    return before_field + (text if text != before else "")


def left_a_field() -> bool:
    """Return whether a field had the keys when this frame began: its Esc is its own."""
    context = imgui.get_current_context()
    return context.active_id_previous_frame not in (0, None) and (
        context.active_id_previous_frame == context.input_text_state.id_
    )


def letters() -> str:
    """Return what was typed in this frame and not taken by a field yet."""
    return "".join(chr(letter) for letter in imgui.get_io().input_queue_characters)


def ctrl_held() -> bool:
    """Return whether Ctrl is down, or went up in this frame, as in a slow one together with its key."""
    io = imgui.get_io()
    return bool(io.key_ctrl or io.key_super or imgui.is_key_released(imgui.Key.mod_ctrl))


def _is_active() -> bool:
    context = imgui.get_current_context()
    return context.active_id != 0 and context.active_id == context.input_text_state.id_

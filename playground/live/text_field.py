"""A text field that is about to open: what is typed until it takes the keys is its own, and no shortcut.

imgui gives a field the keys some turns after it was asked for, and where a picture takes long, a
person has typed by then. While a field is awaited the letters are put by; it begins with them.
"""

from __future__ import annotations

from imgui_bundle import imgui

from playground.workbench.actions import Actions

_TURNS = 6
"""That a field may take to open; one that never does, since it is out of sight, keeps no key longer."""


def await_field(actions: Actions) -> None:
    """Begin to put by what is typed: a field was asked for."""
    actions.awaits_field, actions.typed_ahead = _TURNS, ""


def keeps_keys(actions: Actions) -> bool:
    """Say whether this turn's keys are for a field that is about to open, and put its letters by."""
    if not actions.awaits_field:
        return False
    if _is_active():
        actions.awaits_field = 0
        return True
    actions.awaits_field -= 1
    actions.typed_ahead += letters()
    return True


def with_typed_ahead(actions: Actions, text: str, before: str, typed: str) -> str:
    """Return the text of the field that was drawn last, after what was typed before it took the keys.

    ``before``: its text before this turn, which what is typed replaces; ``typed``: this turn's letters,
    of which the field took those itself that came once it had the keys.
    """
    if not imgui.is_item_active():
        return text
    ahead, actions.typed_ahead = actions.typed_ahead, ""
    if actions.awaits_field and imgui.is_item_activated():
        ahead += typed  # imgui drops those of the turn in which a field is given the keys
    if not ahead:
        return text
    imgui.get_current_context().input_text_state.reload_user_buf_and_move_to_end()
    return ahead + (text if text != before else "")


def left_a_field() -> bool:
    """Say whether a field had the keys when this turn began: its Esc is its own."""
    context = imgui.get_current_context()
    return context.active_id_previous_frame not in (0, None) and (
        context.active_id_previous_frame == context.input_text_state.id_
    )


def letters() -> str:
    """Return what is typed in this turn and was not taken by a field yet."""
    return "".join(chr(letter) for letter in imgui.get_io().input_queue_characters)


def _is_active() -> bool:
    context = imgui.get_current_context()
    return context.active_id != 0 and context.active_id == context.input_text_state.id_

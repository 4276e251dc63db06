"""What lies over the picture, topmost first: Esc closes one layer at a time, and never quits."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

from imgui_bundle import imgui

from playground.live.code_window import ask_to_close, stay
from playground.workbench.actions import Actions


@dataclass(frozen=True)
class Layer:
    """Something open, and what closes it."""

    name: str
    close: Callable[[], None]


def close_one(actions: Actions) -> None:
    """Close what is topmost; where nothing is open, say how to quit."""
    top = next(_open(actions), None)
    if top is None:
        actions.say("nothing is open that Esc could close; Ctrl+Q quits")
    else:
        top.close()


def open_layers(actions: Actions) -> list[str]:
    """Return the names of what is open, topmost first."""
    return [layer.name for layer in _open(actions)]


def _open(actions: Actions) -> Iterator[Layer]:
    see = actions.see
    if imgui.is_popup_open("", imgui.PopupFlags_.any_popup):
        yield Layer("popup", lambda: _close_popup(actions))
    if actions.keymap_shown:
        yield Layer("keys", actions.toggle_keymap)
    if actions.capture.shown:
        yield Layer("capture", lambda: setattr(actions.capture, "shown", False))
    for editing in reversed(actions.editing):
        yield Layer(f"editor {editing.text.path.name}", partial(ask_to_close, editing, actions))
    if see.graph.on:
        yield Layer("graph", see.graph.toggle)
    if see.inspector.on:
        yield Layer("inspector", see.inspector.toggle)
    if actions.painting.on:
        yield Layer("brush", actions.painting.toggle)
    if see.compare.on:
        yield Layer("A/B", see.compare.toggle)
    if actions.fills_screen():
        yield Layer("full screen", actions.full_screen)
    if actions.lesson_shown():
        yield Layer("lesson", actions.toggle_lessons)


def _close_popup(actions: Actions) -> None:
    """Close the innermost popup; one that asks something is answered by leaving all as it is."""
    stay(actions)
    depth = len(imgui.get_current_context().open_popup_stack)
    imgui.internal.close_popup_to_level(max(depth - 1, 0), True)

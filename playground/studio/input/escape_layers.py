"""What lies over the picture, topmost first: Esc closes one layer at a time, and never quits."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from imgui_bundle import imgui

from playground.studio.addition import Layer
from playground.studio.bench import Workbench
from playground.studio.code.panel import ask_to_close, stay


def close_one(bench: Workbench) -> None:
    """Close what is topmost; where nothing is open, say how to quit."""
    for _, close in _open(bench):
        close()
        return
    bench.notices.say("nothing is open that Esc could close; Ctrl+Q quits")


def open_layers(bench: Workbench) -> list[str]:
    """Return the names of what is open, topmost first."""
    return [name for name, _ in _open(bench)]


def _open(bench: Workbench) -> Iterator[Layer]:
    inspection = bench.inspection
    if imgui.is_popup_open("", imgui.PopupFlags_.any_popup):
        yield "popup", lambda: _close_popup(bench)
    if bench.interface.keymap_shown:
        yield "keys", bench.interface.toggle_keymap
    for addition in bench.additions:
        yield from addition.popups()
    for editing in reversed(bench.files.editing):
        yield f"editor {editing.text.path.name}", partial(ask_to_close, editing, bench.files)
    if inspection.graph.on:
        yield "graph", inspection.graph.toggle
    if inspection.inspector.on:
        yield "inspector", inspection.inspector.toggle
    if bench.painting.on:
        yield "brush", bench.painting.toggle
    if inspection.compare.on:
        yield "A/B", inspection.compare.toggle
    if bench.window.is_full():
        yield "full screen", bench.window.toggle_full
    for addition in bench.additions:
        yield from addition.layers()


def _close_popup(bench: Workbench) -> None:
    """Close the innermost popup; a question in it is dismissed."""
    stay(bench.files)
    depth = len(imgui.get_current_context().open_popup_stack)
    imgui.internal.close_popup_to_level(max(depth - 1, 0), True)

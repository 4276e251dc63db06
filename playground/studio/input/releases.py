"""Let a button of the mouse go a frame after the movement that it came with.

Where a picture is slow, the last movement of a drag and the release come in one frame. imgui then ends the
drag without having looked at that movement, so a slider would stay behind the mouse. Of a touch screen it
handles the release one frame later; so such a release is said to come from one.
"""

from __future__ import annotations

import math

from imgui_bundle import imgui


def before_release(position: tuple[float, float]) -> None:
    """Prepare imgui for a release at a place of the window, whose event follows."""
    io = imgui.get_io()
    moved = (io.mouse_pos.x, io.mouse_pos.y) != tuple(map(math.floor, position))  # imgui has whole pixels
    io.add_mouse_source_event(imgui.MouseSource.touch_screen if moved else imgui.MouseSource.mouse)


def after_events() -> None:
    """Have what comes next be the mouse's own."""
    imgui.get_io().add_mouse_source_event(imgui.MouseSource.mouse)

"""The place of a window: full screen and back, restored on a screen; and files dropped on it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import imgui_bundle  # noqa: F401  # before glfw, so that both use one GLFW library

# isort: split
import glfw

Rectangle = tuple[int, int, int, int]
"""x, y, width, height, in the screen's units."""


@dataclass(frozen=True)
class Geometry:
    """A window's place on the screen, in the screen's units."""

    x: int
    y: int
    width: int
    height: int
    maximised: bool = False


class WindowPlacement:
    """The place of one window; ``handle`` gives its current GLFW window."""

    def __init__(self, handle: Callable[[], Any]) -> None:
        self._handle = handle
        self._before: Geometry | None = None  # while it fills the screen: its place
        self._dropped: list[Path] = []
        self._listening: Any = None

    @property
    def full(self) -> bool:
        """Whether it fills a screen."""
        return self._before is not None

    def geometry(self) -> Geometry:
        """Return its place, or that before it filled the screen."""
        if self._before is not None:
            return self._before
        handle = self._handle()
        (x, y), (width, height) = glfw.get_window_pos(handle), glfw.get_window_size(handle)
        return Geometry(x, y, width, height, bool(glfw.get_window_attrib(handle, glfw.MAXIMIZED)))

    def move_to(self, at: tuple[int, int]) -> None:
        """Move its upper left corner, at most as far as all of it stays on a screen."""
        handle = self._handle()
        width, height = glfw.get_window_size(handle)
        left, top, right, bottom = glfw.get_window_frame_size(handle)
        frame = at[0] - left, at[1] - top, width + left + right, height + top + bottom
        x, y = on_screen(frame, screens())
        glfw.set_window_pos(handle, x + left, y + top)

    def toggle_full(self) -> None:
        """Fill the screen that most of it is on, or restore its place."""
        handle = self._handle()
        if self._before is not None:
            back, self._before = self._before, None
            no_monitor: Any = None
            glfw.set_window_monitor(
                handle, no_monitor, back.x, back.y, back.width, back.height, glfw.DONT_CARE
            )
            if back.maximised:
                glfw.maximize_window(handle)
            return
        geometry = self.geometry()
        monitors = glfw.get_monitors()
        if not monitors:
            return
        shares = [_shared(geometry, area) for area in screens()]
        monitor = monitors[shares.index(max(shares))]
        mode = glfw.get_video_mode(monitor)
        self._before = geometry
        glfw.set_window_monitor(handle, monitor, 0, 0, mode.size.width, mode.size.height, mode.refresh_rate)

    def dropped(self) -> list[Path]:
        """Return the files dropped on it since the last call."""
        handle = self._handle()
        if self._listening is not handle:
            took: Any = self.drop
            glfw.set_drop_callback(handle, took)
            self._listening = handle
        paths, self._dropped = self._dropped, []
        return paths

    def drop(self, _: object, names: Iterable[str]) -> None:
        """Store the names of dropped files; GLFW's callback."""
        self._dropped += [Path(name) for name in names]


def screens() -> list[Rectangle]:
    """Return the screens that there are."""
    rectangles = []
    for monitor in glfw.get_monitors():
        (x, y), mode = glfw.get_monitor_pos(monitor), glfw.get_video_mode(monitor)
        rectangles.append((x, y, mode.size.width, mode.size.height))
    return rectangles


def on_screen(window: Rectangle, areas: list[Rectangle]) -> tuple[int, int]:
    """Return where a window's upper left corner goes, so that screens show all of it, or all that fits.

    It stays where they do, also across several; else it goes into the one that shows most of it.
    """
    x, y, width, height = window
    geometry = Geometry(x, y, width, height)
    shares = [_shared(geometry, area) for area in areas]
    if not areas or sum(shares) >= width * height:
        return x, y
    left, top, wide, high = areas[shares.index(max(shares))]
    return max(min(x, left + wide - width), left), max(min(y, top + high - height), top)


def _shared(geometry: Geometry, area: Rectangle) -> int:
    """Return how much of a window is on a screen."""
    x, y, width, height = area
    across = min(geometry.x + geometry.width, x + width) - max(geometry.x, x)
    down = min(geometry.y + geometry.height, y + height) - max(geometry.y, y)
    return max(across, 0) * max(down, 0)

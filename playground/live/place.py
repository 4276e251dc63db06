"""Where the window stands: full screen and back, its place kept for the next time, files dropped on it."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import imgui_bundle  # noqa: F401  # before glfw, so that both use one GLFW library

# isort: split
import glfw

from playground.images.files import replacing

Rectangle = tuple[int, int, int, int]
"""x, y, width, height, in the screen's units."""

_LEAST = 80
"""Of a window, on each axis, must be on a screen for a hand to get hold of it."""


@dataclass(frozen=True)
class Geometry:
    """A window's place on the screen, in the screen's units."""

    x: int
    y: int
    width: int
    height: int
    maximised: bool = False


class Place:
    """One window's; ``handle`` gives GLFW's window of the moment."""

    def __init__(self, handle: Callable[[], Any]) -> None:
        self._handle = handle
        self._before: Geometry | None = None  # while it fills the screen: where it stood
        self._dropped: list[Path] = []
        self._listening: Any = None

    @property
    def full(self) -> bool:
        """Whether it fills a screen."""
        return self._before is not None

    def geometry(self) -> Geometry:
        """Return where it stands, or stood before it filled the screen."""
        if self._before is not None:
            return self._before
        handle = self._handle()
        (x, y), (width, height) = glfw.get_window_pos(handle), glfw.get_window_size(handle)
        return Geometry(x, y, width, height, bool(glfw.get_window_attrib(handle, glfw.MAXIMIZED)))

    def apply(self, wanted: Geometry) -> None:
        """Put it where it stood, moved as far as must be for it to be on a screen that there is."""
        handle, found = self._handle(), within(wanted, screens())
        glfw.set_window_size(handle, found.width, found.height)
        glfw.set_window_pos(handle, found.x, found.y)
        if found.maximised:
            glfw.maximize_window(handle)

    def toggle_full(self) -> None:
        """Fill the screen that most of it is on, or go back to where it stood."""
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
        stood = self.geometry()
        monitors = glfw.get_monitors()
        if not monitors:
            return
        shares = [_shared(stood, area) for area in screens()]
        monitor = monitors[shares.index(max(shares))]
        mode = glfw.get_video_mode(monitor)
        self._before = stood
        glfw.set_window_monitor(handle, monitor, 0, 0, mode.size.width, mode.size.height, mode.refresh_rate)

    def dropped(self) -> list[Path]:
        """Return the files dropped on it since the last call."""
        handle = self._handle()
        if self._listening is not handle:
            took: Any = self.drop
            glfw.set_drop_callback(handle, took)
            self._listening = handle
        found, self._dropped = self._dropped, []
        return found

    def drop(self, _: object, names: Iterable[str]) -> None:
        """Take in the names of files, as GLFW calls it."""
        self._dropped += [Path(name) for name in names]


def screens() -> list[Rectangle]:
    """Return the screens that there are."""
    found = []
    for monitor in glfw.get_monitors():
        (x, y), mode = glfw.get_monitor_pos(monitor), glfw.get_video_mode(monitor)
        found.append((x, y, mode.size.width, mode.size.height))
    return found


def within(wanted: Geometry, there: Iterable[Rectangle]) -> Geometry:
    """Return a place that can be seen: as it is where enough of it is on a screen, else on the first.

    One that is larger than every screen is made as large as the one it is put on.
    """
    areas = list(there)
    if not areas:
        return wanted
    for x, y, width, height in areas:
        across = min(wanted.x + wanted.width, x + width) - max(wanted.x, x)
        down = min(wanted.y + wanted.height, y + height) - max(wanted.y, y)
        if across >= _LEAST and down >= _LEAST and y <= wanted.y:  # its title can be taken hold of
            return wanted
    x, y, width, height = areas[0]
    wide, high = min(wanted.width, width), min(wanted.height, height)
    return Geometry(x + (width - wide) // 2, y + (height - high) // 2, wide, high, wanted.maximised)


def _shared(place: Geometry, area: Rectangle) -> int:
    """Return how much of a window is on a screen."""
    x, y, width, height = area
    across = min(place.x + place.width, x + width) - max(place.x, x)
    down = min(place.y + place.height, y + height) - max(place.y, y)
    return max(across, 0) * max(down, 0)


# ── kept for the next time ───────────────────────────────────────────────────


def state_file(environ: Mapping[str, str], platform: str, home: Path) -> Path:
    """Return the file that keeps the window's place, where the system keeps such things."""
    if platform == "win32":
        folder = Path(environ.get("LOCALAPPDATA") or home / "AppData" / "Local")
    elif platform == "darwin":
        folder = home / "Library" / "Application Support"
    else:
        folder = Path(environ.get("XDG_STATE_HOME") or home / ".local" / "state")
    return folder / "terrain-shader-playground" / "window.json"


def remembered(file: Path) -> Geometry | None:
    """Return the place that was kept; None where there is none, or none that makes sense."""
    try:
        given = json.loads(file.read_text(encoding="utf-8"))
        x, y, width, height = (given[name] for name in ("x", "y", "width", "height"))
    except (OSError, ValueError, KeyError, TypeError):
        return None
    sensible = all(type(n) is int and abs(n) < 100_000 for n in (x, y, width, height))
    if not sensible or min(width, height) < _LEAST:
        return None
    return Geometry(x, y, width, height, given.get("maximised") is True)


def remember(file: Path, place: Geometry) -> None:
    """Keep a place for the next time; where nothing can be written, nothing is kept."""
    with suppress(OSError, ValueError, RuntimeError):
        file.parent.mkdir(parents=True, exist_ok=True)
        with replacing(file) as out:
            out.write(json.dumps(asdict(place)).encode())


def own_file() -> Path:
    """Return the file for this user on this system."""
    return state_file(os.environ, sys.platform, Path.home())

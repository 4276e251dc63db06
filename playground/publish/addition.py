"""What publishing adds to a window: a window of its own, to capture large pictures, films and sheets."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from imgui_bundle import imgui

from playground.publish.window.captures import Captures
from playground.publish.window.panel import draw_capture
from playground.studio.addition import Addition, Layer
from playground.studio.bench import Host, Workbench
from playground.studio.keys import Key

_POLL_INTERVAL = 0.1  # [s] between looks at a job


class Capture(Addition):
    """The captures of one window."""

    name = "the capture's window"
    button = "Capture"
    button_note = "Large pictures, numbered ones, films, sheets of a sweep (C)"

    def __init__(self, host: Host) -> None:
        bench = host.bench
        folder, settle = bench.actions.folder, bench.painting.settle
        self.captures = Captures(bench.session, bench.notices, folder, settle)
        self._theme = host.theme

    def toggle(self) -> None:
        """Open or close the window."""
        self.captures.toggle()

    def popups(self) -> Iterator[Layer]:
        """Yield the window, where it is open."""
        if self.captures.shown:
            yield "capture", self.captures.toggle

    def status(self) -> Mapping[str, object]:
        """Return the path that was captured last."""
        return {"captured": str(self.captures.made or "")}

    @property
    def patience(self) -> float:
        """How long nothing needs to be done here [s]."""
        return math.inf if self.captures.working is None else _POLL_INTERVAL

    def take(self) -> None:
        """Take in how far the job is."""
        self.captures.poll()

    def draw_over(self) -> None:
        """Draw the window, while it is open."""
        draw_capture(self.captures, self._theme())

    def close(self) -> None:
        """Stop the job that is at work."""
        self.captures.close()


def open_addition(host: Host) -> Capture:
    """Return the captures of a window."""
    return Capture(host)


def check_request(request: Mapping[str, object]) -> None:
    """Accept every request: none names a capture."""


def _toggle(bench: Workbench) -> None:
    for addition in bench.additions:
        if isinstance(addition, Capture):
            addition.toggle()


KEYS = (Key(imgui.Key.c, "C", "capture: large pictures, films, sheets", _toggle),)
"""The key of the window."""

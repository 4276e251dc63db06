"""What publishing adds to a window: a dialog that writes what is there as a picture, a film or a file."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from imgui_bundle import imgui

from playground.publish.window.panel import draw_show
from playground.publish.window.show import Show
from playground.studio.addition import Addition, Layer
from playground.studio.bench import Host, Workbench
from playground.studio.keys import Key

_POLL_INTERVAL = 0.1  # [s] between looks at a job


class Showing(Addition):
    """What one window shows to others."""

    name = "what is shown to others"
    button = "Show…"
    button_note = "A picture, a turntable, a film, a web page or a mesh of what is here (C)"

    def __init__(self, host: Host) -> None:
        bench = host.bench
        folder, settle = bench.actions.folder, bench.painting.settle
        self.show = Show(bench.session, bench.notices, folder, settle)
        self._theme = host.theme

    @property
    def has_keys(self) -> bool:
        """Whether the dialog has the keyboard."""
        return self.show.shown and self.show.has_keys

    def toggle(self) -> None:
        """Open or close the dialog."""
        self.show.toggle()
        if self.show.shown:
            self.show.measure()

    def popups(self) -> Iterator[Layer]:
        """Yield the dialog, where it is open."""
        if self.show.shown:
            yield "show", self.show.toggle

    def status(self) -> Mapping[str, object]:
        """Return the path that was written last."""
        return {"captured": str(self.show.made or "")}

    @property
    def patience(self) -> float:
        """How long nothing needs to be done here [s]."""
        return math.inf if self.show.working is None else _POLL_INTERVAL

    def take(self) -> None:
        """Take in how far the job is."""
        self.show.poll()

    def draw_over(self) -> None:
        """Draw the dialog, while it is open."""
        draw_show(self.show, self._theme())

    def update(self, *, idle: bool) -> None:
        """Take what the last picture took."""
        self.show.follow()

    def close(self) -> None:
        """Stop the job that is at work."""
        self.show.close()


def open_addition(host: Host) -> Showing:
    """Return what a window shows to others."""
    return Showing(host)


def check_request(request: Mapping[str, object]) -> None:
    """Accept every request: none names what is shown to others."""


def _toggle(bench: Workbench) -> None:
    for addition in bench.additions:
        if isinstance(addition, Showing):
            addition.toggle()


KEYS = (Key(imgui.Key.c, "C", "show: a picture, turntable, film, web page, mesh", _toggle),)
"""The key of the dialog."""

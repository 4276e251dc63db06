"""What a room that can be removed adds to a live session and its window."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from playground.studio.start.page import Card

Layer = tuple[str, Callable[[], None]]
"""The name of something open, and what closes it."""


class FullScreen(Protocol):
    """What fills a window in place of its panels, around and over the picture.

    ``room``: where the picture is, as x, y from above, width, height, in the window's units.
    """

    name: str  # in notices of what failed, as "the presentation"

    def area(self, pixels: tuple[int, int]) -> tuple[int, int, int, int]:
        """Return where the picture is: x, y from below, width, height [pixels]."""

    def act(self, room: tuple[float, float, float, float]) -> bool:
        """Act on keys and mouse; return whether the mouse is for the picture."""

    def turned(self) -> bool:
        """Return whether something else is shown since the last call; its picture is drawn a frame later."""

    def draw(self, pixels: tuple[int, int], density: float, room: tuple[float, float, float, float]) -> None:
        """Draw what is around and over the picture; ``density``: pixels a unit."""


class Addition:
    """What a room adds to a window; each method adds nothing unless a room's own does."""

    name = ""  # in notices of what failed, as "the lesson"
    button = ""  # the label of the button at the top of the panel, which calls ``toggle``
    button_note = ""

    def begin(self, request: Mapping[str, object]) -> None:
        """Do what the command that opened the window asks for, by name.

        Names are those of the room's options.
        """

    def toggle(self) -> None:
        """Show what the button is for, or hide it."""

    def layers(self) -> Iterable[Layer]:
        """Return what is open that Esc closes, topmost first; all of it lies below the window's own."""
        return ()

    def popups(self) -> Iterable[Layer]:
        """Return the open windows of its own, topmost first: Esc closes them before the window's panels."""
        return ()

    def start_cards(self) -> Iterable[Card]:
        """Return what it adds to the start page, as lessons."""
        return ()

    def status(self) -> Mapping[str, object]:
        """Return fields of the status, as JSON has them."""
        return {}

    @property
    def patience(self) -> float:
        """How long nothing needs to be done here [s]."""
        return math.inf

    @property
    def has_keys(self) -> bool:
        """Whether a window of its own has the keyboard: the keys of the window but Esc are not asked for."""
        return False

    @property
    def shows_own(self) -> bool:
        """Whether the sketch that is shown is the room's, and not the user's."""
        return False

    @property
    def full_screen(self) -> FullScreen | None:
        """What fills the window now; None while nothing does."""
        return None

    def take(self) -> None:
        """Do what was asked from outside, before a frame."""

    def draw_panel(self) -> float:
        """Draw a panel at the window's left side; return the width it takes, in the window's units."""
        return 0.0

    def draw_over(self) -> None:
        """Draw windows of its own, over the picture."""

    def update(self, *, idle: bool) -> None:
        """Update after a frame; ``idle``: there is time to compute."""

    def release(self) -> None:
        """Release what was made in the session's context; it is made again where it is needed."""

    def close(self) -> None:
        """Close what outlives frames, as servers."""

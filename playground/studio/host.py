"""The window that additions of rooms are in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from playground.studio.bench import Workbench
from playground.studio.edits.autosave import Autosave
from playground.studio.theme import Theme


@dataclass(frozen=True)
class Host:
    """What an addition may use of its window."""

    bench: Workbench
    autosave: Autosave
    remember: Callable[[], None]  # stores what is shown, for the next start
    wake: Callable[[], None]  # ends the window's sleep, from any thread
    theme: Callable[[], Theme]

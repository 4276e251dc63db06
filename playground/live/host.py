"""The window that additions of rooms are in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from playground.live.theme import Theme
from playground.workbench.autosave import Autosave
from playground.workbench.bench import Workbench


@dataclass(frozen=True)
class Host:
    """What an addition may use of its window."""

    bench: Workbench
    autosave: Autosave
    remember: Callable[[], None]  # stores what is shown, for the next start
    wake: Callable[[], None]  # ends the window's sleep, from any thread
    theme: Callable[[], Theme]

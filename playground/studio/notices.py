"""Sentences on the screen, each for a few seconds."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

SECONDS = 6.0
"""[s] that a notice stays on the screen."""
_MAX_NOTICES = 5


@dataclass
class Notice:
    """A message on the screen for a while."""

    text: str
    until: float  # by the clock of ``Notices``


@dataclass
class Notices:
    """The notices on the screen."""

    now: Callable[[], float] = time.perf_counter
    items: list[Notice] = field(default_factory=list)

    def say(self, text: str) -> None:
        """Put a message on the screen; the same one again only stays longer."""
        self.drop(text)
        self.items = [*self.items[1 - _MAX_NOTICES :], Notice(text, self.now() + SECONDS)]

    def drop(self, start: str) -> None:
        """Remove notices that begin with a text."""
        self.items = [notice for notice in self.items if not notice.text.startswith(start)]

    def take(self, *queues: deque[str]) -> None:
        """Show what is in queues, emptying them, and remove what has been on the screen long enough."""
        for queue in queues:
            while queue:
                self.say(queue.popleft())
        self.items = [notice for notice in self.items if notice.until > self.now()]

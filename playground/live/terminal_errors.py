"""Tell the terminal that a window was started from what is wrong, each error once while it lasts."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from playground.errors import Diagnostic
from playground.terminal import complain


class TerminalErrors:
    """What the terminal has been told of the errors that the window shows."""

    def __init__(self, tell: Callable[[str], None] = complain) -> None:
        self._tell = tell
        self._told: frozenset[Diagnostic] = frozenset()

    def take(self, errors: Iterable[Diagnostic]) -> None:
        """Tell of the errors that were not there the last time; one that was fixed may come again."""
        now = dict.fromkeys(errors)
        for diagnostic in now:
            if diagnostic not in self._told:
                self._tell(str(diagnostic))
        self._told = frozenset(now)

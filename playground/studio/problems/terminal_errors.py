"""Print what is wrong on the terminal that a window was started from, each error once while it lasts."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Callable, Iterable

from playground.errors import Diagnostic

to_log = logging.getLogger("playground.studio").error
"""Without a command line: Python's log ends on standard error."""


class TerminalErrors:
    """What the terminal has reported of the errors that the window shows; ``tell`` prints there."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self._tell = tell
        self._reported: frozenset[Diagnostic] = frozenset()

    def take(self, errors: Iterable[Diagnostic]) -> None:
        """Print the errors that were not there the last time; one that was fixed may come again.

        Where the terminal is gone, nothing is printed; the window shows them all the same.
        """
        now = dict.fromkeys(errors)
        with contextlib.suppress(OSError, ValueError):
            for diagnostic in now:
                if diagnostic not in self._reported:
                    self._tell(str(diagnostic))
        self._reported = frozenset(now)

"""Stop a long run of a loop that follows the time, so that a window can answer before it goes on."""

from __future__ import annotations

import time
from collections.abc import Callable

_EVERY = 4  # iterations between two looks at the clock, for which the graphics card is waited for


class Unfinished(Exception):
    """A loop was stopped by an engine's ``patience``: nothing is wrong, the next frame goes on."""

    def __init__(self, done: int, wanted: int) -> None:
        super().__init__(f"{done} of {wanted} iterations have run")
        self.done = done
        self.wanted = wanted


class Deadline:
    """When loops that follow the time are to stop; with None never.

    ``finish`` waits for the graphics card, which otherwise has the work still before it.
    """

    def __init__(self, seconds: float | None, finish: Callable[[], None]) -> None:
        self._end = None if seconds is None else time.perf_counter() + seconds
        self._finish = finish

    def check(self, ran: int, done: int, wanted: int) -> None:
        """Raise ``Unfinished`` where time is over and iterations are left; ``ran`` are those of this run."""
        if self._end is None or done >= wanted or ran % _EVERY:
            return
        self._finish()
        if time.perf_counter() > self._end:
            raise Unfinished(done, wanted)

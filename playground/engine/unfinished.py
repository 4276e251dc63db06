"""Stop a long run of passes, or of a loop that follows the time, so that a window can answer meanwhile."""

from __future__ import annotations

import time
from collections.abc import Callable

_EVERY = 4  # iterations between two looks at the clock, for which the graphics card is waited for


class Unfinished(Exception):
    """A loop was stopped by an engine's ``patience``: nothing is wrong, the next frame goes on."""

    def __init__(self, done: int, total: int) -> None:
        super().__init__(f"{done} of {total} iterations have run")
        self.done = done
        self.total = total


class PassesUnfinished(Exception):
    """A picture was stopped between two passes by an engine's ``piece``: the next goes on."""


class Piece:
    """What stops a picture between two passes: where ``over`` says that time is; with None nothing.

    One pass runs at least. ``finish`` waits for the graphics card.
    """

    def __init__(self, over: Callable[[], bool] | None, finish: Callable[[], None]) -> None:
        self._over = over
        self._finish = finish
        self._ran = False

    def check(self) -> None:
        """Raise ``PassesUnfinished`` before a pass runs, where another did and time is over."""
        if self._over is not None and self._ran:
            self._finish()
            if self._over():
                raise PassesUnfinished
        self._ran = True


class Deadline:
    """When loops that follow the time are to stop; with None never.

    ``finish`` waits for the graphics card, which otherwise has the work still before it.
    """

    def __init__(self, seconds: float | None, finish: Callable[[], None]) -> None:
        self._end = None if seconds is None else time.perf_counter() + seconds
        self._finish = finish

    def check(self, ran: int, done: int, total: int) -> None:
        """Raise ``Unfinished`` where time is over and iterations are left; ``ran`` are those of this run."""
        if self._end is None or done >= total or ran % _EVERY:
            return
        self._finish()
        if time.perf_counter() > self._end:
            raise Unfinished(done, total)

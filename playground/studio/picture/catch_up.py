"""Draw pieces of a long run of a loop that follows the time, so that the window answers meanwhile.

After a jump in time, or where a frame takes longer than its 1/60 s, each picture runs for a short time
and shows how far that came; the sketch's clock waits until it is there. It waits likewise while a
source is at work: then the last picture stays.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from playground.engine.engine import Engine
from playground.engine.unfinished import SourceUnfinished, Unfinished

if TYPE_CHECKING:
    import moderngl

PIECE = 0.1
"""[s] that loops may run for one picture."""
_TRIES = 4  # at earlier times: of several loops, each may have come less far


class CatchUp:
    """How far the picture is behind the clock."""

    def __init__(self, now: Callable[[], float] = time.perf_counter) -> None:
        self.behind: tuple[int, int] | None = None  # iterations that have run, and those that are wanted
        self.source = ""  # the path of the source that is at work, whose parts those are then
        self._now = now
        self._since = 0.0

    @property
    def seconds(self) -> float:
        """How long it has been behind [s]."""
        return self._now() - self._since if self.behind else 0.0

    def draw(
        self, engine: Engine, seconds: float, draw: Callable[[float], moderngl.Texture], *, in_full: bool
    ) -> moderngl.Texture | None:
        """Return the picture at a time [s], or ``in_full`` unset at an earlier one that was reached.

        ``draw`` draws the picture of a time; None is returned where the loops need more time for any, and
        while a source is at work.
        """
        before = self.behind
        self.behind, self.source, at = None, "", seconds
        engine.options.patience = None if in_full else PIECE
        try:
            for _ in range(1 + _TRIES):
                try:
                    return draw(at)
                except SourceUnfinished as stopped:
                    self.behind, self.source = (stopped.done, stopped.total), stopped.path
                    self._since = self._since if before else self._now()
                    return None
                except Unfinished as stopped:
                    at *= stopped.done / stopped.total
                    if self.behind is None:
                        self.behind = stopped.done, stopped.total
                        self._since = self._since if before else self._now()
            return None
        finally:
            engine.options.patience = None

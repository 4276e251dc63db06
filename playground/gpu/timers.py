"""Time a stretch of OpenGL work.

On a GPU by timer queries, which are never nested. On software renderers queries are
wrong (a draw of 275 ms reads 1 ms), so there it is the wall clock between two
``finish()`` calls. Only while profiling: both slow a frame down.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import moderngl

WALL, QUERY = "wall clock", "GPU timer"


class Timer:
    """Measure stretches of work on one context."""

    def __init__(self, ctx: moderngl.Context, *, software: bool) -> None:
        self._ctx = ctx
        self._query = None if software else ctx.query(time=True)
        self._open = False
        self.clock = WALL if software else QUERY  # which clock the figures come from

    @contextmanager
    def measure(self, into: dict[str, float], name: str) -> Iterator[None]:
        """Add the milliseconds that the block takes to ``into[name]``; blocks may not be nested."""
        if self._open:
            raise RuntimeError("a timer measures one stretch at a time")
        self._open = True
        try:
            if self._query is not None:
                with self._query:
                    yield
                spent = self._query.elapsed / 1e6
            else:
                self._ctx.finish()
                start = time.perf_counter()
                yield
                self._ctx.finish()
                spent = (time.perf_counter() - start) * 1e3
            into[name] = into.get(name, 0.0) + spent
        finally:
            self._open = False

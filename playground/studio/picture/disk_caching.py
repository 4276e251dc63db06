"""Cache a session's expensive terrain on disk while its picture does not change: see ``engine.disk_caching``.

Nothing is cached of a picture in which a number is not finite: the passes would not run the next
time, and which of them made it would not be found.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from playground.engine.disk_cache import disk_cache_for
from playground.engine.disk_caching import DiskCaching
from playground.engine.engine import Engine

if TYPE_CHECKING:
    from playground.studio.inspect.inspection import Inspection
    from playground.studio.problems.non_finite import FiniteWatch
    from playground.studio.session import Session


class SessionCaching:
    """What one session caches, and reads back; ``limit`` in bytes, 0 for neither."""

    def __init__(self, session: Session, limit: int) -> None:
        self.patience: float | None = None  # [s] until there is something to do; None: nothing is
        self._session = session
        self._limit = limit
        self._reported = ""
        self._full_at = -1  # how many pictures there were when all passes were run last
        self.attach(session.engine)

    def attach(self, engine: Engine) -> None:
        """Have an engine use the disk cache, from its next frame on."""
        if self._limit:
            engine.disk_caching = DiskCaching(disk_cache_for(engine.info, self._limit))

    def update(self, inspection: Inspection, finite: FiniteWatch) -> None:
        """Do a piece of what is to be done, if it is time to."""
        session, caching = self._session, self._session.engine.disk_caching
        self.patience = None
        if caching is None or session.plan is None or session.awaits_data:
            return
        caching.skips = not (inspection.graph.touched or inspection.inspector.on)
        if caching.skipped and not caching.skips and self._full_at != session.draws:
            self._full_at = session.draws
            session.redraw()
            return
        checked = finite.patience is None and not finite.non_finite
        if caching.going or (checked and not session.drafts.testing and not session.is_preview):
            self.patience = caching.look(session.engine, session.plan)
        if caching.store.trouble != self._reported:
            self._reported = caching.store.trouble
            session.notes.append(self._reported)

    def close(self) -> None:
        """Wait until all is written that was read back."""
        if self._session.engine.disk_caching is not None:
            self._session.engine.disk_caching.close()

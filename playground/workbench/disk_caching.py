"""Keep a session's expensive land on disk while its picture rests: see ``engine.disk_caching``.

Of a picture in which a number is not finite nothing is kept: the passes would not run the next
time, and nobody would be told which of them made it.
"""

from __future__ import annotations

from playground.engine.disk_cache import disk_cache_for
from playground.engine.disk_caching import DiskCaching
from playground.engine.engine import Engine
from playground.workbench.actions import Actions
from playground.workbench.non_finite import FiniteWatch
from playground.workbench.session import Session


class Storing:
    """What one session keeps, and takes from there; ``limit`` in bytes, 0 for neither."""

    def __init__(self, session: Session, limit: int) -> None:
        self.patience: float | None = None  # [s] until there is something to do; None: nothing is
        self._session = session
        self._limit = limit
        self._told = ""
        self._asked = -1  # how many pictures there were when all passes were asked for last
        self.attach(session.engine)

    def attach(self, engine: Engine) -> None:
        """Have an engine keep its land, from its next frame on."""
        if self._limit:
            engine.disk_caching = DiskCaching(disk_cache_for(engine.info, self._limit))

    def turn(self, actions: Actions, finite: FiniteWatch) -> None:
        """Do a piece of what is to be done, if it is time to."""
        session, keeping = self._session, self._session.engine.disk_caching
        self.patience = None
        if keeping is None or session.plan is None or session.awaits_data:
            return
        keeping.skips = not (actions.see.graph.on or actions.see.inspector.on)
        if keeping.skipped and not keeping.skips and self._asked != session.draws:
            self._asked = session.draws
            session.redraw()
            return
        looked_at = finite.patience is None and not finite.found
        if keeping.going or (looked_at and not session.drafts.testing and not session.is_preview):
            self.patience = keeping.look(session.engine, session.plan)
        if keeping.store.trouble != self._told:
            self._told = keeping.store.trouble
            session.notes.append(self._told)

    def close(self) -> None:
        """Wait until all is written that was read back."""
        if self._session.engine.disk_caching is not None:
            self._session.engine.disk_caching.close()

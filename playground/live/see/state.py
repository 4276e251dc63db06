"""What is shown beside the picture: what keys and buttons switch, without a screen."""

from __future__ import annotations

from dataclasses import dataclass, field

from playground.live.see.inspector import Inspector
from playground.live.see.record import Record
from playground.live.session import Session


@dataclass
class See:
    """What one session shows of itself."""

    session: Session
    inspector: Inspector = field(init=False)
    record: Record = field(default_factory=Record)
    costs_shown: bool = False  # the costs are on the screen in this turn
    _recorded: int = -1  # the picture that was taken in last

    def __post_init__(self) -> None:
        self.inspector = Inspector(self.session)

    def begin(self) -> None:
        """Begin a turn: nothing is on the screen yet."""
        self.costs_shown = False

    def look(self) -> None:
        """Take in the turn's picture; passes are timed only while somebody looks at the times."""
        session = self.session
        engine, before = session.engine, self._recorded
        if self.costs_shown and engine.profiling and session.draws != before and before >= 0:
            self.record.add(engine.times, engine.texels, engine.triangles)
        self._recorded = session.draws
        if engine.profiling and not self.costs_shown:
            self.record.clear()
            session.times.clear()
        engine.profiling = self.costs_shown

    def release(self) -> None:
        """Give back what was made in the engine's context; it is made again where it is needed."""
        self.inspector.release()

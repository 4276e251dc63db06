"""The state of the inspection tools: what keys and buttons switch, without a screen."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from playground.studio.compare.compare import PERIOD, Compare, Mode
from playground.studio.cost.costs import Record, RunReasons
from playground.studio.graph.graph import THUMBNAIL_INTERVAL, Graph
from playground.studio.inspect.histogram import Colour, Counter, colours_of
from playground.studio.inspect.inspector import Inspector
from playground.studio.session import Session


@dataclass
class Inspection:
    """The inspection tools of one session."""

    session: Session
    inspector: Inspector = field(init=False)
    record: Record = field(default_factory=Record)
    reasons: RunReasons = field(default_factory=RunReasons)
    costs_shown: bool = False  # the costs are on the screen in this frame
    costs_asked: bool = False  # the panel is to open the costs, and to scroll to them
    counter: Counter = field(init=False)
    compare: Compare = field(init=False)
    graph: Graph = field(init=False)
    spread_shown: bool = False  # the histogram is on the screen in this frame
    logarithmic: bool = False
    _colours: dict[int, tuple[Colour, ...]] = field(default_factory=dict)  # of each ramp that was shown
    _recorded: int = -1  # the picture that was taken in last

    def __post_init__(self) -> None:
        self.inspector = Inspector(self.session)
        self.counter = Counter(self.session)
        self.compare = Compare(self.session)
        self.graph = Graph(self.session)

    def patience(self, now: float) -> float:
        """Return how long nothing needs to be done here [s], at a moment of the clock that flickers."""
        if (self.spread_shown and self.counter.waits) or self.graph.reads:
            return 0.0
        if self.compare.on and self.compare.mode is Mode.FLICKER:
            return min(PERIOD - now % PERIOD, THUMBNAIL_INTERVAL if self.graph.waits else math.inf)
        return THUMBNAIL_INTERVAL if self.graph.waits else math.inf

    def begin(self) -> None:
        """Begin a frame: nothing is on the screen yet."""
        self.costs_shown = self.spread_shown = False
        self.session.picture.needs_all_pixels = self.inspector.on

    def update(self) -> None:
        """Record the last picture: why its passes ran, and its costs.

        Passes are timed only while their times are shown.
        """
        session = self.session
        engine, before = session.engine, self._recorded
        if self.costs_shown and engine.options.profiling and session.draws != before and before >= 0:
            self.record.add(engine.record.times, engine.record.texels, engine.record.triangles)
        self._recorded = session.draws
        if engine.options.profiling and not self.costs_shown:
            self.record.clear()
            session.times.clear()
        engine.options.profiling = self.costs_shown
        self.reasons.add(engine.record)
        if self.spread_shown:
            self.counter.go_on()
        else:
            self.counter.stop()

    def colours(self, ramp: int) -> tuple[Colour, ...]:
        """Return the colours of a map's ramp, read from the graphics card once."""
        if ramp not in self._colours:
            with self.session.engine.borrowed():
                self._colours[ramp] = colours_of(self.session.engine.ctx, ramp)
        return self._colours[ramp]

    def release(self) -> None:
        """Release what was made in the engine's context; it is made again where it is needed."""
        self.inspector.release()
        self.counter.stop()
        self.compare.release()
        self.graph.release()

"""The state of the inspection tools: what keys and buttons switch, without a screen."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from playground.sketch.model import Sketch
from playground.studio.compare.compare import PERIOD, Compare, Mode
from playground.studio.cost.costs import Record, RunReasons
from playground.studio.graph.pass_graph import Wiring, wiring_of
from playground.studio.inspect.histogram import Counter
from playground.studio.inspect.inspector import Inspector
from playground.studio.inspect.legend import Colour, colours_of
from playground.studio.inspect.thumbnails import APART, Thumbnails
from playground.studio.session import Session


@dataclass
class Graph:
    """The window of the passes."""

    session: Session
    on: bool = False
    inner: bool = False  # passes inside techniques, too
    timed: bool = False
    _stale: bool = False
    _wiring: tuple[object, bool, Wiring] | None = None  # of which sketch's passes, with those inside
    thumbnails: Thumbnails = field(init=False)

    def __post_init__(self) -> None:
        self.thumbnails = Thumbnails(self.session)

    def toggle(self) -> None:
        """Show or hide the passes."""
        self.on = not self.on

    def wiring(self, sketch: Sketch) -> Wiring:
        """Return the graph of a sketch; worked out once for each."""
        if self._wiring is None or self._wiring[0] is not sketch.graph or self._wiring[1] != self.inner:
            self._wiring = sketch.graph, self.inner, wiring_of(sketch, inner=self.inner)
        return self._wiring[2]

    def update(self, now: float) -> None:
        """Draw one stale thumbnail; release all while the graph is hidden."""
        sketch = self.session.sketch
        if not self.on or sketch is None:
            self._stale = False
            self.thumbnails.release()
        else:
            self._stale = self.thumbnails.refresh(self.wiring(sketch).refs.values(), now)

    @property
    def waits(self) -> bool:
        """Whether thumbnails are still to be drawn."""
        return self.on and self._stale


@dataclass
class Inspection:
    """The inspection tools of one session."""

    session: Session
    inspector: Inspector = field(init=False)
    record: Record = field(default_factory=Record)
    reasons: RunReasons = field(default_factory=RunReasons)
    costs_shown: bool = False  # the costs are on the screen in this frame
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
        if self.spread_shown and self.counter.waits:
            return 0.0
        if self.compare.on and self.compare.mode is Mode.FLICKER:
            return min(PERIOD - now % PERIOD, APART if self.graph.waits else math.inf)
        return APART if self.graph.waits else math.inf

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
        self.graph.thumbnails.release()

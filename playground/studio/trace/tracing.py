"""Trace the texel under the mouse, or one that is pinned, whenever the picture or the choice changes.

A traced text is compiled in a sandbox of its own first, where there is one: so the window does not wait, and
the driver's cache has the program when it is traced here. Nothing is traced while a preview is shown, while a
save is checked, or sooner after a long trace than ``_REST`` times what that took.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import InitVar, dataclass, field
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from playground.engine.non_finite import NotFinite
from playground.engine.plan import Plan, Step
from playground.engine.sandbox import SandboxReport, TrySketch, TryTrace
from playground.engine.trace.model import Event, Trace
from playground.engine.trace.probe import Probe, ProbeMap, map_of
from playground.errors import PlaygroundError
from playground.sketch.model import ComputeVariant, CpuSource, Draw, PlainFragment, TexelKernel
from playground.sketch.variants import canonical_path
from playground.studio.inspect.inspector import Inspector, Pixel
from playground.studio.language import numeral, tr
from playground.studio.reload.stages import refusal
from playground.studio.session import Session
from playground.studio.trace.rows import Selection, TraceView

if TYPE_CHECKING:
    import moderngl

_REST = 3.0  # times what a trace took, before the next one
_PATIENCE = 0.1  # [s] between questions to the sandbox, whose answer wakes the window


class TraceSandbox(Protocol):
    """What compiles traced texts in a process of its own: an ``engine.sandbox.Sandbox``, or a test's fake."""

    def submit(self, request: TrySketch | TryTrace) -> object:
        """Submit a request; it replaces the one before."""

    def poll(self) -> SandboxReport | None:
        """Return the answer to the newest request, once."""


class Beside(Enum):
    """What a trace is compared with."""

    NOTHING = "nothing"
    KEPT = "kept"
    SAVE = "last save"


@dataclass(frozen=True)
class Spot:
    """A texel of a pass."""

    path: str  # "light.visibility"
    texel: tuple[int, int]  # column and row, from the south-west

    def __str__(self) -> str:
        return tr("{path} at {column}, {row}", path=self.path, column=self.texel[0], row=self.texel[1])


@dataclass
class Choice:
    """What is chosen to be traced, of one sketch."""

    sketch: Path | None = None
    pin: tuple[float, float] | None = None  # a place in fractions of the picture; None: the mouse
    spot: Spot | None = None  # a texel that was chosen by number
    pass_name: str = ""  # that is traced; "": what the picture shows
    function: str | None = None  # None: the pass's own; "all", or a name
    iteration: int | None = None  # of a repeated pass, from 0; None: the last
    plain: set[str] = field(default_factory=set)  # passes that are traced in their plain form


@dataclass
class Caret:
    """The line that is looked at."""

    file: str = ""
    line: int = 0  # from 1; 0: none
    is_asked: bool = False  # it is to be shown


@dataclass
class Compared:
    """What a trace is compared with."""

    beside: Beside = Beside.NOTHING
    kept: Trace | None = None
    before: Trace | None = None  # the last save


@dataclass
class ProbeField:
    """An expression that is shown in every texel."""

    expression: str = ""
    message: str = ""  # what the map shows, or why there is none
    coming: ProbeMap | None = None  # shown once the sandbox has compiled it
    find: ProbeMap | None = None  # whose first texel is looked for in the next picture


@dataclass
class Compiler:
    """What compiles traced texts, and what it has answered."""

    sandbox: TraceSandbox | None = None
    compiles: str = ""  # what of, now
    tried: object = None  # the program
    ready: set[object] = field(default_factory=set)  # programs that it has compiled
    refused: dict[object, str] = field(default_factory=dict)  # programs that it could not run


@dataclass
class Seek:
    """What the next trace is to show."""

    not_finite: bool = False  # its first event that is not finite
    run: int = 0  # this run, from 1, of the caret's line


@dataclass
class Under:
    """What is under the mouse or the pin."""

    inspector: Inspector
    pixel: Pixel | None = None
    spots: tuple[Spot, ...] = ()  # what the picture shows first
    of: object = None  # pixel and picture that they are of


@dataclass
class Last:
    """The last trace."""

    count: int = 0  # made so far
    of: object = None  # what was chosen
    free_at: float = 0.0  # when the next one may be made


@dataclass
class Tracing:
    """The traces of one session."""

    session: Session
    sandbox: InitVar[TraceSandbox | None] = None
    now: Callable[[], float] = time.perf_counter
    on: bool = False
    view: TraceView | None = None
    message: str = ""  # why there is no trace of what is chosen
    selection: Selection = field(default_factory=Selection)
    choice: Choice = field(default_factory=Choice)
    caret: Caret = field(default_factory=Caret)
    compared: Compared = field(default_factory=Compared)
    probe: ProbeField = field(default_factory=ProbeField)
    seek: Seek = field(default_factory=Seek)
    last: Last = field(default_factory=Last)
    compiler: Compiler = field(init=False)
    under: Under = field(init=False)

    def __post_init__(self, sandbox: TraceSandbox | None) -> None:
        self.compiler = Compiler(sandbox)
        self.under = Under(Inspector(self.session, inner=True))

    def release(self) -> None:
        """Release what was made in the engine's context."""
        self.under.inspector.release()

    # ── choosing ─────────────────────────────────────────────────────────────

    def toggle(self) -> None:
        """Switch tracing on or off; off leaves nothing but the choice."""
        self.on = not self.on
        if not self.on:
            self.view, self.last.of, self.under.of, self.under.spots = None, None, None, ()
            self.message = self.compiler.compiles = ""
            if isinstance(self.session.view.map, ProbeMap):
                self.session.show(None)

    def point(self, pixel: Pixel) -> None:
        """Trace what is under a pixel of the picture, unless a place is pinned."""
        if not self.is_pinned:
            self.under.pixel = pixel

    def pin_at(self, pixel: Pixel, size: tuple[int, int]) -> None:
        """Pin a pixel of the picture, of a size."""
        self.choice.pin = (pixel[0] + 0.5) / size[0], (pixel[1] + 0.5) / size[1]
        self.choice.spot = None

    def follow(self) -> None:
        """Follow the mouse again."""
        self.choice.pin = self.choice.spot = None

    def keep(self) -> None:
        """Keep the trace that is shown, to compare others with it."""
        if self.view is not None:
            self.compared.kept, self.compared.beside = self.view.trace, Beside.KEPT
            self._show(self.view.trace)

    def compare(self, beside: Beside) -> None:
        """Show the values of another trace beside those of this one."""
        self.compared.beside = beside
        if self.view is not None:
            self._show(self.view.trace)

    def record(self, function: str | None) -> None:
        """Trace other functions: the pass's own, "all", or one."""
        self.choice.function = function

    def trace_not_finite(self, first: NotFinite) -> None:
        """Trace a texel that is not finite, and go to where its run first is not."""
        plan = self.session.plan
        path = _public_path(plan, first.path) if plan is not None else first.path
        self.on, self.seek.not_finite = True, True
        self.choice.pin, self.choice.pass_name, self.choice.spot = None, path, Spot(path, first.texel)

    def go_to_not_finite(self) -> None:
        """Show the first event that is not finite."""
        event = self.view.trace.first_not_finite() if self.view is not None else None
        if event is not None:
            self.go_to(event)
        elif self.on:
            others = tr("; record all functions") if self.choice.function != "all" else ""
            self.message = tr("no recorded value is NaN or infinite") + others

    def go_to_difference(self) -> None:
        """Show the first event that differs from the other trace."""
        if self.view is not None and self.view.difference is not None:
            here, there = self.view.difference
            if here is not None:
                self.go_to(here)
            elif there is not None:
                self.caret.file, self.caret.line, self.caret.is_asked = there.path, there.line, True

    def go_to(self, event: Event) -> None:
        """Show an event's line, in its call and its iterations."""
        if self.view is not None:
            self.view.go_to(event)
            self.caret.file, self.caret.line, self.caret.is_asked = event.path, event.line, True

    def mark(self, size: tuple[float, float]) -> tuple[float, float] | None:
        """Return where in a picture of a size the pinned texel is, in fractions; None where it is not."""
        if self.choice.pin is not None or self.choice.spot is None:
            return self.choice.pin
        shown = self.session.view.map
        if shown is None:
            return None
        path = shown.probe.path if isinstance(shown, ProbeMap) else shown.ref.partition(":")[0]
        result = self.session.result_of(shown.ref)
        if result is None or canonical_path(path) != self.choice.spot.path:
            return None
        texels, worst = result[0].size, max(n / side for n, side in zip(result[0].size, size, strict=True))
        x, y = ((t + 0.5 - n / 2) / worst for t, n in zip(self.choice.spot.texel, texels, strict=True))
        return 0.5 + x / size[0], 0.5 + y / size[1]

    def other(self) -> Trace | None:
        """Return the trace that the one shown is compared with."""
        return {Beside.KEPT: self.compared.kept, Beside.SAVE: self.compared.before}.get(self.compared.beside)

    @property
    def spot(self) -> Spot | None:
        """The texel that is traced, or is to be."""
        if self.choice.spot is not None:
            return self.choice.spot
        named = [spot for spot in self.under.spots if spot.path == self.choice.pass_name]
        return next(iter(named or self.under.spots), None)

    def choose_pass(self, name: str) -> None:
        """Trace another pass, at its texel of the same place."""
        self.choice.pass_name, self.choice.spot, self.choice.iteration = name, None, None
        self.view, self.caret.file, self.caret.line = None, "", 0

    def open(self, file: str) -> None:
        """Show a file, at the first call in it."""
        lines = [call.line for call in self.view.trace.calls if call.path == file] if self.view else []
        self.caret.file, self.caret.line, self.caret.is_asked = file, min(lines, default=1), True

    @property
    def can_be_plain(self) -> bool:
        """Whether the chosen pass runs as a compute shader, and has a plain form that can be traced."""
        step = self._step(self.spot) if self.spot is not None else None
        chosen = self.spot is not None and self.spot.path not in self.choice.plain
        return chosen and step is not None and isinstance(step.kernel, ComputeVariant)

    def trace_plain(self) -> None:
        """Trace the plain form of the chosen pass, which runs for it first."""
        if self.spot is not None:
            self.choice.plain.add(self.spot.path)

    def pin_here(self) -> None:
        """Pin the texel that is traced."""
        self.choice.spot = self.spot

    @property
    def is_pinned(self) -> bool:
        """Whether the mouse changes nothing."""
        return self.choice.pin is not None or self.choice.spot is not None

    @property
    def is_stale(self) -> bool:
        """Whether the values that are shown are not those of what is chosen."""
        return bool(self.compiler.compiles or self.message)

    @property
    def repeats(self) -> int:
        """How many steps the traced pass takes; 1 for one that does not repeat."""
        step = self._step(self.spot) if self.spot is not None else None
        return step.repeat if step is not None else 1

    # ── a frame ──────────────────────────────────────────────────────────────

    def status(self) -> dict[str, object]:
        """Return what is traced, as JSON has it; nothing while tracing is off."""
        if not self.on:
            return {}
        trace = self.view.trace if self.view is not None else None
        parts = self.view.difference if self.view is not None else None
        return {
            "spot": str(self.spot or ""),
            "texel": list(trace.texel) if trace is not None else [],
            "events": len(trace.events) if trace is not None else 0,
            "exact": trace is not None and trace.is_exact,
            "traces": self.last.count,
            "line": self.caret.line,
            "compiling": self.compiler.compiles,
            "message": self.message,
            "probe": self.probe.message,
            "parts": [None if event is None else event.line for event in parts or ()],
        }

    @property
    def patience(self) -> float:
        """How long nothing needs to be done [s]."""
        if not self.on:
            return math.inf
        if self.compiler.compiles:
            return _PATIENCE
        if self.last.of != self._wanted() and self._can_trace:
            return max(self.last.free_at - self.now(), 0.0)
        return math.inf

    def update(self, picture: moderngl.Texture | None) -> None:
        """Trace, if anything has changed and it is time to; ``picture`` is what the session returned last."""
        if not self.on or picture is None:
            return
        if self.choice.sketch != self.session.path:
            self._begin(self.session.path)
        self._take_report()
        if not self._can_trace:
            return
        self._find_spots(picture)
        if self.probe.find is not None and self.probe.find == self.session.view.map:
            self._find_first()
        wanted, spot = self._wanted(), self.spot
        if wanted == self.last.of or self.now() < self.last.free_at or spot is None:
            return
        start = self.now()
        try:
            self._trace(spot, wanted)
        except PlaygroundError as error:
            self._fail(str(error), wanted)
        self.last.free_at = self.now() + _REST * (self.now() - start)

    def _begin(self, sketch: Path) -> None:
        """Begin with another sketch, of which nothing is chosen yet."""
        if self.choice.sketch is not None:
            self.choice = Choice(function=self.choice.function)
            self.compared = Compared(self.compared.beside)
            self.view, self.caret.file, self.probe.message = None, "", ""
            self.compiler.ready.clear()
            self.compiler.refused.clear()
        self.choice.sketch = sketch

    def _trace(self, spot: Spot, wanted: object) -> None:
        """Trace a texel, or have the sandbox compile the text first; raise what is wrong with either."""
        plan = self._plan_of(spot)
        step = _step_of(plan, spot.path)
        if step is None:
            self._fail(tr("the picture was made without '{path}'", path=spot.path), wanted)
        elif not is_traceable(step):
            self._fail(f"'{spot.path}' {why_not(step)}", wanted)
        else:
            program = step.kernel.source.canonical, self.choice.function
            if self.compiler.sandbox is None or program in self.compiler.ready:
                self._run(plan, spot, wanted)
            elif program in self.compiler.refused:
                self._fail(self.compiler.refused[program], wanted)
            else:
                self._compile(plan, spot, program)

    def _plan_of(self, spot: Spot) -> Plan:
        """Return the plan whose pass is traced: the picture's, but for plain forms and a probe's."""
        session, engine = self.session, self.session.engine
        last = engine.record.plan
        assert last is not None and session.sketch is not None
        # A probe's map has other outputs; what it is of runs as in the sketch's own view.
        sketch = session.sketch if isinstance(session.view.map, ProbeMap) else last.sketch
        if spot.path in self.choice.plain:
            return engine.tracer.plan(sketch, spot.path, last.frame_size, last.time, last.steps)
        return last if sketch is last.sketch else engine.plan(sketch, last.frame_size, last.time, last.steps)

    @property
    def _can_trace(self) -> bool:
        session = self.session
        moves = session.animated and session.clock.playing  # then a preview is all that there is
        waits = session.is_preview and not moves
        waits = waits or session.awaits_data or session.catch_up.behind is not None
        return session.plan is not None and session.engine.record.plan is not None and not waits

    def _wanted(self) -> object:
        session = self.session
        choice = self.spot, self.choice.function, self.choice.iteration, frozenset(self.choice.plain)
        return *choice, session.draws, id(session.engine)

    def _step(self, spot: Spot) -> Step | None:
        plan = self.session.engine.record.plan
        return _step_of(plan, spot.path) if plan is not None else None

    def _find_spots(self, picture: moderngl.Texture) -> None:
        """Find the texel of each pass that is under the mouse, or under the pin."""
        session, plan = self.session, self.session.plan
        pixel = self.under.pixel
        if self.choice.pin is not None:
            pixel = int(self.choice.pin[0] * picture.size[0]), int(self.choice.pin[1] * picture.size[1])
        key = pixel, session.draws, id(session.engine)
        if pixel is None or plan is None or key == self.under.of:
            return
        self.under.of = key
        wide, high = plan.frame_size  # fewer pixels than the picture has, in a preview
        drawn = pixel[0] * wide // picture.size[0], pixel[1] * high // picture.size[1]
        report = self.under.inspector.at(pixel, picture)
        spots: dict[str, Spot] = {}
        if session.view.map is None:
            spots["view"] = Spot("view", drawn)
        for sample in (report.shown, *report.samples) if report is not None else ():
            if sample is not None:
                path = sample.name.partition(":")[0]
                spots.setdefault(path, Spot(path, sample.texel))
        for path in plan.flat.outputs:  # as large as the picture: of other tools' shaders, passes of the view
            step = _step_of(plan, path)
            if session.view.map is None and step is not None and step.size == (wide, high):
                spots.setdefault(path, Spot(path, drawn))
        able = [spot for spot in spots.values() if is_traceable(_step_of(plan, spot.path))]
        self.under.spots = (*able, *(spot for spot in spots.values() if spot not in able))

    def _compile(self, plan: Plan, spot: Spot, program: object) -> None:
        """Have the sandbox compile the text of a spot's pass, unless it does already."""
        assert self.compiler.sandbox is not None
        if program != self.compiler.tried and self.probe.coming is None:
            self.compiler.tried, self.compiler.compiles, self.message = program, spot.path, ""
            function = self.choice.function
            self.compiler.sandbox.submit(TryTrace(plan.sketch, spot.path, function, time=plan.time))

    def _take_report(self) -> None:
        compiler = self.compiler
        report = compiler.sandbox.poll() if compiler.sandbox is not None and compiler.compiles else None
        if report is None:
            return
        coming, self.probe.coming = self.probe.coming, None
        tried, self.compiler.tried, self.compiler.compiles = self.compiler.tried, None, ""
        if coming is not None:
            self._take_probe(coming, report)
        elif tried is not None:
            refused = refusal(report)
            if refused is None:
                self.compiler.ready.add(tried)
            else:
                self.compiler.refused[tried] = str(refused)

    def _fail(self, message: str, wanted: object) -> None:
        self.message, self.last.of, self.seek.not_finite = message, wanted, False

    def _run(self, plan: Plan, spot: Spot, wanted: object) -> None:
        tracer = self.session.engine.tracer
        trace = tracer.trace(plan, spot.path, spot.texel, self.choice.iteration, self.choice.function)
        self.last.count += 1
        self.message, self.last.of = "", wanted
        before = self.view.trace if self.view is not None else None
        if before is not None and before.step == trace.step and before.files != trace.files:
            self.compared.before = before
        self._show(trace)
        if self.seek.not_finite:
            self.seek.not_finite = False
            self.go_to_not_finite()
        elif self.seek.run:
            runs = run_events(trace, self.caret.file, self.caret.line)
            run, self.seek.run = self.seek.run, 0
            if run <= len(runs):
                self.go_to(runs[run - 1])

    def _show(self, trace: Trace) -> None:
        self.view = TraceView(trace, self.selection, self.other())
        if self.caret.file not in trace.files:
            self.caret.file = next(iter(self.view.paths), "")
            head = next((call.line for call in trace.calls if call.path == self.caret.file), 0)
            self.caret.line, self.caret.is_asked = head, bool(head)

    # ── probes ───────────────────────────────────────────────────────────────

    def show_probe(self, *, find: bool = False) -> None:
        """Show the expression at the caret's line as a map; or ``find`` the first texel where it is not 0."""
        sketch, spot = self.session.sketch, self.spot
        if sketch is None or spot is None:
            return
        step = self._step(spot)  # of a fast variant the pass that runs
        path = self._own_path(spot.path if step is None or spot.path in self.choice.plain else step.path)
        probe = Probe(path, self.caret.file, self.caret.line, self.probe.expression.strip())
        try:
            probe_map = map_of(sketch, probe)
        except PlaygroundError as error:
            self.probe.message = complaint(error, probe)
            return
        self.probe.message = ""
        self.choice.pin, self.choice.spot = None, spot  # a map has another texel in that place
        self.probe.find = probe_map if find else None
        if self.compiler.sandbox is None:
            self._take_probe(probe_map, SandboxReport(True))
            return
        self.probe.coming, self.compiler.tried = probe_map, None
        self.compiler.compiles = f"'{probe.expression}'"
        self.compiler.sandbox.submit(TrySketch(probe_map.of(sketch), time=self.session.clock.time))

    def _own_path(self, path: str) -> str:
        shown_map = self.session.view.map
        return path if shown_map is None else shown_map.own_path(path)

    def _take_probe(self, probe_map: ProbeMap, report: SandboxReport) -> None:
        refused = refusal(report)
        if refused is not None:
            self.probe.message, self.probe.find = complaint(refused, probe_map.probe), None
            return
        self.session.view.show(probe_map)
        self.session.fit_map()
        self.probe.message = tr("the map shows {probe}", probe=_name_of(probe_map.probe))
        if self.probe.find is not None:
            self.probe.find = self.session.view.map if isinstance(self.session.view.map, ProbeMap) else None

    def _find_first(self) -> None:
        """Pin the first texel, row by row from the south, at which the probe is not 0."""
        probe_map, self.probe.find = self.probe.find, None
        assert probe_map is not None
        found = first_hit(self.session, probe_map)
        if found is None:
            self.probe.message = tr("{probe} is 0 or false in every texel", probe=_name_of(probe_map.probe))
            return
        texel, count, runs = found
        self.choice.pin, self.choice.spot = None, Spot(canonical_path(probe_map.probe.path), texel)
        self.seek.run = runs
        more = tr("; {count} texels in all", count=numeral(count, ",")) if count > 1 else tr("; in no other")
        first = tr("first at texel {column}, {row}, in run {runs}", column=texel[0], row=texel[1], runs=runs)
        self.probe.message = first + more


def complaint(error: PlaygroundError, probe: Probe) -> str:
    """Return why a probe does not compile: the driver's first message, without what it follows from."""
    first = error.diagnostics[0]
    if "k_see" in first.message:
        return tr(
            "'{expression}' is no number, vector or condition; probe a part of it: [0], or a member",
            expression=probe.expression,
        )
    return first.message if first.line == probe.line else str(first)


def _name_of(probe: Probe) -> str:
    return tr("{expression} after line {line}", expression=probe.expression, line=probe.line)


def run_events(trace: Trace, path: str, line: int) -> list[Event]:
    """Return one event of each run of a line."""
    events = [event for event in trace.lines(path).get(line, ()) if event.kind != "enter"]
    return [event for event in events if event.place == events[0].place]


def first_hit(session: Session, probe_map: ProbeMap) -> tuple[tuple[int, int], int, int] | None:
    """Return the first texel where a probe is not 0, how many there are, in which run; None for none."""
    hits = session.read_values(probe_map.hits_ref)
    if hits is None or not hits[..., 1].any():
        return None
    rows, columns = hits[..., 1].nonzero()
    texel = int(columns[0]), int(rows[0])
    return texel, len(rows), int(hits[texel[1], texel[0], 1])


def _step_of(plan: Plan, path: str) -> Step | None:
    """Return the step that gives the first output of a pass at any level."""
    outputs = plan.flat.outputs.get(path, {})
    ref = outputs.get(path.rpartition(".")[2]) or next(iter(outputs.values()), None)
    return plan.step(ref.path) if ref is not None else None


def _public_path(plan: Plan, leaf: str) -> str:
    """Return the path by which a sketch names a leaf, that of a fast variant's last pass too."""
    flat = plan.flat.outputs
    names = (path for path, outputs in flat.items() if any(ref.path == leaf for ref in outputs.values()))
    return leaf if leaf in flat else next(names, leaf)


def is_traceable(step: Step | None) -> bool:
    """Return whether a step has a fragment shader."""
    return step is not None and isinstance(step.kernel, TexelKernel | PlainFragment | Draw)


def why_not(step: Step) -> str:
    """Return why a step has no trace."""
    match step.kernel:
        case ComputeVariant():
            return tr("runs as a compute shader, its fast variant; its plain form can be traced")
        case CpuSource():
            return tr("is made by the processor, so it has no lines to trace; choose another pass")
    return tr("is a compute shader, which is not traced; choose another pass")

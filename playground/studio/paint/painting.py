"""The brush over the picture: strokes on an image of the sketch, stored in a file of their own.

A layer is a file parameter that its kernel lets be painted on: a mask of four weights, or one number a
texel. The file that the sketch names is never written to: painting begins a new one in the current
folder and puts it in its place.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.engine.camera import Eye, ground_under, seen_from
from playground.engine.plan import Plan, Step, view_height
from playground.engine.sources import source_kind
from playground.engine.textures import split_format
from playground.errors import DataError, PlaygroundError
from playground.sketch.assign import resolve, shown_parameters, value_of, values_of
from playground.sketch.files import find_file
from playground.sketch.flat import Ref
from playground.sketch.model import CpuSource, Parameter, Sketch
from playground.studio.language import tr
from playground.studio.paint.brush import TOOLS, Brush, Dab, Tool, rate_of
from playground.studio.paint.erode_tool import ErodeTool, technique_at
from playground.studio.paint.layer import MAX_TEXELS, NUMBERS, WEIGHTS, Layer, LayerKind
from playground.studio.session import Session

MIN_RADIUS, DEFAULT_RADIUS, MAX_RADIUS = 0.002, 0.025, 0.25
"""A brush's radius, in fractions of the terrain's longer side."""

CLICK, MAX_DAB_SECONDS = 0.05, 0.25
"""[s] How long a stroke works on the place where it begins, and at most from one frame to the next."""

MAX_SIDE_BY_FILE = 1024
"""Where the picture follows by the file only: a larger one takes longer to write than the mouse to move."""

SAVES_EVERY = 0.1
"""[s] Where the picture can follow a stroke by its file only; any file is written when the stroke ends."""


class Painting:
    """What is painted in one session."""

    def __init__(
        self,
        session: Session,
        folder: Path,
        now: Callable[[], float] = time.perf_counter,
        wake: Callable[[], None] | None = None,
    ) -> None:
        """Paint on a session's sketch; ``wake`` is called, on any thread, where ``follow`` has work."""
        self.session = session
        self.folder = folder  # where new masks go
        self.brush = Brush(radius=0.0)
        self.now = now
        self._taken = False  # painting is on
        self._layers: dict[str, Layer] = {}  # by the parameter's path
        self._targets: tuple[Sketch | None, tuple[str, ...]] = (None, ())
        self._chosen = ""
        self._heights: tuple[object, NDArray[np.float32] | None] = (None, None)  # and of which picture
        self._eroding: ErodeTool | None = None
        self._wake = wake
        self._reported: dict[Path, int] = {}  # how many writes of a layer's file have been looked at
        self._stroke: Layer | None = None  # what the stroke that goes on is painted on
        self._last: tuple[float, float] | None = None  # where the stroke is
        self._saved_at = 0.0
        self._moved_at = 0.0

    @property
    def on(self) -> bool:
        """Whether painting is on, and there is something to paint on."""
        return self._taken and bool(self.target)

    @property
    def targets(self) -> tuple[str, ...]:
        """The paths of the parameters that can be painted on, those first that a technique shows."""
        sketch = self.session.sketch
        if self._targets[0] is not sketch:
            self._targets = sketch, _painted(sketch)
        return self._targets[1]

    @property
    def target(self) -> str:
        """The path of the parameter that is painted on; "" where the sketch has none."""
        return self._chosen if self._chosen in self.targets else next(iter(self.targets), "")

    @property
    def sculpts(self) -> bool:
        """Whether what is painted on has one number a texel: it takes tools in place of layers."""
        step = self._step_of(self.target)
        return step is not None and _kind_of(step) is NUMBERS

    @property
    def tools(self) -> tuple[Tool, ...]:
        """The tools that what is painted on takes: it erodes where heights are and a technique is named."""
        return TOOLS if self.erodes_by else tuple(tool for tool in TOOLS if tool != "erode")

    @property
    def erodes_by(self) -> str:
        """The technique that erode runs, as ``use`` names it; "" where it has none, or no height."""
        brush = self._parameter().brush
        return brush.erode if brush is not None and self._adds_metres else ""

    @property
    def levels(self) -> tuple[float, float]:
        """The least and the most that flatten may be told to go to."""
        relief = self.session.plan.terrain.relief if self.session.plan else None
        return (-(relief or 0.0), 2 * relief) if relief and self._adds_metres else (-4.0, 4.0)

    @property
    def rate(self) -> float:
        """How fast raise goes [m/s], or numbers a second."""
        return self.brush.strength * rate_of(self.brush, metres=self._adds_metres)

    @property
    def _adds_metres(self) -> bool:
        step, plan = self._step_of(self.target), self.session.plan
        return step is not None and plan is not None and _ground_ref(plan, step.path) is not None

    def choose(self, target: str) -> None:
        """Paint on another parameter, by its path."""
        self.release()
        self._chosen = target
        if self.brush.tool not in self.tools:
            self.brush = replace(self.brush, tool="raise")

    @property
    def files(self) -> frozenset[Path]:
        """The masks that were begun: they need not be watched."""
        return frozenset(layer.path for layer in self._layers.values())

    @property
    def layer(self) -> Layer | None:
        """The mask that was begun for what is painted on, if it is still in its place."""
        layer, sketch = self._layers.get(self.target), self.session.sketch
        if layer is None or sketch is None:
            return None
        value = value_of(sketch, self.target, values_of(sketch))
        return layer if str(value) == str(layer.path) else None

    @property
    def side(self) -> float:
        """The terrain's longer side [m]."""
        return max(self.session.plan.terrain.extent or (0.0,)) if self.session.plan else 0.0

    def toggle(self) -> None:
        """Take the brush, or put it down."""
        if not self.target:
            self.session.notes.append(
                tr('this sketch has nothing to paint on: none of its files has the word "paint"')
            )
        self._taken = bool(self.target) and not self._taken
        if not MIN_RADIUS * self.side <= self.brush.radius <= MAX_RADIUS * self.side:
            self.brush = replace(self.brush, radius=DEFAULT_RADIUS * self.side)

    def resize(self, by: float) -> None:
        """Make the brush wider, by steps of a tenth."""
        radius = self.brush.radius * 1.1**by
        self.brush = replace(
            self.brush, radius=min(max(radius, MIN_RADIUS * self.side), MAX_RADIUS * self.side)
        )

    def strengthen(self, by: float) -> None:
        """Make the brush stronger, by steps of a twentieth of the strongest."""
        self.brush = replace(self.brush, strength=min(max(self.brush.strength + by / 20, 0.01), 1.0))

    def soften(self, by: float) -> None:
        """Make the brush fade over more of its radius, by steps of a twentieth."""
        self.brush = replace(self.brush, softness=min(max(self.brush.softness + by / 20, 0.0), 1.0))

    def take_tool(self, tool: Tool) -> None:
        """Sculpt with another tool, while the brush is on what can be sculpted."""
        if not (self.on and self.sculpts):
            return
        if tool in self.tools:
            self.brush = replace(self.brush, tool=tool)
        else:
            self.session.notes.append(
                tr("nothing to {tool} in {target}: choose another tool", tool=tr(tool), target=self.target)
            )

    def ground(self, position: tuple[float, float]) -> tuple[float, float] | None:
        """Return where on the terrain a place of the picture lies, both in fractions; None in the sky."""
        surface = self._surface()
        return ground_under(surface[0], position, *surface[1:]) if surface is not None else None

    def outline(self, position: tuple[float, float], corners: int) -> list[tuple[float, float]]:
        """Return the brush's circle as it lies on the terrain, in fractions of the picture; [] in the sky."""
        surface, middle = self._surface(), self.ground(position)
        if surface is None or middle is None:
            return []
        eye, heights, extent, relief = surface
        angles = np.linspace(0, 2 * np.pi, corners, endpoint=False)
        around = np.stack([np.cos(angles), np.sin(angles)], axis=1) * self.brush.radius
        fractions = np.clip(np.array(middle) + around / extent, 0.0, 1.0)
        return seen_from(eye, fractions, heights, extent, relief)

    def press(self, position: tuple[float, float]) -> None:
        """Begin a stroke at a place of the picture, in fractions from its lower left."""
        if self.layer is not None and not self.layer.holds():
            # Another program has removed the file, or painted on it.
            self._saved(self.layer.take_in if self.layer.path.exists() else self.layer.save)
        plan, step = self.session.plan, self._step_of(self.target)
        if self._heights[1] is None:
            self._heights = None, None  # what could not be read may be there now
        if self._height() is None and not (plan and view_height(plan)):
            self.session.notes.append(tr("the view shows no height, so there is no ground to paint on"))
        self._last = self.ground(position)
        if self._last is None:
            return
        ground = _ground_of(self.session, step.path) if step is not None and self.sculpts else None
        if ground is None and self.sculpts and self._adds_metres:
            self._last = None  # a note says why it cannot be read
            return
        layer = self._start_layer()
        if layer is not None:
            self._hand_over(layer)
            if self.sculpts:
                layer.set_base(ground)
                if self.brush.tool == "erode" and not self._erodes(layer):
                    self._last = None  # a note says why
                    return
            layer.begin()
            self._stroke = layer
            self._saved_at = -SAVES_EVERY
            self._moved_at = self.now() - CLICK
            self.move(position)

    def move(self, position: tuple[float, float]) -> None:
        """Go on with the stroke, for as long as it is since the last time; nothing where it has ended."""
        plan, layer = self.session.plan, self.layer
        if plan is None or plan.terrain.extent is None or layer is None or layer is not self._stroke:
            return
        now, at = self.ground(position), self.now()
        seconds, self._moved_at = min(at - self._moved_at, MAX_DAB_SECONDS), at
        if now is not None:
            try:
                layer.paint(Dab(self._last or now, now, plan.terrain.extent, self.brush, seconds))
            except PlaygroundError as error:
                self.session.notes.append(str(error))
                self.release()
                return
            if layer.path in self.session.engine.painted:
                self.session.redraw()
            elif at - self._saved_at >= SAVES_EVERY:
                self._saved(layer.save)
                self._saved_at = at
        self._last = now

    def release(self) -> None:
        """End the stroke; until the next press nothing is painted."""
        self._last = self._stroke = None
        if self.layer is not None and not self.layer.saved:
            self._saved(self.layer.save)

    def follow(self) -> None:
        """Report what went wrong with files that were written meanwhile, and show those that are read."""
        for layer in self._layers.values():
            ended = layer.writing.writes
            if self._reported.get(layer.path) == ended:
                continue
            self._reported[layer.path] = ended
            if layer.writing.error is not None:
                self.session.notes.append(str(layer.writing.error))
            if layer.path not in self.session.engine.painted:
                self.session.redraw()

    def settle(self) -> bool:
        """Wait until the files hold what is painted, for who is about to read them; a note says what fails.

        Return whether they do.
        """
        for layer in self._layers.values():
            if not layer.saved:
                layer.save()
        for layer in self._layers.values():
            with suppress(PlaygroundError):  # what ``follow`` reports
                layer.writing.wait()
        self.follow()
        return all(layer.saved for layer in self._layers.values())

    def close(self) -> list[str]:
        """End the stroke and wait for the files; return a message for each that could not be written."""
        self.release()
        self.settle()
        errors = (layer.writing.error for layer in self._layers.values())
        return [str(error) for error in errors if error is not None]

    def undo(self) -> None:
        """Undo the last stroke."""
        self._edit(self.layer, Layer.undo)

    def redo(self) -> None:
        """Redo the stroke that was undone last."""
        self._edit(self.layer, Layer.redo)

    def clear(self) -> None:
        """Take all paint away."""
        self._edit(self._start_layer(), Layer.clear)

    def _edit(self, layer: Layer | None, act: Callable[[Layer], None]) -> None:
        """End the stroke, change a mask and save it; what others have painted on it is read instead."""
        self.release()
        if layer is None:
            return
        if layer.holds() or not layer.path.exists():
            self._saved(lambda: act(layer))
            return
        self._saved(layer.take_in)
        self.session.notes.append(
            tr("{path} was changed by another program: it stays as it is now", path=layer.path.name)
        )

    def _saved(self, act: Callable[[], None]) -> None:
        try:
            act()
        except DataError as error:
            self.session.notes.append(str(error))
        self.session.redraw()

    def _shows(self, step: Step, path: Path, size: tuple[int, int]) -> bool:
        """Say whether the picture can show a layer from memory: a source reads it, texel for texel."""
        if not isinstance(step.kernel, CpuSource) or size != step.size:
            return False
        name = self.target.rpartition(".")[2]
        return source_kind(step.kernel.registry).picture({**step.values, name: str(path)}, size) == path

    def _hand_over(self, layer: Layer) -> None:
        """Have the picture show a layer from memory, where it can."""
        step, painted = self._step_of(self.target), self.session.engine.painted
        painted.pop(layer.path, None)
        if step is not None and self._shows(step, layer.path, layer.size):
            painted[layer.path] = layer

    def _erodes(self, layer: Layer) -> bool:
        """Have a layer erode by the technique that its parameter names, as its files are now.

        Return whether it can; a note says why not.
        """
        parameter, engine = self._parameter(), self.session.engine
        if "erode" not in self.tools:
            self.session.notes.append(
                tr("nothing to erode in {target}: choose another tool", target=self.target)
            )
            return False
        try:
            technique = technique_at(self.erodes_by, parameter.file)
            runner = self._eroding.runner if self._eroding is not None else None
            if runner is None or runner.engine is not engine or runner.technique != technique:
                self._eroding = ErodeTool(engine, technique)
        except PlaygroundError as error:
            self.session.notes.append(str(error))
            return False
        layer.eroding = self._eroding
        return True

    def _parameter(self) -> Parameter:
        """Return the parameter that is painted on; there is one."""
        assert self.session.sketch is not None
        return resolve(self.session.sketch.graph, self.target)[0].parameter

    def _step_of(self, path: str) -> Step | None:
        """Return the step of the plan whose parameter has a path."""
        sketch, plan = self.session.sketch, self.session.plan
        if not path or sketch is None or plan is None:
            return None
        return plan.step(resolve(sketch.graph, path)[0].path.rpartition(".")[0])

    def _start_layer(self) -> Layer | None:
        """Return the mask that is painted on, begun again where the sketch names another file."""
        if self.layer is not None:
            return self.layer
        path, sketch = self.target, self.session.sketch
        step = self._step_of(path)
        if sketch is None or step is None:
            return None
        leaf = resolve(sketch.graph, path)[0]
        name = re.sub(r"[^\w.-]+", "-", f"{sketch.name}-{path}").strip("-.")
        try:
            file = str(value_of(sketch, path, values_of(sketch)))
            of = find_file(file, sketch.folder, leaf.parameter.file, path) if file else None
            most = MAX_TEXELS if self._shows(step, self.folder, step.size) else MAX_SIDE_BY_FILE
            layer = Layer.create(self.folder, name, _kind_of(step), step.size, of=of, most=most)
        except PlaygroundError as error:
            self.session.notes.append(str(error))
            return None
        if path in self._layers:
            self.settle()  # another takes its place, and nobody looks after it any more
        self._layers[path] = layer
        self._reported[layer.path] = layer.writing.writes
        layer.writing.ended = self._wake or layer.writing.ended
        self.session.data.trust(layer.path)
        self.session.drafts.set(path, str(layer.path))
        self.session.notes.append(
            tr("painting on {path} in {parent}", path=layer.path.name, parent=layer.path.parent)
        )
        return layer

    def _surface(self) -> tuple[Eye, NDArray[np.float32], tuple[float, float], float] | None:
        """Return the eye, the heights, the extent [m] and the shown relief [m] of the picture's terrain."""
        plan, heights = self.session.plan, self._height()
        if plan is None or heights is None or plan.terrain.extent is None or plan.shown_relief is None:
            return None
        return plan.eye, heights, plan.terrain.extent, plan.shown_relief

    def _height(self) -> NDArray[np.float32] | None:
        """Return the heights that the picture shows, read once for each picture; a stroke moves none."""
        session = self.session
        if self._last is None and self._heights[0] != session.draws:
            ref = view_height(session.plan) if session.plan is not None else ""
            self._heights = session.draws, session.read_values(ref) if ref else None
        return self._heights[1]


def _painted(sketch: Sketch | None) -> tuple[str, ...]:
    """Return the parameters that may be painted on, those that a technique shows before those inside."""
    if sketch is None:
        return ()
    painted = [shown for shown in shown_parameters(sketch) if shown.parameter.brush is not None]
    return tuple(shown.path for shown in sorted(painted, key=lambda shown: not shown.exported))


def _kind_of(step: Step) -> LayerKind:
    """Return what is painted: a number a texel where a source gives one, else a mask."""
    outputs = step.kernel.outputs
    is_numbers = (
        isinstance(step.kernel, CpuSource) and len(outputs) == 1 and split_format(outputs[0].format)[0] == 1
    )
    return NUMBERS if is_numbers else WEIGHTS


def _ground_ref(plan: Plan, step: str) -> Ref | None:
    """Return the height under what a step gives, by its path; None: it changes no height.

    It is that of the pass that reads the step, before the change: its input ``height``.
    """
    for reader in plan.walk():
        inputs = dict(reader.inputs)
        height = inputs.get("height")
        reads = any(isinstance(source, Ref) and source.path == step for source in inputs.values())
        if reads and isinstance(height, Ref) and height.path != step:
            return height
    return None


def _ground_of(session: Session, step: str) -> NDArray[np.float32] | None:
    """Return the heights (ny, nx) [m] under what a step gives; None: it changes no height."""
    plan = session.plan
    ref = _ground_ref(plan, step) if plan is not None else None
    if plan is None or ref is None or plan.terrain.relief is None:
        return None
    values = session.read_values(str(ref))
    return None if values is None else values * np.float32(plan.terrain.relief)

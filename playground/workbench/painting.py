"""The brush over the picture: strokes on an image of the sketch, stored in a file of their own.

A canvas is a file parameter that its kernel lets be painted on: a mask of four weights, or one number a
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
from playground.engine.files import find_file
from playground.engine.plan import Step, view_height
from playground.engine.sources import source_kind
from playground.engine.textures import split_format
from playground.errors import DataError, PlaygroundError
from playground.sketch.assign import resolve, shown_parameters, value_of, values_of
from playground.sketch.model import CpuSource, Parameter, Sketch
from playground.workbench.brush import TOOLS, Brush, Tool
from playground.workbench.canvas import MAX_TEXELS, Canvas
from playground.workbench.erode_tool import ErodeTool, technique_at
from playground.workbench.painted_mask import MAX_SIDE_BY_FILE, Mask
from playground.workbench.sculpted_ground import ground_of, ground_ref
from playground.workbench.sculpture import Sculpture, rate_of
from playground.workbench.session import Session

MIN_RADIUS, DEFAULT_RADIUS, MAX_RADIUS = 0.002, 0.025, 0.25
"""A brush's radius, in shares of the terrain's longer side."""

CLICK, MAX_DAB_SECONDS = 0.05, 0.25
"""[s] How long a stroke works on the place where it begins, and at most from one frame to the next."""

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
        self._now = now
        self._taken = False  # painting is on
        self._canvases: dict[str, Canvas] = {}  # by the parameter's path
        self._found: tuple[Sketch | None, tuple[str, ...]] = (None, ())
        self._chosen = ""
        self._heights: tuple[object, NDArray[np.float32] | None] = (None, None)  # and of which picture
        self._eroding: ErodeTool | None = None
        self._wake = wake
        self._reported: dict[Path, int] = {}  # how many writes of a canvas's file have been looked at
        self._stroke: Canvas | None = None  # what the stroke that goes on is painted on
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
        if self._found[0] is not sketch:
            self._found = sketch, _painted(sketch)
        return self._found[1]

    @property
    def target(self) -> str:
        """The path of the parameter that is painted on; "" where the sketch has none."""
        return self._chosen if self._chosen in self.targets else next(iter(self.targets), "")

    @property
    def sculpts(self) -> bool:
        """Whether what is painted on has one number a texel: it takes tools in place of layers."""
        step = self._step_of(self.target)
        return step is not None and _kind_of(step) is Sculpture

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
        return step is not None and plan is not None and ground_ref(plan, step.path) is not None

    def choose(self, target: str) -> None:
        """Paint on another parameter, by its path."""
        self.release()
        self._chosen = target
        if self.brush.tool not in self.tools:
            self.brush = replace(self.brush, tool="raise")

    @property
    def files(self) -> frozenset[Path]:
        """The masks that were begun: they need not be watched."""
        return frozenset(canvas.path for canvas in self._canvases.values())

    @property
    def canvas(self) -> Canvas | None:
        """The mask that was begun for what is painted on, if it is still in its place."""
        canvas, sketch = self._canvases.get(self.target), self.session.sketch
        if canvas is None or sketch is None:
            return None
        value = value_of(sketch, self.target, values_of(sketch))
        return canvas if str(value) == str(canvas.path) else None

    @property
    def side(self) -> float:
        """The terrain's longer side [m]."""
        return max(self.session.plan.terrain.extent or (0.0,)) if self.session.plan else 0.0

    def toggle(self) -> None:
        """Take the brush, or put it down."""
        if not self.target:
            self.session.notes.append(
                'this sketch has nothing to paint on: none of its files has the word "paint"'
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
            self.session.notes.append(f"nothing to {tool} in {self.target}: choose another tool")

    def ground(self, position: tuple[float, float]) -> tuple[float, float] | None:
        """Return where on the terrain a place of the picture lies, both in shares; None in the sky."""
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
        shares = np.clip(np.array(middle) + around / extent, 0.0, 1.0)
        return seen_from(eye, shares, heights, extent, relief)

    def press(self, position: tuple[float, float]) -> None:
        """Begin a stroke at a place of the picture, in shares from its lower left."""
        if self.canvas is not None and not self.canvas.holds():
            # Another program has removed the file, or painted on it.
            self._saved(self.canvas.take_in if self.canvas.path.exists() else self.canvas.save)
        plan, step = self.session.plan, self._step_of(self.target)
        if self._heights[1] is None:
            self._heights = None, None  # what could not be read may be there now
        if self._height() is None and not (plan and view_height(plan)):
            self.session.notes.append("the view shows no height, so there is no ground to paint on")
        self._last = self.ground(position)
        if self._last is None:
            return
        ground = ground_of(self.session, step.path) if step is not None and self.sculpts else None
        if ground is None and self.sculpts and self._adds_metres:
            self._last = None  # a note says why it cannot be read
            return
        canvas = self._begun()
        if canvas is not None:
            self._hand_over(canvas)
            if isinstance(canvas, Sculpture):
                canvas.set_base(ground)
                if self.brush.tool == "erode" and not self._erodes(canvas):
                    self._last = None  # a note says why
                    return
            canvas.begin()
            self._stroke = canvas
            self._saved_at = -SAVES_EVERY
            self._moved_at = self._now() - CLICK
            self.move(position)

    def move(self, position: tuple[float, float]) -> None:
        """Go on with the stroke, for as long as it is since the last time; nothing where it has ended."""
        plan, canvas = self.session.plan, self.canvas
        if plan is None or plan.terrain.extent is None or canvas is None or canvas is not self._stroke:
            return
        now, at = self.ground(position), self._now()
        seconds, self._moved_at = min(at - self._moved_at, MAX_DAB_SECONDS), at
        if now is not None:
            try:
                canvas.paint(self._last or now, now, plan.terrain.extent, self.brush, seconds)
            except PlaygroundError as error:
                self.session.notes.append(str(error))
                self.release()
                return
            if canvas.path in self.session.engine.painted:
                self.session.redraw()
            elif at - self._saved_at >= SAVES_EVERY:
                self._saved(canvas.save)
                self._saved_at = at
        self._last = now

    def release(self) -> None:
        """End the stroke; until the next press nothing is painted."""
        self._last = self._stroke = None
        if self.canvas is not None and not self.canvas.saved:
            self._saved(self.canvas.save)

    def follow(self) -> None:
        """Report what went wrong with files that were written meanwhile, and show those that are read."""
        for canvas in self._canvases.values():
            ended = canvas.writing.writes
            if self._reported.get(canvas.path) == ended:
                continue
            self._reported[canvas.path] = ended
            if canvas.writing.error is not None:
                self.session.notes.append(str(canvas.writing.error))
            if canvas.path not in self.session.engine.painted:
                self.session.redraw()

    def settle(self) -> bool:
        """Wait until the files hold what is painted, for who is about to read them; a note says what fails.

        Return whether they do.
        """
        for canvas in self._canvases.values():
            if not canvas.saved:
                canvas.save()
        for canvas in self._canvases.values():
            with suppress(PlaygroundError):  # what ``follow`` reports
                canvas.writing.wait()
        self.follow()
        return all(canvas.saved for canvas in self._canvases.values())

    def close(self) -> list[str]:
        """End the stroke and wait for the files; return a message for each that could not be written."""
        self.release()
        self.settle()
        errors = (canvas.writing.error for canvas in self._canvases.values())
        return [str(error) for error in errors if error is not None]

    def undo(self) -> None:
        """Undo the last stroke."""
        self._edit(self.canvas, Canvas.undo)

    def redo(self) -> None:
        """Redo the stroke that was undone last."""
        self._edit(self.canvas, Canvas.redo)

    def clear(self) -> None:
        """Take all paint away."""
        self._edit(self._begun(), Canvas.clear)

    def _edit(self, canvas: Canvas | None, act: Callable[[Canvas], None]) -> None:
        """End the stroke, change a mask and save it; what others have painted on it is read instead."""
        self.release()
        if canvas is None:
            return
        if canvas.holds() or not canvas.path.exists():
            self._saved(lambda: act(canvas))
            return
        self._saved(canvas.take_in)
        self.session.notes.append(f"{canvas.path.name} was changed by another program: it stays as it is now")

    def _saved(self, act: Callable[[], None]) -> None:
        try:
            act()
        except DataError as error:
            self.session.notes.append(str(error))
        self.session.redraw()

    def _shows(self, step: Step, path: Path, size: tuple[int, int]) -> bool:
        """Say whether the picture can show a canvas from memory: a source reads it, texel for texel."""
        if not isinstance(step.kernel, CpuSource) or size != step.size:
            return False
        name = self.target.rpartition(".")[2]
        return source_kind(step.kernel.registry).picture({**step.values, name: str(path)}, size) == path

    def _hand_over(self, canvas: Canvas) -> None:
        """Have the picture show a canvas from memory, where it can."""
        step, painted = self._step_of(self.target), self.session.engine.painted
        painted.pop(canvas.path, None)
        if step is not None and self._shows(step, canvas.path, canvas.size):
            painted[canvas.path] = canvas

    def _erodes(self, canvas: Sculpture) -> bool:
        """Have a canvas erode by the technique that its parameter names, as its files are now.

        Return whether it can; a note says why not.
        """
        parameter, engine = self._parameter(), self.session.engine
        if "erode" not in self.tools:
            self.session.notes.append(f"nothing to erode in {self.target}: choose another tool")
            return False
        try:
            technique = technique_at(self.erodes_by, parameter.file)
            runner = self._eroding.runner if self._eroding is not None else None
            if runner is None or runner.engine is not engine or runner.technique != technique:
                self._eroding = ErodeTool(engine, technique)
        except PlaygroundError as error:
            self.session.notes.append(str(error))
            return False
        canvas.eroding = self._eroding
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

    def _begun(self) -> Canvas | None:
        """Return the mask that is painted on, begun again where the sketch names another file."""
        if self.canvas is not None:
            return self.canvas
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
            canvas: Canvas = _kind_of(step).create(self.folder, name, of, step.size, most)
        except PlaygroundError as error:
            self.session.notes.append(str(error))
            return None
        if path in self._canvases:
            self.settle()  # another takes its place, and nobody looks after it any more
        self._canvases[path] = canvas
        self._reported[canvas.path] = canvas.writing.writes
        canvas.writing.ended = self._wake or canvas.writing.ended
        self.session.data.trust(canvas.path)
        self.session.drafts.set(path, str(canvas.path))
        self.session.notes.append(f"painting on {canvas.path.name} in {canvas.path.parent}")
        return canvas

    def _surface(self) -> tuple[Eye, NDArray[np.float32], tuple[float, float], float] | None:
        """Return the eye, the heights, the extent [m] and the relief [m] of the picture's terrain."""
        plan, heights = self.session.plan, self._height()
        if plan is None or heights is None or plan.terrain.extent is None or plan.terrain.relief is None:
            return None
        return plan.eye, heights, plan.terrain.extent, plan.terrain.relief

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


def _kind_of(step: Step) -> type[Mask] | type[Sculpture]:
    """Return what is painted: a number a texel where a source gives one, else a mask."""
    outputs = step.kernel.outputs
    is_sculpture = (
        isinstance(step.kernel, CpuSource) and len(outputs) == 1 and split_format(outputs[0].format)[0] == 1
    )
    return Sculpture if is_sculpture else Mask

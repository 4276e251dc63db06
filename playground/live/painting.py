"""The brush over the picture: strokes on a mask of the sketch, kept in a file of their own.

A mask is a file parameter that its kernel lets be painted on. The file that the sketch names is
never written to: painting begins a new one in the current folder and puts it in its place.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.engine.files import find_file
from playground.errors import DataError, PlaygroundError
from playground.live.brush import Brush
from playground.live.canvas import Canvas
from playground.live.session import Session
from playground.sketch.assign import Shown, shown_parameters, value_of, values_of
from playground.sketch.model import Sketch
from playground.terrain.pick import ground_under, seen_from

NARROWEST, USUAL, WIDEST = 0.002, 0.025, 0.25
"""A brush's radius, in shares of the land's longer side."""


class Painting:
    """What is painted in one session."""

    def __init__(self, session: Session, folder: Path) -> None:
        self.session = session
        self.folder = folder  # where new masks go
        self.on = False
        self.brush = Brush(radius=0.0)
        self._canvases: dict[str, Canvas] = {}  # by the parameter's path
        self._heights: NDArray[np.float32] | None = None  # of the land, while a stroke goes on
        self._last: tuple[float, float] | None = None  # where the stroke is

    @property
    def target(self) -> str:
        """The path of the parameter that is painted on; "" where the sketch has none."""
        found = _painted(self.session.sketch)
        return found.path if found else ""

    @property
    def files(self) -> frozenset[Path]:
        """The masks that were begun: whoever watches files need not hear of these."""
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
        """The land's longer side [m]."""
        return max(self.session.plan.land.extent or (0.0,)) if self.session.plan else 0.0

    def toggle(self) -> None:
        """Take the brush, or put it down."""
        self.on = bool(self.target) and not self.on
        if not self.target:
            self.session.notes.append("this sketch has no mask to paint on; texturing/alpha_map/mask is one")
        if self.on and not self.brush.radius:
            self.brush = replace(self.brush, radius=USUAL * self.side)

    def ground(self, place: tuple[float, float]) -> tuple[float, float] | None:
        """Return where on the land a place of the picture lies, both in shares; None in the sky."""
        plan = self.session.plan
        heights = self._heights if self._heights is not None else self._read_heights()
        if plan is None or heights is None or plan.land.extent is None or plan.land.relief is None:
            return None
        return ground_under(plan.eye, place, heights, plan.land.extent, plan.land.relief)

    def outline(self, place: tuple[float, float], corners: int) -> list[tuple[float, float]]:
        """Return the brush's circle as it lies on the land, in shares of the picture; [] in the sky."""
        plan, middle = self.session.plan, self.ground(place)
        if middle is None or plan is None or plan.land.extent is None or plan.land.relief is None:
            return []
        heights = self._heights if self._heights is not None else self._read_heights()
        if heights is None:
            return []
        turns = np.linspace(0, 2 * np.pi, corners, endpoint=False)
        around = np.stack([np.cos(turns), np.sin(turns)], axis=1) * self.brush.radius
        shares = np.clip(np.array(middle) + around / plan.land.extent, 0.0, 1.0)
        return seen_from(plan.eye, shares, heights, plan.land.extent, plan.land.relief)

    def press(self, place: tuple[float, float]) -> None:
        """Begin a stroke at a place of the picture, in shares from its lower left."""
        self._heights = self._read_heights()
        self._last = self.ground(place)
        canvas = self._begun() if self._last is not None else None
        if canvas is not None:
            canvas.begin()
            self.move(place)

    def move(self, place: tuple[float, float]) -> None:
        """Go on with the stroke."""
        plan, canvas = self.session.plan, self.canvas
        if self._heights is None or plan is None or plan.land.extent is None or canvas is None:
            return
        now = self.ground(place)
        if now is not None:
            canvas.paint(self._last or now, now, plan.land.extent, self.brush)
            self._saved(canvas.save)
        self._last = now

    def release(self) -> None:
        """End the stroke."""
        self._heights = self._last = None

    def undo(self) -> None:
        """Take the last stroke back."""
        if self.canvas is not None:
            self._saved(self.canvas.undo)

    def clear(self) -> None:
        """Take all paint away."""
        canvas = self._begun()
        if canvas is not None:
            self._saved(canvas.clear)

    def _saved(self, act: Callable[[], None]) -> None:
        try:
            act()
        except DataError as error:
            self.session.notes.append(str(error))
        self.session.look_again()

    def _begun(self) -> Canvas | None:
        """Return the mask that is painted on, begun anew where the sketch names another file."""
        found, sketch, plan = _painted(self.session.sketch), self.session.sketch, self.session.plan
        if self.canvas is not None:
            return self.canvas
        if found is None or sketch is None or plan is None or plan.land.extent is None:
            return None
        name = re.sub(r"[^\w.-]+", "-", f"{sketch.name}-{found.path}").strip("-.")
        try:
            file = str(value_of(sketch, found.path, values_of(sketch)))
            of = find_file(file, sketch.folder, found.parameter.file, found.path) if file else None
            canvas = Canvas.begun(self.folder, name, of, plan.land.extent)
        except PlaygroundError as error:
            self.session.notes.append(str(error))
            return None
        self._canvases[found.path] = canvas
        self.session.set(found.path, str(canvas.path))
        self.session.notes.append(f"painting on {canvas.path.name} in {self.folder}")
        return canvas

    def _read_heights(self) -> NDArray[np.float32] | None:
        sketch = self.session.sketch
        heights = [ref for ref in self.session.refs if ref.endswith(":height")]
        ref = next(
            (ref for ref in reversed(heights) if "." not in ref), ""
        )  # the last that a pass itself gives
        if sketch is None or not ref:
            return None
        try:
            return self.session.engine.read(sketch, ref, time=self.session.clock.time)
        except PlaygroundError:
            return None


def _painted(sketch: Sketch | None) -> Shown | None:
    """Return the first parameter that may be painted on, those that a technique shows before those inside."""
    if sketch is None:
        return None
    found = [shown for shown in shown_parameters(sketch) if shown.parameter.painted]
    return min(found, key=lambda shown: not shown.exported, default=None)

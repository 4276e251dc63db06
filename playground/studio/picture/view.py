"""What is drawn of a sketch: its own view or a map of a texture, repeats stopped early, the frame's sides.

A camera's field of view is its vertical one. Next to the panels a picture is narrower than what
the sketch was framed for, and would be cut at its sides: it is opened instead, so that more is
visible above and below. Only the window does so; a render of a size is that of the sketch's camera.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from playground.engine.planner import repeats_of
from playground.errors import PlaygroundError
from playground.sketch.map_sketch import Map
from playground.sketch.model import DEFAULT_PICTURE, Camera, Graph, Sketch, Technique, Value
from playground.sketch.wiring import output_names
from playground.studio.land.looks import Appearance, Look

Place = tuple[float, float]
"""Of a node of the graph: column from the left, and its middle downwards, in heights of a node."""


@dataclass(frozen=True)
class Kept:
    """What a window keeps of a sketch besides its edits."""

    views: tuple[tuple[int, Camera], ...] = ()  # numbered ones
    places: tuple[tuple[str, Place], ...] = ()  # of nodes of the graph that were moved
    appearance: Appearance = field(default_factory=Appearance)  # of the terrain


class View:
    """What one session draws; ``revision`` counts the changes."""

    def __init__(self) -> None:
        self.map: Map | None = None  # drawn instead of the sketch's own view
        self.look: Look | None = None  # drawn instead of the sketch's own view, where no map is
        self.last_ref = ""  # the texture of the map shown last
        self.steps: dict[str, int] = {}  # repeats that are stopped early, by path
        self.muted: frozenset[str] = frozenset()  # passes that let through what they are made of
        self.interpolated = True  # what a stopped repeat has not reached is filled
        self.views: dict[int, Camera] = {}  # kept, by number
        self.places: dict[str, Place] = {}  # of nodes of the graph that were moved
        self.exaggeration = 1.0  # how many times higher than it is the terrain is shown
        self.turning = False  # the camera goes round, as on a turntable
        self.turned = 0.0  # [degrees] by which it has gone, for the picture alone
        self.framed_for = DEFAULT_PICTURE  # [pixels] the image whose sides stay visible in a narrower window
        self.revision = 0
        self._next: tuple[dict[str, int], Map | None] | None = None  # for a sketch that is being opened
        self._next_kept = Kept()

    def restore(
        self,
        steps: Mapping[str, int],
        shown: Map | None,
        kept: Kept | None = None,
        *,
        later: bool = False,
    ) -> None:
        """Stop repeats after so many steps, and show a map or, with None, the sketch's own view.

        ``kept``: None leaves what there is. ``later``: once the sketch that is being opened is drawn.
        """
        if later:
            self._next, self._next_kept = (dict(steps), shown), kept or Kept()
            return
        if kept is not None:
            self.views, self.places = dict(kept.views), dict(kept.places)
            self.look, self.exaggeration = kept.appearance.look, kept.appearance.exaggeration
        self.steps.clear()
        self.steps.update(steps)
        self.map = shown
        self.revision += 1

    def take_next(self) -> bool:
        """Show what was restored for the sketch that is drawn now for the first time, if any is.

        Returns whether that is so; a turntable was the one before's.
        """
        if self._next is None:
            return False
        (steps, shown), self._next = self._next, None
        self.muted = frozenset()
        self.turning, self.turned = False, 0.0
        self.restore(steps, shown, self._next_kept)
        return True

    def forget_next(self) -> None:
        """Forget what was restored for a sketch that is not opened after all."""
        self._next = None

    @property
    def state(self) -> tuple[dict[str, int], Map | None]:
        """What ``restore`` takes to draw the sketch that is open so again, drawn already or not."""
        return self._next if self._next is not None else (dict(self.steps), self.map)

    @property
    def kept(self) -> Kept:
        """What ``restore`` takes besides, to have it so again."""
        appearance = Appearance(self.exaggeration, self.look)
        return Kept(tuple(sorted(self.views.items())), tuple(sorted(self.places.items())), appearance)

    def show(self, shown: Map | None) -> None:
        """Show a map or, with None, the sketch's own view."""
        self.map = shown
        self.revision += 1

    def show_as(self, look: Look | None) -> None:
        """Show the terrain in a look or, with None, by the sketch's own view."""
        self.look = look
        self.revision += 1

    def seen(self, camera: Camera) -> Camera:
        """Return a camera as it is shown: turned, and looking at the same place of an exaggerated terrain."""
        if camera.target is not None and self.exaggeration != 1.0:
            x, y, z = camera.target
            camera = replace(camera, target=(x, y, z * self.exaggeration))
        return replace(camera, azimuth=(camera.azimuth + self.turned) % 360.0) if self.turned else camera

    def unseen(self, camera: Camera, before: Camera) -> Camera:
        """Return the camera that is shown as another, which was moved from where ``before`` is shown."""
        if camera.target == self.seen(before).target:
            camera = replace(camera, target=before.target)
        elif camera.target is not None and self.exaggeration != 1.0:
            x, y, z = camera.target
            camera = replace(camera, target=(x, y, z / self.exaggeration))
        return replace(camera, azimuth=(camera.azimuth - self.turned) % 360.0) if self.turned else camera

    def set_map(self, name: str, value: Value) -> None:
        """Set a parameter of the map."""
        if self.map is not None:
            self.show(self.map.with_value(name, value))

    def stop_at(self, path: str, step: int | None) -> None:
        """Stop a repeat after so many steps; with None it runs to its end again."""
        self.revision += 1
        self.steps.pop(path, None)
        if step is not None:
            self.steps[path] = step

    def mute(self, name: str, on: bool) -> None:
        """Draw as if a pass were not there, with what it is made of in its place; or no longer."""
        self.revision += 1
        self.muted = self.muted | {name} if on else self.muted - {name}

    def interpolate(self, on: bool) -> None:
        """Fill what stopped repeats have not reached, where their headers say how, or show it as it is."""
        self.revision += 1
        self.interpolated = on

    def stops(self, sketch: Sketch, time: float, *, coming: bool = False) -> dict[str, int]:
        """Return where to stop: a repeat that is gone, or has fewer steps by now, is not stopped.

        ``coming``: in a sketch that is being opened, where there is one.
        """
        steps = self._next[0] if coming and self._next is not None else self.steps
        repeats = steps_of_repeats(sketch, time) if steps else {}
        return {path: step for path, step in steps.items() if step < repeats.get(path, 0)}


def steps_of_repeats(sketch: Sketch, time: float) -> dict[str, int]:
    """Return how many steps every repeated kernel and loop takes, by path; nothing where that is an error."""
    try:
        return repeats_of(sketch, time=time)
    except PlaygroundError:  # it is reported when the sketch is drawn
        return {}


# ── maps ──────────────────────────────────────────────────────────────────────


def ref_name(ref: str) -> str:
    """Return a texture's name without its repetition: "height:height" is "height"."""
    path, _, output = ref.partition(":")
    return path if path.rpartition(".")[2] == output else ref


def in_view(sketch: Sketch, ref: str) -> bool:
    """Say whether a texture is one of the sketch's view: a map can show it, though no list has it."""
    path, _, output = ref.partition(":")
    technique: Technique | None = None
    for number, name in enumerate(path.split(".")):
        around = technique if number else sketch.graph
        spec = around.find(name) if isinstance(around, Graph) else None
        if spec is None or (number == 0 and name != "view"):
            return False
        technique = spec.technique
    return technique is not None and output in output_names(technique)


def fitted(shown: Map, values: NDArray[np.float32]) -> Map:
    """Return the map with its channel and range chosen to suit a texture's values.

    One or two components are shown as a number, from the lowest to the highest there
    is; three or four as a colour from 0 to 1. Values that are not finite are left out.
    """
    names = {p.name for p in shown.kernel.parameters}
    components = 1 if values.ndim == 2 else values.shape[2]
    settings: dict[str, Value] = {"channel": 0 if components >= 3 else 1, "lowest": 0.0, "highest": 1.0}
    if components < 3:
        numbers = values if values.ndim == 2 else values[..., 0]
        finite = numbers[np.isfinite(numbers)]
        if finite.size and finite.min() < finite.max():
            settings |= {"lowest": float(finite.min()), "highest": float(finite.max())}
    for name, value in settings.items():
        if name in names:
            shown = shown.with_value(name, value)
    return shown


# ── the frame ─────────────────────────────────────────────────────────────────


MAX_FIELD_OF_VIEW = 100.0
"""[degrees] that a view is opened to at most: beyond, what is near its edges is drawn out of shape."""

Size = tuple[int, int]


def framed(sketch: Sketch, time: float, size: Size, room: Size) -> Sketch:
    """Return a sketch at a time as it is shown in a ``room``; the same object where nothing is opened.

    ``size``: the size of the picture whose sides stay visible. Sizes in pixels.
    """
    now = sketch.at(time)
    opened = field_for(now.camera.field_of_view, size, room)
    if opened == now.camera.field_of_view:
        return sketch
    return replace(now, camera=replace(now.camera, field_of_view=opened))


def field_for(degrees: float, size: Size, room: Size) -> float:
    """Return the vertical field of view that shows in a room what a picture shows from side to side."""
    narrower = (size[0] / size[1]) / (room[0] / max(room[1], 1))
    if narrower <= 1.0:
        return degrees
    opened = 2 * math.degrees(math.atan(math.tan(math.radians(degrees) / 2) * narrower))
    return max(degrees, min(opened, MAX_FIELD_OF_VIEW))

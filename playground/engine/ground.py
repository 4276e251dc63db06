"""Keep the eye over the terrain: one look at the height that stands under it, and a camera raised over that.

The terrain is what the first draw reads as its input ``height``, if that draw names ``relief``
and the camera. Its texels are read once for each place of the eye; an eye beside the
terrain is left where it is.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from playground.engine.plan import Plan, Step
from playground.engine.results import Result
from playground.errors import Diagnostic
from playground.paths import shown
from playground.sketch.flatten import Ref
from playground.sketch.model import Camera, Sketch

if TYPE_CHECKING:
    import moderngl

    from playground.engine.engine import Engine

PlanOf = Callable[[Sketch], Plan]

CLEARANCE = 0.002  # over the ground, as a share of the eye's distance from its target: see ``terrain.camera``
_TURNED = 89.0  # [degrees] of elevation, at most


class Ground:
    """What stands under the eye of the last frame."""

    def __init__(self) -> None:
        self.raised = 0.0  # [m] by which the last frame's eye was raised; 0: it stood over the terrain
        self._known: tuple[tuple[int, float, float], float] | None = None

    @property
    def message(self) -> str:
        """What there is to say of the last frame's eye; "" if it was left where it stood."""
        if not self.raised:
            return ""
        return f"the eye stood under the terrain and was raised by {self.raised:.0f} m, to just above it"

    def draw(
        self,
        engine: Engine,
        texture_of: Callable[[Plan, Ref], moderngl.Texture],
        sketch: Sketch,
        plan_of: PlanOf,
    ) -> moderngl.Texture:
        """Draw a sketch's picture; where the eye stood under the terrain, again from just above it.

        That is told among the engine's warnings, once for a sketch.
        """
        plan = plan_of(sketch)
        view = next(iter(plan.flat.outputs["view"].values()))
        texture = texture_of(plan, view)
        with engine.borrowed():
            camera = self.over(plan, engine.results, engine.ctx)
        if camera is None:
            return texture
        file = shown(sketch.file)
        engine.warnings.once(Diagnostic(self.message, file, severity="warning"), "the eye's height")
        return texture_of(plan_of(sketch.with_camera(camera)), view)

    def over(self, plan: Plan, results: Mapping[str, Result], ctx: moderngl.Context) -> Camera | None:
        """Return a camera whose eye is over the terrain, or None where the plan's own is.

        ``results`` are what was made for the plan.
        """
        self.raised = 0.0
        source = _terrain_of(plan)
        result = results.get(source.path) if source else None
        extent, relief = plan.land.extent, plan.land.relief
        if source is None or result is None or extent is None or relief is None:
            return None
        x, y, z = plan.eye.position
        place = np.array([x / extent[0], y / extent[1]]) * (np.array(result.size) - 1)
        if not ((place >= 0) & (place <= np.array(result.size) - 1)).all():
            return None
        key = (result.number, x, y)
        if self._known is None or self._known[0] != key:
            self._known = key, _height_at(place, result, source.output, ctx)
        lowest = self._known[1] * relief + CLEARANCE * plan.eye.distance
        if not z < lowest:  # or no number
            return None
        self.raised = lowest - z
        return _seen_from((x, y, lowest), plan)


def _terrain_of(plan: Plan) -> Ref | None:
    for step in plan.walk():
        source = dict(step.inputs).get("height")
        if isinstance(source, Ref) and _draws_terrain(step):
            return source
    return None


def _draws_terrain(step: Step) -> bool:
    kernel = step.kernel
    return kernel.kind == "draw" and all(map(kernel.reads, ("relief", "clip_from_world")))


def _height_at(place: NDArray[np.float64], result: Result, output: str, ctx: moderngl.Context) -> float:
    """Return the height between the four texels around a place."""
    low = np.minimum(place.astype(int), np.maximum(np.array(result.size) - 2, 0))
    wide, tall = (min(2, n) for n in result.size)
    window = int(low[0]), int(low[1]), wide, tall
    attachment = [each.name for each in result.outputs].index(output)
    read = result.framebuffer(ctx).read(window, 1, attachment=attachment, alignment=1, dtype="f4")
    texels = np.frombuffer(read, np.float32).reshape(tall, wide)
    corners = np.pad(texels, ((0, 2 - tall), (0, 2 - wide)), mode="edge")
    p, q = place - low
    return float(np.array([1 - q, q]) @ corners.astype(np.float64) @ np.array([1 - p, p]))


def _seen_from(position: tuple[float, float, float], plan: Plan) -> Camera:
    """Return the camera that looks at the plan's target from another place."""
    target = plan.eye.target
    east, north, up = (a - b for a, b in zip(position, target, strict=True))
    level = math.hypot(east, north)
    camera = plan.sketch.camera
    return replace(
        camera,
        azimuth=math.degrees(math.atan2(east, north)) if level > 0 else camera.azimuth,
        elevation=min(math.degrees(math.atan2(up, level)), _TURNED),
        distance=math.hypot(level, up),
        target=target,
    )

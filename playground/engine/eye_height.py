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
        self._read: tuple[tuple[int, float, float], float] | None = None  # texture and place → height there
        self._stays: str = ""  # what the texture under a raised eye depends on

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
        source = _terrain_of(plan)
        camera, before = None, None
        if source and self.raised and self._read and self._stays == engine.keys_of(plan).steps[source.path]:
            camera = self._over(plan, self._read[0][1:], self._read[1])  # as the last frame's
        if camera is None:
            texture = texture_of(plan, view)
            with engine.borrowed():
                camera = self._look(plan, source, engine.results, engine.ctx)
            if source is None or camera is None:
                return texture
            self._stays = engine.keys_of(plan).steps[source.path]
            before = engine.ran, engine.texels, engine.times, engine.triangles
        warning = Diagnostic(self.message, shown(sketch.file), severity="warning")
        engine.warnings.once(warning, "the eye's height")
        texture = texture_of(plan_of(sketch.with_camera(camera)), view)
        if before is not None:
            _add(engine, *before)
        return texture

    def _look(
        self, plan: Plan, source: Ref | None, results: Mapping[str, Result], ctx: moderngl.Context
    ) -> Camera | None:
        """Return a camera whose eye is over the terrain, or None where the plan's own is.

        ``results`` are what was made for the plan.
        """
        self.raised = 0.0
        result = results.get(source.path) if source else None
        place = _place_of(plan)
        if source is None or result is None or place is None:
            return None
        key = (result.number, *place)
        if self._read is None or self._read[0] != key:
            self._read = key, _height_at(place, result, source.output, ctx)
        return self._over(plan, place, self._read[1])

    def _over(self, plan: Plan, place: tuple[float, float], height: float) -> Camera | None:
        """Return a camera over a height that is known at a place; None where the plan's own eye may stay."""
        self.raised = 0.0
        if plan.land.relief is None or _place_of(plan) != place:
            return None
        x, y, z = plan.eye.position
        lowest = height * plan.land.relief + CLEARANCE * plan.eye.distance
        if not z < lowest:  # or no number
            return None
        self.raised = lowest - z
        return _seen_from((x, y, lowest), plan)


def _place_of(plan: Plan) -> tuple[float, float] | None:
    """Return where the eye stands over the terrain, in shares of its sides; None beside it."""
    if plan.land.extent is None or plan.land.relief is None:
        return None
    x, y = (at / side for at, side in zip(plan.eye.position, plan.land.extent, strict=False))
    return (x, y) if 0 <= x <= 1 and 0 <= y <= 1 else None


def _add(engine: Engine, ran: list[str], texels: int, times: dict[str, float], triangles: int) -> None:
    """Add what an earlier drawing of the same frame ran and took to what the engine tells of it."""
    engine.ran = [*ran, *(path for path in engine.ran if path not in ran)]
    engine.texels += texels
    engine.times = {path: times.get(path, 0.0) + engine.times.get(path, 0.0) for path in times | engine.times}
    engine.runner.draws.drawn += triangles


def _terrain_of(plan: Plan) -> Ref | None:
    for step in plan.walk():
        source = dict(step.inputs).get("height")
        if isinstance(source, Ref) and _draws_terrain(step):
            return source
    return None


def _draws_terrain(step: Step) -> bool:
    kernel = step.kernel
    return kernel.kind == "draw" and all(map(kernel.reads, ("relief", "clip_from_world")))


def _height_at(share: tuple[float, float], result: Result, output: str, ctx: moderngl.Context) -> float:
    """Return the height between the four texels around a place."""
    place = np.array(share) * (np.array(result.size) - 1)
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

"""Keep the eye above the terrain: read the height under it, and return a camera raised above that.

The terrain is what the first draw reads as its input ``height``, if that draw names ``relief``
and the camera. Its texels are read once for each place of the eye; an eye outside the
terrain is left where it is, and so is any whose sketch says ``above_ground = false``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from playground.engine.cache_keys import Keys
from playground.engine.plan import Plan
from playground.engine.results import Result
from playground.sketch.flat import Ref
from playground.sketch.model import Camera

if TYPE_CHECKING:
    import moderngl

CLEARANCE = 0.002  # above the ground, as a fraction of the eye's distance from its target: see ``camera``
_MAX_ELEVATION = 89.0  # [degrees] of elevation, at most


class EyeHeight:
    """Reads the height under the eye of the last frame, and raises the eye over it."""

    def __init__(self) -> None:
        self.raised_by = 0.0  # [m] by which the last frame's eye was raised; 0: it was above the terrain
        self._read: tuple[tuple[int, float, float], float] | None = None  # texture and place → height there
        self._terrain_key = ""  # of the texture under the eye

    @property
    def message(self) -> str:
        """The warning about the last frame's eye; "" if it was not raised."""
        if not self.raised_by:
            return ""
        return f"the eye was under the terrain and was raised by {self.raised_by:.0f} m, to just above it"

    def raised_as_before(self, plan: Plan, keys_of: Callable[[Plan], Keys]) -> Camera | None:
        """Return a camera over the terrain where the last frame's eye was raised over the same terrain.

        ``keys_of`` gives the keys of a plan. None: the terrain must be drawn and read first.
        """
        if not self.raised_by or self._read is None:
            return None
        source = _terrain_of(plan)
        if source is None or self._terrain_key != keys_of(plan).result(source.path):
            return None
        return self._over(plan, self._read[0][1:], self._read[1])

    def raised(
        self, plan: Plan, keys: Keys, results: Mapping[str, Result], ctx: moderngl.Context
    ) -> Camera | None:
        """Return a camera whose eye is over the terrain, or None where the plan's own is.

        ``keys`` and ``results`` are those of the plan, which was drawn.
        """
        self.raised_by = 0.0
        source, position = _terrain_of(plan), _place_of(plan)
        result = results.get(source.path) if source else None
        if source is None or result is None or position is None:
            return None
        key = (result.number, *position)
        if self._read is None or self._read[0] != key:
            self._read = key, height_at(position, result, source.output, ctx)
        self._terrain_key = keys.result(source.path)
        return self._over(plan, position, self._read[1])

    def _over(self, plan: Plan, position: tuple[float, float], height: float) -> Camera | None:
        """Return a camera over a height that is known at a place; None where the plan's own eye may stay."""
        self.raised_by = 0.0
        if plan.shown_relief is None or _place_of(plan) != position:
            return None
        x, y, z = plan.eye.position
        lowest = height * plan.shown_relief + CLEARANCE * plan.eye.distance
        if not z < lowest:  # or no number
            return None
        self.raised_by = lowest - z
        return _camera_at((x, y, lowest), plan)


def _place_of(plan: Plan) -> tuple[float, float] | None:
    """Return where the eye is above the terrain, in fractions of its sides; None outside it.

    None as well where the sketch lets the eye be under the ground.
    """
    if plan.terrain.extent is None or plan.terrain.relief is None or not plan.sketch.picture.above_ground:
        return None
    (east, north, _), (width, height) = plan.eye.position, plan.terrain.extent
    x, y = east / width, north / height
    return (x, y) if 0 <= x <= 1 and 0 <= y <= 1 else None


def _terrain_of(plan: Plan) -> Ref | None:
    for step in plan.draws:
        if isinstance(source := dict(step.inputs).get("height"), Ref):
            if step.kernel.reads("relief") and step.kernel.reads("clip_from_world"):
                return source
    return None


def height_at(share: tuple[float, float], result: Result, output: str, ctx: moderngl.Context) -> float:
    """Return the height between the four texels around a place."""
    texel = np.array(share) * (np.array(result.size) - 1)
    low = np.minimum(texel.astype(int), np.maximum(np.array(result.size) - 2, 0))
    wide, tall = (min(2, n) for n in result.size)
    window = int(low[0]), int(low[1]), wide, tall
    attachment = [each.name for each in result.outputs].index(output)
    read = result.framebuffer(ctx).read(window, 1, attachment=attachment, alignment=1, dtype="f4")
    texels = np.frombuffer(read, np.float32).reshape(tall, wide)
    corners = np.pad(texels, ((0, 2 - tall), (0, 2 - wide)), mode="edge")
    p, q = texel - low
    return float(np.array([1 - q, q]) @ corners.astype(np.float64) @ np.array([1 - p, p]))


def _camera_at(position: tuple[float, float, float], plan: Plan) -> Camera:
    """Return the camera that looks at the plan's target from another place."""
    target = plan.eye.target
    east, north, up = (a - b for a, b in zip(position, target, strict=True))
    level = math.hypot(east, north)
    camera = plan.sketch.camera
    return replace(
        camera,
        azimuth=math.degrees(math.atan2(east, north)) if level > 0 else camera.azimuth,
        elevation=min(math.degrees(math.atan2(up, level)), _MAX_ELEVATION),
        distance=math.hypot(level, up),
        target=target,
    )

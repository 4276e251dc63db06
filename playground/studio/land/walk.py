"""Walk on the terrain: the eye a person's height over the ground that is drawn, wherever one walks.

What it sets is the sketch's camera, as an orbit does: it is remembered, kept as a view and saved like any
other. So is the view's mesh, which gets a vertex for each texel: one of fewer is metres over the heights here
and there, and would hide what one sees. The heights are read once for each of their versions, so that a step
reads nothing from the GPU.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from playground.engine import lod
from playground.engine.camera import ground_under, unit_vector
from playground.engine.plan import view_height
from playground.engine.textures import read_texels
from playground.sketch.assign import find_targets, shown_parameters, value_of, values_of
from playground.sketch.model import Camera, Draw, Sketch, Value
from playground.studio.language import tr
from playground.studio.session import Session

EYE_HEIGHT = 1.7
"""[m] of the eye over the ground."""
SLOWEST, FASTEST = 0.5, 500.0
"""[m/s] that one walks."""
STRIDE = 4.0
"""Times as fast, with Shift."""
_CROSSING = 300.0  # [s] in which the longer side is walked at first
_NOTCH = 1.25  # times as fast for a notch of the wheel
_AHEAD = 250.0  # [m] of the target: near enough to keep the nearest ground, far enough for the depth buffer
_STEEPEST = 85.0  # [degrees] that one looks up or down
_WIDE = 55.0  # [degrees] upright that a walk shows at least


_DETAIL, _FULL_GRID = "detail", 0  # the parameter of mesh "land", and its choice with fewest vertices


def standing_height(
    heights: NDArray[np.floating], extent: tuple[float, float], east: float, north: float
) -> float:
    """Return the height (as the texels have it) that one stands on at a place [m] of the terrain.

    ``heights``: (ny, nx), row 0 south. Four texels are drawn as two triangles, cut along either diagonal, and
    between the two surfaces is the bilinear one: it is the upper of them, so that the ground hides nothing.
    """
    ny, nx = heights.shape
    x, y = east / extent[0] * (nx - 1), north / extent[1] * (ny - 1)
    i, j = min(int(x), max(nx - 2, 0)), min(int(y), max(ny - 2, 0))
    u, v = x - i, y - j
    right, up = min(i + 1, nx - 1), min(j + 1, ny - 1)
    (a, b), (c, d) = heights[np.ix_((j, up), (i, right))].tolist()
    rising = a + u * (b - a) + v * (d - b) if u >= v else a + v * (c - a) + u * (d - c)
    falling = a + u * (b - a) + v * (c - a) if u + v <= 1 else d + (1 - u) * (c - d) + (1 - v) * (b - d)
    return float(max(rising, falling))


def _mesh_of_texels(sketch: Sketch) -> dict[str, Value]:
    """Return what gives the meshes of the terrain a vertex for each texel, where they have fewer."""
    draws = [
        path for path, kernel in sketch.graph.kernels if isinstance(kernel, Draw) and kernel.mesh == "land"
    ]
    leaves, values = {f"{path}.{_DETAIL}" for path in draws}, values_of(sketch)
    return {
        shown.path: len(lod.DETAILS) - 1
        for shown in shown_parameters(sketch)
        if shown.exported
        and any(target.path in leaves for target in find_targets(sketch.graph, shown.path))
        and value_of(sketch, shown.path, values) == _FULL_GRID
    }


@dataclass(frozen=True)
class Walker:
    """Where one stands, and where one looks to."""

    east: float  # [m]
    north: float
    heading: float  # [degrees] clockwise from north
    pitch: float = 0.0  # [degrees] above the horizon

    def moved(self, right: float, forward: float, extent: tuple[float, float]) -> Walker:
        """Return the walker so many metres on, still on the terrain."""
        east, north, _ = unit_vector((self.heading, 0.0))
        x = self.east + east * forward + north * right
        y = self.north + north * forward - east * right
        return replace(self, east=min(max(x, 0.0), extent[0]), north=min(max(y, 0.0), extent[1]))

    def turned(self, right: float, up: float) -> Walker:
        """Return the walker looking so many degrees elsewhere."""
        pitch = min(max(self.pitch + up, -_STEEPEST), _STEEPEST)
        return replace(self, heading=(self.heading + right) % 360.0, pitch=pitch)

    def camera(self, ground: float, camera: Camera) -> Camera:
        """Return another camera at this place, over the ground [m], of as many digits as are saved."""
        azimuth, elevation = round((self.heading + 180.0) % 360.0, 2) % 360.0, round(-self.pitch, 2)
        place = self.east, self.north, ground + EYE_HEIGHT
        away = unit_vector((azimuth, elevation))  # the eye, from the target
        x, y, z = (round(p - _AHEAD * a, 2) for p, a in zip(place, away, strict=True))
        wide = max(camera.field_of_view, _WIDE)
        return Camera(azimuth, elevation, _AHEAD, (x, y, z), wide)


class Walk:
    """A walk over what one session shows; ``before`` is called as it begins."""

    def __init__(self, session: Session, before: Callable[[], None] = lambda: None) -> None:
        self.session = session
        self.walker: Walker | None = None
        self.speed = 1.4  # [m/s]
        self._before = before
        self._way = (0.0, 0.0)  # to the right and forward, -1..1
        self._is_fast = False
        self._camera: Camera | None = None  # that was set last
        self._heights: tuple[object, NDArray[np.float32] | None] = (None, None)  # version → heights

    @property
    def on(self) -> bool:
        """Whether one walks."""
        return self.walker is not None

    @property
    def moves(self) -> bool:
        """Whether a key has one go on."""
        return self.on and self._way != (0.0, 0.0)

    def toggle(self) -> None:
        """Begin at the ground in the picture's middle, or end: the camera stays where it is."""
        if self.on:
            self.end()
        else:
            self.begin()

    def begin(self) -> None:
        """Begin at the ground in the picture's middle; a notice says why where that cannot be."""
        session = self.session
        session.turn_table(False)
        plan, land = session.plan, self._land()
        if plan is None or session.sketch is None or land is None or not session.orbits:
            session.notes.append(tr("there is no terrain in this picture to walk on"))
            return
        heights, extent, relief = land
        place = ground_under(plan.eye, (0.5, 0.5), heights, extent, relief)
        if place is None:
            session.notes.append(tr("the middle of the picture shows no ground; turn it there to walk"))
            return
        self._before()
        self.walker = Walker(place[0] * extent[0], place[1] * extent[1], plan.sketch.camera.azimuth + 180.0)
        self.speed = min(max(max(extent) / _CROSSING, 1.4), FASTEST)
        session.drafts.set_all(_mesh_of_texels(session.sketch))
        self._follow()
        session.notes.append(tr("walking: W A S D or arrows, drag to look around; Esc ends"))

    def end(self) -> None:
        """End; the camera stays where it is."""
        self.walker, self._way, self._heights = None, (0.0, 0.0), (None, None)

    def head(self, right: float, forward: float, *, fast: bool = False) -> None:
        """Take what the keys say, -1..1 each: go on that way until they say another."""
        self._way, self._is_fast = (right, forward), fast

    def look(self, across: float, down: float) -> None:
        """Look around by a drag, in fractions of the picture's height: the land follows the mouse."""
        if self.walker is not None and (across or down) and self.session.plan is not None:
            wide = self.session.plan.sketch.camera.field_of_view
            self.walker = self.walker.turned(-across * wide, down * wide)
            self._follow()

    def hurry(self, notches: float) -> None:
        """Walk faster, or slower."""
        self.speed = min(max(self.speed * _NOTCH**notches, SLOWEST), FASTEST)

    def advance(self, seconds: float) -> None:
        """Go on for so long; a camera that was set otherwise ends the walk."""
        sketch = self.session.sketch
        if self.walker is None:
            return
        if sketch is None or sketch.camera != self._camera:
            self.end()
            return
        plan = self.session.plan
        if self.moves and plan is not None and plan.terrain.extent is not None:
            right, forward = self._way
            far = self.speed * seconds * (STRIDE if self._is_fast else 1.0) / math.hypot(right, forward)
            self.walker = self.walker.moved(right * far, forward * far, plan.terrain.extent)
        self._follow()

    def _follow(self) -> None:
        """Set the camera over the ground at the walker's place."""
        session, land = self.session, self._land()
        if self.walker is None or session.sketch is None or land is None:
            return
        heights, extent, relief = land
        ground = standing_height(heights, extent, self.walker.east, self.walker.north) * relief
        before = session.sketch.camera
        seen = self.walker.camera(ground, before)
        camera = session.view.unseen(seen, before)
        if camera.target is not None:
            x, y, z = camera.target
            camera = replace(camera, target=(x, y, round(z, 2)))
        if camera != before:
            session.drafts.set_camera(camera)
        self._camera = session.sketch.camera

    def _land(self) -> tuple[NDArray[np.float32], tuple[float, float], float] | None:
        """Return the heights that are drawn, their extent [m] and the relief that is shown [m]."""
        plan = self.session.plan
        if plan is None or plan.terrain.extent is None or plan.shown_relief is None:
            return None
        result = self.session.result_of(view_height(plan))
        if result is not None and result[1] != self._heights[0]:
            texture, version = result
            self._heights = version, read_texels(texture, (0, 0), texture.size)[..., 0]
        heights = self._heights[1]
        return None if heights is None else (heights, plan.terrain.extent, plan.shown_relief)

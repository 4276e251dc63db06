"""Read what is under the mouse: every pass's number there, where on the terrain that is, how steep.

It reads what the last picture was made from, a texel of each texture; it draws nothing of
the sketch, and asks again only when the mouse or the picture has moved on.

The place of the terrain under a pixel is found on the graphics card, so that its heights stay there. The ray
march is that of ``engine.camera``: along the pixel's ray in steps of a texel, then the step that goes below
the ground is halved. One fragment does it, and four numbers come back.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from playground.engine.camera import Eye, ray_over
from playground.engine.plan import Plan, view_height
from playground.engine.textures import read_texels
from playground.shader.own_shaders import own_shader
from playground.studio.picture.full_screen import TexelShader
from playground.studio.session import Session

if TYPE_CHECKING:
    import moderngl


class Ground(TexelShader):
    """Finds, in one context, places of the terrain."""

    def __init__(self, ctx: moderngl.Context) -> None:
        super().__init__(ctx, own_shader("surface_point.frag"), (1, 1))

    def under(
        self,
        eye: Eye,
        position: tuple[float, float],
        heights: moderngl.Texture,
        extent: tuple[float, float],
        relief: float,
    ) -> tuple[float, float, float] | None:
        """Return where on the terrain a place of the picture lies, and its height; None where there is sky.

        As ``engine.camera.ground_under``: the place in fractions of the picture from its lower left,
        the answer in fractions of the terrain's sides, east and north; the height as the texture has it.
        The context is the caller's to make current and to leave as it was.
        """
        result = ray_over(eye, position, heights.size, extent)
        if result is None:
            return None
        origin, way, entry, leave, steps = result
        texels = self.compute(
            {"height": heights},
            start=tuple((origin + entry * way).tolist()),
            way=tuple(way.tolist()),
            far=leave - entry,
            steps=steps,
            extent=extent,
            relief=relief,
        )
        east, north, hit, high = texels.ravel().tolist()
        return (east, north, high) if hit else None


Pixel = tuple[int, int]
"""Across and up, from the lower left."""


@dataclass(frozen=True)
class Sample:
    """The texel of one texture at a place."""

    name: str  # "pass" or "pass:output"
    texel: tuple[int, int]
    values: tuple[float, ...]
    metres: float | None = None  # where the number is a height


@dataclass(frozen=True)
class GroundPoint:
    """A point of the terrain."""

    east: float  # [m] from the terrain's south-west corner
    north: float
    height: float  # [m] above the terrain's height 0
    above_sea: float  # [m]
    normal: tuple[float, float, float]  # a unit vector: east, north, up
    slope: float  # [degrees] from level


@dataclass(frozen=True)
class PixelReport:
    """The textures and the terrain under a pixel."""

    pixel: Pixel
    picture: tuple[int, ...]  # the picture's own colour, 0..255, display-encoded
    ground: GroundPoint | None  # None: sky, or no terrain in the picture
    samples: tuple[Sample, ...]
    shown: Sample | None = None  # in a map: the texture that it shows
    missing: tuple[str, ...] = ()  # passes that this picture was made without


@dataclass
class Inspector:
    """Reads the textures under the mouse in one session."""

    session: Session
    on: bool = False
    inner: bool = False  # passes inside techniques as well
    reads: int = 0  # how often anything was read
    _ground: Ground | None = None
    _key: object = None
    _report: PixelReport | None = field(default=None, repr=False)

    def toggle(self) -> None:
        """Switch the inspector on or off."""
        self.on = not self.on

    def at(self, pixel: Pixel, picture: moderngl.Texture) -> PixelReport | None:
        """Return what is under a pixel of the picture; None outside it, and while new data is checked.

        ``picture`` is what the session's last ``frame`` returned.
        """
        width, height = picture.size
        if not (0 <= pixel[0] < width and 0 <= pixel[1] < height):
            return None
        if self.session.awaits_data:
            return None
        key = pixel, self.session.draws, self.inner, id(self.session.engine)
        if key != self._key:
            self._key = key
            with self.session.engine.borrowed():
                self._report = self._look(pixel, picture)
            self.reads += 1
        return self._report

    def release(self) -> None:
        """Release what was made in the engine's context."""
        if self._ground is not None:
            self._ground.release()
        self._ground = self._key = None

    def _look(self, pixel: Pixel, picture: moderngl.Texture) -> PixelReport:
        session, plan = self.session, self.session.plan
        colour = read_texels(picture, pixel, (1, 1))[0, 0]
        bytes_ = tuple(round(float(c) * 255) for c in colour[:3])
        if plan is None:
            return PixelReport(pixel, bytes_, None, ())
        if session.view.map is not None:
            return self._look_at_map(plan, pixel, bytes_, picture.size)
        ref = view_height(plan)
        heights = self._texture(ref)
        extent, relief = plan.terrain.extent, plan.shown_relief
        if heights is None or extent is None or relief is None or not session.orbits:
            return PixelReport(pixel, bytes_, None, ())
        if self._ground is None or self._ground.ctx is not session.engine.ctx:
            self._ground = Ground(session.engine.ctx)
        fraction = (pixel[0] + 0.5) / picture.size[0], (pixel[1] + 0.5) / picture.size[1]
        hit = self._ground.under(plan.eye, fraction, heights, extent, relief)
        if hit is None:
            return PixelReport(pixel, bytes_, None, ())
        samples, missing = self._samples(plan, hit[:2])
        return PixelReport(pixel, bytes_, ground_point_of(plan, heights, hit), samples, None, missing)

    def _look_at_map(
        self, plan: Plan, pixel: Pixel, colour: tuple[int, ...], size: tuple[int, int]
    ) -> PixelReport:
        assert self.session.view.map is not None
        ref = self.session.view.map.ref
        shown = self._texture(ref)
        texel = texel_of_map(pixel, size, shown.size) if shown is not None else None
        if shown is None or texel is None:
            return PixelReport(pixel, colour, None, ())
        fraction = texel[0] / max(shown.size[0] - 1, 1), texel[1] / max(shown.size[1] - 1, 1)
        heights = self._texture(view_height(plan))
        ground = None
        if heights is not None:
            high = read_texels(heights, _node(fraction, heights.size), (1, 1))[0, 0, 0]
            ground = ground_point_of(plan, heights, (*fraction, float(high)))
        samples, missing = self._samples(plan, fraction)
        return PixelReport(pixel, colour, ground, samples, self._sample(plan, ref, shown, texel), missing)

    def _samples(
        self, plan: Plan, fraction: tuple[float, float]
    ) -> tuple[tuple[Sample, ...], tuple[str, ...]]:
        """Return every pass's number at the node of its own that is nearest to a place of the terrain."""
        samples, missing = [], []
        for name in names_of(plan, inner=self.inner):
            texture = self._texture(name)
            if texture is None:
                missing.append(name)
            else:
                samples.append(self._sample(plan, name, texture, _node(fraction, texture.size)))
        return tuple(samples), tuple(missing)

    def _sample(self, plan: Plan, name: str, texture: moderngl.Texture, texel: tuple[int, int]) -> Sample:
        values = tuple(read_texels(texture, texel, (1, 1))[0, 0].tolist())
        relief = plan.terrain.relief
        is_height = len(values) == 1 and name.partition(":")[2] == "height" and relief is not None
        return Sample(name, texel, values, values[0] * relief if is_height and relief is not None else None)

    def _texture(self, name: str) -> moderngl.Texture | None:
        result = self.session.result_of(name)
        return result[0] if result is not None else None


def names_of(plan: Plan, *, inner: bool) -> list[str]:
    """Return the textures of the sketch's own passes as "pass:output", those inside them too on request."""
    names = []
    for path, outputs in plan.flat.outputs.items():
        if path.partition(".")[0] != "view" and (inner or "." not in path):
            names += [f"{path}:{output}" for output in outputs]
    return names


def texel_of_map(pixel: Pixel, size: tuple[int, int], shown: tuple[int, int]) -> tuple[int, int] | None:
    """Return which texel of a texture ``shown`` texels large ``view/map`` puts at a pixel; None outside it.

    In single precision and in the same order as there.
    """
    whole, texels = np.array(size, np.float32), np.array(shown, np.float32)
    worst = (texels / whole).max()
    half = np.float32(0.5)
    texel = (np.array(pixel, np.float32) + half - half * whole) * worst + half * texels
    if (texel < 0).any() or (texel >= texels).any():
        return None
    return int(texel[0]), int(texel[1])


def ground_point_of(plan: Plan, heights: moderngl.Texture, hit: tuple[float, float, float]) -> GroundPoint:
    """Return the terrain's place there; ``hit``: fractions east and north, and the height between the texels.

    The normal is by central differences of the nearest node's neighbours, one-sided on the edge.
    """
    terrain, (nx, ny) = plan.terrain, heights.size
    assert terrain.extent is not None and terrain.relief is not None
    x, y = _node(hit[:2], heights.size)
    west, south, east, north = max(x - 1, 0), max(y - 1, 0), min(x + 1, nx - 1), min(y + 1, ny - 1)
    texels = read_texels(heights, (west, south), (east - west + 1, north - south + 1))[..., 0]
    block = texels.astype(np.float64) * terrain.relief
    row, column = block[y - south], block[:, x - west]
    steps = terrain.extent[0] / max(nx - 1, 1), terrain.extent[1] / max(ny - 1, 1)
    rise = tuple(
        float(line[-1] - line[0]) / ((len(line) - 1) * step) if len(line) > 1 else 0.0
        for line, step in zip((row, column), steps, strict=True)
    )
    steep = math.hypot(*rise)
    long = math.hypot(steep, 1.0)
    high = hit[2] * terrain.relief
    return GroundPoint(
        hit[0] * terrain.extent[0],
        hit[1] * terrain.extent[1],
        high,
        high + (terrain.base_elevation or 0.0),
        (-rise[0] / long, -rise[1] / long, 1.0 / long),
        math.degrees(math.atan(steep)),
    )


def _node(fraction: tuple[float, float], size: tuple[int, int]) -> tuple[int, int]:
    """Return the node nearest to a place, in fractions of the terrain's sides."""
    x, y = (min(max(round(s * (n - 1)), 0), n - 1) for s, n in zip(fraction, size, strict=True))
    return x, y

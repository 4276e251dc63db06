"""Draw the view from the craft: each visible part, then the sky, then the frame for a screen.

A part has textures of its own, so it is one draw; parts out of view are culled. A missing part
is drawn as a plain of the terrain's mean height and colour, mostly within the haze.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from playground.engine.camera import Eye
from playground.engine.engine import Engine
from playground.engine.meshes import skirted
from playground.engine.textures import make_framebuffer, make_texture, read_texture
from playground.flight.craft import Lens
from playground.flight.layout import Plot
from playground.flight.parts import Parts, Slot, daylight_of
from playground.flight.programs import AIR_DIRECTIONS, screen_program, terrain_program
from playground.flight.woods import Woods
from playground.paths import GLSL
from playground.sketch.flat import Ref
from playground.sketch.model import Graph, PassSpec, Sketch
from playground.sketch.techniques import read_technique

if TYPE_CHECKING:
    import moderngl


LEVEL_AT = (0.35, 1.2, 2.6)
"""Parts away from the eye from which each next level is drawn."""
SKIRT = 2.0
"""Depth of a part's skirt over a triangle's side: at most that much is cut from an edge."""
GRAIN = 700.0
"""[m] period of the ground's fine grain, about."""
UNITS = 12
"""Of textures: heights, ground, daylight, grain, air; sky, scattered, left, cloud; woods, their light."""
MAGENTA = (1.0, 0.0, 1.0)


def visibility_range(radius: float) -> float:
    """Return how far terrain is visible [parts] where parts are wanted whose middle is within ``radius``.

    From their middle to their farthest corner is 0.71 parts, and the eye's place is known to 0.18.
    """
    return max(radius - 0.89, 0.5)


class Before(NamedTuple):
    """When and from where sky and air were looked at."""

    eye: tuple[float, float, float]  # [m]
    lens: Lens
    seconds: float


class Scene:
    """Draws on one context, into textures of its own."""

    def __init__(self, engine: Engine, plot: Plot, samples: int) -> None:
        self.ctx = ctx = engine.ctx
        self.plot = plot
        self.samples = samples
        self.drawn = 0  # parts drawn last
        self._end = 0.0  # of the terrain [m]
        self._shown: tuple[tuple[Any, ...], Around] | None = None
        self.triangles = 0  # of the last picture
        self._terrain = terrain_program(ctx)
        self._sky = screen_program(ctx, "sky")
        self._present = screen_program(ctx, "present")
        self._horizon = screen_program(ctx, "air")
        self._levels = steps_of(plot.intervals)
        self._buffers: list[moderngl.Buffer] = []
        self._meshes = [self._mesh(step) for step in self._levels]
        self._plain = self._mesh(plot.intervals)
        self._arrays = {p.glo: ctx.vertex_array(p, []) for p in (self._sky, self._present, self._horizon)}
        self._daylight = make_texture(ctx, (1, 1), "rgba32f", np.array([0, 0, 0, 1], np.float32).tobytes())
        self._flat = make_texture(ctx, (1, 1), "r32f", np.array([0.3], np.float32).tobytes())
        self._mean = make_texture(
            ctx, (1, 1), "rgba16f", np.array([0.1, 0.11, 0.07, 1], np.float16).tobytes()
        )
        self._grain = _grain(ctx)
        self._air = make_texture(ctx, (AIR_DIRECTIONS, 1), "rgba16f")
        self._air.filter = (ctx.LINEAR, ctx.LINEAR)
        self._air.repeat_x = self._air.repeat_y = False
        self._ring = make_framebuffer(ctx, [self._air])
        self._smooth = ctx.sampler(False, False, False, (ctx.LINEAR, ctx.LINEAR))
        self._tiled = ctx.sampler(True, True, False, (ctx.LINEAR_MIPMAP_LINEAR, ctx.LINEAR))
        self._towards_sun = (0.0, 1.0)
        self._take_air()
        self._surface: Surface | None = None
        self._outdoors: Outdoors | None = None
        self.woods: Woods | None = None
        try:
            self._outdoors = Outdoors(engine, plot) if self._natural else None
            self.woods = Woods(engine, plot) if plot.trees is not None else None
        except BaseException:
            self.release()
            raise

    @property
    def _natural(self) -> bool:
        """Whether sky and air are those of a daylight."""
        return self.plot.outdoors is not None

    def take_daylight(self, texture: moderngl.Texture) -> None:
        """Copy the small texture of ``daylight``; another kind of texture of that name is ignored."""
        if texture.components != 4 or texture.dtype not in ("f2", "f4") or texture.width < 2:
            return
        self._daylight.release()
        form = "rgba16f" if texture.dtype == "f2" else "rgba32f"
        self._daylight = make_texture(self.ctx, texture.size, form, texture.read(alignment=1))
        self._daylight.filter = (self.ctx.NEAREST, self.ctx.NEAREST)
        self._take_air()

    def _take_air(self) -> None:
        """Find the sun's direction: the colour of the horizon depends on the angle from it alone."""
        self._light = daylight_of(read_texture(self._daylight))
        east, north, _ = self._light.to_sun
        level = float(np.hypot(east, north))
        self._towards_sun = (east / level, north / level) if level > 1e-9 else (0.0, 1.0)

    def _altitude(self, eye: tuple[float, float, float]) -> float:
        """Return how high the eye is over the sea [km]."""
        return max(eye[2] + self.plot.base, 0.0) / 1000

    def _draw_air(self, eye: tuple[float, float, float]) -> None:
        """Compute the air's colour on the horizon for the eye's height."""
        self._ring.use()
        self._ring.viewport = (0, 0, AIR_DIRECTIONS, 1)
        self.ctx.enable_only(0)
        self.ctx.clear_samplers(0, UNITS)
        self._daylight.use(2)
        view = self.plot.view
        _set(self._horizon, daylight=2, natural=self._natural, zenith=view.zenith, horizon=view.horizon)
        _set(self._horizon, altitude=self._altitude(eye))
        self._arrays[self._horizon.glo].render(self.ctx.TRIANGLES, vertices=3)

    def draw(
        self,
        parts: Parts,
        eye: tuple[float, float, float],
        lens: Lens,
        size: tuple[int, int],
        *,
        seconds: float = 0.0,
        before: Before | None = None,
        bare: bool = False,
    ) -> moderngl.Texture:
        """Draw a picture and return its texture, rgba8, encoded, valid until the next draw.

        Clouds are where the wind has carried them after so many seconds. Sky and air are those of
        ``before``, a little earlier, None: of now. ``bare`` leaves out sky, air, trees and the
        replacement of missing parts, and shows magenta there, to find holes.
        """
        self._end = visibility_range(parts.radius) * self.plot.width
        self._draw_air(eye)
        values = self._view_values(lens, eye)
        around = self._around(before or Before(eye, lens, seconds), size, parts.hour)
        if self._outdoors is not None and around is not None:
            values |= _values_of(around) | {"to_sun": self._light.to_sun}
            values["over_tile"] = self._outdoors.over_tile(eye, seconds)
        if self.woods is not None:
            values |= self.woods.values(parts, eye, lens, self._light) | {"picture": size}
        surface = self._surface_of(size)
        surface.many.use()
        surface.many.viewport = (0, 0, *size)
        surface.many.clear(*MAGENTA, 1.0, depth=1.0)
        self._bind(around)
        self.ctx.enable_only(self.ctx.DEPTH_TEST)
        _set(self._terrain, **values)
        self._draw_terrain(parts, eye, lens, bare=bare)
        if not bare:
            if self.woods is not None:
                self.woods.draw(values)
            # After the terrain: the sky is computed where it is visible only.
            self.ctx.depth_func = "<="
            _set(self._sky, **values)
            self._arrays[self._sky.glo].render(self.ctx.TRIANGLES, vertices=3)
            self.ctx.depth_func = "<"
        self.ctx.enable_only(0)
        self.ctx.clear_samplers(0, UNITS)
        if surface.single is not None:
            self.ctx.copy_framebuffer(surface.single, surface.many)
        surface.shown.use()
        surface.shown.viewport = (0, 0, *size)
        surface.light.use(0)
        _set(self._present, picture=0, exposure=self.plot.view.exposure, tone=self.plot.view.tone)
        _set(self._present, white=self.plot.view.white, plain=bare)
        self._arrays[self._present.glo].render(self.ctx.TRIANGLES, vertices=3)
        return surface.picture

    def release(self) -> None:
        """Release everything."""
        if self._outdoors is not None:
            self._outdoors.release()
        if self.woods is not None:
            self.woods.release()
        if self._surface is not None:
            self._surface.release()
        owned: list[Any] = [array for array, _ in (*self._meshes, self._plain)]
        owned += [*self._arrays.values(), *self._buffers, self._ring]
        owned += [self._terrain, self._sky, self._present, self._horizon]
        owned += [self._daylight, self._flat, self._mean, self._grain, self._air]
        owned += [self._smooth, self._tiled]
        for item in owned:
            item.release()

    # ── the terrain ─────────────────────────────────────────────────────────────

    def _draw_terrain(self, parts: Parts, eye: tuple[float, float, float], lens: Lens, *, bare: bool) -> None:
        plot, program = self.plot, self._terrain
        view = plot.view
        _set(program, heights=0, ground=1, woods=10, spacing=plot.spacing, relief=plot.relief)
        _set(program, width=plot.width, clear=bare)
        _set(program, sea=view.sea, sea_level=view.sea_level - plot.base, eye_up=eye[2])
        _set(program, air_table=4, towards_sun=self._towards_sun, grain=3)
        _set(program, grain_times=max(round(plot.width / GRAIN), 1))
        _set(program, water=view.water, clarity=view.clarity)
        names = sorted(parts.visible)
        slots = [parts.slots.get(name) for name in names]
        there = [s for s in slots if s is not None]
        low_up = min((s.lowest for s in there), default=0.3) * plot.relief
        middle = float(np.mean([s.nodes[0, 0] for s in there])) if there else 0.3
        if there and len(there) < len(slots):
            self._flat.write(np.array([middle], np.float32).tobytes())
            self._mean.write(np.mean([s.mean for s in there], axis=0).astype(np.float16).tobytes())
        corner = np.array(names, np.float64).reshape(-1, 2) * plot.width - eye[:2]
        below = np.array([s.lowest * plot.relief if s else low_up for s in slots])
        above = np.array([s.highest * plot.relief if s else middle * plot.relief for s in slots])
        skirt = 4 * plot.spacing * self._levels[-1]
        sea_up = view.sea_level - plot.base if view.sea else -1e9
        boxes_low = np.column_stack([corner, below - skirt - eye[2]])
        boxes_high = np.column_stack([corner + plot.width, np.maximum(above, sea_up) - eye[2]])
        visible = lens.sees(boxes_low, boxes_high) if names else np.zeros(0, bool)
        gap = np.maximum(np.maximum(boxes_low, -boxes_high), 0.0)
        far = np.sqrt((gap**2).sum(axis=1)) / plot.width
        self.drawn = self.triangles = 0
        # Nearest first: the depth test then skips what they hide.
        for index in np.lexsort((np.arange(len(names)), far)):
            if visible[index]:
                slot = slots[index]
                if slot is None and bare:
                    continue
                ups = float(boxes_low[index, 2]), float(boxes_high[index, 2])
                self._draw_part(slot, corner[index], eye[2], float(far[index]), lens, ups)

    def _draw_part(
        self,
        slot: Slot | None,
        corner: Any,
        eye_up: float,
        far: float,
        lens: Lens,
        heights_of: tuple[float, float],
    ) -> None:
        """Draw a part whose corner is there from the eye, so far away; ``heights_of``: from the eye [m]."""
        if slot is None:
            (array, blocks), step, level = self._plain, self.plot.intervals, len(self._levels)
            heights, ground = self._flat, self._mean
        else:
            level = min(sum(far >= start for start in LEVEL_AT), len(self._levels) - 1)
            (array, blocks), step = self._meshes[level], self._levels[level]
            heights, ground = slot.heights, slot.ground
        heights.use(0)
        ground.use(1)
        if slot is not None and slot.woods is not None:
            slot.woods.use(10)
        _set(self._terrain, wooded=slot is not None and slot.woods is not None)
        _set(self._terrain, corner=(float(corner[0]), float(corner[1]), -eye_up), is_flat=slot is None)
        _set(self._terrain, skirt=SKIRT * self.plot.spacing * step)
        self.drawn += 1
        if level > 0:
            array.render(self.ctx.TRIANGLES)
            self.triangles += sum(block.indices for block in blocks) // 3
            return
        # So large that much of it is beside the picture.
        nodes = np.array([block.nodes for block in blocks], np.float64) * self.plot.spacing
        ups = np.broadcast_to(heights_of, (len(blocks), 2))
        low = np.column_stack([nodes[:, :2] + corner[:2], ups[:, 0]])
        high = np.column_stack([nodes[:, 2:] + corner[:2], ups[:, 1]])
        for index in np.nonzero(lens.sees(low, high))[0]:
            array.render(self.ctx.TRIANGLES, vertices=blocks[index].indices, first=blocks[index].first)
            self.triangles += blocks[index].indices // 3

    def _mesh(self, step: int) -> tuple[moderngl.VertexArray, list[Block]]:
        vertices, indices, blocks = part_mesh(self.plot.intervals, step)
        buffers = self.ctx.buffer(vertices.tobytes()), self.ctx.buffer(indices.tobytes())
        self._buffers += buffers
        array = self.ctx.vertex_array(
            self._terrain, [(buffers[0], "3f", "node")], index_buffer=buffers[1], index_element_size=4
        )
        return array, blocks

    def _around(self, before: Before, size: tuple[int, int], hour: float) -> Around | None:
        """Return air and sky of a moment; computed once for all pictures that take them."""
        if self._outdoors is None:
            return None
        if self._shown is None or self._shown[0] != (before.eye, before.seconds, size, hour):
            drawn = self._outdoors.draw(before.eye, before.lens, size, before.seconds, hour)
            self._shown = (before.eye, before.seconds, size, hour), drawn
        return self._shown[1]

    def _view_values(self, lens: Lens, eye: tuple[float, float, float]) -> dict[str, Any]:
        """Return what all programs are given."""
        view = self.plot.view
        values: dict[str, Any] = {"daylight": 2, "natural": self._natural, "zenith": view.zenith}
        values |= {"horizon": view.horizon, "altitude": self._altitude(eye), "eye_up": eye[2]}
        values |= {"pixel": lens.pixel, "clip_from_near": lens.clip_from_near.T.ravel().tolist()}
        return values | {"near_from_clip": lens.near_from_clip.T.ravel().tolist(), "end": self._end}

    def _bind(self, around: Around | None) -> None:
        """Bind what all programs read."""
        self.ctx.clear_samplers(0, UNITS)
        self._daylight.use(2)
        self._grain.use(3)
        self._air.use(4)
        if around is not None:
            textures = (around.sky, around.scattered, around.left, around.cloud)
            for unit, texture in enumerate(textures, 5):
                texture.use(unit)
                (self._tiled if texture is around.cloud else self._smooth).use(unit)
            if around.table is not None:
                around.table.use(11)

    def _surface_of(self, size: tuple[int, int]) -> Surface:
        if self._surface is None or self._surface.size != size:
            if self._surface is not None:
                self._surface.release()
            self._surface = Surface(self.ctx, size, self.samples)
        return self._surface


class Surface:
    """Framebuffers: light with depth and samples, and the frame for a screen."""

    def __init__(self, ctx: moderngl.Context, size: tuple[int, int], samples: int) -> None:
        self.size = size
        self.light = make_texture(ctx, size, "rgba16f")
        self.light.filter = (ctx.NEAREST, ctx.NEAREST)
        self.picture = make_texture(ctx, size, "rgba8")
        self.picture.filter = (ctx.NEAREST, ctx.NEAREST)
        self.shown = make_framebuffer(ctx, [self.picture])
        self._owned: list[Any] = [self.light, self.picture]
        self.single: moderngl.Framebuffer | None = None
        depth = ctx.depth_renderbuffer(size, samples=samples if samples > 1 else 0)
        if samples > 1:
            colour = ctx.renderbuffer(size, 4, samples=samples, dtype="f2")
            self.many = make_framebuffer(ctx, [colour], depth)
            self.single = make_framebuffer(ctx, [self.light])
            self._owned += [colour]
        else:
            self.many = make_framebuffer(ctx, [self.light], depth)
        self._owned += [depth]

    def release(self) -> None:
        """Release it."""
        for framebuffer in (self.many, self.single, self.shown):
            if framebuffer is not None:
                framebuffer.release()
        for item in self._owned:
            item.release()


def _values_of(around: Around) -> dict[str, Any]:
    """Return what programs are given of what is around the craft."""
    units = {"sky_picture": 5, "scattered": 6, "left": 7, "cloud": 8, "table": 11, "clouded": around.clouded}
    return {**units, "wind": around.wind, "open_mean": around.mean, "outdoors_clip": around.clip}


def _set(program: moderngl.Program, **values: Any) -> None:
    """Set those uniforms that the driver has not optimised out."""
    for name, value in values.items():
        uniform: Any = program.get(name, None)
        if uniform is not None:
            uniform.value = value


def _grain(ctx: moderngl.Context) -> moderngl.Texture:
    """Return periodic noise around a half, of all frequencies but the lowest."""
    side = 128
    random = np.random.default_rng(15)
    fy, fx = np.meshgrid(np.fft.fftfreq(side), np.fft.fftfreq(side), indexing="ij")
    frequency = np.hypot(fx, fy)
    strength = np.where(frequency < 3 / side, 0.0, np.maximum(frequency, 1 / side) ** -0.8)
    channels = []
    for _ in range(2):
        noise = np.fft.ifft2(np.fft.fft2(random.standard_normal((side, side))) * strength).real
        channels.append(np.clip(0.5 + noise / (4 * noise.std()), 0, 1))
    texture = make_texture(
        ctx, (side, side), "rg8", np.round(np.stack(channels, -1) * 255).astype("u1").tobytes()
    )
    texture.build_mipmaps()
    texture.filter = (ctx.LINEAR_MIPMAP_LINEAR, ctx.LINEAR)
    return texture


# ── air and sky ────────────────────────────────────────────────────────────────


CACHE_BYTES = 32 * 2**20
NO_CLOUDS = 0
"""Of the parameter that says which are drawn (clouds/parameters/drawn.glsl)."""

_WOOD, _WOOD_USE, _WOOD_SIZE = "wood_light", "trees/wood", ("24", "216")
_PASS, _USE = "outdoors", "flight/outdoors"
_TABLES = ("columns", "bounced", "dome")  # of the daylight
_CLOUDS = {"cloud": ("clouds/field", "4"), "drift": ("clouds/drift", "1")}  # where a sketch has none


@dataclass(frozen=True)
class Around:
    """What is around the craft in one picture; the textures live until the next one."""

    sky: moderngl.Texture  # rgba16f, the picture's directions
    scattered: moderngl.Texture  # of scene/air
    left: moderngl.Texture
    cloud: moderngl.Texture  # a tile
    wind: tuple[float, ...]  # clouds/drift
    table: moderngl.Texture | None  # of trees/wood, where there are trees
    mean: float  # what clouds leave of the sun on the mean
    clip: list[float]  # the lens of sky and air, columns: from around the eye to the picture
    clouded: bool  # whether clouds are drawn, and throw shadows


class Outdoors:
    """Air, sky and clouds of a sketch with a daylight; use ``release()`` at the end."""

    def __init__(self, engine: Engine, plot: Plot) -> None:
        self._engine = Engine(engine.ctx, driver=engine.driver, cache_bytes=CACHE_BYTES)
        # A processor draws the sky at half the picture's size: all of it is soft.
        self._coarser = 2 if engine.info.software else 1
        self._plot = plot
        self._sketch, self._clouded = _with_outdoors(plot)
        self._table: moderngl.Texture | None = None
        self._table_hour = math.nan
        self._mean: tuple[float, float] | None = None
        # Where the wind carries the clouds in a second, and how wide their tile is.
        try:
            at = [
                self._engine.read(self._sketch, "drift", time=time)[0, 0].astype(np.float64)
                for time in (0, 1)
            ]
        except BaseException:
            self._engine.release()
            raise
        self._still = tuple(float(n) for n in at[0])
        self._wide = self._still[3]
        self._wind = (at[1][:2] - at[0][:2] + self._wide / 2) % self._wide - self._wide / 2

    def draw(
        self, eye: tuple[float, float, float], lens: Lens, size: tuple[int, int], seconds: float, hour: float
    ) -> Around:
        """Compute what is around an eye [m], so many seconds after the start, at a time of day.

        The clouds stay, and the eye goes against the wind: so nothing else depends on the seconds.
        """
        size = max(size[0] // self._coarser, 1), max(size[1] // self._coarser, 1)
        sketch = self._sketch.with_values({self._plot.hour: hour}) if self._plot.hour else self._sketch
        if self._plot.trees is not None and hour != self._table_hour:
            self._take_table(sketch, hour)
        plan = self._engine.plan(sketch, size, ref=_PASS)
        plan = replace(plan, eye=_eye_at(self.over_tile(eye, seconds), lens))
        sky = self._engine.texture_of(plan, plan.flat.ref(_PASS, sketch.name))

        def of(name: str) -> moderngl.Texture:
            ref: Ref = plan.flat.ref(name, sketch.name)
            return self._engine.record.results[ref.path].textures[ref.output]

        air, cloud = (of(f"{_PASS}:scattered"), of(f"{_PASS}:left")), of("cloud")
        clip = lens.clip_from_near.T.ravel().tolist()
        mean = self._mean_of(cloud, hour)
        return Around(sky, *air, cloud, self._still, self._table, mean, clip, self._clouded)

    def over_tile(self, eye: tuple[float, float, float], seconds: float) -> tuple[float, float, float]:
        """Return where an eye is over the clouds' tile [m], after so many seconds."""
        east, north = (np.array(eye[:2]) - self._wind * seconds) % self._wide
        return float(east), float(north), eye[2]

    def _mean_of(self, cloud: moderngl.Texture, hour: float) -> float:
        """Return what clouds leave of the sun on the mean, at a time of day (clouds/shadow)."""
        if self._mean is None or self._mean[0] != hour:
            level = max(cloud.size).bit_length() - 1
            texel = np.frombuffer(cloud.read(level=level, alignment=1), np.float16)
            self._mean = hour, max(float(texel[3]), 1e-4)
        return self._mean[1]

    def _take_table(self, sketch: Sketch, hour: float) -> None:
        """Copy the light on a wood at a time of day."""
        if self._table is not None:
            self._table.release()
        texture = self._engine.texture(sketch, _WOOD)
        self._table = make_texture(self._engine.ctx, texture.size, "rgba32f", texture.read(alignment=1))
        self._table_hour = hour

    def release(self) -> None:
        """Release the engine."""
        if self._table is not None:
            self._table.release()
        self._engine.release()


def _eye_at(position: tuple[float, float, float], lens: Lens) -> Eye:
    shift = np.eye(4)
    shift[:3, 3] = np.negative(position)
    with np.errstate(under="ignore"):
        matrix = (lens.clip_from_near.astype(np.float64) @ shift).astype(np.float32)
    return Eye(matrix, position, position, 1.0)


def _with_outdoors(plot: Plot) -> tuple[Sketch, bool]:
    """Return the sketch with air and sky before its view, and whether clouds are drawn."""
    sketch = plot.sketch
    *passes, view = sketch.graph.passes
    names = {spec.name for spec in passes}
    clouded = names >= _CLOUDS.keys()
    for name, (use, size) in _CLOUDS.items():
        if name not in names:
            passes.append(PassSpec(name, use, read_technique(use, GLSL, GLSL), size=(size, size)))
    technique = read_technique(_USE, GLSL, GLSL)
    assert isinstance(technique, Graph)
    outdoors = dict(plot.outdoors or {})
    if not clouded:
        outdoors["clouds"] = NO_CLOUDS
    inputs = tuple((name, f"daylight:{name}") for name in _TABLES)
    passes.append(PassSpec(_PASS, _USE, technique, inputs=inputs, values=tuple(outdoors.items())))
    if plot.trees is not None:
        wood = read_technique(_WOOD_USE, GLSL, GLSL)
        own = {p.name for p in wood.parameters}
        values = tuple((name, value) for name, value in plot.trees.items() if name in own)
        passes.append(PassSpec(_WOOD, _WOOD_USE, wood, values=values, size=_WOOD_SIZE))
    graph = replace(sketch.graph, passes=(*passes, view))
    return replace(sketch, graph=graph), clouded


# ── meshes of a part ───────────────────────────────────────────────────────────


LEVELS = 4
BLOCKS = 4
"""Of the nearest parts, so many a side are drawn or not."""


class Block(NamedTuple):
    """Some of a part's triangles."""

    first: int  # index
    indices: int
    nodes: tuple[int, int, int, int]  # from east and north to east and north


def steps_of(intervals: int) -> tuple[int, ...]:
    """Return for each level how many intervals a triangle's side spans: 1, 2, 4 … as far as they fit."""
    steps = [1]
    while len(steps) < LEVELS and intervals % (2 * steps[-1]) == 0 and intervals // (2 * steps[-1]) >= 4:
        steps.append(2 * steps[-1])
    return tuple(steps)


def part_mesh(intervals: int, step: int) -> tuple[NDArray[np.float32], NDArray[np.uint32], list[Block]]:
    """Return vertices (n, 3): east node, north node, 1 at the skirt's foot; indices; and blocks.

    The indices of a block follow each other, so that it is drawn alone; the last has the skirt.
    """
    vertices, indices = skirted(np.arange(0, intervals + 1, step, dtype=np.float32))
    triangles = indices.reshape(-1, 3)
    low, foot = vertices[triangles].min(axis=1), vertices[triangles, 2].max(axis=1)
    side = max(intervals // BLOCKS, step)
    blocks = -(-intervals // side)
    number = (low[:, 1] // side * blocks + low[:, 0] // side).astype(int)
    number[foot > 0] = blocks * blocks
    order = np.argsort(number, kind="stable")
    ends = np.searchsorted(number[order], np.arange(blocks * blocks + 1), side="right") * 3
    starts = [0, *ends[:-1].tolist()]
    result = []
    for block, (start, end) in enumerate(zip(starts, ends.tolist(), strict=True)):
        if block == blocks * blocks:
            result.append(Block(start, end - start, (0, 0, intervals, intervals)))
        elif end > start:
            west, south = block % blocks * side, block // blocks * side
            reach = min(west + side, intervals), min(south + side, intervals)
            result.append(Block(start, end - start, (west, south, *reach)))
    return vertices, triangles[order].ravel(), result

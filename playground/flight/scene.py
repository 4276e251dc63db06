"""Draw the view from the craft: each visible part, then the sky, then the frame for a screen.

A part has textures of its own, so it is one draw; parts out of view are culled. A missing part
is drawn as a plain of the terrain's mean height and colour, mostly within the haze.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from playground.flight.layout import Plot
from playground.flight.lens import Lens
from playground.flight.meshes import part_mesh, steps_of
from playground.flight.parts import Parts, Slot
from playground.flight.programs import AIR_DIRECTIONS, screen_program, terrain_program
from playground.gpu.textures import make_framebuffer, make_texture

if TYPE_CHECKING:
    import moderngl

LEVEL_AT = (0.35, 1.2, 2.6)
"""Parts away from the eye from which each next level is drawn."""
SKIRT = 2.0
"""Depth of a part's skirt over a triangle's side: at most that much is cut from an edge."""
GRAIN = 700.0
"""[m] period of the ground's fine grain, about."""
MAGENTA = (1.0, 0.0, 1.0)


def visibility_range(radius: float) -> float:
    """Return how far terrain is visible [parts] where parts are wanted whose middle is within ``radius``.

    From their middle to their farthest corner is 0.71 parts, and the eye's place is known to 0.18.
    """
    return max(radius - 0.89, 0.5)


class Scene:
    """Draws on one context, into textures of its own."""

    def __init__(self, ctx: moderngl.Context, plot: Plot, samples: int) -> None:
        self.ctx = ctx
        self.plot = plot
        self.samples = samples
        self.drawn = 0  # parts drawn last
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
        self._form: type = np.float32
        self._grain = _grain(ctx)
        self._air = make_texture(ctx, (AIR_DIRECTIONS, 1), "rgba16f")
        self._air.filter = (ctx.LINEAR, ctx.LINEAR)
        self._air.repeat_x = self._air.repeat_y = False
        self._ring = make_framebuffer(ctx, [self._air])
        self._towards_sun = (0.0, 1.0)
        self._take_air()
        self._surface: Surface | None = None

    @property
    def _natural(self) -> bool:
        """Whether sky and air are those of a daylight: the view asks for it, and there is one."""
        return self.plot.view.sky == 1 and self._daylight.width > 1

    def take_daylight(self, texture: moderngl.Texture) -> None:
        """Copy the small texture of ``daylight``; another kind of texture of that name is ignored."""
        if texture.components != 4 or texture.dtype not in ("f2", "f4") or texture.width < 2:
            return
        self._form = np.float16 if texture.dtype == "f2" else np.float32
        self._daylight.release()
        form = "rgba16f" if texture.dtype == "f2" else "rgba32f"
        self._daylight = make_texture(self.ctx, texture.size, form, texture.read(alignment=1))
        self._daylight.filter = (self.ctx.NEAREST, self.ctx.NEAREST)
        self._take_air()

    def _take_air(self) -> None:
        """Find the sun's direction: the air's colour depends on the angle from it alone."""
        east, north = (float(n) for n in np.frombuffer(self._daylight.read(alignment=1), self._form)[:2])
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
        self.ctx.clear_samplers(0, 3)
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
        bare: bool = False,
    ) -> moderngl.Texture:
        """Draw a picture and return its texture, rgba8, encoded, valid until the next draw.

        ``bare`` leaves out sky, air and the replacement of missing parts, and shows magenta
        there, to find holes.
        """
        self._draw_air(eye)
        surface = self._surface_of(size)
        surface.many.use()
        surface.many.viewport = (0, 0, *size)
        surface.many.clear(*MAGENTA, 1.0, depth=1.0)
        self.ctx.clear_samplers(0, 5)
        self._grain.use(3)
        self._air.use(4)
        self._daylight.use(2)
        self.ctx.enable_only(self.ctx.DEPTH_TEST)
        self._draw_terrain(parts, eye, lens, bare=bare)
        if not bare:
            # After the terrain: the sky is computed where it is visible only.
            self.ctx.depth_func = "<="
            self._set_sky(self._sky, lens, eye)
            self._arrays[self._sky.glo].render(self.ctx.TRIANGLES, vertices=3)
            self.ctx.depth_func = "<"
        self.ctx.enable_only(0)
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
        if self._surface is not None:
            self._surface.release()
        owned: list[Any] = [array for array, _ in (*self._meshes, self._plain)]
        owned += [*self._arrays.values(), *self._buffers, self._ring]
        owned += [self._terrain, self._sky, self._present, self._horizon]
        owned += [self._daylight, self._flat, self._mean, self._grain, self._air]
        for item in owned:
            item.release()

    # ── the terrain ─────────────────────────────────────────────────────────────

    def _draw_terrain(self, parts: Parts, eye: tuple[float, float, float], lens: Lens, *, bare: bool) -> None:
        plot, program = self.plot, self._terrain
        self._set_sky(program, lens, eye)
        view = plot.view
        _set(program, heights=0, ground=1, spacing=plot.spacing, relief=plot.relief)
        _set(program, width=plot.width, end=visibility_range(parts.radius) * plot.width, clear=bare)
        _set(program, sea=view.sea, sea_level=view.sea_level - plot.base, eye_up=eye[2])
        _set(program, air_table=4, towards_sun=self._towards_sun, grain=3)
        _set(program, grain_times=max(round(plot.width / GRAIN), 1))
        _set(program, water=view.water, clarity=view.clarity)
        names = sorted(parts.wanted)
        found = [parts.slots.get(name) for name in names]
        there = [s for s in found if s is not None]
        low_up = min((s.lowest for s in there), default=0.3) * plot.relief
        middle = float(np.mean([s.nodes[0, 0] for s in there])) if there else 0.3
        if there and len(there) < len(found):
            self._flat.write(np.array([middle], np.float32).tobytes())
            self._mean.write(np.mean([s.mean for s in there], axis=0).astype(np.float16).tobytes())
        corner = np.array(names, np.float64).reshape(-1, 2) * plot.width - eye[:2]
        below = np.array([s.lowest * plot.relief if s else low_up for s in found])
        above = np.array([s.highest * plot.relief if s else middle * plot.relief for s in found])
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
                slot = found[index]
                if slot is None and bare:
                    continue
                self._draw_part(slot, corner[index], eye[2], float(far[index]))

    def _draw_part(self, slot: Slot | None, corner: Any, eye_up: float, far: float) -> None:
        if slot is None:
            array, step = self._plain[0], self.plot.intervals
            heights, ground, count = self._flat, self._mean, self._plain[1]
        else:
            level = min(sum(far >= start for start in LEVEL_AT), len(self._levels) - 1)
            (array, count), step = self._meshes[level], self._levels[level]
            heights, ground = slot.heights, slot.ground
        heights.use(0)
        ground.use(1)
        _set(self._terrain, corner=(float(corner[0]), float(corner[1]), -eye_up), is_flat=slot is None)
        _set(self._terrain, skirt=SKIRT * self.plot.spacing * step)
        array.render(self.ctx.TRIANGLES)
        self.drawn += 1
        self.triangles += count

    def _mesh(self, step: int) -> tuple[moderngl.VertexArray, int]:
        vertices, indices = part_mesh(self.plot.intervals, step)
        buffers = self.ctx.buffer(vertices.tobytes()), self.ctx.buffer(indices.tobytes())
        self._buffers += buffers
        array = self.ctx.vertex_array(
            self._terrain, [(buffers[0], "3f", "node")], index_buffer=buffers[1], index_element_size=4
        )
        return array, len(indices) // 3

    def _set_sky(self, program: moderngl.Program, lens: Lens, eye: tuple[float, float, float]) -> None:
        view = self.plot.view
        _set(program, daylight=2, natural=self._natural, zenith=view.zenith, horizon=view.horizon)
        _set(program, altitude=self._altitude(eye))
        _set(program, pixel=lens.pixel, clip_from_near=lens.clip_from_near.T.ravel().tolist())
        _set(program, near_from_clip=lens.near_from_clip.T.ravel().tolist())

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

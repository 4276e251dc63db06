"""Cut a part out of the textures that a sketch computed for it and its apron."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from playground.engine.textures import make_framebuffer
from playground.flight.layout import Plot
from playground.flight.programs import screen_program

if TYPE_CHECKING:
    import moderngl


PROGRAMS = ("part_heights", "part_ground", "part_map")


class Cutter:
    """Fills a slot's textures; the light is multiplied into the colour that is there."""

    def __init__(self, ctx: moderngl.Context, plot: Plot) -> None:
        self.ctx: Any = ctx
        self.plot = plot
        self._programs = [screen_program(ctx, name) for name in PROGRAMS]
        self._arrays = [ctx.vertex_array(program, []) for program in self._programs]
        self._surfaces: dict[int, moderngl.Framebuffer] = {}  # by the texture's own number

    def heights(self, target: moderngl.Texture, source: moderngl.Texture) -> None:
        """Cut the heights of the part's own nodes."""
        self._draw(0, target, source, apron=self.plot.apron)

    def ground(
        self,
        target: moderngl.Texture,
        name: str,
        source: moderngl.Texture,
        *,
        first: bool,
        sky: tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> None:
        """Cut the part's own texels, over what is there or times it; ``sky``: its light in the source."""
        start, rise = self.plot.shares[name]
        if not first:
            self.ctx.enable_only(self.ctx.BLEND)
            self.ctx.blend_func = self.ctx.DST_COLOR, self.ctx.ZERO
        self._draw(1, target, source, first=start, rise=rise, sky=sky)
        self.ctx.enable_only(0)
        self.ctx.blend_func = self.ctx.DEFAULT_BLENDING

    def woods(self, target: moderngl.Texture, source: moderngl.Texture, channel: int) -> None:
        """Cut one number of the part's own texels into a channel."""
        plot, surface = self.plot, self._surface(target)
        each = (source.width - 1) / (plot.intervals + 2 * plot.apron)
        rise = each * plot.intervals / (target.width - 1)
        surface.color_mask = channel == 0, channel == 1, False, False
        self._draw(2, target, source, first=plot.apron * each, rise=rise)
        surface.color_mask = True, True, True, True

    def sunny(self, target: moderngl.Texture) -> None:
        """Leave all of the sun to woods: the sketch does not say what of it is visible."""
        self._surface(target).clear(0.0, 1.0, 0.0, 0.0)

    def bare(self, target: moderngl.Texture) -> None:
        """Fill with grey: the sketch has neither colour nor light."""
        self._surface(target).clear(0.7, 0.7, 0.7, 1.0)

    def release(self) -> None:
        """Release programs and framebuffers."""
        owned: list[Any] = [*self._surfaces.values(), *self._arrays, *self._programs]
        for item in owned:
            item.release()
        self._surfaces.clear()

    def _draw(self, which: int, target: moderngl.Texture, source: moderngl.Texture, **values: Any) -> None:
        surface = self._surface(target)
        surface.use()
        surface.viewport = (0, 0, *target.size)
        self.ctx.clear_samplers(0, 1)
        source.use(0)
        program = self._programs[which]
        for name, value in {"source": 0, **values}.items():
            program[name].value = value  # type: ignore[union-attr]
        self._arrays[which].render(self.ctx.TRIANGLES, vertices=3)

    def _surface(self, target: moderngl.Texture) -> moderngl.Framebuffer:
        if target.glo not in self._surfaces:
            self._surfaces[target.glo] = make_framebuffer(self.ctx, [target])
        return self._surfaces[target.glo]

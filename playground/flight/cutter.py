"""Cut a part out of the textures that a sketch made of it and its apron."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from playground.flight.layout import Plot
from playground.gpu.textures import make_framebuffer
from playground.gpu.triangle import TRIANGLE

if TYPE_CHECKING:
    import moderngl

_HEIGHTS = """#version 330
uniform sampler2D source;
uniform int apron;
out float height;
void main() { height = texelFetch(source, ivec2(gl_FragCoord.xy) + apron, 0).r; }
"""
# Between texels only where the source is coarser: on a texel the part of the way is 0, and
# a + (b - a) 0 is a to the last bit.
_GROUND = """#version 330
uniform sampler2D source;
uniform float first;
uniform float rise;
out vec4 ground;
void main() {
    vec2 place = first + rise * floor(gl_FragCoord.xy);
    ivec2 low = ivec2(place);
    ivec2 high = min(low + 1, textureSize(source, 0) - 1);
    vec2 share = place - vec2(low);
    vec3 a = texelFetch(source, low, 0).rgb, b = texelFetch(source, ivec2(high.x, low.y), 0).rgb;
    vec3 c = texelFetch(source, ivec2(low.x, high.y), 0).rgb, d = texelFetch(source, high, 0).rgb;
    vec3 south = a + (b - a) * share.x, north = c + (d - c) * share.x;
    ground = vec4(south + (north - south) * share.y, 1.0);
}
"""


class Cutter:
    """Fills a slot's textures; the light is multiplied into the colour that is there."""

    def __init__(self, ctx: moderngl.Context, plot: Plot) -> None:
        self.ctx: Any = ctx
        self.plot = plot
        self._programs = [ctx.program(vertex_shader=TRIANGLE, fragment_shader=t) for t in (_HEIGHTS, _GROUND)]
        self._arrays = [ctx.vertex_array(program, []) for program in self._programs]
        self._surfaces: dict[int, moderngl.Framebuffer] = {}  # by the texture's own number

    def heights(self, target: moderngl.Texture, source: moderngl.Texture) -> None:
        """Cut the heights of the part's own nodes."""
        self._draw(0, target, source, apron=self.plot.apron)

    def ground(self, target: moderngl.Texture, name: str, source: moderngl.Texture, *, first: bool) -> None:
        """Cut the part's own texels, over what is there or times it."""
        start, rise = self.plot.shares[name]
        if not first:
            self.ctx.enable_only(self.ctx.BLEND)
            self.ctx.blend_func = self.ctx.DST_COLOR, self.ctx.ZERO
        self._draw(1, target, source, first=start, rise=rise)
        self.ctx.enable_only(0)
        self.ctx.blend_func = self.ctx.DEFAULT_BLENDING

    def bare(self, target: moderngl.Texture) -> None:
        """Fill with grey: the sketch has neither colour nor light."""
        self._surface(target).clear(0.7, 0.7, 0.7, 1.0)

    def release(self) -> None:
        """Give programs and framebuffers back."""
        kept: list[Any] = [*self._surfaces.values(), *self._arrays, *self._programs]
        for item in kept:
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

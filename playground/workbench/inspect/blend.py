"""Paint two pictures over one another: parted by a line, or their difference."""

from __future__ import annotations

from typing import TYPE_CHECKING

from playground.gpu.triangle import TRIANGLE

if TYPE_CHECKING:
    import moderngl

# As in ``picture.Painter``: texels are fetched, and what has another size is stretched.
_FRAGMENT = """#version 330
uniform sampler2D first;
uniform sampler2D second;
uniform ivec4 area;
uniform float split;  // share of the width; left of it is the first
uniform float gain;   // above 0: so many times the difference
out vec4 colour;
vec3 texel(sampler2D of, vec2 share) {
    ivec2 size = textureSize(of, 0);
    return texelFetch(of, clamp(ivec2(share * vec2(size)), ivec2(0), size - 1), 0).rgb;
}
void main() {
    vec2 share = (gl_FragCoord.xy - vec2(area.xy)) / vec2(area.zw);
    vec3 a = texel(first, share), b = texel(second, share);
    colour = vec4(gain > 0.0 ? gain * abs(a - b) : share.x < split ? a : b, 1.0);
}
"""


class Blend:
    """Paints into whatever framebuffer it is given."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx
        self._program = ctx.program(vertex_shader=TRIANGLE, fragment_shader=_FRAGMENT)
        self._triangle = ctx.vertex_array(self._program, [])

    def paint(
        self,
        pictures: tuple[moderngl.Texture, moderngl.Texture],
        target: moderngl.Framebuffer,
        area: tuple[int, int, int, int],
        *,
        split: float = 0.5,
        gain: float = 0.0,
    ) -> None:
        """Fill ``area`` of the target (x, y from below, width, height [pixels]).

        With a ``gain`` of 0 the first lies left of ``split`` and the second right of it; else what
        is shown is the difference of their display-encoded colours, so many times.
        """
        target.use()
        target.viewport = area
        self.ctx.disable(self.ctx.BLEND | self.ctx.DEPTH_TEST | self.ctx.CULL_FACE)
        self.ctx.clear_samplers(0, 2)
        for unit, texture in enumerate(pictures):
            texture.use(unit)
        given = {"first": 0, "second": 1, "area": area, "split": split, "gain": gain}
        for name, value in given.items():
            self._program[name].value = value  # type: ignore[union-attr]
        self._triangle.render(self.ctx.TRIANGLES, vertices=3)

    def release(self) -> None:
        """Give the program back."""
        self._triangle.release()
        self._program.release()

"""Keep the last good picture in a texture of its own, and put a texture on a screen.

The engine's textures live until its next frame, which may fail; this one stays.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from playground.engine.frame import Frame
from playground.gpu.textures import make_framebuffer, make_texture
from playground.gpu.triangle import TRIANGLE

if TYPE_CHECKING:
    import moderngl

# Texels are fetched, not sampled, so that whatever sampler is bound changes nothing; a
# picture kept from another size is stretched.
_FRAGMENT = """#version 330
uniform sampler2D picture;
uniform ivec4 area;
uniform bool grey;
out vec4 colour;
void main() {
    vec2 share = (gl_FragCoord.xy - vec2(area.xy)) / vec2(area.zw);
    ivec2 size = textureSize(picture, 0);
    vec4 texel = texelFetch(picture, clamp(ivec2(share * vec2(size)), ivec2(0), size - 1), 0);
    colour = vec4(grey ? texel.rrr : texel.rgb, 1.0);
}
"""


class Painter:
    """Draws textures into whatever framebuffer is bound."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx
        self._program = ctx.program(vertex_shader=TRIANGLE, fragment_shader=_FRAGMENT)
        self._triangle = ctx.vertex_array(self._program, [])

    def paint(
        self, texture: moderngl.Texture, target: moderngl.Framebuffer, area: tuple[int, int, int, int]
    ) -> None:
        """Fill ``area`` of the target (x, y from below, width, height [pixels]) with a texture."""
        target.use()
        target.viewport = area
        self.ctx.disable(self.ctx.BLEND | self.ctx.DEPTH_TEST | self.ctx.CULL_FACE)
        self.ctx.clear_samplers(0, 1)
        if texture.filter[0] not in (self.ctx.NEAREST, self.ctx.LINEAR):
            texture.filter = (self.ctx.NEAREST, self.ctx.NEAREST)
        texture.use(0)
        self._set("picture", 0)
        self._set("area", area)
        self._set("grey", texture.components == 1)
        self._triangle.render(self.ctx.TRIANGLES, vertices=3)

    def release(self) -> None:
        """Give the program back."""
        self._triangle.release()
        self._program.release()

    def _set(self, name: str, value: object) -> None:
        self._program[name].value = value  # type: ignore[union-attr]


class Picture:
    """The last good picture, display-encoded."""

    def __init__(self, painter: Painter) -> None:
        self._painter = painter
        self.texture: moderngl.Texture | None = None  # rgba8; None before the first picture
        self._surface: moderngl.Framebuffer | None = None

    def copy(self, texture: moderngl.Texture) -> None:
        """Take a copy of a texture."""
        if self.texture is None or self._surface is None or self.texture.size != texture.size:
            self.release()
            self.texture = make_texture(self._painter.ctx, texture.size, "rgba8")
            self.texture.filter = (self._painter.ctx.NEAREST, self._painter.ctx.NEAREST)
            self._surface = self._painter.ctx.framebuffer([self.texture])
        if (texture.components, texture.dtype, texture.samples) == (4, "f1", 0):
            # Copied, not painted: where the processor draws that takes a tenth of the time.
            source = make_framebuffer(self._painter.ctx, [texture])
            self._painter.ctx.copy_framebuffer(self._surface, source)
            source.release()
        else:
            self._painter.paint(texture, self._surface, (0, 0, *texture.size))

    def frame(self, sketch: str = "", time: float = 0.0) -> Frame | None:
        """Read it back, as what can be saved; None before the first picture."""
        if self.texture is None:
            return None
        width, height = self.texture.size
        rows = np.frombuffer(self.texture.read(alignment=1), np.uint8).reshape(height, width, 4)
        rows = rows[::-1].copy()
        rows[..., 3] = 255  # nothing shows through a window
        return Frame(rows, sketch, time)

    def release(self) -> None:
        """Give the texture back."""
        for kept in (self._surface, self.texture):
            if kept is not None:
                kept.release()
        self.texture = self._surface = None

"""Draw a fragment shader over an area of a framebuffer."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from playground.shader.own_shaders import TRIANGLE

if TYPE_CHECKING:
    import moderngl


class FullScreen:
    """A program that is drawn with a triangle over all of an area; the context is its caller's."""

    def __init__(self, ctx: moderngl.Context, fragment_shader: str) -> None:
        self.ctx = ctx
        self._program = ctx.program(vertex_shader=TRIANGLE, fragment_shader=fragment_shader)
        self._triangle = ctx.vertex_array(self._program, [])

    def draw(
        self,
        target: moderngl.Framebuffer,
        textures: Mapping[str, moderngl.Texture],
        *,
        area: tuple[int, int, int, int] | None = None,
        **uniforms: object,
    ) -> None:
        """Draw over an ``area`` of the target (x, y from below, width, height [pixels]), or all of it.

        A uniform ``area`` is set as well where one is given.
        """
        target.use()
        self.ctx.disable(self.ctx.BLEND | self.ctx.DEPTH_TEST | self.ctx.CULL_FACE)
        if area is not None:
            target.viewport = area
            uniforms["area"] = area
        if textures:
            self.ctx.clear_samplers(0, len(textures))
        for unit, (name, texture) in enumerate(textures.items()):
            texture.use(unit)
            uniforms[name] = unit
        for name, value in uniforms.items():
            self._program[name].value = value  # type: ignore[union-attr]
        self._triangle.render(self.ctx.TRIANGLES, vertices=3)

    def release(self) -> None:
        """Release the program."""
        self._triangle.release()
        self._program.release()

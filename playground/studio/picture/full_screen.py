"""Fragment shaders over an area of a framebuffer: show, enlarge, blend and store pictures, compute texels.

The engine's textures live until its next frame, which may fail; a stored ``Picture`` stays.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.engine.frame import Frame
from playground.engine.textures import make_framebuffer, make_texture
from playground.shader.own_shaders import TRIANGLE, own_part, own_shader

if TYPE_CHECKING:
    import moderngl


class ScreenQuad:
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


class TexelShader(ScreenQuad):
    """Computes a few texels, rgba32f, with a fragment shader; the context is its caller's."""

    def __init__(self, ctx: moderngl.Context, fragment_shader: str, size: tuple[int, int]) -> None:
        super().__init__(ctx, fragment_shader)
        self._texture = make_texture(ctx, size, "rgba32f")
        self._framebuffer = make_framebuffer(ctx, [self._texture])

    def compute(self, textures: Mapping[str, moderngl.Texture], **uniforms: Any) -> NDArray[np.float32]:
        """Return the texels, (height, width, 4), the lowest row first."""
        self.draw(self._framebuffer, textures, **uniforms)
        width, height = self._texture.size
        return np.frombuffer(self._texture.read(), np.float32).reshape(height, width, 4)

    def release(self) -> None:
        """Release the program and its texture."""
        self._framebuffer.release()
        self._texture.release()
        super().release()


class Enlarger:
    """Enlarges pictures in one context, which is its caller's to make current."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx
        self._shaders: dict[tuple[str, bool], ScreenQuad] = {}  # by the way, and whether it is grey
        self._wide: moderngl.Texture | None = None  # enlarged along its rows
        self._surface: moderngl.Framebuffer | None = None

    def draw(self, picture: moderngl.Texture, target: moderngl.Framebuffer) -> None:
        """Fill a target with a display-encoded picture; alpha becomes 1."""
        size = target.width, picture.height
        if self._wide is None or self._surface is None or self._wide.size != size:
            self._release_surface()
            self._wide = make_texture(self.ctx, size, "rgba8")
            self._surface = self.ctx.framebuffer([self._wide])
        rows, columns = size[0] / picture.width, target.height / picture.height
        grey = picture.components == 1
        self._along("1, 0", grey).draw(self._surface, {"picture": picture}, times=rows)
        self._along("0, 1", False).draw(target, {"picture": self._wide}, times=columns)

    def _along(self, way: str, grey: bool) -> ScreenQuad:
        """Return the program that enlarges along rows, "1, 0", or along columns, "0, 1"."""
        if (way, grey) not in self._shaders:
            text = own_part("enlarged.frag", way=way, grey=str(grey).lower())
            self._shaders[way, grey] = ScreenQuad(self.ctx, text)
        return self._shaders[way, grey]

    def release(self) -> None:
        """Release what was made."""
        self._release_surface()
        for shader in self._shaders.values():
            shader.release()
        self._shaders.clear()

    def _release_surface(self) -> None:
        for made in (self._surface, self._wide):
            if made is not None:
                made.release()
        self._surface = self._wide = None


class Blend(ScreenQuad):
    """Paints two pictures into a framebuffer."""

    def __init__(self, ctx: moderngl.Context) -> None:
        super().__init__(ctx, own_shader("blend_images.frag"))

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
        named = dict(zip(("first", "second"), pictures, strict=True))
        self.draw(target, named, area=area, split=split, gain=gain)


class Painter:
    """Draws textures into framebuffers."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx
        self._shader = ScreenQuad(ctx, own_shader("show_image.frag"))

    def paint(
        self, texture: moderngl.Texture, target: moderngl.Framebuffer, area: tuple[int, int, int, int]
    ) -> None:
        """Fill ``area`` of the target (x, y from below, width, height [pixels]) with a texture."""
        if texture.filter[0] not in (self.ctx.NEAREST, self.ctx.LINEAR):
            texture.filter = (self.ctx.NEAREST, self.ctx.NEAREST)
        self._shader.draw(target, {"picture": texture}, area=area, grey=texture.components == 1)

    def release(self) -> None:
        """Release the program."""
        self._shader.release()


class Picture:
    """The last good picture, display-encoded."""

    def __init__(self, painter: Painter) -> None:
        self._painter = painter
        self.texture: moderngl.Texture | None = None  # rgba8; None before the first picture
        self._surface: moderngl.Framebuffer | None = None
        self._enlarger: Enlarger | None = None

    def copy(self, texture: moderngl.Texture, size: tuple[int, int] | None = None) -> None:
        """Take a copy of a texture; of a preview with fewer pixels, enlarged to ``size``."""
        size = size or texture.size
        if self.texture is None or self._surface is None or self.texture.size != size:
            self._release_texture()
            self.texture = make_texture(self._painter.ctx, size, "rgba8")
            self.texture.filter = (self._painter.ctx.NEAREST, self._painter.ctx.NEAREST)
            self._surface = self._painter.ctx.framebuffer([self.texture])
        if texture.size != size:
            self._enlarger = self._enlarger or Enlarger(self._painter.ctx)
            self._enlarger.draw(texture, self._surface)
        elif (texture.components, texture.dtype, texture.samples) == (4, "f1", 0):
            # Copied, not painted: on a software renderer that takes a tenth of the time.
            source = make_framebuffer(self._painter.ctx, [texture])
            self._painter.ctx.copy_framebuffer(self._surface, source)
            source.release()
        else:
            self._painter.paint(texture, self._surface, (0, 0, *size))

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
        """Release what was made."""
        self._release_texture()
        if self._enlarger is not None:
            self._enlarger.release()
        self._enlarger = None

    def _release_texture(self) -> None:
        for made in (self._surface, self.texture):
            if made is not None:
                made.release()
        self.texture = self._surface = None

"""Store the last good picture in a texture of its own, and put a texture on a screen.

The engine's textures live until its next frame, which may fail; this one stays.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from playground.engine.frame import Frame
from playground.engine.textures import make_framebuffer, make_texture
from playground.shader.own_shaders import own_shader
from playground.studio.picture.enlarged import Enlarger
from playground.studio.picture.full_screen import FullScreen

if TYPE_CHECKING:
    import moderngl


class Painter:
    """Draws textures into framebuffers."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx
        self._shader = FullScreen(ctx, own_shader("show_image.frag"))

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

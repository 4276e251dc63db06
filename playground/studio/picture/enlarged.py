"""Enlarge a picture smoothly to the size of another: along its rows, then along its columns."""

from __future__ import annotations

from typing import TYPE_CHECKING

from playground.engine.textures import make_texture
from playground.shader.own_shaders import own_part
from playground.studio.picture.full_screen import FullScreen

if TYPE_CHECKING:
    import moderngl


class Enlarger:
    """Enlarges pictures in one context, which is its caller's to make current."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx
        self._shaders: dict[tuple[str, bool], FullScreen] = {}  # by the way, and whether it is grey
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

    def _along(self, way: str, grey: bool) -> FullScreen:
        """Return the program that enlarges along rows, "1, 0", or along columns, "0, 1"."""
        if (way, grey) not in self._shaders:
            text = own_part("enlarged.frag", way=way, grey=str(grey).lower())
            self._shaders[way, grey] = FullScreen(self.ctx, text)
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

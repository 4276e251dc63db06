"""Paint two pictures over one another: divided by a line, or their difference."""

from __future__ import annotations

from typing import TYPE_CHECKING

from playground.shader.own_shaders import own_shader
from playground.studio.picture.full_screen import FullScreen

if TYPE_CHECKING:
    import moderngl


class Blend(FullScreen):
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

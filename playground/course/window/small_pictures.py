"""Small pictures on a page: textures of arrays, as long as they are drawn."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from imgui_bundle import ImVec2, imgui

from playground.course.tasks.verdict import Picture

if TYPE_CHECKING:
    import moderngl

_MAX_TEXTURES = 24  # textures that are kept; beyond, all are released and made again where they are drawn


@dataclass
class SmallPictures:
    """The textures of one context."""

    ctx: moderngl.Context
    _known: dict[int, tuple[Picture, moderngl.Texture]] = field(default_factory=dict)

    def draw(self, picture: Picture, wide: float) -> None:
        """Draw a picture (h, w, 3), top row first, so many pixels wide."""
        if id(picture) not in self._known:
            if len(self._known) >= _MAX_TEXTURES:
                self.release()
            self._known[id(picture)] = picture, self._texture(picture)
        height, width, _ = picture.shape
        imgui.image(imgui.ImTextureRef(self._known[id(picture)][1].glo), ImVec2(wide, wide * height / width))

    def release(self) -> None:
        """Release all textures."""
        cached, self._known = self._known, {}
        for _, texture in cached.values():
            texture.release()

    def _texture(self, picture: Picture) -> moderngl.Texture:
        height, width, _ = picture.shape
        data = np.ascontiguousarray(picture).tobytes()
        texture = self.ctx.texture((width, height), 3, data, alignment=1)
        texture.filter = (self.ctx.LINEAR, self.ctx.LINEAR)
        texture.repeat_x = texture.repeat_y = False
        return texture

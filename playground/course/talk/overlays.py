"""Images of Pillow over the picture in the window, each a texture until another takes its place."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from imgui_bundle import ImVec2, imgui

if TYPE_CHECKING:
    import moderngl
    from PIL.Image import Image


@dataclass
class Overlays:
    """The images of one context, by name."""

    _known: dict[str, tuple[object, moderngl.Texture | None]] = field(default_factory=dict)

    def knows(self, name: str, key: object) -> bool:
        """Return whether the image of that name is the one for a key."""
        return name in self._known and self._known[name][0] == key

    def put(self, name: str, key: object, image: Image | None, ctx: moderngl.Context) -> None:
        """Take an image for a key, in place of the one before; None: nothing is shown."""
        before = self._known.get(name, (None, None))[1]
        if before is not None:
            before.release()
        texture = None
        if image is not None:
            texture = ctx.texture(image.size, 4, image.tobytes(), alignment=1)
            texture.filter = (ctx.LINEAR, ctx.LINEAR)
        self._known[name] = key, texture

    def draw(self, name: str, position: tuple[float, float], density: float) -> None:
        """Draw an image with its upper left corner at a place, in the window's units."""
        texture = self._known.get(name, (None, None))[1]
        if texture is not None:
            low = ImVec2(*position)
            high = ImVec2(low.x + texture.size[0] / density, low.y + texture.size[1] / density)
            imgui.get_background_draw_list().add_image(imgui.ImTextureRef(texture.glo), low, high)

    def release(self) -> None:
        """Release all; they are made again where they are needed."""
        cached, self._known = self._known, {}
        for _, texture in cached.values():
            if texture is not None:
                texture.release()

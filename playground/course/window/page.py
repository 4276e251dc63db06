"""What every block of a page is drawn with: the reader, the texts, the buttons."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from imgui_bundle import ImVec2, imgui

from playground.course.model import Lesson, Markdown
from playground.course.tasks.verdict import Picture
from playground.course.typeset import written
from playground.course.window.prose import Prose
from playground.course.window.reader import Reader
from playground.live import theme
from playground.live.draw import button, inked, pushed_id, styled
from playground.live.panel_memory import Memory
from playground.live.theme import Theme

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


TEXT = theme.TEXT_SIZE + 1.0
"""Of a lesson's text: it is read at length."""


@dataclass
class Page:
    """What the blocks of a page are drawn with, in one frame."""

    reader: Reader
    lesson: Lesson
    look: Theme
    prose: Prose
    memory: Memory  # of the parameters' rows
    pictures: SmallPictures
    present: Callable[[], None]  # begins a presentation of the lesson

    def say(self, key: str, *arguments: object) -> str:
        """Return a label of the interface."""
        return self.reader.say(key, *arguments)

    def text(self, words: Markdown, *, size: float = TEXT, dim: bool = False) -> None:
        """Draw a text of the lesson, its numbers in their places."""
        if words:
            ink = theme.packed(theme.DIM if dim else theme.INK)
            filled = self.reader.numbers.fill(words, self.lesson)
            self.prose.draw(filled, self.look, size=size, ink=ink)

    def plain(self, words: str, rgb: theme.Rgb = theme.INK) -> None:
        """Draw a text that is no Markdown, as a compiler's words, wrapped."""
        with self.look.font(self.look.code, theme.SMALL), inked(rgb):
            imgui.text_wrapped(written(words))

    def behind(self, name: str, what: str, words: Markdown, label: str = "") -> None:
        """Draw a button, and what it uncovers; nothing where there is nothing behind it."""
        shown, key = self.reader.shown, (name, what)
        if not words:
            return
        if key not in shown:
            if self.button(label or self.say(what)):
                shown.add(key)
            return
        self.text(words)
        if self.button(f"{self.say('hide')}##{what}"):
            shown.discard(key)

    def label(self, text: str, rgb: theme.Rgb = theme.ACCENT) -> None:
        """Write a block's label."""
        with self.look.font(self.look.bold, theme.SMALL):
            imgui.text_colored(theme.colour(rgb), text)

    @contextmanager
    def frame(self, name: str, rgb: theme.Rgb = theme.LINE) -> Iterator[None]:
        """Draw the block inside with a bar on its left."""
        scale = self.look.scale
        with pushed_id(name):
            top = imgui.get_cursor_screen_pos()
            imgui.indent(12 * scale)
            imgui.begin_group()
            yield
            imgui.end_group()
            imgui.unindent(12 * scale)
            corner = ImVec2(top.x + 3 * scale, imgui.get_item_rect_max().y)
            draw = imgui.get_window_draw_list()
            draw.add_rect_filled(ImVec2(top.x, top.y), corner, theme.packed(rgb), 1.5 * scale)

    def button(self, text: str, note: str = "", *, on: bool = False, enabled: bool = True) -> bool:
        """Draw a button; ``on``: it is in effect already. Return whether it is pressed."""
        with styled({imgui.Col_.button: theme.colour(theme.ACCENT, 0.45)} if on else {}):
            return button(written(text), written(note), enabled=enabled)

    def same_line(self, text: str) -> None:
        """Stay on the same line where a button with this text has room there."""
        style = imgui.get_style()
        wide = imgui.calc_text_size(text, True).x + 2 * style.frame_padding.x
        right = imgui.get_item_rect_max().x + style.item_spacing.x + wide
        edge = imgui.get_cursor_screen_pos().x + imgui.get_content_region_avail().x
        if right <= edge:
            imgui.same_line()

"""What every block of a page is drawn with: the reader, texts laid out once for each width, buttons."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from imgui_bundle import ImVec2, imgui
from numpy.typing import NDArray

from playground.course.model import Lesson, Markdown
from playground.course.tasks import Picture
from playground.course.typeset import (
    FORMULA_SIZE,
    Extent,
    Layout,
    Placed,
    Run,
    Spacing,
    laid_out,
    set_formula,
    written,
)
from playground.course.window.reader import Reader
from playground.studio import theme
from playground.studio.draw import button, explain, inked, pushed_id, styled
from playground.studio.panel.parameter_list import PanelState
from playground.studio.theme import Theme

if TYPE_CHECKING:
    import moderngl

Pixels = NDArray[np.uint8]

_SPACING = Spacing(
    gap=9.0,
    close=4.0,
    leading=3.0,
    indent=20.0,
    mark=6.0,
    cell=12.0,
    above_rule=3.0,
    below_rule=4.0,
    rule=1.0,
    code=8.0,
    least=40.0,
    headings=(6.0, 4.0, 2.0),
    centres=True,
)
"""In units of scale 1."""
_PAD = 3.0  # around code in a line
_CACHED = 400


@dataclass
class Textures:
    """Pictures as textures of one context, top row first: one by each name, made again for another key.

    Beyond ``most`` all are released, and made again where they are drawn.
    """

    ctx: moderngl.Context
    most: int = 300
    _known: dict[object, tuple[object, Callable[[], Pixels | None], moderngl.Texture | None]] = field(
        default_factory=dict
    )

    def get(
        self, name: object, make: Callable[[], Pixels | None], key: object = None
    ) -> moderngl.Texture | None:
        """Return the texture of what ``make`` returns, (h, w, 3 or 4) of uint8; None where that is None."""
        if name not in self._known or self._known[name][0] != key:
            if len(self._known) >= self.most:
                self.release()
            if (before := self._known.pop(name, (None, make, None))[2]) is not None:
                before.release()
            pixels = make()
            self._known[name] = key, make, None if pixels is None else self._texture(pixels)
        return self._known[name][2]

    def release(self) -> None:
        """Release all textures."""
        cached, self._known = self._known, {}
        for _, _, texture in cached.values():
            if texture is not None:
                texture.release()

    def _texture(self, pixels: Pixels) -> moderngl.Texture:
        height, width, channels = pixels.shape
        data = np.ascontiguousarray(pixels).tobytes()
        texture = self.ctx.texture((width, height), channels, data, alignment=1)
        texture.filter = (self.ctx.LINEAR, self.ctx.LINEAR)
        texture.repeat_x = texture.repeat_y = False
        return texture


def draw_picture(textures: Textures, picture: Picture, wide: float) -> None:
    """Draw a picture (h, w, 3), top row first, so many pixels wide."""
    texture = textures.get(id(picture), lambda: picture)  # it is kept with the texture: so is its id
    assert texture is not None
    height, width, _ = picture.shape
    imgui.image(imgui.ImTextureRef(texture.glo), ImVec2(wide, wide * height / width))


@dataclass
class Prose:
    """Draws texts.

    ``follow`` receives the address of a link that is clicked on; ``describe`` returns the tooltip of one.
    """

    textures: Callable[[], Textures]
    follow: Callable[[str], None]
    describe: Callable[[str], str]
    _layouts: dict[object, Layout] = field(default_factory=dict)

    def draw(
        self,
        words: str,
        look: Theme,
        *,
        size: float = theme.TEXT_SIZE,
        ink: int | None = None,
    ) -> None:
        """Draw a text where the cursor is, over the width that is left."""
        wide = imgui.get_content_region_avail().x
        ink = theme.packed(theme.palette.ink) if ink is None else ink
        layout = self._layout_of(words, look, size, ink, wide)
        corner = imgui.get_cursor_screen_pos()
        imgui.dummy(ImVec2(min(layout.width, wide), max(layout.height, 1.0)))
        if not imgui.is_item_visible():
            return
        draw = imgui.get_window_draw_list()
        for piece in layout.pieces:
            x, y = corner.x + piece.x, corner.y + piece.y
            if piece.box is not None:
                wide_box, high_box, what = piece.box
                colour = theme.packed(theme.palette.line if what == "rule" else theme.palette.field)
                draw.add_rect_filled(ImVec2(x, y), ImVec2(x + wide_box, y + high_box), colour, 4 * look.scale)
            elif piece.line is not None:
                for run in piece.line.runs:
                    self._run(run, x, y + piece.line.ascent, piece.size, ink, look)

    # ── layout ───────────────────────────────────────────────────────────────

    def _layout_of(self, words: str, look: Theme, size: float, ink: int, width: float) -> Layout:
        key = words, size, ink, round(width), look.scale
        if key not in self._layouts:
            if len(self._layouts) >= _CACHED:
                self._layouts.clear()

            def extent(run: Run, size: float) -> Extent:
                return self._extent(run, size, ink, look)

            self._layouts[key] = laid_out(words, size, width, _SPACING.scaled(look.scale), extent)
        return self._layouts[key]

    def _extent(self, run: Run, size: float, ink: int, look: Theme) -> Extent:
        if run.formula:
            formula = self._formula(run, size, ink, look)
            if formula is not None:
                width, height, baseline, _ = formula
                return Extent(width, baseline, height - baseline)
        with look.font(*_font(run, size, look)):
            text = imgui.calc_text_size(written(run.text))
            ascent = imgui.get_font_baked().ascent
        pad = 2 * _PAD * look.scale if run.code and not run.alone and run.text.strip() else 0.0
        return Extent(text.x + pad, ascent, max(text.y - ascent, 0.0))

    def _formula(
        self, run: Run, size: float, ink: int, look: Theme
    ) -> tuple[float, float, float, imgui.ImTextureRef] | None:
        """Return a formula's width, height and baseline in the window's units, and its texture."""
        density = imgui.get_io().display_framebuffer_scale.x or 1.0
        letters = round(size * look.scale * density * FORMULA_SIZE)
        formula = set_formula(run.text, letters, ink, display=run.alone)
        if formula is None:
            return None
        texture = self.textures().get((run.text, letters, ink, run.alone), lambda: formula.pixels)
        assert texture is not None
        wide, high = texture.size
        return wide / density, high / density, formula.baseline / density, imgui.ImTextureRef(texture.glo)

    # ── drawing ──────────────────────────────────────────────────────────────

    def _run(self, placed_run: Placed, x: float, baseline: float, size: float, ink: int, look: Theme) -> None:
        run, extent = placed_run.run, placed_run.extent
        draw = imgui.get_window_draw_list()
        low = ImVec2(x + placed_run.x, baseline - extent.ascent)
        high = ImVec2(low.x + extent.width, baseline + extent.descent)
        if run.formula:
            formula = self._formula(run, size, ink, look)
            if formula is not None:
                corner = ImVec2(round(low.x), round(low.y))  # on whole pixels, so that it stays sharp
                draw.add_image(formula[3], corner, ImVec2(corner.x + formula[0], corner.y + formula[1]))
                return
        font, size = _font(run, size, look)
        text = written(run.text)
        if run.code and not run.alone and text.strip():
            draw.add_rect_filled(low, high, theme.packed(theme.palette.field), 3 * look.scale)
            low = ImVec2(low.x + _PAD * look.scale, low.y)
        if run.link:
            ink = theme.packed(theme.palette.accent)
            self._link(run, low, high, baseline)
        draw.add_text(font, size * look.scale, low, ink, text)

    def _link(self, run: Run, low: ImVec2, high: ImVec2, baseline: float) -> None:
        draw = imgui.get_window_draw_list()
        under = imgui.is_window_hovered() and imgui.is_mouse_hovering_rect(low, high)
        alpha = 1.0 if under else 0.45
        line = baseline + 2
        draw.add_line(ImVec2(low.x, line), ImVec2(high.x, line), theme.packed(theme.palette.accent, alpha))
        if under:
            imgui.set_mouse_cursor(imgui.MouseCursor_.hand)
            explain(written(self.describe(run.link)), "")
            if imgui.is_mouse_released(0) and not imgui.is_mouse_dragging(0):
                self.follow(run.link)


def _font(run: Run, size: float, look: Theme) -> tuple[imgui.ImFont, float]:
    if run.code or run.formula:
        return look.code, size
    return (look.bold if run.bold else look.italic if run.italic else look.text), size


TEXT = theme.TEXT_SIZE + 1.0
"""Of a lesson's text: it is read at length."""


@dataclass
class Page:
    """What the blocks of a page are drawn with, in one frame."""

    reader: Reader
    lesson: Lesson
    look: Theme
    prose: Prose
    memory: PanelState  # of the parameters' rows
    textures: Textures
    present: Callable[[], None]  # begins a presentation of the lesson

    def say(self, key: str, *arguments: object, **named: object) -> str:
        """Return a label of the interface."""
        return self.reader.say(key, *arguments, **named)

    def text(self, words: Markdown, *, size: float = TEXT, dim: bool = False) -> None:
        """Draw a text of the lesson, its numbers in their places."""
        if words:
            ink = theme.packed(theme.palette.dim if dim else theme.palette.ink)
            filled = self.reader.numbers.fill(words, self.lesson)
            self.prose.draw(filled, self.look, size=size, ink=ink)

    def plain(self, words: str, rgb: theme.Rgb | None = None) -> None:
        """Draw a text that is no Markdown, as a compiler's words, wrapped."""
        with self.look.font(self.look.code, theme.SMALL), inked(rgb or theme.palette.ink):
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

    def label(self, text: str, rgb: theme.Rgb | None = None) -> None:
        """Write a block's label."""
        with self.look.font(self.look.bold, theme.SMALL):
            imgui.text_colored(theme.colour(rgb or theme.palette.accent), text)

    @contextmanager
    def frame(self, name: str, rgb: theme.Rgb | None = None) -> Iterator[None]:
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
            draw.add_rect_filled(
                ImVec2(top.x, top.y), corner, theme.packed(rgb or theme.palette.line), 1.5 * scale
            )

    def button(self, text: str, note: str = "", *, on: bool = False, enabled: bool = True) -> bool:
        """Draw a button; ``on``: it is in effect already. Return whether it is pressed."""
        with styled({imgui.Col_.button: theme.colour(theme.palette.accent, 0.45)} if on else {}):
            return button(written(text), written(note), enabled=enabled)

    def same_line(self, text: str) -> None:
        """Stay on the same line where a button with this text has room there."""
        style = imgui.get_style()
        wide = imgui.calc_text_size(text, True).x + 2 * style.frame_padding.x
        right = imgui.get_item_rect_max().x + style.item_spacing.x + wide
        edge = imgui.get_cursor_screen_pos().x + imgui.get_content_region_avail().x
        if right <= edge:
            imgui.same_line()

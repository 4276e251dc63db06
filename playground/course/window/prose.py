"""Markdown in the window: its layout is computed once for each width, then it is drawn line by line.

Formulas are on the baseline of their line, or in the middle of one of their own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from imgui_bundle import ImVec2, imgui

from playground.course.window.formulas import Formulas
from playground.course.window.line_breaking import Extent, Line, Placed, broken
from playground.course.window.markdown_runs import Run, Runs, TextBlock, parts_of, written
from playground.live import theme
from playground.live.panel_rows import explain
from playground.live.theme import Theme

_GAP, _CLOSE = 9.0, 4.0  # between parts, in units of scale 1
_LEADING = 3.0
_INDENT = 20.0
_CELL = 12.0
_PAD = 3.0  # around code in a line
_HEADINGS = {1: 6.0, 2: 4.0, 3: 2.0}  # how much larger
_CACHED = 400


@dataclass(frozen=True)
class _Style:
    """What all of a text is drawn with."""

    size: float
    ink: int
    scale: float


@dataclass(frozen=True)
class _Piece:
    """A line in its place, or a rectangle."""

    x: float
    y: float  # of the line's top
    line: Line | None = None
    box: tuple[float, float, int] = (0.0, 0.0, 0)  # width, height, colour


@dataclass(frozen=True)
class _Layout:
    pieces: tuple[tuple[_Piece, _Style], ...]
    height: float
    width: float


@dataclass
class _Typesetter:
    """Puts the parts of a text one below the other; ``y`` is where the last one ends."""

    look: Theme
    style: _Style
    width: float
    extent: Callable[[Run, _Style, Theme], Extent]
    y: float = 0.0
    pieces: list[tuple[_Piece, _Style]] = field(default_factory=list)

    def add(self, part: TextBlock) -> None:
        """Put a part below those before it."""
        left = part.indent * _INDENT * self.look.scale
        room = max(self.width - left, 40.0 * self.look.scale)
        if part.kind == "rule":
            self._box(0, self.width, self.look.scale, theme.LINE)
            self.y += self.look.scale
        elif part.kind == "table":
            self._table(part, left, room)
        elif part.kind == "code":
            self._code(part, left, room)
        else:
            self._paragraph(part, left, room)

    def _paragraph(self, part: TextBlock, left: float, room: float) -> None:
        runs, style, leading = part.runs, self.style, _LEADING * self.look.scale
        if part.kind == "heading":
            style = replace(style, size=style.size + _HEADINGS.get(part.level, 0.0))
            runs = tuple(replace(run, bold=True) for run in runs)
        lines = self._lines(runs, room, style)
        if part.mark and lines:
            mark = self._lines((Run(part.mark),), room, style)[0]
            left_edge = left - mark.width - 6 * self.look.scale
            self.pieces.append((_Piece(left_edge, self.y + lines[0].ascent - mark.ascent, mark), style))
        for line in lines:
            x = left + max(room - line.width, 0.0) / 2 if part.kind == "formula" else left
            self.pieces.append((_Piece(x, self.y, line), style))
            self.y += line.ascent + line.descent + leading
        self.y -= leading if lines else 0.0

    def _code(self, part: TextBlock, left: float, room: float) -> None:
        pad, at, top = 8 * self.look.scale, len(self.pieces), self.y
        self.y += pad
        for text in part.runs[0].text.split("\n"):
            # Blanks at the start of a line of code are its indentation.
            run = Run(text.replace(" ", "\u00a0"), code=True, alone=True)
            lines = self._lines((run,), room - 2 * pad, self.style)
            for line in lines:
                self.pieces.append((_Piece(left + pad, self.y, line), self.style))
                self.y += line.ascent + line.descent
            if not lines:
                self.y += self.extent(Run("", code=True), self.style, self.look).ascent
        self.y += pad
        ground = _Piece(left, top, box=(room, self.y - top, theme.packed(theme.FIELD)))
        self.pieces.insert(at, (ground, self.style))

    def _table(self, part: TextBlock, left: float, room: float) -> None:
        gap, scale = _CELL * self.look.scale, self.look.scale
        count = max(map(len, part.rows), default=0)
        target = [0.0] * count
        for row in part.rows:
            for column, cell in enumerate(row):
                lines = self._lines(cell, 1e6, self.style)
                target[column] = max([target[column], *(line.width for line in lines)])
        gaps = gap * max(count - 1, 0)
        widths = _shared(target, room - gaps)
        for number, row in enumerate(part.rows):
            x, bottom = left, self.y
            for column, cell in enumerate(row):
                down = self.y
                for line in self._lines(cell, widths[column] + 1, self.style):
                    shift = widths[column] - line.width if part.numbers[column] else 0.0
                    self.pieces.append((_Piece(x + shift, down, line), self.style))
                    down += line.ascent + line.descent
                bottom = max(bottom, down)
                x += widths[column] + gap
            self.y = bottom + 3 * scale
            self._box(left, sum(widths) + gaps, scale, theme.LINE if number == 0 else theme.FIELD)
            self.y += 4 * scale

    def _lines(self, runs: Runs, room: float, style: _Style) -> tuple[Line, ...]:
        return broken(runs, room, lambda run: self.extent(run, style, self.look))

    def _box(self, x: float, wide: float, high: float, rgb: theme.Rgb) -> None:
        self.pieces.append((_Piece(x, self.y, box=(wide, high, theme.packed(rgb))), self.style))


@dataclass
class Prose:
    """Draws texts.

    ``follow`` receives the address of a link that is clicked on; ``describe`` returns the tooltip of one.
    """

    formulas: Callable[[], Formulas]
    follow: Callable[[str], None]
    describe: Callable[[str], str]
    _layouts: dict[object, _Layout] = field(default_factory=dict)

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
        layout = self._layout_of(words, look, size, theme.packed(theme.INK) if ink is None else ink, wide)
        corner = imgui.get_cursor_screen_pos()
        imgui.dummy(ImVec2(min(layout.width, wide), max(layout.height, 1.0)))
        if not imgui.is_item_visible():
            return
        draw = imgui.get_window_draw_list()
        for piece, style in layout.pieces:
            x, y = corner.x + piece.x, corner.y + piece.y
            if piece.line is None:
                wide_box, high_box, colour = piece.box
                draw.add_rect_filled(ImVec2(x, y), ImVec2(x + wide_box, y + high_box), colour, 4 * look.scale)
            else:
                for run in piece.line.runs:
                    self._run(run, x, y + piece.line.ascent, style, look)

    # ── layout ───────────────────────────────────────────────────────────────

    def _layout_of(self, words: str, look: Theme, size: float, ink: int, width: float) -> _Layout:
        key = words, size, ink, round(width), look.scale
        if key not in self._layouts:
            if len(self._layouts) >= _CACHED:
                self._layouts.clear()
            self._layouts[key] = self._layout(words, look, size, ink, width)
        return self._layouts[key]

    def _layout(self, words: str, look: Theme, size: float, ink: int, width: float) -> _Layout:
        setter = _Typesetter(look, _Style(size, ink, look.scale), width, self._extent)
        for number, part in enumerate(parts_of(words)):
            if number:
                setter.y += (_CLOSE if part.close else _GAP) * look.scale
            setter.add(part)
        widest = max((p.x + (p.line.width if p.line else p.box[0]) for p, _ in setter.pieces), default=0.0)
        return _Layout(tuple(setter.pieces), setter.y, widest)

    def _extent(self, run: Run, style: _Style, look: Theme) -> Extent:
        if run.formula:
            formula = self._formula(run, style)
            if formula is not None:
                width, height, baseline, _ = formula
                return Extent(width, baseline, height - baseline)
        with look.font(*_font(run, style.size, look)):
            size = imgui.calc_text_size(_shown(run))
            ascent = imgui.get_font_baked().ascent
        pad = 2 * _PAD * style.scale if run.code and not run.alone and run.text.strip() else 0.0
        return Extent(size.x + pad, ascent, max(size.y - ascent, 0.0))

    def _formula(self, run: Run, style: _Style) -> tuple[float, float, float, imgui.ImTextureRef] | None:
        """Return a formula's width, height and baseline in the window's units, and its texture."""
        density = imgui.get_io().display_framebuffer_scale.x or 1.0
        # Latin Modern's letters are smaller than those of a text of the same size.
        size = style.size * style.scale * density * 1.12
        formula = self.formulas().get(run.text, size, style.ink, display=run.alone)
        if formula is None:
            return None
        texture, baseline = formula
        wide, high = texture.size
        return wide / density, high / density, baseline / density, imgui.ImTextureRef(texture.glo)

    # ── drawing ──────────────────────────────────────────────────────────────

    def _run(self, placed_run: Placed, x: float, baseline: float, style: _Style, look: Theme) -> None:
        run, extent = placed_run.run, placed_run.extent
        draw = imgui.get_window_draw_list()
        low = ImVec2(x + placed_run.x, baseline - extent.ascent)
        high = ImVec2(low.x + extent.width, baseline + extent.descent)
        if run.formula:
            formula = self._formula(run, style)
            if formula is not None:
                corner = ImVec2(round(low.x), round(low.y))  # on whole pixels, so that it stays sharp
                draw.add_image(formula[3], corner, ImVec2(corner.x + formula[0], corner.y + formula[1]))
                return
        font, size = _font(run, style.size, look)
        text, ink = _shown(run), style.ink
        if run.code and not run.alone and text.strip():
            draw.add_rect_filled(low, high, theme.packed(theme.FIELD), 3 * look.scale)
            low = ImVec2(low.x + _PAD * look.scale, low.y)
        if run.link:
            ink = theme.packed(theme.ACCENT)
            self._link(run, low, high, baseline)
        draw.add_text(font, size * look.scale, low, ink, text)

    def _link(self, run: Run, low: ImVec2, high: ImVec2, baseline: float) -> None:
        draw = imgui.get_window_draw_list()
        under = imgui.is_window_hovered() and imgui.is_mouse_hovering_rect(low, high)
        alpha = 1.0 if under else 0.45
        line = baseline + 2
        draw.add_line(ImVec2(low.x, line), ImVec2(high.x, line), theme.packed(theme.ACCENT, alpha))
        if under:
            imgui.set_mouse_cursor(imgui.MouseCursor_.hand)
            explain(written(self.describe(run.link)), "")
            if imgui.is_mouse_released(0) and not imgui.is_mouse_dragging(0):
                self.follow(run.link)


def _font(run: Run, size: float, look: Theme) -> tuple[imgui.ImFont, float]:
    if run.code or run.formula:
        return look.code, size
    return (look.bold if run.bold else look.italic if run.italic else look.text), size


def _shown(run: Run) -> str:
    return written(run.text)


def _shared(values: list[float], room: float) -> list[float]:
    """Return the widths of columns: what they want where there is room, else narrow ones whole."""
    if sum(values) <= room:
        return values
    widths, left = list(values), room
    open_columns = sorted(range(len(values)), key=lambda column: values[column])
    for number, column in enumerate(open_columns):
        share = left / (len(open_columns) - number)
        widths[column] = min(values[column], share)
        left -= widths[column]
    return widths

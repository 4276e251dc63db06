"""Markdown in the window: its layout is computed once for each width, then it is drawn line by line.

Formulas are on the baseline of their line, or in the middle of one of their own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from imgui_bundle import ImVec2, imgui

from playground.live import theme
from playground.live.lesson.formulas import Formulas
from playground.live.lesson.line_breaking import Extent, Line, Placed, broken
from playground.live.lesson.markdown_runs import Part, Run, Runs, parts_of, written
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
        width: float = 0.0,
    ) -> None:
        """Draw a text where the cursor is, over the width that is left or one of its own."""
        wide = width or imgui.get_content_region_avail().x
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
                for placed in piece.line.placed:
                    self._run(placed, x, y + piece.line.ascent, style, look)

    def height(self, words: str, look: Theme, width: float, size: float = theme.TEXT_SIZE) -> float:
        """Return how high a text is at a width, in the window's units."""
        return self._layout_of(words, look, size, theme.packed(theme.INK), width).height

    # ── layout ───────────────────────────────────────────────────────────────

    def _layout_of(self, words: str, look: Theme, size: float, ink: int, width: float) -> _Layout:
        key = words, size, ink, round(width), look.scale
        if key not in self._layouts:
            if len(self._layouts) >= _CACHED:
                self._layouts.clear()
            self._layouts[key] = self._layout(words, look, size, ink, width)
        return self._layouts[key]

    def _layout(self, words: str, look: Theme, size: float, ink: int, width: float) -> _Layout:
        pieces: list[tuple[_Piece, _Style]] = []
        y = 0.0
        for number, part in enumerate(parts_of(words)):
            if number:
                y += (_CLOSE if part.close else _GAP) * look.scale
            y = self._part(part, y, pieces, _Style(size, ink, look.scale), look, width)
        reach = max((p.x + (p.line.width if p.line else p.box[0]) for p, _ in pieces), default=0.0)
        return _Layout(tuple(pieces), y, reach)

    def _part(
        self,
        part: Part,
        y: float,
        pieces: list[tuple[_Piece, _Style]],
        style: _Style,
        look: Theme,
        width: float,
    ) -> float:
        """Put a part into its place; return where it ends."""
        left = part.indent * _INDENT * look.scale
        room = max(width - left, 40.0 * look.scale)
        if part.kind == "rule":
            pieces.append((_Piece(0, y, box=(width, look.scale, theme.packed(theme.LINE))), style))
            return y + look.scale
        if part.kind == "table":
            return self._table(part, left, y, pieces, style, look, room)
        runs = part.runs
        if part.kind == "heading":
            style = _Style(style.size + _HEADINGS.get(part.level, 0.0), style.ink, style.scale)
            runs = tuple(Run(r.text, True, r.italic, r.code, r.formula, r.link, r.breaks) for r in runs)
        if part.kind == "code":
            return self._code(part, left, y, pieces, style, look, room)
        lines = broken(runs, room, lambda run: self._extent(run, style, look))
        if part.mark and lines:
            mark = broken((Run(part.mark),), room, lambda run: self._extent(run, style, look))[0]
            place = left - mark.width - 6 * look.scale
            pieces.append((_Piece(place, y + lines[0].ascent - mark.ascent, mark), style))
        for line in lines:
            x = left + max(room - line.width, 0.0) / 2 if part.kind == "formula" else left
            pieces.append((_Piece(x, y, line), style))
            y += line.ascent + line.descent + _LEADING * look.scale
        return y - (_LEADING * look.scale if lines else 0.0)

    def _code(
        self,
        part: Part,
        left: float,
        y: float,
        pieces: list[tuple[_Piece, _Style]],
        style: _Style,
        look: Theme,
        room: float,
    ) -> float:
        pad = 8 * look.scale
        at = len(pieces)
        top, y = y, y + pad
        for text in part.runs[0].text.split("\n"):
            # Blanks at the start of a line of code are its indentation.
            run = Run(text.replace(" ", "\u00a0"), code=True, alone=True)
            lines = broken((run,), room - 2 * pad, lambda r: self._extent(r, style, look))
            for line in lines:
                pieces.append((_Piece(left + pad, y, line), style))
                y += line.ascent + line.descent
            if not lines:
                y += self._extent(Run("", code=True), style, look).ascent
        y += pad
        pieces.insert(at, (_Piece(left, top, box=(room, y - top, theme.packed(theme.FIELD))), style))
        return y

    def _table(
        self,
        part: Part,
        left: float,
        y: float,
        pieces: list[tuple[_Piece, _Style]],
        style: _Style,
        look: Theme,
        room: float,
    ) -> float:
        gap = _CELL * look.scale

        def lines_of(runs: Runs, width: float) -> tuple[Line, ...]:
            return broken(runs, width, lambda run: self._extent(run, style, look))

        count = max(map(len, part.rows), default=0)
        wanted = [0.0] * count
        for row in part.rows:
            for column, cell in enumerate(row):
                wanted[column] = max([wanted[column], *(line.width for line in lines_of(cell, 1e6))])
        free = room - gap * max(count - 1, 0)
        widths = _shared(wanted, free)
        for number, row in enumerate(part.rows):
            set_row = [lines_of(cell, widths[column] + 1) for column, cell in enumerate(row)]
            x, bottom = left, y
            for column, lines in enumerate(set_row):
                down = y
                for line in lines:
                    shift = widths[column] - line.width if part.numbers[column] else 0.0
                    pieces.append((_Piece(x + shift, down, line), style))
                    down += line.ascent + line.descent
                bottom = max(bottom, down)
                x += widths[column] + gap
            y = bottom + 3 * look.scale
            strong = theme.LINE if number == 0 else theme.FIELD
            rule = sum(widths) + gap * max(count - 1, 0), look.scale, theme.packed(strong)
            pieces.append((_Piece(left, y, box=rule), style))
            y += 4 * look.scale
        return y

    def _extent(self, run: Run, style: _Style, look: Theme) -> Extent:
        if run.formula:
            found = self._formula(run, style)
            if found is not None:
                width, height, baseline, _ = found
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
        found = self.formulas().get(run.text, size, style.ink, display=run.alone)
        if found is None:
            return None
        texture, baseline = found
        wide, high = texture.size
        return wide / density, high / density, baseline / density, imgui.ImTextureRef(texture.glo)

    # ── drawing ──────────────────────────────────────────────────────────────

    def _run(self, placed: Placed, x: float, baseline: float, style: _Style, look: Theme) -> None:
        run, extent = placed.run, placed.extent
        draw = imgui.get_window_draw_list()
        low = ImVec2(x + placed.x, baseline - extent.ascent)
        high = ImVec2(low.x + extent.width, baseline + extent.descent)
        if run.formula:
            found = self._formula(run, style)
            if found is not None:
                corner = ImVec2(round(low.x), round(low.y))  # on whole pixels, so that it stays sharp
                draw.add_image(found[3], corner, ImVec2(corner.x + found[0], corner.y + found[1]))
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


def _shared(wanted: list[float], room: float) -> list[float]:
    """Return the widths of columns: what they want where there is room, else narrow ones whole."""
    if sum(wanted) <= room:
        return wanted
    widths, left = list(wanted), room
    open_columns = sorted(range(len(wanted)), key=lambda column: wanted[column])
    for number, column in enumerate(open_columns):
        share = left / (len(open_columns) - number)
        widths[column] = min(wanted[column], share)
        left -= widths[column]
    return widths

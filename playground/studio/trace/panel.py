"""The window of a trace: code with values behind its lines, sliders and sparklines at loops, the probe.

Rows are drawn by hand, those in sight only. What is not finite has a frame as well as a colour, and what
differs a sign: no information is in colour alone.
"""

from __future__ import annotations

import math
import re
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from pathlib import Path
from typing import TYPE_CHECKING

from imgui_bundle import ImVec2, imgui

from playground.engine.trace.probe import ProbeMap
from playground.memo import INTERFACE
from playground.paths import shown
from playground.shader.syntax.tokens import tokenize
from playground.studio import theme
from playground.studio.draw import (
    QUIET,
    Area,
    button,
    choose,
    fitting,
    fitting_path,
    pushed_id,
    styled,
    wrapped,
)
from playground.studio.language import counted, tr
from playground.studio.theme import Theme
from playground.studio.trace.rows import FunctionHead, Item, LoopHead, Row, TraceView
from playground.studio.trace.tracing import Beside, Spot, Tracing
from playground.studio.widgets import slide_whole

if TYPE_CHECKING:
    import moderngl

_CODE = 0.52  # fraction of the width that code takes first
_SLIDER, _SPARK = 124.0, 96.0  # [units of scale 1] widths
_REST = 76.0  # [units of scale 1] that "… 3 more" takes
_CLICK = 4.0  # that the mouse may move during a click
_GUTTER = 5  # letters left of the code: the line's number
_WORDS = frozenset(
    "if else for while do switch case default break continue return discard struct const in out inout uniform"
    " void float int uint bool vec2 vec3 vec4 ivec2 ivec3 ivec4 uvec2 uvec3 uvec4 bvec2 bvec3 bvec4 mat2 mat3"
    " mat4 sampler2D true false".split()
)
_FUNCTIONS = {None: "its own file's", "all": "all"}


@dataclass
class TracePanel:
    """What the window remembers between frames besides what is traced."""

    code: float = _CODE  # fraction of the width
    selects: tuple[int, int] | None = None  # the line in which a selection is drawn, and its first column
    selection: tuple[int, int, int] | None = None  # line, first column, last column

    def draw(self, tracing: Tracing, look: Theme, area: Area) -> None:
        """Draw it while tracing is on."""
        if not tracing.on:
            return
        x, y, wide, high = area
        margin, scale = 14 * look.scale, look.scale
        tall = max(min(0.54 * high, high - 2 * margin), 200.0)
        imgui.set_next_window_pos(
            ImVec2(x + margin, y + high - margin), imgui.Cond_.appearing, ImVec2(0.0, 1.0)
        )
        imgui.set_next_window_size(ImVec2(max(wide - 2 * margin, 300.0), tall), imgui.Cond_.appearing)
        imgui.set_next_window_size_constraints(ImVec2(420 * scale, 180 * scale), ImVec2(1e5, 1e5))
        flags = QUIET | imgui.WindowFlags_.no_collapse | imgui.WindowFlags_.no_scrollbar
        flags |= imgui.WindowFlags_.no_focus_on_appearing
        ground = {
            imgui.Col_.window_bg: theme.colour(theme.palette.ground, 0.97),
            imgui.Col_.title_bg_active: theme.colour(theme.palette.raised),
        }
        with styled(ground, {imgui.StyleVar_.window_rounding: 8 * scale}):
            visible, stays = imgui.begin(f"{title_of(tracing)}###trace", True, flags)
            if visible:
                self._head(tracing, look)
                self._code(tracing, look)
                self._probe(tracing, look)
            imgui.end()
        if stays is False:
            tracing.toggle()

    # ── the head ─────────────────────────────────────────────────────────────

    def _head(self, tracing: Tracing, look: Theme) -> None:
        view, wide = tracing.view, 10 * imgui.get_font_size()
        self._pass(tracing, wide)
        pinned = tracing.is_pinned
        label = tr("Unpin") if pinned else tr("Pin")
        note = (
            tr("Trace what is under the mouse")
            if pinned
            else tr("Stay at this texel, as by a click on the picture")
        )
        unpin = max(_width_of(tr("Unpin")), _width_of(tr("Pin")))
        _flow(unpin)
        if button(f"{label}##pin", note, wide=unpin):
            tracing.follow() if pinned else tracing.pin_here()
        _flow(0.9 * wide)
        imgui.set_next_item_width(0.9 * wide)
        self._functions(tracing)
        bad = view.trace.first_not_finite() if view is not None else None
        if _flowing(
            tr("! First not finite"), tr("The line that first gives NaN or infinity"), bad is not None
        ):
            tracing.go_to_not_finite()
        if _flowing(tr("Keep"), tr("Compare what follows with this trace"), view is not None):
            tracing.keep()
        _flow(wide)
        imgui.set_next_item_width(wide)
        now = tracing.compared.beside
        beside = choose("##beside", tr("beside: {name}", name=_beside(now)), Beside, now, name=_beside)
        if beside is not None:
            tracing.compare(beside)
        if view is not None and tracing.other() is not None:
            parts = view.difference is not None
            if _flowing(tr("≠ First difference"), tr("The first event at which the two part"), parts):
                tracing.go_to_difference()
        if tracing.can_be_plain and _flowing(
            tr("Trace its plain form"), tr("It runs first, which may take a while")
        ):
            tracing.trace_plain()
        self._steps(tracing, wide)
        self._files(tracing, look)
        self._state(tracing, look)

    def _pass(self, tracing: Tracing, wide: float) -> None:
        spot = tracing.spot
        imgui.set_next_item_width(wide)
        chosen = choose(
            "##pass",
            spot.path if spot is not None else tr("pass"),
            tracing.under.spots,
            spot,
            name=lambda each: f"{each.path}   {each.texel[0]}, {each.texel[1]}",
            flags=imgui.ComboFlags_.height_large,
        )
        imgui.set_item_tooltip(tr("The pass that is traced, at the texel of its own under the mouse"))
        if chosen is not None:
            tracing.choose_pass(chosen.path)

    def _functions(self, tracing: Tracing) -> None:
        view = tracing.view
        names = [*view.trace.others, *view.trace.functions] if view is not None else []
        options: list[str | None] = [None, "all", *dict.fromkeys(names)]
        chosen = _function_name(tracing.choice.function)
        if imgui.begin_combo("##functions", tr("functions: {name}", name=chosen)):
            for option in options:
                is_chosen = option == tracing.choice.function
                if imgui.selectable(_function_name(option), is_chosen)[0]:
                    tracing.record(option)
            imgui.end_combo()
        imgui.set_item_tooltip(
            tr("Whose values are recorded; a large text with all takes seconds to compile")
        )

    def _state(self, tracing: Tracing, look: Theme) -> None:
        """Draw the line that says what the trace is of, or why there is none."""
        if tracing.view is None:
            return
        text, ink = state_of(tracing)
        imgui.same_line()
        with look.font(look.text, theme.SMALL):
            room = imgui.get_content_region_avail().x
            imgui.text_colored(theme.colour(ink), fitting(text.replace("\n", "  "), room))
            imgui.set_item_tooltip(text)

    def _steps(self, tracing: Tracing, wide: float) -> None:
        """Draw the slider over the steps of a repeated pass."""
        count = tracing.repeats
        if count > 1:
            _flow(wide)
            now = count - 1 if tracing.choice.iteration is None else min(tracing.choice.iteration, count - 1)
            imgui.set_next_item_width(wide)
            number = slide_whole(
                "##step", now + 1, (1, count), lambda n: tr("step {number} of {count}", number=n, count=count)
            )
            if number is not None:
                tracing.choice.iteration = None if number == count else number - 1

    # ── the code ─────────────────────────────────────────────────────────────

    def _code(self, tracing: Tracing, look: Theme) -> None:
        style = imgui.get_style()
        below = imgui.get_frame_height_with_spacing() * (2 if _probe_is_broken() else 1)
        with look.font(look.text, theme.SMALL):
            below += imgui.get_text_line_height_with_spacing() if tracing.probe.message else 0.0
        size = ImVec2(0, -below)
        view = tracing.view
        if view is None:
            imgui.begin_child("code", size)
            text, ink = state_of(tracing)
            with wrapped():
                imgui.text_colored(theme.colour(ink), text)
            imgui.end_child()
            return
        with look.font(look.code):
            ground = {imgui.Col_.child_bg: theme.colour(theme.palette.surround)}
            gaps = {imgui.StyleVar_.item_spacing: ImVec2(style.item_spacing.x, 2 * look.scale)}
            with styled(ground, gaps):
                imgui.begin_child("code", size)
                self._rows(tracing, view, look)
                imgui.end_child()

    def _files(self, tracing: Tracing, look: Theme) -> None:
        """Draw the files of the trace, and the calls that are shown, outermost first."""
        view = tracing.view
        if view is None:
            return
        room = 0.62 * imgui.get_window_width()
        imgui.align_text_to_frame_padding()
        imgui.set_next_item_width(imgui.get_font_size() * 13)
        closed = fitting_path(Path(tracing.caret.file).name, imgui.get_font_size() * 10.5)
        chosen = choose("##file", closed, view.paths, tracing.caret.file, name=shown)
        imgui.set_item_tooltip(tracing.caret.file)
        if chosen is not None:
            tracing.open(chosen)
        for call in view.stack():
            label = f"{call.function}##call {call.index}"
            wide = imgui.calc_text_size(call.function).x + 2 * imgui.get_style().frame_padding.x
            imgui.same_line()
            if imgui.get_cursor_pos_x() + wide > room:
                imgui.text_disabled("…")
                break
            if button(label, tr("line {line} of {file}", line=call.line, file=shown(call.path)), small=True):
                tracing.caret.file, tracing.caret.line, tracing.caret.is_asked = call.path, call.line, True

    def _rows(self, tracing: Tracing, view: TraceView, look: Theme) -> None:
        rows = view.rows(tracing.caret.file)
        line = imgui.get_text_line_height() + 2 * look.scale
        letter = imgui.calc_text_size("0").x
        wide = imgui.get_content_region_avail().x
        grid = _Grid(imgui.get_cursor_screen_pos(), letter, line, wide, self.code * wide)
        self._splitter(grid, len(rows), look)
        if tracing.caret.is_asked and tracing.caret.line:
            tracing.caret.is_asked = False
            imgui.set_scroll_y(max((tracing.caret.line - 1) * line - imgui.get_window_height() / 3, 0.0))
        first = max(int(imgui.get_scroll_y() / line) - 1, 0)
        last = first + int(imgui.get_window_height() / line) + 3
        colours = _colours_of(tuple(row.code for row in rows))
        for row in rows[first:last]:
            with pushed_id(row.number):
                self._row(tracing, view, row, grid, colours[row.number - 1], look)
        imgui.set_cursor_screen_pos(ImVec2(grid.corner.x, grid.corner.y + len(rows) * line))
        imgui.dummy(ImVec2(1, 1))

    def _splitter(self, grid: _Grid, count: int, look: Theme) -> None:
        """Draw what moves the edge between code and values."""
        half, top = 4 * look.scale, imgui.get_window_pos().y
        x = grid.corner.x + grid.code
        imgui.set_cursor_screen_pos(ImVec2(x - half, top))
        imgui.set_next_item_allow_overlap()
        imgui.invisible_button("##split", ImVec2(2 * half, imgui.get_window_height()))
        if imgui.is_item_active():
            self.code = min(max(self.code + imgui.get_io().mouse_delta.x / grid.wide, 0.2), 0.8)
        if imgui.is_item_active() or imgui.is_item_hovered():
            imgui.set_mouse_cursor(imgui.MouseCursor_.resize_ew)
        end = ImVec2(x, top + imgui.get_window_height())
        imgui.get_window_draw_list().add_line(ImVec2(x, top), end, theme.packed(theme.palette.line))

    def _row(
        self, tracing: Tracing, view: TraceView, row: Row, grid: _Grid, colours: Sequence[_Piece], look: Theme
    ) -> None:
        draw, top = imgui.get_window_draw_list(), grid.corner.y + (row.number - 1) * grid.line
        left, edge = grid.corner.x, grid.corner.x + grid.code
        if row.number == tracing.caret.line:
            far = ImVec2(grid.corner.x + grid.wide, top + grid.line)
            draw.add_rect_filled(ImVec2(left, top), far, theme.packed(theme.palette.field))
        number = f"{row.number:>{_GUTTER - 1}}"
        draw.add_text(ImVec2(left, top + look.scale), theme.packed(theme.palette.dim), number)
        if row.items:  # a line that gave something has a mark, whether or not its values are in sight
            middle = ImVec2(left + (_GUTTER - 0.5) * grid.letter, top + grid.line / 2)
            draw.add_circle_filled(middle, 2 * look.scale, theme.packed(theme.palette.accent))
        start = left + _GUTTER * grid.letter
        self._selected(tracing, row, start, top, grid, edge)
        draw.push_clip_rect(ImVec2(start, top), ImVec2(edge - 4 * look.scale, top + grid.line), True)
        for column, text, ink in colours:
            alpha = 1.0 if row.is_reached else 0.5
            draw.add_text(
                ImVec2(start + column * grid.letter, top + look.scale), theme.packed(ink, alpha), text
            )
        draw.pop_clip_rect()
        imgui.set_cursor_screen_pos(ImVec2(edge + 8 * look.scale, top + look.scale))
        self._values(tracing, view, row, grid, look)

    def _selected(
        self, tracing: Tracing, row: Row, start: float, top: float, grid: _Grid, edge: float
    ) -> None:
        """Take the caret's line and what of it is selected, by the mouse; draw the selection."""
        imgui.set_cursor_screen_pos(ImVec2(grid.corner.x, top))
        code = row.code.expandtabs(4)
        if imgui.invisible_button("##code", ImVec2(max(edge - grid.corner.x - 5, 1.0), grid.line)):
            tracing.caret.line = row.number
        if len(code) * grid.letter > edge - start:
            imgui.set_item_tooltip(code.strip())
        mouse = imgui.get_io().mouse_pos
        column = min(max(round((mouse.x - start) / grid.letter), 0), len(code))
        if imgui.is_item_hovered():
            imgui.set_mouse_cursor(imgui.MouseCursor_.text_input)
            if imgui.is_mouse_double_clicked(0):
                self._select(tracing, row, code, *word_at(code, int((mouse.x - start) / grid.letter)))
            elif imgui.is_mouse_clicked(0):
                tracing.caret.line, self.selects, self.selection = row.number, (row.number, column), None
        if self.selects is not None and self.selects[0] == row.number and imgui.is_mouse_down(0):
            if abs(column - self.selects[1]) > 0 and not imgui.is_mouse_double_clicked(0):
                self._select(tracing, row, code, *sorted((self.selects[1], column)))
        elif self.selects is not None and not imgui.is_mouse_down(0):
            self.selects = None
        if self.selection is not None and self.selection[0] == row.number:
            low = ImVec2(start + self.selection[1] * grid.letter, top)
            high = ImVec2(min(start + self.selection[2] * grid.letter, edge), top + grid.line)
            imgui.get_window_draw_list().add_rect_filled(low, high, theme.packed(theme.palette.accent, 0.35))

    def _select(self, tracing: Tracing, row: Row, code: str, first: int, last: int) -> None:
        self.selection = row.number, first, last
        text = code[first:last].strip()
        if text:
            tracing.caret.line, tracing.probe.expression = row.number, text

    # ── values ───────────────────────────────────────────────────────────────

    def _values(self, tracing: Tracing, view: TraceView, row: Row, grid: _Grid, look: Theme) -> None:
        narrow: dict[imgui.StyleVar_, float | ImVec2] = {
            imgui.StyleVar_.frame_padding: ImVec2(4 * look.scale, 0),
            imgui.StyleVar_.item_spacing: ImVec2(12 * look.scale, 0),
        }
        if tracing.is_stale:
            narrow[imgui.StyleVar_.alpha] = 0.5
        with styled(sizes=narrow):
            drawn = False
            if row.head is not None and row.head.count > 1:
                self._call(view, row.head, look)
                drawn = True
            elif row.head is not None and not row.head.is_linked:
                imgui.text_disabled(tr("(other iteration)"))
                drawn = True
            for at, head in enumerate(row.loops):
                with pushed_id(f"loop {at}"):
                    if drawn:
                        imgui.same_line()
                    self._loop(view, head, look)
                    drawn = True
            for at, item in enumerate(row.items):
                if drawn:
                    imgui.same_line()
                drawn = True
                room = grid.corner.x + grid.wide - imgui.get_cursor_screen_pos().x
                rest = _REST * look.scale if at < len(row.items) - 1 else 0.0
                if not _item(item, room - rest, look):
                    _rest(row.items[at:], look)
                    return

    def _call(self, view: TraceView, head: FunctionHead, look: Theme) -> None:
        """Draw which call of a function is shown, and what steps through them."""
        caller = view.trace.calls[head.call].caller
        note = tr("{name}: call {number} of {count}", name=head.key[1], number=head.number, count=head.count)
        if caller is not None:
            note += tr(", by {name}", name=view.trace.calls[caller].function)
        number = _stepper(tr("call"), head.number, head.count, note, look)
        if number is not None:
            view.choose_call(head.key, number - 1)
        if not head.is_linked:
            imgui.same_line()
            imgui.text_disabled(tr("(other iteration)"))

    def _loop(self, view: TraceView, head: LoopHead, look: Theme) -> None:
        """Draw the slider over a loop's iterations, and the sparkline of one of its names."""
        note = tr(
            "iteration {number} of {count}; Ctrl+click types one", number=head.chosen + 1, count=head.count
        )
        number = _stepper("", head.chosen + 1, head.count, note, look)
        if number is not None:
            view.choose_iteration(head, number - 1)
        if head.plotted:
            imgui.same_line()
            self._sparkline(view, head, look)

    def _sparkline(self, view: TraceView, head: LoopHead, look: Theme) -> None:
        size = ImVec2(_SPARK * look.scale, imgui.get_text_line_height())
        corner = imgui.get_cursor_screen_pos()
        imgui.invisible_button("##spark", size)
        draw, end = imgui.get_window_draw_list(), corner + size
        draw.add_rect_filled(corner, end, theme.packed(theme.palette.field), 2 * look.scale)
        points = spark_points(head.series, (corner.x, corner.y, size.x, size.y))
        for one, other in pairwise(points):
            if one[2] and other[2]:
                draw.add_line(
                    ImVec2(*one[:2]), ImVec2(*other[:2]), theme.packed(theme.palette.accent), look.scale
                )
        for x, _, is_finite in points:
            if is_finite is False:  # a cross and not only a colour
                _cross(draw, x, corner.y + size.y / 2, 3 * look.scale)
        with look.font(look.code, theme.SMALL):
            name = fitting(head.plotted, size.x - 4 * look.scale)
            draw.add_text(corner + ImVec2(2 * look.scale, 0), theme.packed(theme.palette.dim, 0.9), name)
        x = points[min(head.chosen, len(points) - 1)][0] if points else corner.x
        draw.add_line(ImVec2(x, corner.y), ImVec2(x, end.y), theme.packed(theme.palette.ink, 0.8), look.scale)
        if imgui.is_item_hovered():
            at = round((imgui.get_io().mouse_pos.x - corner.x) / size.x * max(head.count - 1, 0))
            at = min(max(at, 0), head.count - 1)
            number = head.series[at]
            text = tr("no value") if number is None else f"{number:.6g}"
            note = tr("{name}, iteration {number}: {value}", name=head.plotted, number=at + 1, value=text)
            imgui.set_tooltip(f"{note}\n{tr('right click: another name')}")
            if imgui.is_mouse_clicked(0):
                view.choose_iteration(head, at)
        if imgui.begin_popup_context_item("##names"):
            for name in head.names:
                if imgui.selectable(name, name == head.plotted)[0]:
                    view.plot(head, name)
            imgui.end_popup()

    # ── the probe ────────────────────────────────────────────────────────────

    def _probe(self, tracing: Tracing, look: Theme) -> None:
        """Draw the field of an expression, and what shows it."""
        line = tracing.caret.line
        where = tr("behind line {line}", line=line) if line else tr("behind a line")
        shows = isinstance(tracing.session.view.map, ProbeMap)
        back, show = tr("Back to the picture"), tr("Show as a map")
        find = tr("First texel where it is true")
        labels = back if shows else show, find
        imgui.align_text_to_frame_padding()
        imgui.text_disabled(tr("Probe"))
        imgui.same_line()
        wide = imgui.calc_text_size(where).x + imgui.get_style().item_spacing.x
        if not _probe_is_broken():
            wide += sum(_width_of(label) + imgui.get_style().item_spacing.x for label in labels)
        imgui.set_next_item_width(-wide)
        with look.font(look.code):
            hint = tr("an expression: select it in a line, or type it")
            probe = tracing.probe
            _, probe.expression = imgui.input_text_with_hint("##probe", hint, probe.expression)
        imgui.same_line()
        imgui.text_disabled(where)
        if not _probe_is_broken():
            imgui.same_line()
        can = bool(tracing.caret.line and tracing.probe.expression.strip())
        if shows:
            if button(back, tr("The sketch's own view again")):
                tracing.session.show(None)
        elif button(show, tr("Its value in every texel; legend and histogram: in the panel"), enabled=can):
            tracing.show_probe()
        imgui.same_line()
        if button(find, tr("The first texel, from the south-west, where it is not 0"), enabled=can):
            tracing.show_probe(find=True)
        if tracing.probe.message:
            with look.font(look.text, theme.SMALL):
                text = tracing.probe.message
                room = imgui.get_content_region_avail().x
                imgui.text_colored(theme.colour(theme.palette.warm), fitting(text.replace("\n", "  "), room))
                imgui.set_item_tooltip(text)


@dataclass(frozen=True)
class _Grid:
    """Where rows are drawn."""

    corner: ImVec2
    letter: float  # widths of a letter and of all, height of a line
    line: float
    wide: float
    code: float  # width of the code


def _probe_is_broken() -> bool:
    """Return whether the probe's buttons need a line of their own."""
    return imgui.get_window_width() < 46 * imgui.get_font_size()


def _width_of(label: str) -> float:
    return imgui.calc_text_size(label).x + 2 * imgui.get_style().frame_padding.x


def _flow(wide: float) -> None:
    """Go on in the same line where what comes has room in it."""
    imgui.same_line()
    if imgui.get_content_region_avail().x < wide:
        imgui.new_line()


def _flowing(label: str, note: str, enabled: bool = True) -> bool:
    """Draw a button in the same line, or in the next; return whether it is pressed."""
    _flow(_width_of(label))
    return button(label, note, enabled=enabled)


def _stepper(word: str, number: int, count: int, note: str, look: Theme) -> int | None:
    """Draw a slider from 1 to a count between two buttons; return the number that is chosen."""
    chosen = number - 1 if button("<", tr("the one before"), small=True, enabled=number > 1) else None
    imgui.same_line(0, 2 * look.scale)
    imgui.set_next_item_width(_SLIDER * look.scale)
    slid = slide_whole(
        "##slide",
        number,
        (1, max(count, 1)),
        lambda n: tr("{word} {number} of {count}", word=word, number=n, count=count).strip(),
    )
    imgui.set_item_tooltip(note)
    imgui.same_line(0, 2 * look.scale)
    if button(">", tr("the next one"), small=True, enabled=number < count):
        chosen = number + 1
    return slid if slid is not None else chosen


# ── texts ─────────────────────────────────────────────────────────────────────


def title_of(tracing: Tracing) -> str:
    """Return the window's title: which texel of which pass."""
    spot = tracing.spot
    return (
        tr("Trace: {spot}", spot=spot) if spot is not None else tr("Trace: move the mouse over the picture")
    )


def state_of(tracing: Tracing) -> tuple[str, theme.Rgb]:
    """Return what is traced or why it is not, and the colour to write it in."""
    view = tracing.view
    if tracing.compiler.compiles:
        return tr("compiling {name} …", name=tracing.compiler.compiles), theme.palette.warm
    if tracing.message:
        return tracing.message, theme.palette.warm
    if view is None:
        return (
            tr("a click on the picture pins a texel; Shift+click compares it with the one before"),
            theme.palette.dim,
        )
    trace = view.trace
    parts = [
        tr(
            "{values} of {calls}",
            values=counted(len(trace.events), "value"),
            calls=counted(len(trace.calls), "call"),
        )
    ]
    if not trace.is_complete:
        parts.append(tr("cut at the limit of events"))
    if trace.is_discarded:
        parts.append(tr("the run ends in a discard"))
    elif trace.is_exact:
        parts.append(tr("its result is the texel's, bit for bit"))
    else:
        parts.append(tr("its result differs from the texel's: the driver rounds a recorded sum otherwise"))
    if tracing.other() is None:
        missing = {Beside.KEPT: tr("nothing is kept yet"), Beside.SAVE: tr("nothing was saved since")}
        parts += [missing[tracing.compared.beside]] if tracing.compared.beside in missing else []
    else:
        parts.append(tr("both run alike") if view.difference is None else f"≠ {other_name(tracing)}")
    return "   ".join(parts), theme.palette.dim


def other_name(tracing: Tracing) -> str:
    """Return what is beside a trace: its texel, where it is another, or the save before."""
    other = tracing.other()
    if other is None or tracing.compared.beside is Beside.SAVE:
        return tr("before the last save")
    return tr("{spot}, kept", spot=Spot(other.step, (other.texel[0], other.texel[1])))


def _beside(beside: Beside) -> str:
    return tr(beside.value)


def _function_name(function: str | None) -> str:
    return tr(_FUNCTIONS[function]) if function in _FUNCTIONS else str(function)


def word_at(code: str, column: int) -> tuple[int, int]:
    """Return where the name under a column begins and ends, with the members before it: "march.foot"."""
    for match in re.finditer(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*|\[\w+\])*", code):
        if match.start() <= column < match.end():
            end = re.match(r"\w*", code[column:])
            return match.start(), column + (end.end() if end is not None else 0)
    return column, column


def spark_points(
    series: Sequence[float | None], box: tuple[float, float, float, float]
) -> list[tuple[float, float, bool | None]]:
    """Return where each number of a series lies in a box, and whether it is finite; None: there is none."""
    left, top, wide, high = box
    finite = [n for n in series if n is not None and math.isfinite(n)]
    low, span = min(finite, default=0.0), max(finite, default=0.0) - min(finite, default=0.0)
    points: list[tuple[float, float, bool | None]] = []
    for at, number in enumerate(series):
        x = left + wide * (at / (len(series) - 1) if len(series) > 1 else 0.5)
        is_finite = None if number is None else math.isfinite(number)
        share = (number - low) / span if number is not None and is_finite and span > 0 else 0.5
        points.append((x, top + high - 2 - share * (high - 4), is_finite))
    return points


_Piece = tuple[int, str, theme.Rgb]
"""Column, text, colour."""


@INTERFACE.cached()
def _colours_of(lines: tuple[str, ...]) -> tuple[tuple[_Piece, ...], ...]:
    """Return the coloured pieces of each line, tabs as four spaces."""
    shown = [line.expandtabs(4) for line in lines]
    starts = [0, *accumulate(len(line) + 1 for line in shown)]
    tokens, comments = tokenize("\n".join(shown))
    spans = [(c.start, c.end, theme.palette.dim) for c in comments]
    spans += [(t.start, t.end, theme.palette.dim) for t in tokens if t.kind == "directive"]
    spans += [(t.start, t.end, theme.palette.accent) for t in tokens if t.text in _WORDS]
    inks: list[list[tuple[int, int, theme.Rgb]]] = [[] for _ in lines]
    for start, end, ink in sorted(spans):
        for at in range(bisect_right(starts, start) - 1, min(bisect_right(starts, end - 1), len(lines))):
            inks[at].append((max(start - starts[at], 0), min(end - starts[at], len(shown[at])), ink))
    return tuple(tuple(_pieces(line, mine)) for line, mine in zip(shown, inks, strict=True))


def _pieces(line: str, inks: Sequence[tuple[int, int, theme.Rgb]]) -> list[_Piece]:
    pieces, at = [], 0
    for start, end, ink in (*inks, (len(line), len(line), theme.palette.ink)):
        pieces += [(at, line[at:start], theme.palette.ink), (start, line[start:end], ink)]
        at = max(at, end)
    return [piece for piece in pieces if piece[1].strip()]


# ── items ─────────────────────────────────────────────────────────────────────


def _item(item: Item, room: float, look: Theme) -> bool:
    """Draw what one name gave; return False, and draw nothing, where it has no room."""
    name = item.name if item.name in ("→", "?", "") else f"{item.name} ="
    value = item.text if item.is_finite else f"! {item.text}"
    other = f" ≠ {item.other}" if item.other else ""
    whole = imgui.calc_text_size(f"{name} {value}{other}").x
    if whole > room and room < 60 * look.scale:
        return False
    if name:
        imgui.text_colored(theme.colour(theme.palette.dim), name)
        imgui.same_line(0, 4 * look.scale)
    left = max(room - imgui.calc_text_size(f"{name} ").x - 8 * look.scale, 20.0)
    ink = theme.palette.ink if item.is_finite else theme.palette.alarm
    imgui.text_colored(theme.colour(ink), fitting(value, left))
    low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
    imgui.set_item_tooltip(
        item.full + ("\n" + tr("in the other trace: {value}", value=item.other) if item.other else "")
    )
    gap = ImVec2(2 * look.scale, 0)
    draw = imgui.get_window_draw_list()
    if not item.is_finite:
        draw.add_rect(low - gap, high + gap, theme.packed(theme.palette.alarm), 2 * look.scale)
    if item.other and (left := left - (high.x - low.x)) > 20 * look.scale:
        imgui.same_line(0, 4 * look.scale)
        imgui.text_colored(theme.colour(theme.palette.warm), fitting(f"≠ {item.other}", left))
    if item.parts:
        end = ImVec2(imgui.get_item_rect_max().x, high.y)
        draw.add_rect(low - gap, end + gap, theme.packed(theme.palette.warm), 2 * look.scale, 2 * look.scale)
    return True


def _rest(items: Sequence[Item], look: Theme) -> None:
    imgui.text_disabled(tr("… {count} more", count=len(items)))
    imgui.set_item_tooltip("\n".join(item.full for item in items))


def _cross(draw: imgui.ImDrawList, x: float, y: float, half: float) -> None:
    ink = theme.packed(theme.palette.alarm)
    draw.add_line(ImVec2(x - half, y - half), ImVec2(x + half, y + half), ink, 2)
    draw.add_line(ImVec2(x - half, y + half), ImVec2(x + half, y - half), ink, 2)


def act_on_picture(tracing: Tracing, picture: moderngl.Texture | None, area: Area, density: float) -> None:
    """Take the texel under the mouse, and pin it at a click; with Shift, keep the one before beside it."""
    io = imgui.get_io()
    if not tracing.on or picture is None or io.want_capture_mouse or io.key_ctrl:
        return
    x, y = int((io.mouse_pos.x - area[0]) * density // 1), int((io.mouse_pos.y - area[1]) * density // 1)
    pixel = x, picture.size[1] - 1 - y
    if not (0 <= pixel[0] < picture.size[0] and 0 <= pixel[1] < picture.size[1]):
        return
    gone = imgui.get_mouse_drag_delta(0, 0.0)
    if imgui.is_mouse_released(0) and math.hypot(gone.x, gone.y) < _CLICK:
        if io.key_shift:
            tracing.keep()
        tracing.pin_at(pixel, picture.size)
    elif not imgui.is_mouse_down(0):
        tracing.point(pixel)


def draw_mark(tracing: Tracing, look: Theme, area: Area) -> None:
    """Draw a cross on the picture where a place is pinned."""
    mark = tracing.mark(area[2:]) if tracing.on else None
    if mark is None:
        return
    x, y = area[0] + mark[0] * area[2], area[1] + (1 - mark[1]) * area[3]
    draw, near, far = imgui.get_background_draw_list(), 3 * look.scale, 10 * look.scale
    for ink, thick in ((theme.packed((0.0, 0.0, 0.0), 0.8), 4.0), (theme.packed(theme.DARK.warm), 2.0)):
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            start, end = ImVec2(x + near * dx, y + near * dy), ImVec2(x + far * dx, y + far * dy)
            draw.add_line(start, end, ink, thick * look.scale)

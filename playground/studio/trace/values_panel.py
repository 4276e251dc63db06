"""What a traced texel gave, behind the lines of the code pane: values, calls, loops with a sparkline.

It draws over the editor's own window, after that. A line that reads otherwise than when it was traced has
nothing. What is not finite has a mark and a frame as well as a colour, and what differs a sign.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from imgui_bundle import ImVec2, imgui
from imgui_bundle import imgui_color_text_edit as text_edit

from playground.studio import theme
from playground.studio.draw import Area, pushed_id, styled
from playground.studio.language import tr
from playground.studio.theme import Theme
from playground.studio.trace.rows import FunctionHead, Item, LoopHead, Row, TraceView
from playground.studio.trace.tracing import Tracing
from playground.studio.widgets import slide_whole

_SLIDER, _SPARK, _COVER = 10, 8, 24  # [letters] widths, the last of the code that values may cover
_Pos = text_edit.TextEditor.DocPos


def follow_caret(tracing: Tracing, path: str, editor: text_edit.TextEditor) -> None:
    """Take the cursor's line of a traced file, and what is selected in it, which a probe may show."""
    view, caret = tracing.view, tracing.caret
    if view is None or path not in view.trace.files or caret.is_asked:
        return
    caret.file, caret.line = path, editor.get_main_cursor_position().line + 1
    selection = editor.get_main_cursor_selection()
    start, end = selection.start, selection.end
    if start.line == end.line and start.index < end.index:
        code = editor.get_line_text(start.line)
        first, last = start.index, end.index
        if re.fullmatch(r"\w+", code[first:last]):
            first, last = word_at(code, first)
        tracing.probe.expression = code[first:last].strip()


def draw_values(
    tracing: Tracing, path: str, editor: text_edit.TextEditor, wrong: set[int], waits: bool, look: Theme
) -> list[Area]:
    """Write what a texel gave behind the lines of a file into the current window, which is the editor's.

    ``wrong``: lines, from 1, behind which something else stands; ``waits``: the text is newer than what is
    drawn. Returns where things are that take the mouse.
    """
    view = tracing.view
    if view is None or path not in view.paths:
        return []
    alpha = 0.5 if tracing.is_stale or waits else 1.0
    lines = _Lines(tracing, view, editor, look, alpha)
    first, last = editor.get_first_visible_row(), editor.get_last_visible_row()
    sizes: dict[imgui.StyleVar_, float | ImVec2] = {imgui.StyleVar_.alpha: alpha}
    sizes[imgui.StyleVar_.frame_padding] = ImVec2(2 * look.scale, 0)
    with styled(sizes=sizes):
        for row in view.rows(path):
            line = row.number - 1
            if line >= editor.get_line_count() or row.number in wrong:
                continue
            text = editor.get_line_text(line)
            end = _Pos(line, len(text))
            is_seen = first <= editor.doc_pos2_vis_pos(end).row <= last
            if is_seen and text.rstrip() == row.code.rstrip():
                with pushed_id(row.number):
                    lines.draw(row, end)
    return lines.places


@dataclass
class _Spot:
    """Where the next thing on a line is drawn."""

    x: float
    y: float
    right: float  # the end of the room


class _Lines:
    """The lines of one frame."""

    def __init__(
        self, tracing: Tracing, view: TraceView, editor: text_edit.TextEditor, look: Theme, alpha: float
    ) -> None:
        self.tracing, self.view, self.editor, self.look, self.alpha = tracing, view, editor, look, alpha
        self.places: list[Area] = []  # that take the mouse
        self.wide, self.high = editor.get_glyph_width(), editor.get_line_height()
        corner, size = imgui.get_window_pos(), imgui.get_window_size()
        bar = imgui.get_style().scrollbar_size if imgui.get_scroll_max_y() > 0 else 0.0
        self.right = corner.x + size.x - bar - 2 * look.scale
        self.sink = imgui.get_window_draw_list()

    def draw(self, row: Row, end: text_edit.TextEditor.DocPos) -> None:
        """Draw what a line gave, as far as there is room, and what chooses its call and its iteration."""
        place_of = self.editor.doc_pos2_screen_pos
        place, start = place_of(end), place_of(_Pos(end.line, 0))
        if not row.is_reached:
            ground = theme.packed(theme.palette.ground, 0.5)
            self.sink.add_rect_filled(start, ImVec2(place.x, place.y + self.high), ground)
        if row.items and imgui.get_scroll_x() == 0:  # whether or not its values have room
            middle = ImVec2(start.x - 0.6 * self.wide, start.y + self.high / 2)
            self.sink.add_circle_filled(middle, 2 * self.look.scale, theme.packed(theme.palette.accent))
        spot = _Spot(place.x + 2 * self.wide, place.y, self.right)
        if row.head is not None and row.head.count > 1:
            self._call(row.head, spot)
        if row.head is not None and not row.head.is_linked:
            self._text(spot, tr("(other iteration)"), theme.palette.dim)
        for number, head in enumerate(row.loops):
            with pushed_id(f"loop {number}"):
                self._loop(head, spot)
        self._make_room(row, spot)
        for at, item in enumerate(row.items):
            if not self._item(item, spot, is_last=at == len(row.items) - 1):
                self._rest(row.items[at:], spot)
                return

    def _make_room(self, row: Row, spot: _Spot) -> None:
        """Cover the end of a long line that has no room for values, but that of the cursor or the mouse."""
        whole = sum(len(text) + 1 for item in row.items for text, _ in _pieces(item))
        needs = min(whole, _COVER) * self.wide
        has_room = not row.items or spot.right - spot.x >= needs
        if row.number == self.tracing.caret.line or row.loops or has_room:
            return
        mouse, x = imgui.get_mouse_pos(), spot.right - needs
        if imgui.is_window_hovered() and mouse.x < x and spot.y <= mouse.y < spot.y + self.high:
            return  # the mouse is on the code
        spot.x = x
        low, high = ImVec2(spot.x - self.wide / 2, spot.y), ImVec2(spot.right, spot.y + self.high)
        self.sink.add_rect_filled(low, high, theme.packed(theme.palette.raised, 0.95))

    def _call(self, head: FunctionHead, spot: _Spot) -> None:
        """Draw which call of a function is shown, and what steps through them."""
        caller = self.view.trace.calls[head.call].caller
        note = tr("{name}: call {number} of {count}", name=head.key[1], number=head.number, count=head.count)
        if caller is not None:
            note = tr("{call}, by {name}", call=note, name=self.view.trace.calls[caller].function)
        number = self._stepper("##call", head.number, head.count, note, spot)
        if number is not None:
            self.view.choose_call(head.key, number - 1)

    def _loop(self, head: LoopHead, spot: _Spot) -> None:
        """Draw the slider over a loop's iterations, and the sparkline of one of its names."""
        if head.count > 1:
            words = "iteration {number} of {count}; Ctrl+click types one"
            note = tr(words, number=head.chosen + 1, count=head.count)
            number = self._stepper("##turn", head.chosen + 1, head.count, note, spot)
            if number is not None:
                self.view.choose_iteration(head, number - 1)
        letters = min((spot.right - spot.x) / self.wide - 2.5, _SPARK)
        if head.plotted and letters >= _SPARK / 2:
            self._sparkline(head, spot, letters * self.wide)

    def _stepper(self, label: str, number: int, count: int, note: str, spot: _Spot) -> int | None:
        """Draw a slider from 1 to a count, between two buttons where there is room; return what is chosen."""
        if spot.x + _SLIDER * self.wide > spot.right:
            return None
        has_buttons = spot.x + (_SLIDER + 5 + _SPARK) * self.wide <= spot.right
        start, chosen = spot.x, None
        for word, wide in (("<", 2), ("", _SLIDER), (">", 2)):
            if word and not has_buttons:
                continue
            imgui.set_cursor_screen_pos(ImVec2(spot.x, spot.y))
            imgui.set_next_item_width(wide * self.wide)
            if not word:
                slid = slide_whole(label, number, (1, count), lambda n: f"{n}/{count}")
                chosen = chosen if slid is None else slid
                imgui.set_item_tooltip(note)
            elif imgui.button(f"{word}{label}", ImVec2(wide * self.wide, self.high)):
                chosen = min(max(number + (1 if word == ">" else -1), 1), count)
            spot.x += (wide + 0.3) * self.wide
        self.places.append((start, spot.y, spot.x, spot.y + self.high))
        spot.x += 0.7 * self.wide
        return chosen

    def _sparkline(self, head: LoopHead, spot: _Spot, wide: float) -> None:
        draw, look = self.sink, self.look
        corner, size = ImVec2(spot.x, spot.y), ImVec2(wide, self.high)
        self.places.append((corner.x, corner.y, corner.x + size.x, corner.y + size.y))
        spot.x += wide + self.wide
        imgui.set_cursor_screen_pos(corner)
        imgui.invisible_button("##spark", size)
        end = corner + size
        draw.add_rect_filled(corner, end, theme.packed(theme.palette.field), 2 * look.scale)
        points = spark_points(head.series, (corner.x, corner.y, size.x, size.y))
        for one, other in pairwise(points):
            if one[2] and other[2]:
                ink = theme.packed(theme.palette.accent)
                draw.add_line(ImVec2(*one[:2]), ImVec2(*other[:2]), ink, look.scale)
        for x, _, is_finite in points:
            if is_finite is False:  # a cross and not only a colour
                _cross(draw, x, corner.y + size.y / 2, 3 * look.scale)
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
                self.view.choose_iteration(head, at)
        if imgui.begin_popup_context_item("##names"):
            for name in head.names:
                if imgui.selectable(name, name == head.plotted)[0]:
                    self.view.plot(head, name)
            imgui.end_popup()

    def _item(self, item: Item, spot: _Spot, *, is_last: bool) -> bool:
        """Draw what one name gave; return False, and draw nothing, where it has no room."""
        pieces = _pieces(item)
        room = (spot.right - spot.x) / self.wide - (0 if is_last else 2)
        whole = sum(len(text) + 1 for text, _ in pieces)
        if whole > room and room < 8:
            return False
        start = spot.x
        for text, ink in pieces:
            left = int((spot.right - spot.x) / self.wide) - (0 if is_last else 2)
            self._text(spot, text if len(text) <= left else f"{text[: max(left - 1, 0)]}…", ink)
        low, high = ImVec2(start - 2, spot.y + 1), ImVec2(spot.x - self.wide + 2, spot.y + self.high - 1)
        if not item.is_finite or item.parts:
            ink = theme.palette.warm if item.is_finite else theme.palette.alarm
            self.sink.add_rect(low, high, theme.packed(ink, self.alpha), 2 * self.look.scale)
        spot.x += self.wide
        if imgui.is_mouse_hovering_rect(low, high):
            imgui.set_tooltip(full_text(item))
        return True

    def _rest(self, items: Sequence[Item], spot: _Spot) -> None:
        """Write that there is more than has room; the mouse over it shows all."""
        x = min(spot.x, self.right - 2 * self.wide)
        low, high = ImVec2(x, spot.y), ImVec2(self.right, spot.y + self.high)
        self.sink.add_rect_filled(low, high, theme.packed(theme.palette.raised))
        ink = theme.palette.dim if all(item.is_finite for item in items) else theme.palette.alarm
        words = "…" if all(item.is_finite for item in items) else "!…"
        self.sink.add_text(low, theme.packed(ink), words)
        if imgui.is_mouse_hovering_rect(low, high):
            imgui.set_tooltip("\n".join(map(full_text, items)))

    def _text(self, spot: _Spot, text: str, ink: theme.Rgb) -> None:
        self.sink.add_text(ImVec2(spot.x, spot.y), theme.packed(ink, self.alpha), text)
        spot.x += (len(text) + 1) * self.wide


def _pieces(item: Item) -> list[tuple[str, theme.Rgb]]:
    """Return what is written of a name and its value."""
    name = item.name if item.name in ("→", "?", "") else f"{item.name} ="
    pieces = [(name, theme.palette.dim)] if name else []
    if item.is_finite:
        pieces.append((item.text, theme.palette.ink))
    else:
        pieces.append((f"! {item.text}", theme.palette.alarm))
    return [*pieces, (f"≠ {item.other}", theme.palette.warm)] if item.other else pieces


def full_text(item: Item) -> str:
    """Return what a name gave with all digits, and what it gave in the other trace."""
    return item.full + (f"\n{tr('in the other trace: {value}', value=item.other)}" if item.other else "")


def _cross(draw: imgui.ImDrawList, x: float, y: float, half: float) -> None:
    ink = theme.packed(theme.palette.alarm)
    draw.add_line(ImVec2(x - half, y - half), ImVec2(x + half, y + half), ink, 2)
    draw.add_line(ImVec2(x - half, y + half), ImVec2(x + half, y - half), ink, 2)


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

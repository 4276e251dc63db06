"""The tab of the passes: their graph, drawn by ourselves so that it is crisp at every zoom.

The wheel zooms, a drag moves the graph or a node; it fits its pane until then, and again after F. A click
chooses a node or a wire, a double click opens a node: the passes inside it, or its code. A drag from an
output to an input wires; let go in the empty, it asks what to add there. A node dropped on a wire goes
between. With the keys, which a click gives the graph and Esc takes away, all of that is done as well.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from imgui_bundle import ImVec2, imgui

from playground.sketch import model
from playground.sketch.edit_passes import Wire
from playground.studio import focus, theme
from playground.studio.bench import Workbench
from playground.studio.draw import button, ctrl_held, disabled, fitting, inked, letters
from playground.studio.graph.canvas_panel import (
    HIGH,
    MOST,
    STEP,
    WIDE,
    ZOOMS,
    Canvas,
    Pins,
    Span,
    corner_of,
    distance,
    draw_wire,
    is_near,
    middle_of,
    nearest_pin,
    node_at,
    pins_of,
    text_width,
    wire_spans,
    write,
)
from playground.studio.graph.chooser_panel import draw_chooser
from playground.studio.graph.edits import technique_at
from playground.studio.graph.graph import Graph, Pin, Pull, Wiring, cost_of
from playground.studio.interface import Tab
from playground.studio.language import numeral, tr, tr_label
from playground.studio.picture.view import Place
from playground.studio.session import Session
from playground.studio.theme import Theme

_THUMB = 54.0
_TEXT = 78.0  # where a node's text begins
_LEGIBLE = 0.45  # of the size of letters: below, a node has its name alone, no smaller than this
_LEAST = 10.5  # [units] of that name
_NEAR = 8.0  # [units] that the mouse may be away from a pin or a wire
_PLUS = 9.0  # [units] radius of the + on a wire
_NUDGE = {(-1, 0): (-0.25, 0.0), (1, 0): (0.25, 0.0), (0, -1): (0.0, -0.5), (0, 1): (0.0, 0.5)}
_F = imgui.ButtonFlags_
_DRAGS = imgui.HoveredFlags_.allow_when_blocked_by_active_item


def passes_tab(bench: Workbench) -> Tab:
    """Return the strip's tab of the passes."""
    panel = GraphPanel(bench)
    return Tab("passes", "Passes", panel.draw)


@dataclass(frozen=True)
class _Node:
    """One node in a frame."""

    name: str
    ref: str  # its texture
    at: tuple[float, float]  # its upper left corner [units of the graph]
    is_hovered: bool
    is_muted: bool
    is_shown: bool


_Line = tuple[Wire, tuple[list[Span], list[Span]]]
"""A wire, and where it runs."""


@dataclass
class _Drag:
    """A node that is dragged."""

    node: str
    grip: tuple[float, float]  # from its corner to the mouse [units of the graph]
    place: Place  # where it is now
    target: Wire | None = None  # the wire that it is over


class GraphPanel:
    """Draws the graph of one window, and does what is asked for in it."""

    def __init__(self, bench: Workbench) -> None:
        self._bench = bench
        self._zoom, self._pan = 1.0, (0.0, 0.0)
        self._fits = True  # until the graph is moved or zoomed by hand
        self._rests = False  # the mouse does, over the pane: what is under it is explained
        self._drag: _Drag | None = None
        self._menu = ""  # the node whose menu is open
        self._wire_menu: Pin | None = None  # the wire whose menu is open: reader and input

    @property
    def graph(self) -> Graph:
        """What is chosen in it."""
        return self._bench.inspection.graph

    def draw(self, look: Theme) -> None:
        """Draw the tab in the current window."""
        graph, bench = self.graph, self._bench
        wiring = graph.begin(bench.notices.now())
        if wiring is None:
            return
        if graph.times:
            bench.inspection.costs_shown = True
        self._switches(look, wiring)
        corner, room = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail()
        if room.x < 20 or room.y < 20:
            return
        canvas = self._canvas(corner, room, wiring, look.scale)
        draw = imgui.get_window_draw_list()
        draw.push_clip_rect(corner, ImVec2(corner.x + room.x, corner.y + room.y), True)
        self._ground(canvas, wiring)
        wiring = self._drag_on(wiring, canvas)
        pins = pins_of(wiring, canvas)
        lines = [(wire, wire_spans(wire, wiring, canvas, pins)) for wire in wiring.wires]
        lit = self._wire_under_mouse(lines, wiring, canvas)
        target = self._drag.target if self._drag is not None else None
        above = [ln for ln in lines if ln[0] is target or {ln[0].giver, ln[0].reader} & {*wiring.above}]
        self._draw_wires([line for line in lines if line not in above], lit, canvas)
        for node in wiring.stacked:
            self._draw_node(node, wiring, canvas, look)
        self._draw_wires(above, lit, canvas)  # nothing goes around a node that was moved
        if graph.inside is None:
            self._pull(wiring, canvas, pins)
            self._plus(lit, wiring, canvas, pins, look)
        self._pin_marks(wiring, canvas, pins)
        self._drop()
        if lit is not None and imgui.is_mouse_clicked(0):
            graph.wire, graph.chosen = (lit.reader, lit.input), ""
        if lit is not None and imgui.is_mouse_clicked(1):
            self._open_menu("wire menu", wire=(lit.reader, lit.input))
        if graph.has_keys:
            edge = ImVec2(corner.x + room.x - 1, corner.y + room.y - 1)
            draw.add_rect(ImVec2(corner.x + 1, corner.y + 1), edge, theme.packed(theme.palette.accent, 0.7))
        draw.pop_clip_rect()
        self._draw_menu(wiring)
        self._draw_wire_menu(wiring)
        self._draw_ground_menu()
        draw_chooser(bench, wiring, look)
        self._keys(wiring)  # after it: the "+" that opens it is no letter of its search

    # ── the pane ─────────────────────────────────────────────────────────────

    def _switches(self, look: Theme, wiring: Wiring) -> None:
        graph = self.graph
        with disabled(graph.inside is not None):
            if button(
                f"+ {tr('Pass')}###add pass", tr("Add a pass before the view; + on a node adds one after it")
            ):
                self._ask("")
        imgui.same_line()
        if button(f"{tr('Fit')}###fit", tr("Fit the graph to its pane (F)")):
            self._fits = True
        imgui.same_line()
        if graph.inside:
            if button(f"‹ {graph.inside}###out", tr("Back to the sketch's own passes (Esc)")):
                self._go_inside(None)
        else:
            changed, inner = imgui.checkbox(f"{tr('Inside techniques')}###inner", graph.inside is not None)
            if changed:
                self._go_inside("" if inner else None)
        imgui.same_line()
        changed, timed = imgui.checkbox(f"{tr('Time each pass')}###timed", graph.times)
        if changed:
            graph.timed = timed
        imgui.same_line()
        imgui.align_text_to_frame_padding()
        more = ""
        if graph.pulled is not None and graph.pulled.by_keys:
            words = tr(
                "Wire from {name}: arrows choose a pass, Enter joins, Esc lets go", name=graph.pulled.giver
            )
        elif graph.has_keys:
            words = tr("Arrows choose, Enter opens, + adds, Del deletes; right click: menu")
            more = tr(
                "Shift+arrows choose a wire, W begins one, M mutes, S shows, Ctrl+D duplicates,"
                " Ctrl+arrows: earlier and later in the file, Ctrl+Shift+arrows move, T tidies, Esc: leave"
            )
        else:
            words = tr("Double click: open. Drag: move, or onto a wire. Right click: menu")
            more = tr(
                "A click chooses; a drag from a pin to another wires them, to empty space it adds a pass"
            )
        room = imgui.get_content_region_avail().x
        imgui.text_disabled(fitting(words, room))
        if more or fitting(words, room) != words:
            imgui.set_item_tooltip("\n".join(filter(None, [words, more])))

    def _canvas(self, corner: ImVec2, room: ImVec2, wiring: Wiring, scale: float) -> Canvas:
        if self._fits:
            first, top, last, end = wiring.layout.bounds
            wide, high = (last - first) * STEP + WIDE, max(end - top, 1.0) * HIGH
            fit = min((room.x - 24 * scale) / wide, (room.y - 12 * scale) / high) / scale
            self._zoom = min(max(fit, ZOOMS[0]), MOST)
            k = self._zoom * scale
            self._pan = (room.x - wide * k) / 2 - first * STEP * k, (room.y - high * k) / 2 - top * HIGH * k
        return Canvas(corner, room, self._zoom, self._pan, scale)

    def _ground(self, canvas: Canvas, wiring: Wiring) -> None:
        """Take what is done to the pane itself: zoom, move, give the keys."""
        graph, io = self.graph, imgui.get_io()
        imgui.set_next_item_allow_overlap()
        flags = _F.mouse_button_left | _F.mouse_button_middle | _F.enable_nav
        if imgui.invisible_button("canvas", canvas.room, flags) and focus.is_shown():
            graph.gets_keys = True  # by Space or Enter
        self._rests = imgui.is_item_hovered(imgui.HoveredFlags_.for_tooltip)
        inside = canvas.holds(io.mouse_pos) and imgui.is_window_hovered(_DRAGS)
        over = node_at(wiring, canvas, io.mouse_pos) if inside else ""
        if imgui.is_item_hovered() and imgui.is_mouse_double_clicked(0):
            self._fits = True
        if imgui.is_item_hovered() and imgui.is_mouse_clicked(1) and not over:
            self._open_menu("ground menu")
        if imgui.is_item_active() and (io.mouse_delta.x or io.mouse_delta.y) and graph.pulled is None:
            self._pan = self._pan[0] + io.mouse_delta.x, self._pan[1] + io.mouse_delta.y
            self._fits = False
        if inside and io.mouse_wheel:
            self._magnify(
                1.15**io.mouse_wheel, io.mouse_pos.x - canvas.corner.x, io.mouse_pos.y - canvas.corner.y
            )
        if inside:
            graph.touched = True
        if imgui.is_mouse_clicked(0) and not imgui.is_popup_open("", imgui.PopupFlags_.any_popup):
            graph.has_keys = inside
            if inside:
                graph.wire, graph.chosen = None, over

    def _magnify(self, by: float, x: float, y: float) -> None:
        new = min(max(self._zoom * by, ZOOMS[0]), ZOOMS[1])
        ratio = new / self._zoom
        self._pan = x - (x - self._pan[0]) * ratio, y - (y - self._pan[1]) * ratio
        self._zoom, self._fits = new, False

    # ── wires ────────────────────────────────────────────────────────────────

    def _wire_under_mouse(self, lines: list[_Line], wiring: Wiring, canvas: Canvas) -> Wire | None:
        """Return the wire under the mouse; note the one under the node that is dragged."""
        mouse, graph, drag = imgui.get_mouse_pos(), self.graph, self._drag
        if graph.inside is not None or not canvas.holds(mouse) or not imgui.is_window_hovered(_DRAGS):
            return None
        if drag is not None:
            x, y = corner_of(wiring, drag.node)
            middle = canvas.place(x + WIDE / 2, y + HIGH / 2)
            free = [line for line in lines if drag.node not in (line[0].giver, line[0].reader)]
            drag.target = _wire_at(free, canvas, [mouse, middle], 2 * _NEAR * canvas.scale)
            return None
        if graph.pulled is not None or not imgui.is_window_hovered() or node_at(wiring, canvas, mouse):
            return None
        near = _wire_at(lines, canvas, [mouse], _NEAR * canvas.scale * 0.7, round_plus=True)
        if near is not None and self._rests:
            note = tr("found by its name") if not near.is_written else tr("Del takes it away")
            imgui.set_tooltip(f"{_wire_name(near)}\n{note}")
        return near

    def _draw_wires(self, lines: list[_Line], lit: Wire | None, canvas: Canvas) -> None:
        graph, drag, palette = self.graph, self._drag, theme.palette
        muted = self._bench.session.view.muted
        for wire, spans in lines:
            is_target = drag is not None and wire is drag.target
            is_lit = wire is lit or is_target or graph.wire == (wire.reader, wire.input)
            touches = graph.chosen in (wire.giver, wire.reader) and bool(graph.chosen)
            ink = palette.accent if is_lit else palette.ink if touches else palette.dim
            if (
                is_target
                and drag is not None
                and self._bench.passes.why_not(drag.node, wire.reader, wire.input)
            ):
                ink = palette.alarm
            alpha = 0.35 if {wire.giver, wire.reader} & muted else 0.9
            thick = (3.0 if is_lit else 2.0) * max(min(canvas.zoom, 1.2), 0.5) * canvas.scale
            draw_wire(spans, canvas, theme.packed(ink, alpha), thick)

    def _plus(self, lit: Wire | None, wiring: Wiring, canvas: Canvas, pins: Pins, look: Theme) -> None:
        """Draw a + in the middle of the wire under the mouse, or of the one that is chosen."""
        pin = (lit.reader, lit.input) if lit is not None else self.graph.wire
        wire = wiring.wire_to(pin)
        if wire is None or self._drag is not None or self.graph.pulled is not None:
            return
        middle, side = middle_of(wire_spans(wire, wiring, canvas, pins)), _PLUS * canvas.scale
        low, far = ImVec2(middle.x - side, middle.y - side), ImVec2(middle.x + side, middle.y + side)
        if _area("+ wire", low, far, canvas):
            self._ask_on(wire)
        palette, draw = theme.palette, imgui.get_window_draw_list()
        ground = palette.pressed if imgui.is_item_hovered() else palette.hover
        draw.add_circle_filled(middle, side, theme.packed(ground))
        draw.add_circle(middle, side, theme.packed(palette.accent))
        if imgui.is_item_hovered():
            imgui.set_tooltip(tr("Add a pass on this wire (+)"))
        arm, ink, thick = 0.5 * side, theme.packed(palette.ink), 1.5 * canvas.scale
        draw.add_line(ImVec2(middle.x - arm, middle.y), ImVec2(middle.x + arm, middle.y), ink, thick)
        draw.add_line(ImVec2(middle.x, middle.y - arm), ImVec2(middle.x, middle.y + arm), ink, thick)

    # ── nodes that are dragged ───────────────────────────────────────────────

    def _drag_on(self, wiring: Wiring, canvas: Canvas) -> Wiring:
        """Return the graph with the node that is dragged where the mouse has it."""
        drag = self._drag
        if drag is None or drag.node not in wiring.refs:
            self._drag = None
            return wiring
        x, y = canvas.units(imgui.get_mouse_pos())
        drag.place = (x - drag.grip[0]) / STEP, (y - drag.grip[1]) / HIGH + 0.5
        return wiring.moved({drag.node: drag.place})

    def _drop(self) -> None:
        """Say what becomes of the node that is dragged, and do that where it is let go."""
        drag, edits = self._drag, self._bench.passes
        if drag is None:
            return
        wire = drag.target
        reason = edits.why_not(drag.node, wire.reader, wire.input) if wire is not None else ""
        if wire is not None:
            words = tr(
                "{name} between {giver} and {reader}", name=drag.node, giver=wire.giver, reader=wire.reader
            )
            with inked(theme.palette.alarm if reason else theme.palette.ink):
                imgui.set_tooltip(reason or words)
        if imgui.is_mouse_down(0):
            return
        self._drag = None
        if wire is None:
            self.graph.place(drag.node, drag.place)
        elif reason:
            self._bench.notices.say(reason)
        elif edits.put(drag.node, wire.reader, wire.input):
            self._bench.session.view.places.pop(drag.node, None)  # where it is now is worked out

    def _pull(self, wiring: Wiring, canvas: Canvas, pins: Pins) -> None:
        """Draw the wire that is pulled from an output, and join or ask where it is let go."""
        graph, mouse = self.graph, imgui.get_mouse_pos()
        hovers = canvas.holds(mouse) and imgui.is_window_hovered(_DRAGS)
        out = nearest_pin(pins.outputs, mouse, _NEAR * canvas.scale) if hovers else None
        if graph.pulled is None:
            if out is not None and imgui.is_mouse_clicked(0):
                graph.pulled = Pull(*out)
                graph.chosen = out[0]
            return
        giver, output, by_keys = graph.pulled.giver, graph.pulled.output, graph.pulled.by_keys
        start = pins.outputs.get((giver, output))
        if start is None:
            graph.pulled = None
            return
        target = (
            nearest_pin(pins.inputs, mouse, 1.6 * _NEAR * canvas.scale) if hovers and not by_keys else None
        )
        over = graph.chosen if by_keys else node_at(wiring, canvas, mouse)
        if target is None and over and over != giver:
            target = over, wiring.input_for(giver, output, over)
        refused = target is not None and (not target[1] or graph.is_refused(giver, target[0]))
        end = start if by_keys else mouse
        if target is not None:
            x, y = corner_of(wiring, target[0])
            end = pins.inputs.get(target) or canvas.place(x, y + HIGH / 2)  # a node without an input
        ink = theme.packed(theme.palette.alarm if refused else theme.palette.accent)
        bend = max(0.5 * abs(end.x - start.x), 26 * canvas.k)
        draw = imgui.get_window_draw_list()
        points = ImVec2(start.x + bend, start.y), ImVec2(end.x - bend, end.y)
        draw.add_bezier_cubic(start, *points, end, ink, 3 * canvas.scale)
        if by_keys and target is not None:
            imgui.set_next_window_pos(
                ImVec2(end.x, end.y + 2 * _NEAR * canvas.scale)
            )  # there, not at the mouse
        if refused and target is not None:
            self._say_refusal(giver, target)
        elif target is not None:
            imgui.set_tooltip(f"{giver}:{output} → {target[0]}.{target[1]}")
        if not by_keys and not imgui.is_mouse_down(0):
            graph.pulled = None
            if target is not None and not refused:
                self._bench.passes.wire(giver, output, *target)
            elif target is None and hovers and not over and distance(start, mouse) > 3 * _NEAR * canvas.scale:
                self._ask(giver, output)

    def _say_refusal(self, giver: str, target: Pin) -> None:
        if not target[1]:
            imgui.set_tooltip(tr("{name} takes no input", name=target[0]))
        else:
            words = "{giver} is made from {reader} already: this would make a cycle"
            imgui.set_tooltip(tr(words, giver=giver, reader=target[0]))

    def _pin_marks(self, wiring: Wiring, canvas: Canvas, pins: Pins) -> None:
        draw, mouse = imgui.get_window_draw_list(), imgui.get_mouse_pos()
        wired = {(wire.reader, wire.input) for wire in wiring.wires}
        radius = max(min(canvas.k, 1.3 * canvas.scale), 0.5 * canvas.scale)
        hovers = canvas.holds(mouse) and imgui.is_window_hovered() and self.graph.inside is None
        hovers = hovers and self._drag is None
        lit = nearest_pin(pins.outputs, mouse, _NEAR * canvas.scale) if hovers else None
        lit_in = nearest_pin(pins.inputs, mouse, _NEAR * canvas.scale) if hovers and lit is None else None
        for pin, point in pins.inputs.items():
            ink = theme.packed(theme.palette.accent if pin == lit_in else theme.palette.ink)
            if pin in wired or self.graph.inside is not None:
                draw.add_circle_filled(point, 3.4 * radius, ink)
            else:
                draw.add_circle_filled(point, 3.4 * radius, theme.packed(theme.palette.ground))
                draw.add_circle(point, 3.4 * radius, ink)
        for pin, point in pins.outputs.items():
            pulled = self.graph.pulled
            on = pin == lit or (pulled is not None and pin == (pulled.giver, pulled.output))
            draw.add_circle_filled(
                point,
                (5.4 if on else 3.8) * radius,
                theme.packed(theme.palette.accent if on else theme.palette.ink),
            )
        if lit is not None and self.graph.pulled is None:
            imgui.set_tooltip(
                tr("{name}: drag it to an input, or to empty space to add a pass", name=":".join(lit))
            )
        elif lit_in is not None and self.graph.pulled is None:
            imgui.set_tooltip(".".join(lit_in))

    # ── nodes ────────────────────────────────────────────────────────────────

    def _draw_node(self, name: str, wiring: Wiring, canvas: Canvas, look: Theme) -> None:
        """Draw one node, and take what is done to it."""
        graph, session = self.graph, self._bench.session
        x, y = corner_of(wiring, name)
        low, far, k = canvas.place(x, y), canvas.place(x + WIDE, y + HIGH), canvas.k
        if far.x < canvas.corner.x or low.x > canvas.corner.x + canvas.room.x:
            return
        if far.y < canvas.corner.y or low.y > canvas.corner.y + canvas.room.y:
            return
        ref = wiring.refs[name]
        is_free = graph.pulled is None and imgui.is_window_hovered() and canvas.holds(imgui.get_mouse_pos())
        shown = session.view.map.ref == ref if session.view.map is not None else name == "view"
        node = _Node(
            name,
            ref,
            (x, y),
            is_hovered=is_free and node_at(wiring, canvas, imgui.get_mouse_pos()) == name,
            is_muted=name.partition(".")[0] in session.view.muted,
            is_shown=shown,
        )
        imgui.set_next_item_allow_overlap()
        _area(f"node {name}", ImVec2(low.x + 6 * k, low.y), ImVec2(far.x - 6 * k, far.y), canvas)
        if imgui.is_item_hovered() and graph.pulled is None and self._drag is None:
            if imgui.is_mouse_double_clicked(0):
                self._open(name)
            if imgui.is_mouse_clicked(1):
                graph.chosen, graph.wire = name, None
                self._open_menu("node menu", node=name)
            on_picture = (
                imgui.get_mouse_pos().x < canvas.place(x + _TEXT, y).x
            )  # else it would hide the buttons
            if on_picture and imgui.is_item_hovered(imgui.HoveredFlags_.for_tooltip):
                lines = [_tooltip(name, session), self._bench.inspection.reasons.text(name)]
                imgui.set_tooltip("\n".join(filter(None, lines)))
        if imgui.is_item_active() and imgui.is_mouse_dragging(0, 4 * canvas.scale) and self._drag is None:
            mouse, delta = imgui.get_mouse_pos(), imgui.get_mouse_drag_delta(0, 0.0)
            at = canvas.units(ImVec2(mouse.x - delta.x, mouse.y - delta.y))
            if graph.pulled is None:
                self._drag = _Drag(name, (at[0] - x, at[1] - y), wiring.layout.places[name])
                self._fits = False
        self._draw_box(node, low, far, canvas)
        size = _LEAST * canvas.scale
        if canvas.zoom < _LEGIBLE and size < HIGH * k:
            place = ImVec2(low.x + 7 * canvas.scale, (low.y + far.y - 1.2 * size) / 2)
            ink = theme.palette.dim if node.is_muted else theme.palette.ink
            write(name.rpartition(".")[2], look.bold, size, place, WIDE * k - 12 * canvas.scale, ink)
            return
        self._draw_picture(node, canvas.place(x + 14, y + 5), _THUMB * k)
        if canvas.zoom < _LEGIBLE:
            return
        is_marked = node.is_hovered or node.is_muted or node.is_shown or name == graph.chosen
        has_buttons = is_marked and graph.inside is None and name != "view"
        self._write_words(node, canvas, look, has_buttons=has_buttons)
        if has_buttons:
            self._draw_buttons(node, canvas, look)

    def _draw_box(self, node: _Node, low: ImVec2, far: ImVec2, canvas: Canvas) -> None:
        draw, palette, k = imgui.get_window_draw_list(), theme.palette, canvas.k
        ground = palette.raised if node.is_hovered else palette.field
        draw.add_rect_filled(low, far, theme.packed(ground, 0.55 if node.is_muted else 1.0), 6 * k)
        if node.is_shown:
            draw.add_rect(low, far, theme.packed(palette.accent), 6 * k, 2 * canvas.scale)
        if node.name == self.graph.chosen:
            out = 3 * canvas.scale
            corner = ImVec2(low.x - out, low.y - out), ImVec2(far.x + out, far.y + out)
            draw.add_rect(*corner, theme.packed(palette.ink), 8 * k, 2 * canvas.scale)
        if node.is_muted:
            left, right = ImVec2(low.x, (low.y + far.y) / 2), ImVec2(far.x, (low.y + far.y) / 2)
            draw.add_line(left, right, theme.packed(palette.dim), 2 * canvas.scale)

    def _draw_picture(self, node: _Node, low: ImVec2, side: float) -> None:
        draw, thumbnails = imgui.get_window_draw_list(), self.graph.thumbnails
        high, texture = ImVec2(low.x + side, low.y + side), thumbnails.get(node.ref)
        if texture is None:
            draw.add_rect(low, high, theme.packed(theme.palette.line))
            return
        # Dimmed where it is of another picture than the last.
        alpha = 0.45 if node.is_muted or not thumbnails.is_current(node.ref) else 1.0
        tint = theme.packed((1.0, 1.0, 1.0), alpha)
        draw.add_image(imgui.ImTextureRef(texture.glo), low, high, ImVec2(0, 1), ImVec2(1, 0), tint)

    def _write_words(self, node: _Node, canvas: Canvas, look: Theme, *, has_buttons: bool) -> None:
        """Write a node's name, its technique, unless buttons take its place, and what it cost."""
        palette, sketch = theme.palette, self.graph.sketch
        spec = sketch.graph.find(node.name) if sketch is not None else None
        use = spec.use.rpartition("/")[2] if spec is not None else node.name.rpartition(".")[0]
        runs, ran, spent = cost_of(self._bench.session, node.name)
        cost = runs if spent is None else f"{numeral(spent, '.2f' if spent < 10 else '.0f')} ms"
        cost = tr("muted") if node.is_muted else f"• {cost}" if ran else cost
        ink = palette.accent if ran and not node.is_muted else palette.dim
        rows = [(node.name.rpartition(".")[2], look.bold, 14.0, palette.ink, 5.0)]
        rows += [] if has_buttons else [(use, look.text, 12.0, palette.dim, 24.0)]
        for text, font, size, colour, down in (*rows, (cost, look.text, 12.0, ink, 43.0)):
            place = canvas.place(node.at[0] + _TEXT, node.at[1] + down)
            write(text, font, size * canvas.k, place, (WIDE - _TEXT - 8) * canvas.k, colour)

    def _draw_buttons(self, node: _Node, canvas: Canvas, look: Theme) -> None:
        """Draw M, S and + in a node."""
        edits, palette, draw = self._bench.passes, theme.palette, imgui.get_window_draw_list()
        mute = tr("Mute: let through what it is made of; not written (M)")
        solo = tr("Solo: show its texture from above; not written (S)")
        row: tuple[tuple[str, bool, str, Callable[[], object]], ...] = (
            ("M", node.is_muted, mute, lambda: edits.mute(node.name)),
            ("S", node.is_shown, solo, lambda: edits.solo(node.name, node.ref)),
            ("+", False, tr("Add a pass after it (+)"), lambda: self._ask(node.name)),
        )
        side, size = 17.0, 12.5 * canvas.k
        for number, (sign, is_lit, note, act) in enumerate(row):
            x, y = node.at[0] + WIDE - 8 - (3 - number) * (side + 3), node.at[1] + 23
            low, far = canvas.place(x, y), canvas.place(x + side, y + side)
            clicked = _area(f"{sign} {node.name}", low, far, canvas)
            hovered = imgui.is_item_hovered()
            if hovered:
                imgui.set_tooltip(note)
            ground = palette.grab if is_lit else palette.pressed if hovered else palette.hover
            draw.add_rect_filled(low, far, theme.packed(ground), 3 * canvas.k)
            if is_lit:
                draw.add_rect(low, far, theme.packed(palette.ink), 3 * canvas.k)
            place = ImVec2(
                (low.x + far.x - text_width(sign, look.bold, size)) / 2, (low.y + far.y) / 2 - 0.62 * size
            )
            draw.add_text(look.bold, size, place, theme.packed(palette.ink), sign)
            if clicked:
                act()

    # ── what can be done ─────────────────────────────────────────────────────

    def _ask(self, after: str, output: str = "", on: Wire | None = None) -> None:
        """Open the chooser for a pass behind another, or on a wire."""
        sketch = self.graph.sketch
        if sketch is not None:
            self.graph.touched = True
            self.graph.chooser.open(sketch, "" if after == "view" else after, output, on)

    def _ask_on(self, wire: Wire) -> None:
        self._ask(wire.giver, wire.output, wire)

    def _add(self, wiring: Wiring) -> None:
        """Open the chooser for a pass behind the node that is chosen, or on the wire."""
        wire = wiring.wire_to(self.graph.wire)
        if wire is not None:
            self._ask_on(wire)
        else:
            self._ask(self.graph.chosen)

    def _open(self, node: str) -> None:
        """Open a node: the passes inside it, or its code."""
        if self.graph.inside is None and isinstance(self._technique(node), model.Graph):
            self._go_inside(node)
        else:
            self._open_code(node)

    def _technique(self, node: str) -> model.Technique | None:
        return technique_at(self.graph.sketch, node) if self.graph.sketch is not None else None

    def _go_inside(self, node: str | None) -> None:
        self.graph.inside, self.graph.chosen, self._fits = node, self.graph.inside or "", True

    def _open_code(self, node: str) -> None:
        technique = self._technique(node)
        if technique is None or not technique.path:
            self._bench.notices.say(tr("{name} has no code of its own", name=node))
            return
        self.graph.has_keys = False
        self._bench.files.open(Path(technique.path), here=True)

    def _delete(self) -> None:
        graph, edits = self.graph, self._bench.passes
        if graph.wire is not None:
            edits.unwire(*graph.wire)
        elif graph.chosen:
            edits.delete(graph.chosen)

    def _duplicate(self) -> None:
        new = self._bench.passes.duplicate(self.graph.chosen)
        self.graph.chosen = new or self.graph.chosen

    def _begin_wire(self, wiring: Wiring) -> None:
        graph = self.graph
        outputs = wiring.outputs.get(graph.chosen, ())
        if outputs:
            graph.pulled = Pull(graph.chosen, outputs[0], by_keys=True)

    def _nudge(self, wiring: Wiring, step: tuple[int, int]) -> None:
        """Move the node that is chosen a little."""
        (column, y), (across, down) = wiring.layout.places[self.graph.chosen], _NUDGE[step]
        self.graph.place(self.graph.chosen, (column + across, y + down))

    def _enter(self, wiring: Wiring) -> None:
        """Open what is chosen; or join the wire that was begun by a key to it."""
        graph = self.graph
        if graph.pulled is None:
            self._open(graph.chosen)
            return
        giver, output, graph.pulled = graph.pulled.giver, graph.pulled.output, None
        name = wiring.input_for(giver, output, graph.chosen)
        if giver != graph.chosen and name:
            self._bench.passes.wire(giver, output, graph.chosen, name)

    def _keys(self, wiring: Wiring) -> None:
        """Do what a key asks for while the graph has the keys."""
        graph, io, key = self.graph, imgui.get_io(), imgui.Key
        popup = imgui.is_popup_open("", imgui.PopupFlags_.any_popup)
        if not graph.has_keys or popup or io.want_text_input or io.key_alt or graph.chooser.is_open:
            return
        chosen, edits, ctrl, own = graph.chosen, self._bench.passes, ctrl_held(), graph.inside is None
        arrows = {
            key.left_arrow: (-1, 0),
            key.right_arrow: (1, 0),
            key.up_arrow: (0, -1),
            key.down_arrow: (0, 1),
        }
        for arrow, step in arrows.items():
            if imgui.is_key_pressed(arrow):
                graph.took_key = True
                if ctrl and io.key_shift and chosen:
                    self._nudge(wiring, step)
                elif ctrl and chosen and own:
                    edits.move(chosen, step[0] or step[1])
                elif io.key_shift and not ctrl:
                    graph.step_wire()
                elif not ctrl:
                    graph.wire = None
                    graph.step(*step)
        acts: list[tuple[imgui.Key, bool, Callable[[], object]]]
        if ctrl:
            acts = [(key.d, bool(chosen) and own, self._duplicate)]
        else:
            acts = [
                (key.f, True, self._fit),
                (key.t, True, graph.tidy),
                (key.tab, True, lambda: graph.step_on(-1 if io.key_shift else 1)),
                (key.enter, bool(chosen), lambda: self._enter(wiring)),
                (key.keypad_enter, bool(chosen), lambda: self._enter(wiring)),
                (key.s, bool(chosen), lambda: edits.solo(chosen, wiring.refs[chosen])),
                (key.m, bool(chosen) and own, lambda: edits.mute(chosen)),
                (key.w, bool(chosen) and own, lambda: self._begin_wire(wiring)),
                (key.insert, own, lambda: self._add(wiring)),
                (key.delete, own and (bool(chosen) or graph.wire is not None), self._delete),
            ]
        for which, can, act in acts:
            if can and imgui.is_key_pressed(which, repeat=which == key.tab):
                graph.took_key = True
                act()
        if "+" in letters() and own and not ctrl:
            graph.took_key = True
            self._add(wiring)

    def _fit(self) -> None:
        self._fits = True

    def _open_menu(self, menu: str, *, node: str = "", wire: Pin | None = None) -> None:
        """Open a menu, of a node, a wire or the graph, which gets the keys."""
        self.graph.has_keys, self._menu, self._wire_menu = True, node, wire
        if wire is not None:
            self.graph.wire, self.graph.chosen = wire, ""
        imgui.open_popup(menu)

    def _draw_menu(self, wiring: Wiring) -> None:
        """Draw the menu of a node."""
        node, edits, own = self._menu, self._bench.passes, self.graph.inside is None
        if not imgui.begin_popup("node menu"):
            return
        if node not in wiring.refs:
            imgui.close_current_popup()
            imgui.end_popup()
            return
        imgui.text_disabled(node)
        ref, is_view, muted = wiring.refs[node], node == "view", node in self._bench.session.view.muted
        has_passes = own and isinstance(self._technique(node), model.Graph)
        mute = tr("No longer muted") if muted else tr("Mute")
        rows: list[_Row] = [
            ("inside", tr("Passes inside it"), tr("Enter"), has_passes, lambda: self._go_inside(node)),
            ("code", tr("Its code"), "" if has_passes else tr("Enter"), True, lambda: self._open_code(node)),
            ("show", tr("Show"), "S", True, lambda: self._bench.passes.solo(node, ref)),
            ("parameters", tr("Its parameters"), "", True, lambda: self._reveal(node)),
        ]
        if own:
            rows += [
                ("mute", mute, "M", not is_view, lambda: edits.mute(node)),
                ("behind", tr("Add a pass after…"), "+", not is_view, lambda: self._ask(node)),
                ("duplicate", tr("Duplicate"), "Ctrl+D", not is_view, self._duplicate),
                ("earlier", tr("Earlier in the file"), "Ctrl+←", not is_view, lambda: edits.move(node, -1)),
                ("later", tr("Later in the file"), "Ctrl+→", not is_view, lambda: edits.move(node, 1)),
                ("delete", tr("Delete"), tr("Del"), not is_view, lambda: edits.delete(node)),
            ]
        _rows("pass", rows)
        imgui.end_popup()

    def _draw_wire_menu(self, wiring: Wiring) -> None:
        if not imgui.begin_popup("wire menu"):
            return
        wire = wiring.wire_to(self._wire_menu)
        if wire is None:
            imgui.close_current_popup()
        else:
            imgui.text_disabled(_wire_name(wire))
            pin, unwire = (wire.reader, wire.input), self._bench.passes.unwire
            rows: list[_Row] = [
                ("on", tr("Add a pass here…"), "+", True, lambda: self._ask_on(wire)),
                ("cut", tr("Disconnect"), tr("Del"), wire.is_written, lambda: unwire(*pin)),
            ]
            _rows("wire", rows)
            if not wire.is_written:
                imgui.text_disabled(tr("found by its name"))
        imgui.end_popup()

    def _draw_ground_menu(self) -> None:
        if not imgui.begin_popup("ground menu"):
            return
        graph = self.graph
        rows: list[_Row] = [
            ("add", tr("Add a pass…"), "+", graph.inside is None, lambda: self._ask("")),
            ("tidy", tr("Tidy: place all nodes anew"), "T", bool(graph.session.view.places), graph.tidy),
            ("fit", tr("Fit"), "F", True, self._fit),
        ]
        _rows("graph", rows)
        imgui.end_popup()

    def _reveal(self, node: str) -> None:
        self._bench.interface.show_pass(node.partition(".")[0])


_Row = tuple[str, str, str, bool, Callable[[], object]]
"""Of a menu: its id, its words, its key, whether it can be done, what it does."""


def _rows(menu: str, rows: list[_Row]) -> None:
    """Draw the rows of a menu, and do what is clicked on."""
    for key, words, shortcut, can, act in rows:
        if imgui.menu_item_simple(f"{words}###{key} {menu}", shortcut, False, can):
            act()


def _wire_name(wire: Wire) -> str:
    source = f"{wire.giver}:{wire.output}" if wire.output else wire.source
    return f"{source} → {wire.reader}.{wire.input}"


def _area(name: str, low: ImVec2, far: ImVec2, canvas: Canvas) -> bool:
    """Take clicks between two corners, as far as that is in the pane; return whether there was one."""
    x, y, corner = max(low.x, canvas.corner.x), max(low.y, canvas.corner.y), canvas.corner
    right, bottom = min(far.x, corner.x + canvas.room.x), min(far.y, corner.y + canvas.room.y)
    imgui.set_cursor_screen_pos(ImVec2(min(x, right - 1), min(y, bottom - 1)))
    return bool(imgui.invisible_button(name, ImVec2(max(right - x, 1), max(bottom - y, 1))))


def _wire_at(
    lines: list[_Line], canvas: Canvas, points: list[ImVec2], reach: float, *, round_plus: bool = False
) -> Wire | None:
    """Return the wire at the first of the points that is near one; also near its middle, where its + is."""
    for point in points:
        for wire, spans in lines:
            on_plus = round_plus and distance(middle_of(spans), point) < _PLUS * canvas.scale
            if on_plus or is_near(spans, canvas, point, reach):
                return wire
    return None


def _tooltip(node: str, session: Session) -> str:
    """Return what a node's tooltip says: its technique, its texture's size and format, its cost."""
    plan = session.plan
    lines = [node]
    spec = plan.flat.specs.get(node) if plan is not None else None
    if spec is not None:
        lines.append(spec.use)
        if spec.technique.title:
            lines.append(tr_label(spec.technique.title))
    if plan is not None and spec is not None:
        for output, ref in plan.flat.outputs[node].items():
            step = plan.step(ref.path)
            if step is not None:
                form = next((o.format for o in step.kernel.outputs if o.name == ref.output), "")
                lines.append(f"{output}  {step.size[0]} x {step.size[1]} {form}")
    runs, _, spent = cost_of(session, node)
    lines.append(runs if spent is None else f"{runs}, {numeral(spent, '.2f')} ms")
    return "\n".join(lines)

"""The tab of the passes: their graph, drawn by ourselves so that it is crisp at every zoom.

The wheel zooms, a drag moves the graph; it fits its pane until then, and again after F. A click chooses a
node, a double click shows its texture from above. A drag from an output to an input wires; let go in the
empty, it asks what to add there. With the keys, which a click gives the graph and Esc takes away, all of
that is done as well.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from imgui_bundle import ImVec2, imgui

from playground.sketch.edit_passes import Wire
from playground.studio import theme
from playground.studio.bench import Workbench
from playground.studio.draw import button, ctrl_held, disabled, fitting, letters
from playground.studio.graph.canvas_panel import (
    HIGH,
    MOST,
    STEP,
    WIDE,
    ZOOMS,
    Canvas,
    Pins,
    corner_of,
    distance,
    draw_wire,
    is_near,
    nearest_pin,
    node_at,
    pins_of,
    text_width,
    wire_spans,
    write,
)
from playground.studio.graph.chooser_panel import draw_chooser
from playground.studio.graph.graph import Graph, Wiring, cost_of
from playground.studio.interface import Tab
from playground.studio.language import tr
from playground.studio.session import Session
from playground.studio.theme import Theme

_THUMB = 54.0
_TEXT = 78.0  # where a node's text begins
_LEGIBLE = 0.45  # of the size of letters: below, nothing is written
_NEAR = 8.0  # [units] that the mouse may be away from a pin or a wire
_F = imgui.ButtonFlags_


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


class GraphPanel:
    """Draws the graph of one window, and does what is asked for in it."""

    def __init__(self, bench: Workbench) -> None:
        self._bench = bench
        self._zoom, self._pan = 1.0, (0.0, 0.0)
        self._fits = True  # until the graph is moved or zoomed by hand
        self._wire: tuple[str, str] | None = None  # the wire that is chosen: reader and input
        self._rests = False  # the mouse does, over the pane: what is under it is explained
        self._menu = ""  # the node whose menu is open

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
        pins = pins_of(wiring, canvas)
        lit = self._wires(wiring, canvas, pins)
        for node in wiring.refs:
            self._draw_node(node, wiring, canvas, look)
        if not graph.inner:
            self._pull(wiring, canvas, pins)
        self._pin_marks(wiring, canvas, pins)
        if lit is not None and imgui.is_mouse_clicked(0):
            self._wire, graph.chosen = (lit.reader, lit.input), ""
        if graph.has_keys:
            edge = ImVec2(corner.x + room.x - 1, corner.y + room.y - 1)
            draw.add_rect(ImVec2(corner.x + 1, corner.y + 1), edge, theme.packed(theme.palette.accent, 0.7))
        draw.pop_clip_rect()
        self._draw_menu(wiring)
        draw_chooser(bench, wiring, look)
        self._keys(wiring)  # after it: the "+" that opens it is no letter of its search

    # ── the pane ─────────────────────────────────────────────────────────────

    def _switches(self, look: Theme, wiring: Wiring) -> None:
        graph = self.graph
        with disabled(graph.inner):
            if button(
                f"+ {tr('Pass')}###add pass", tr("Add a pass before the view; + on a node adds one behind it")
            ):
                self._ask("")
        imgui.same_line()
        if button(f"{tr('Fit')}###fit", tr("Fit the graph to its pane (F)")):
            self._fits = True
        imgui.same_line()
        _, graph.inner = imgui.checkbox(f"{tr('Inside techniques')}###inner", graph.inner)
        imgui.same_line()
        changed, timed = imgui.checkbox(f"{tr('Time each pass')}###timed", graph.times)
        if changed:
            graph.timed = timed
        imgui.same_line()
        imgui.align_text_to_frame_padding()
        if graph.pulled is not None and graph.by_keys:
            words = tr(
                "Wire from {name}: arrows choose a pass, Enter joins, Esc lets go", name=graph.pulled[0]
            )
        elif graph.has_keys:
            words = tr(
                "Arrows, Enter shows, + adds, W wires, M mutes, D duplicates, Del deletes, Ctrl+arrows move"
            )
        else:
            words = tr(
                "Click: choose. Double click: show. Drag from a pin: wire. Right click: all that can be done"
            )
        room = imgui.get_content_region_avail().x
        imgui.text_disabled(fitting(words, room))
        if fitting(words, room) != words:
            imgui.set_item_tooltip(words)

    def _canvas(self, corner: ImVec2, room: ImVec2, wiring: Wiring, scale: float) -> Canvas:
        if self._fits:
            columns, high = wiring.layout.size
            wide, high = max(columns, 1) * STEP - (STEP - WIDE), max(high, 1.0) * HIGH
            fit = min((room.x - 24 * scale) / wide, (room.y - 12 * scale) / high) / scale
            self._zoom = min(max(fit, ZOOMS[0]), MOST)
            k = self._zoom * scale
            self._pan = (room.x - wide * k) / 2, (room.y - high * k) / 2
        return Canvas(corner, room, self._zoom, self._pan, scale)

    def _ground(self, canvas: Canvas, wiring: Wiring) -> None:
        """Take what is done to the pane itself: zoom, move, give the keys."""
        graph, io = self.graph, imgui.get_io()
        imgui.set_next_item_allow_overlap()
        imgui.invisible_button("canvas", canvas.room, _F.mouse_button_left | _F.mouse_button_middle)
        self._rests = imgui.is_item_hovered(imgui.HoveredFlags_.for_tooltip)
        inside = canvas.holds(io.mouse_pos) and imgui.is_window_hovered(
            imgui.HoveredFlags_.allow_when_blocked_by_active_item
        )
        if imgui.is_item_hovered() and imgui.is_mouse_double_clicked(0):
            self._fits = True
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
                self._wire, graph.chosen = None, node_at(wiring, canvas, io.mouse_pos)

    def _magnify(self, by: float, x: float, y: float) -> None:
        new = min(max(self._zoom * by, ZOOMS[0]), ZOOMS[1])
        ratio = new / self._zoom
        self._pan = x - (x - self._pan[0]) * ratio, y - (y - self._pan[1]) * ratio
        self._zoom, self._fits = new, False

    # ── wires ────────────────────────────────────────────────────────────────

    def _wires(self, wiring: Wiring, canvas: Canvas, pins: Pins) -> Wire | None:
        """Draw the wires; return the one under the mouse."""
        mouse, near = imgui.get_mouse_pos(), None
        hovers = canvas.holds(mouse) and imgui.is_window_hovered() and self.graph.pulled is None
        over = node_at(wiring, canvas, mouse)
        lines = [(wire, wire_spans(wire, wiring, canvas, pins)) for wire in wiring.wires]
        if hovers and not over and not self.graph.inner:
            reach = _NEAR * canvas.scale * 0.7
            near = next((wire for wire, spans in lines if is_near(spans, canvas, mouse, reach)), None)
        muted = self._bench.session.view.muted
        for wire, spans in lines:
            chosen = self._wire == (wire.reader, wire.input)
            touches = self.graph.chosen in (wire.giver, wire.reader) and bool(self.graph.chosen)
            ink = (
                theme.palette.accent
                if wire is near or chosen
                else theme.palette.ink
                if touches
                else theme.palette.dim
            )
            alpha = 0.35 if {wire.giver, wire.reader} & muted else 0.9
            thick = (3.0 if chosen or wire is near else 2.0) * max(min(canvas.zoom, 1.2), 0.5) * canvas.scale
            draw_wire(spans, canvas, theme.packed(ink, alpha), thick)
        if near is not None and self._rests:
            source = f"{near.giver}:{near.output}" if near.output else near.source
            note = tr("found by its name") if not near.is_written else tr("Del takes it away")
            imgui.set_tooltip(f"{source} → {near.reader}.{near.input}\n{note}")
        return near

    def _pull(self, wiring: Wiring, canvas: Canvas, pins: Pins) -> None:
        """Draw the wire that is pulled from an output, and join or ask where it is let go."""
        graph, mouse = self.graph, imgui.get_mouse_pos()
        hovers = canvas.holds(mouse) and imgui.is_window_hovered(
            imgui.HoveredFlags_.allow_when_blocked_by_active_item
        )
        out = nearest_pin(pins.outputs, mouse, _NEAR * canvas.scale) if hovers else None
        if graph.pulled is None:
            if out is not None and imgui.is_mouse_clicked(0):
                graph.pulled, graph.by_keys = out, False
                graph.chosen = out[0]
            return
        start = pins.outputs.get(graph.pulled)
        if start is None:
            graph.pulled = None
            return
        giver, output = graph.pulled
        target = (
            nearest_pin(pins.inputs, mouse, 1.6 * _NEAR * canvas.scale)
            if hovers and not graph.by_keys
            else None
        )
        over = graph.chosen if graph.by_keys else node_at(wiring, canvas, mouse)
        if target is None and over and over != giver:
            target = over, wiring.input_for(giver, output, over)
        refused = target is not None and (not target[1] or graph.is_refused(giver, target[0]))
        end = start if graph.by_keys else mouse
        if target is not None:
            x, y = corner_of(wiring, target[0])
            end = pins.inputs.get(target) or canvas.place(x, y + HIGH / 2)  # a node without an input
        ink = theme.packed(theme.palette.alarm if refused else theme.palette.accent)
        bend = max(0.5 * abs(end.x - start.x), 26 * canvas.k)
        draw = imgui.get_window_draw_list()
        points = ImVec2(start.x + bend, start.y), ImVec2(end.x - bend, end.y)
        draw.add_bezier_cubic(start, *points, end, ink, 3 * canvas.scale)
        if graph.by_keys and target is not None:
            imgui.set_next_window_pos(
                ImVec2(end.x, end.y + 2 * _NEAR * canvas.scale)
            )  # there, not at the mouse
        if refused and target is not None:
            self._say_refusal(giver, target)
        elif target is not None:
            imgui.set_tooltip(f"{giver}:{output} → {target[0]}.{target[1]}")
        if not graph.by_keys and not imgui.is_mouse_down(0):
            graph.pulled = None
            if target is not None and not refused:
                self._bench.passes.wire(giver, output, *target)
            elif target is None and hovers and not over and distance(start, mouse) > 3 * _NEAR * canvas.scale:
                self._ask(giver, output)

    def _say_refusal(self, giver: str, target: tuple[str, str]) -> None:
        if not target[1]:
            imgui.set_tooltip(tr("{name} takes no input", name=target[0]))
        else:
            words = "{giver} is made from {reader} already: this would close a circle"
            imgui.set_tooltip(tr(words, giver=giver, reader=target[0]))

    def _pin_marks(self, wiring: Wiring, canvas: Canvas, pins: Pins) -> None:
        draw, mouse = imgui.get_window_draw_list(), imgui.get_mouse_pos()
        wired = {(wire.reader, wire.input) for wire in wiring.wires}
        radius = max(min(canvas.k, 1.3 * canvas.scale), 0.5 * canvas.scale)
        hovers = canvas.holds(mouse) and imgui.is_window_hovered() and not self.graph.inner
        lit = nearest_pin(pins.outputs, mouse, _NEAR * canvas.scale) if hovers else None
        lit_in = nearest_pin(pins.inputs, mouse, _NEAR * canvas.scale) if hovers and lit is None else None
        for pin, point in pins.inputs.items():
            ink = theme.packed(theme.palette.accent if pin == lit_in else theme.palette.ink)
            if pin in wired or self.graph.inner:
                draw.add_circle_filled(point, 3.4 * radius, ink)
            else:
                draw.add_circle_filled(point, 3.4 * radius, theme.packed(theme.palette.ground))
                draw.add_circle(point, 3.4 * radius, ink)
        for pin, point in pins.outputs.items():
            on = pin in (lit, self.graph.pulled)
            draw.add_circle_filled(
                point,
                (5.4 if on else 3.8) * radius,
                theme.packed(theme.palette.accent if on else theme.palette.ink),
            )
        if lit is not None and self.graph.pulled is None:
            imgui.set_tooltip(
                tr("{name}: drag it to an input, or into the empty to add a pass", name=":".join(lit))
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
        imgui.set_cursor_screen_pos(ImVec2(low.x + 6 * k, low.y))
        imgui.set_next_item_allow_overlap()
        imgui.invisible_button(f"node {name}", ImVec2(max(far.x - low.x - 12 * k, 1), max(far.y - low.y, 1)))
        if imgui.is_item_hovered() and graph.pulled is None:
            if imgui.is_mouse_double_clicked(0):
                self._show(name, ref)
            if imgui.is_mouse_clicked(1):
                graph.chosen, graph.has_keys, self._menu = name, True, name
                imgui.open_popup("node menu")
            on_picture = (
                imgui.get_mouse_pos().x < canvas.place(x + _TEXT, y).x
            )  # else it would hide the buttons
            if on_picture and imgui.is_item_hovered(imgui.HoveredFlags_.for_tooltip):
                lines = [_tooltip(name, session), self._bench.inspection.reasons.text(name)]
                imgui.set_tooltip("\n".join(filter(None, lines)))
        self._draw_box(node, low, far, canvas)
        self._draw_picture(node, canvas.place(x + 14, y + 5), _THUMB * k)
        if canvas.k < _LEGIBLE:  # what could not be read is not written
            return
        is_marked = node.is_hovered or node.is_muted or node.is_shown or name == graph.chosen
        has_buttons = is_marked and not graph.inner and name != "view"
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
        cost = runs if spent is None else f"{spent:.2f} ms" if spent < 10 else f"{spent:.0f} ms"
        cost = tr("muted") if node.is_muted else cost
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
            ("+", False, tr("Add a pass behind it (+)"), lambda: self._ask(node.name)),
        )
        side, size = 17.0, 12.5 * canvas.k
        for number, (sign, is_lit, note, act) in enumerate(row):
            x, y = node.at[0] + WIDE - 8 - (3 - number) * (side + 3), node.at[1] + 23
            low, far = canvas.place(x, y), canvas.place(x + side, y + side)
            imgui.set_cursor_screen_pos(low)  # away from the node's middle, where one clicks on it
            clicked = imgui.invisible_button(f"{sign} {node.name}", ImVec2(far.x - low.x, far.y - low.y))
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

    def _show(self, node: str, ref: str) -> None:
        self._bench.session.show(None if node.partition(".")[0] == "view" else ref)

    def _ask(self, after: str, output: str = "") -> None:
        """Open the chooser for a pass behind another."""
        sketch = self.graph.sketch
        if sketch is not None:
            self.graph.touched = True
            self.graph.chooser.open(sketch, "" if after == "view" else after, output)

    def _delete(self) -> None:
        graph, edits = self.graph, self._bench.passes
        if self._wire is not None:
            edits.unwire(*self._wire)
            self._wire = None
        elif graph.chosen:
            edits.delete(graph.chosen)

    def _duplicate(self) -> None:
        new = self._bench.passes.duplicate(self.graph.chosen)
        self.graph.chosen = new or self.graph.chosen

    def _begin_wire(self, wiring: Wiring) -> None:
        graph = self.graph
        outputs = wiring.outputs.get(graph.chosen, ())
        if outputs:
            graph.pulled, graph.by_keys = (graph.chosen, outputs[0]), True

    def _enter(self, wiring: Wiring) -> None:
        """Show what is chosen; or join the wire that was begun by a key to it."""
        graph = self.graph
        if graph.pulled is None:
            self._show(graph.chosen, wiring.refs[graph.chosen])
            return
        (giver, output), graph.pulled = graph.pulled, None
        name = wiring.input_for(giver, output, graph.chosen)
        if giver != graph.chosen and name:
            self._bench.passes.wire(giver, output, graph.chosen, name)

    def _keys(self, wiring: Wiring) -> None:
        """Do what a key asks for while the graph has the keys."""
        graph, io, key = self.graph, imgui.get_io(), imgui.Key
        popup = imgui.is_popup_open("", imgui.PopupFlags_.any_popup)
        if not graph.has_keys or popup or io.want_text_input or io.key_alt or graph.chooser.on:
            return
        chosen, edits, ctrl = graph.chosen, self._bench.passes, ctrl_held()
        arrows = {
            key.left_arrow: (-1, 0),
            key.right_arrow: (1, 0),
            key.up_arrow: (0, -1),
            key.down_arrow: (0, 1),
        }
        for arrow, step in arrows.items():
            if imgui.is_key_pressed(arrow):
                graph.took_key = True
                if not ctrl:
                    graph.step(*step)
                    self._wire = None
                elif chosen and not graph.inner:
                    edits.move(chosen, step[0] or step[1])
        if ctrl:
            return
        acts: list[tuple[imgui.Key, bool, Callable[[], object]]] = [
            (key.f, True, self._fit),
            (key.enter, bool(chosen), lambda: self._enter(wiring)),
            (key.keypad_enter, bool(chosen), lambda: self._enter(wiring)),
        ]
        if not graph.inner:
            acts += [
                (key.m, bool(chosen), lambda: edits.mute(chosen)),
                (key.s, bool(chosen), lambda: edits.solo(chosen, wiring.refs[chosen])),
                (key.d, bool(chosen), self._duplicate),
                (key.w, bool(chosen), lambda: self._begin_wire(wiring)),
                (key.delete, bool(chosen) or self._wire is not None, self._delete),
            ]
        for which, can, act in acts:
            if can and imgui.is_key_pressed(which, repeat=False):
                graph.took_key = True
                act()
        if "+" in letters() and not graph.inner:
            graph.took_key = True
            self._ask(chosen)

    def _fit(self) -> None:
        self._fits = True

    def _draw_menu(self, wiring: Wiring) -> None:
        if not imgui.begin_popup("node menu"):
            return
        node, edits, inner = self._menu, self._bench.passes, self.graph.inner
        if node not in wiring.refs:
            imgui.close_current_popup()
            imgui.end_popup()
            return
        imgui.text_disabled(node)
        is_view, muted = node == "view", node in self._bench.session.view.muted
        rows: list[tuple[str, str, str, bool, Callable[[], object]]] = [
            ("show", tr("Show"), tr("Enter"), True, lambda: self._show(node, wiring.refs[node])),
            ("parameters", tr("Its parameters"), "", True, lambda: self._reveal(node)),
        ]
        if not inner:
            rows += [
                (
                    "mute",
                    tr("No longer muted") if muted else tr("Mute"),
                    "M",
                    not is_view,
                    lambda: edits.mute(node),
                ),
                ("behind", tr("Add a pass behind…"), "+", not is_view, lambda: self._ask(node)),
                ("duplicate", tr("Duplicate"), "D", not is_view, self._duplicate),
                ("earlier", tr("Earlier in the file"), "Ctrl+←", not is_view, lambda: edits.move(node, -1)),
                ("later", tr("Later in the file"), "Ctrl+→", not is_view, lambda: edits.move(node, 1)),
                ("delete", tr("Delete"), tr("Del"), not is_view, lambda: edits.delete(node)),
            ]
        for key, words, shortcut, can, act in rows:
            if imgui.menu_item_simple(f"{words}###{key} pass", shortcut, False, can):
                act()
        imgui.end_popup()

    def _reveal(self, node: str) -> None:
        self._bench.interface.show_pass(node.partition(".")[0])


def _tooltip(node: str, session: Session) -> str:
    """Return what a node's tooltip says: its technique, its texture's size and format, its cost."""
    plan = session.plan
    lines = [node]
    spec = plan.flat.specs.get(node) if plan is not None else None
    if spec is not None:
        lines.append(spec.use)
        if spec.technique.title:
            lines.append(spec.technique.title)
    if plan is not None and spec is not None:
        for output, ref in plan.flat.outputs[node].items():
            step = plan.step(ref.path)
            if step is not None:
                form = next((o.format for o in step.kernel.outputs if o.name == ref.output), "")
                lines.append(f"{output}  {step.size[0]} x {step.size[1]} {form}")
    runs, _, spent = cost_of(session, node)
    lines.append(runs if spent is None else f"{runs}, {spent:.2f} ms")
    return "\n".join(lines)

"""The window of the passes as a graph: thumbnails, runs, times; a click shows a texture from above."""

from __future__ import annotations

from dataclasses import dataclass, field

from imgui_bundle import ImVec2, imgui

from playground.studio import theme
from playground.studio.cost.costs import RunReasons
from playground.studio.draw import QUIET, Area, fitting, styled
from playground.studio.graph.graph import Thumbnails, Wiring, cost_of
from playground.studio.inspect.inspection import Inspection
from playground.studio.session import Session
from playground.studio.theme import Theme

_THUMB = 84.0
_WIDE, _GAP_X, _GAP_Y = 108.0, 46.0, 16.0


@dataclass
class _Drawing:
    """What every node in one frame uses."""

    wiring: Wiring
    session: Session
    thumbnails: Thumbnails
    reasons: RunReasons
    look: Theme
    origin: ImVec2
    high: float = 0.0
    boxes: dict[str, tuple[float, float]] = field(default_factory=dict)  # each node's corner


def draw_graph(session: Session, inspection: Inspection, look: Theme, area: Area) -> None:
    """Draw it while it is open."""
    graph, sketch = inspection.graph, session.sketch
    if not graph.on or sketch is None:
        return
    x, y, wide, high = area
    scale, margin = look.scale, 30 * look.scale
    imgui.set_next_window_pos(ImVec2(x + margin, y + margin), imgui.Cond_.appearing)
    size = ImVec2(max(wide - 2 * margin, 200.0), max(min(0.62 * high, high - 2 * margin), 160.0))
    imgui.set_next_window_size(size, imgui.Cond_.appearing)
    flags = QUIET | imgui.WindowFlags_.no_collapse | imgui.WindowFlags_.horizontal_scrollbar
    ground, rounding = theme.colour(theme.palette.ground, 0.95), 8 * scale
    with styled({imgui.Col_.window_bg: ground}, {imgui.StyleVar_.window_rounding: rounding}):
        visible, stays = imgui.begin("Passes###graph", True, flags)
        graph.on = bool(stays)
        if visible:
            _switches(inspection)
            corner = imgui.get_cursor_screen_pos()
            lines = 3 if session.engine.options.profiling else 2
            high = (_THUMB + 8) * scale + lines * imgui.get_text_line_height()
            wiring, reasons = graph.wiring(sketch), inspection.reasons
            _nodes(_Drawing(wiring, session, graph.thumbnails, reasons, look, corner, high))
        imgui.end()


def _switches(inspection: Inspection) -> None:
    graph = inspection.graph
    _, graph.inner = imgui.checkbox("Inside techniques", graph.inner)
    imgui.same_line()
    _, graph.timed = imgui.checkbox("Time each pass", graph.timed)
    if graph.timed:
        inspection.costs_shown = True
    imgui.same_line()
    imgui.text_disabled("a click shows a texture from above")


def _nodes(drawing: _Drawing) -> None:
    wiring, scale, origin = drawing.wiring, drawing.look.scale, drawing.origin
    step = (_WIDE + _GAP_X) * scale, drawing.high + _GAP_Y * scale
    for node, (column, row) in wiring.places.items():
        drawing.boxes[node] = origin.x + column * step[0], origin.y + row * step[1]
    draw = imgui.get_window_draw_list()
    for giver, reader in wiring.edges:
        (x0, y0), (x1, y1) = drawing.boxes[giver], drawing.boxes[reader]
        start = ImVec2(x0 + _WIDE * scale, y0 + drawing.high / 2)
        end, bend = ImVec2(x1, y1 + drawing.high / 2), _GAP_X * scale
        first, second = ImVec2(start.x + bend, start.y), ImVec2(end.x - bend, end.y)
        draw.add_bezier_cubic(start, first, second, end, theme.packed(theme.palette.line), 2 * scale)
        draw.add_circle_filled(end, 3 * scale, theme.packed(theme.palette.dim))
    for node, ref in wiring.refs.items():
        _node(node, ref, drawing)


def _node(node: str, ref: str, drawing: _Drawing) -> None:
    session, thumbnails, scale = drawing.session, drawing.thumbnails, drawing.look.scale
    x, y = drawing.boxes[node]
    corner, far = ImVec2(x, y), ImVec2(x + _WIDE * scale, y + drawing.high)
    imgui.set_cursor_screen_pos(corner)
    is_view = node.partition(".")[0] == "view"
    if imgui.invisible_button(f"node {node}", ImVec2(far.x - x, far.y - y)):
        session.show(None if is_view else ref)
    hovered = imgui.is_item_hovered()
    if hovered:
        imgui.set_tooltip("\n".join(filter(None, [_tooltip(node, session), drawing.reasons.text(node)])))
    shown = session.view.map.ref == ref if session.view.map is not None else node == "view"
    draw = imgui.get_window_draw_list()
    draw.add_rect_filled(
        corner, far, theme.packed(theme.palette.raised if hovered else theme.palette.field), 6 * scale
    )
    if shown:
        draw.add_rect(corner, far, theme.packed(theme.palette.accent), 6 * scale, 2 * scale)
    left, top = x + (_WIDE - _THUMB) / 2 * scale, y + 6 * scale
    low, high = ImVec2(left, top), ImVec2(left + _THUMB * scale, top + _THUMB * scale)
    texture = thumbnails.get(ref)
    if texture is None:
        draw.add_rect(low, high, theme.packed(theme.palette.line))
    else:
        dim = 1.0 if thumbnails.is_current(ref) else 0.45  # of another picture than the last
        tint = theme.packed((1.0, 1.0, 1.0), dim)
        draw.add_image(imgui.ImTextureRef(texture.glo), low, high, ImVec2(0, 1), ImVec2(1, 0), tint)
    runs, ran, spent = cost_of(session, node)
    lines = [(node, theme.palette.ink), (runs, theme.palette.accent if ran else theme.palette.dim)]
    if session.engine.options.profiling:
        lines.append((f"{spent:.2f} ms" if spent is not None else "", theme.palette.dim))
    line = imgui.get_text_line_height()
    for number, (text, ink) in enumerate(lines):
        text = fitting(text, (_WIDE - 8) * scale)
        across = x + (_WIDE * scale - imgui.calc_text_size(text).x) / 2
        draw.add_text(ImVec2(across, high.y + number * line), theme.packed(ink), text)


def _tooltip(node: str, session: Session) -> str:
    """Return what a node's tooltip says: its technique, its texture's size and format."""
    plan = session.plan
    lines = [node]
    spec = plan.flat.specs.get(node) if plan is not None else None
    if spec is not None:
        lines.append(spec.use)
    if plan is not None and spec is not None:
        for output, ref in plan.flat.outputs[node].items():
            step = plan.step(ref.path)
            if step is not None:
                form = next((o.format for o in step.kernel.outputs if o.name == ref.output), "")
                lines.append(f"{output}  {step.size[0]} x {step.size[1]} {form}")
    return "\n".join(lines)

"""Where the graph of passes is in its pane, how its wires run there, and text of any size."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import pairwise

from imgui_bundle import ImVec2, imgui

from playground.sketch.edit_passes import Wire
from playground.studio import theme
from playground.studio.draw import fitting
from playground.studio.graph.graph import Pin, Wiring

WIDE, HIGH = 172.0, 64.0
"""Of a node [units at zoom 1]."""
STEP = WIDE + 54.0
"""From one column to the next."""
MOST = 1.25
"""The zoom at which a graph that fits is drawn at most."""
ZOOMS = (0.08, 3.0)


@dataclass
class Canvas:
    """Where the graph is in its pane: from units of the layout to the window's."""

    corner: ImVec2
    room: ImVec2
    zoom: float
    pan: tuple[float, float]
    scale: float

    @property
    def k(self) -> float:
        """Window units of a unit of the graph."""
        return self.zoom * self.scale

    def place(self, x: float, y: float) -> ImVec2:
        """Return where a point of the graph is in the window."""
        return ImVec2(self.corner.x + self.pan[0] + x * self.k, self.corner.y + self.pan[1] + y * self.k)

    def units(self, point: ImVec2) -> tuple[float, float]:
        """Return where a point of the window is in the graph."""
        x, y = point.x - self.corner.x - self.pan[0], point.y - self.corner.y - self.pan[1]
        return x / self.k, y / self.k

    def holds(self, point: ImVec2) -> bool:
        """Return whether a point of the window is in the pane."""
        x, y = point.x - self.corner.x, point.y - self.corner.y
        return 0 <= x < self.room.x and 0 <= y < self.room.y


@dataclass
class Pins:
    """Where the pins of the nodes are, by pass and name."""

    inputs: dict[Pin, ImVec2] = field(default_factory=dict)
    outputs: dict[Pin, ImVec2] = field(default_factory=dict)

    def main_output(self, node: str) -> ImVec2:
        """Return where the first output of a pass is."""
        return next(point for (name, _), point in self.outputs.items() if name == node)


def corner_of(wiring: Wiring, node: str) -> tuple[float, float]:
    """Return the upper left corner of a node [units of the graph]."""
    column, y = wiring.layout.places[node]
    return column * STEP, (y - 0.5) * HIGH


def pins_of(wiring: Wiring, canvas: Canvas) -> Pins:
    """Return where all pins are: along a node's sides, one below the other."""
    pins = Pins()
    for node in wiring.refs:
        x, y = corner_of(wiring, node)
        for names, across, places in (
            (wiring.inputs.get(node, ()), 0.0, pins.inputs),
            (wiring.outputs.get(node, ()), WIDE, pins.outputs),
        ):
            for number, name in enumerate(names):
                down = HIGH * (number + 1) / (len(names) + 1)
                places[node, name] = canvas.place(x + across, y + down)
    return pins


Span = tuple[ImVec2, ImVec2]
"""A piece of a wire, from the left to the right."""


def wire_spans(wire: Wire, wiring: Wiring, canvas: Canvas, pins: Pins) -> tuple[list[Span], list[Span]]:
    """Return the bends of a wire between columns, and the straight pieces where it crosses one."""
    first = pins.outputs.get((wire.giver, wire.output)) or pins.main_output(wire.giver)
    last, straight = pins.inputs[wire.reader, wire.input], list[Span]()
    if wiring.layout.places[wire.giver][0] < wiring.layout.places[wire.reader][0]:
        for column, y in wiring.layout.route((wire.giver, wire.reader)):
            left, right = column * STEP, column * STEP + WIDE
            straight.append((canvas.place(left, y * HIGH), canvas.place(right, y * HIGH)))
    ends = [(first, first), *straight, (last, last)]
    return [(a, b) for (_, a), (b, _) in pairwise(ends)], straight


def draw_wire(spans: tuple[list[Span], list[Span]], canvas: Canvas, ink: int, thick: float) -> None:
    """Draw a wire."""
    draw = imgui.get_window_draw_list()
    for a, b in spans[0]:
        bend = _bend(a, b, canvas)
        draw.add_bezier_cubic(a, ImVec2(a.x + bend, a.y), ImVec2(b.x - bend, b.y), b, ink, thick)
    for a, b in spans[1]:
        draw.add_line(a, b, ink, thick)


def middle_of(spans: tuple[list[Span], list[Span]]) -> ImVec2:
    """Return the middle of a wire, where it is between two columns."""
    a, b = spans[0][len(spans[0]) // 2]
    return ImVec2((a.x + b.x) / 2, (a.y + b.y) / 2)


def is_near(spans: tuple[list[Span], list[Span]], canvas: Canvas, mouse: ImVec2, reach: float) -> bool:
    """Return whether the mouse is on a wire, or so near to it."""
    for n, (a, b) in enumerate((*spans[0], *spans[1])):
        bend = _bend(a, b, canvas) if n < len(spans[0]) else 0.0
        low, high = sorted((a.y, b.y))
        inside = min(a.x, b.x - bend) - reach < mouse.x < max(b.x, a.x + bend) + reach
        if not inside or not low - reach < mouse.y < high + reach:
            continue
        points: list[ImVec2] = []
        for step in range(15):
            t = step / 14
            w = (1 - t) ** 3, 3 * (1 - t) ** 2 * t, 3 * (1 - t) * t * t, t**3
            x = w[0] * a.x + w[1] * (a.x + bend) + w[2] * (b.x - bend) + w[3] * b.x
            points.append(ImVec2(x, (w[0] + w[1]) * a.y + (w[2] + w[3]) * b.y))
        if any(_distance_to(p, q, mouse) < reach for p, q in pairwise(points)):
            return True
    return False


def _bend(a: ImVec2, b: ImVec2, canvas: Canvas) -> float:
    return max(0.5 * abs(b.x - a.x), 14 * canvas.k)


def distance(a: ImVec2, b: ImVec2) -> float:
    """Return how far two points are apart."""
    return math.dist((a.x, a.y), (b.x, b.y))


def _distance_to(a: ImVec2, b: ImVec2, mouse: ImVec2) -> float:
    dx, dy = b.x - a.x, b.y - a.y
    t = ((mouse.x - a.x) * dx + (mouse.y - a.y) * dy) / ((dx * dx + dy * dy) or 1.0)
    t = min(max(t, 0.0), 1.0)
    return math.dist((a.x + t * dx, a.y + t * dy), (mouse.x, mouse.y))


def nearest_pin(pins: Mapping[Pin, ImVec2], mouse: ImVec2, reach: float) -> Pin | None:
    """Return the pin nearest to the mouse, within a reach."""
    found = min(pins, key=lambda pin: distance(pins[pin], mouse), default=None)
    return found if found is not None and distance(pins[found], mouse) < reach else None


def node_at(wiring: Wiring, canvas: Canvas, mouse: ImVec2) -> str:
    """Return the node under the mouse; "" for none."""
    for node in reversed(wiring.stacked):
        x, y = corner_of(wiring, node)
        low, far = canvas.place(x, y), canvas.place(x + WIDE, y + HIGH)
        if low.x <= mouse.x < far.x and low.y <= mouse.y < far.y:
            return node
    return ""


def write(text: str, font: imgui.ImFont, size: float, place: ImVec2, room: float, ink: theme.Rgb) -> None:
    """Write a text at any size, cut by an ellipsis where there is no room for it."""
    with _font(font, size):
        shown = fitting(text, room)
    imgui.get_window_draw_list().add_text(font, size, place, theme.packed(ink), shown)


def text_width(text: str, font: imgui.ImFont, size: float) -> float:
    """Return how wide a text is in a font of a size, both in the window's units."""
    with _font(font, size):
        return float(imgui.calc_text_size(text).x)


@contextmanager
def _font(font: imgui.ImFont, size: float) -> Iterator[None]:
    """Measure text with a font of a size in the window's units, whatever the interface's own scale is."""
    imgui.push_font(font, size / imgui.get_style().font_scale_dpi)
    yield
    imgui.pop_font()

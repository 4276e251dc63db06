"""Draw the inspection tools over the picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imgui_bundle import imgui

from playground.studio.bench import Workbench
from playground.studio.compare.panel import draw_ab
from playground.studio.draw import Area
from playground.studio.graph.panel import draw_graph
from playground.studio.inspect.inspector import Inspector
from playground.studio.inspect.panel import draw_values
from playground.studio.keyframes.panel import draw_timeline
from playground.studio.theme import Theme

if TYPE_CHECKING:
    import moderngl


def draw_inspection(
    bench: Workbench, picture: moderngl.Texture | None, look: Theme, area: Area, density: float
) -> None:
    """Draw all of it that is on; ``picture`` is what the session's last ``frame`` returned."""
    session, inspection = bench.session, bench.inspection
    if picture is not None:
        inspection.compare.follow(picture)
    inspection.graph.update(bench.notices.now())  # before it is drawn: what is released is not shown
    draw_graph(session, inspection, look, area)
    draw_ab(inspection.compare, bench.undo, look, area)
    draw_timeline(bench.undo, bench.interface, look, area)
    if picture is not None:
        _inspect(inspection.inspector, picture, look, area, density)
    inspection.update()


def _inspect(
    inspector: Inspector, picture: moderngl.Texture, look: Theme, area: Area, density: float
) -> None:
    if not inspector.on or imgui.get_io().want_capture_mouse:
        return
    inspector.inner = imgui.get_io().key_shift
    mouse = imgui.get_mouse_pos()
    across = int((mouse.x - area[0]) * density // 1)
    down = int((mouse.y - area[1]) * density // 1)
    report = inspector.at((across, picture.size[1] - 1 - down), picture)
    if report is not None:
        draw_values(report, look, area)

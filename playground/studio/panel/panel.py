"""The panel: what can be changed, made from the sketch's own annotations.

From the top: title, undo, resets, time and presets; which texture is shown; a search; a
section a pass, with its technique and parameters; what each pass cost. What a
technique exports comes first, what is inside is folded.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from imgui_bundle import ImVec2, imgui

from playground.studio import theme
from playground.studio.bench import Workbench
from playground.studio.cost.panel import draw_costs
from playground.studio.draw import SIDE_PANEL, wrapped
from playground.studio.input.keys import KEYS
from playground.studio.input.text_field import await_field
from playground.studio.inspect.inspection import Inspection
from playground.studio.inspect.panel import draw_spread
from playground.studio.keyframes.panel import KeyframeList
from playground.studio.paint.panel import draw_paintbox
from playground.studio.panel.head import draw_head, draw_search
from playground.studio.panel.memory import Memory
from playground.studio.panel.pass_sections import Sections
from playground.studio.panel.rows import row
from playground.studio.panel.widgets import WidgetSlot, draw_value, explanation
from playground.studio.session import Session
from playground.studio.theme import Theme


@dataclass
class Panel:
    """The panel's own memory: its width, what is searched for and typed in it."""

    width: float = theme.PANEL_WIDTH  # in units of scale 1
    memory: Memory = field(default_factory=Memory)

    def __post_init__(self) -> None:
        self._sections = Sections(self.memory)
        self._keyframes = KeyframeList()

    def draw(self, bench: Workbench, look: Theme, left: float = 0.0) -> float:
        """Draw the panel over the window's left side; return the width it takes, in the window's units.

        ``left``: what is taken there already.
        """
        room = imgui.get_main_viewport().size
        widest = max(room.x - left - 160 * look.scale, 160.0)
        target = min(self.width * look.scale, widest)
        imgui.set_next_window_pos(ImVec2(left, 0))
        imgui.set_next_window_size(ImVec2(target, room.y))
        imgui.set_next_window_size_constraints(
            ImVec2(min(240 * look.scale, widest), room.y), ImVec2(min(620 * look.scale, widest), room.y)
        )
        imgui.begin("panel", None, SIDE_PANEL)
        if bench.interface.searching:
            bench.interface.searching, self.memory.focus_search = False, True
            await_field(bench.interface.ahead)
        draw_head(self.memory, bench, look)
        sketch = bench.session.sketch
        if sketch is not None:
            draw_paintbox(bench.painting)
            draw_search(self.memory, bench.interface.ahead)
        footer = _footer_lines(bench.session.orbits)
        bar = imgui.WindowFlags_.always_vertical_scrollbar if sketch is not None else 0
        imgui.begin_child("sections", ImVec2(0, -_footer_height(footer, look)), 0, bar)
        if sketch is not None:
            if not self.memory.filter:
                _map(bench.session, bench.inspection, look)
            self._sections.draw(sketch, bench, look)
            if not self.memory.filter:
                self._keyframes.draw(bench.keyframes, look)
                draw_costs(sketch, bench.session, bench.inspection, look)
        imgui.end_child()
        _footer(footer, look)
        width = imgui.get_window_size().x
        imgui.end()
        if abs(width - target) > 0.5:  # pulled; a narrow window alone makes it no narrower for good
            self.width = width / look.scale
        return width


def _map(session: Session, inspection: Inspection, look: Theme) -> None:
    """Draw how the map is shown, while there is one."""
    shown = session.view.map
    if shown is None:
        return
    for parameter in shown.kernel.parameters:
        path, value = f"map.{parameter.name}", shown.value(parameter.name)
        with row(parameter.title, explanation(parameter, path)):
            changed = draw_value(parameter, value, WidgetSlot(f"##{path}", look.scale, Path()))
        if changed is not None:
            session.view.set_map(parameter.name, changed)
    if imgui.button("Fit to the values"):
        session.fit_map()
    draw_spread(session, inspection, look)


def _footer_lines(orbits: bool) -> tuple[str, str]:
    """Return the lines at the bottom: what the mouse does, and the keys used most."""
    mouse = "Drag to orbit, Shift to pan, Ctrl for the sun, wheel to zoom" if orbits else ""
    return mouse, "   ".join(f"{key.name} {key.brief}" for key in KEYS if key.brief)


def _footer_height(lines: tuple[str, str], look: Theme) -> float:
    """Return the room that the lines take: in a narrow panel they are broken."""
    wide, gap = imgui.get_content_region_avail().x, imgui.get_style().item_spacing.y
    with look.font(look.text, theme.SMALL):
        return sum(imgui.calc_text_size(line, False, wide).y + gap for line in lines) + 2 * gap


def _footer(lines: tuple[str, str], look: Theme) -> None:
    imgui.separator()
    with look.font(look.text, theme.SMALL):
        with wrapped():
            for line in lines:
                imgui.text_disabled(line)

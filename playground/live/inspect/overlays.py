"""Draw what is shown beside the picture, over it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imgui_bundle import imgui

from playground.live.inspect.ab import draw_ab
from playground.live.inspect.graph import draw_graph
from playground.live.inspect.timeline import draw_timeline
from playground.live.inspect.tooltip import draw_glass
from playground.live.overlay import Area
from playground.live.theme import Theme
from playground.workbench.actions import Actions

if TYPE_CHECKING:
    import moderngl


def draw_see(
    actions: Actions, picture: moderngl.Texture | None, look: Theme, area: Area, density: float
) -> None:
    """Draw all of it that is on; ``picture`` is what the session's last ``frame`` returned."""
    if picture is not None:
        actions.see.compare.follow(picture)
    actions.see.graph.look(actions.now())  # before anything of it is drawn: what is given back is not shown
    draw_graph(actions, look, area)
    draw_ab(actions, look, area)
    draw_timeline(actions, look, area)
    if picture is not None:
        _inspect(actions, picture, look, area, density)
    actions.see.look()


def _inspect(actions: Actions, picture: moderngl.Texture, look: Theme, area: Area, density: float) -> None:
    inspector = actions.see.inspector
    if not inspector.on or imgui.get_io().want_capture_mouse:
        return
    inspector.inner = imgui.get_io().key_shift
    mouse = imgui.get_mouse_pos()
    across = int((mouse.x - area[0]) * density // 1)
    down = int((mouse.y - area[1]) * density // 1)
    found = inspector.at((across, picture.size[1] - 1 - down), picture)
    if found is not None:
        draw_glass(found, look, area)

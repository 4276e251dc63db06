"""The table of what the picture cost: what ran, how often, how long, and by which clock."""

from __future__ import annotations

from imgui_bundle import imgui

from playground.live import theme
from playground.live.actions import Actions
from playground.live.theme import Theme
from playground.sketch.model import Sketch


def draw_costs(sketch: Sketch, actions: Actions, look: Theme) -> None:
    """Draw the table of what ran, how often and how long."""
    session, engine = actions.session, actions.session.engine
    imgui.spacing()
    with look.font(look.bold):
        opened = imgui.collapsing_header("Cost###costs")
    if not opened:
        return
    changed, on = imgui.checkbox("Time each pass", engine.profiling)
    imgui.set_item_tooltip(
        "By the wall clock each pass waits for the one before, so pictures take a little longer"
    )
    if changed:
        engine.profiling = on
        session.times.clear()
    if engine.profiling:
        imgui.same_line()
        imgui.text_disabled(f"by {engine.clock}")
    paths = [path for path in engine.runs if path.partition(".")[0] in {p.name for p in sketch.graph.passes}]
    flags = imgui.TableFlags_.row_bg | imgui.TableFlags_.sizing_stretch_prop
    if imgui.begin_table("costs", 3, flags):
        for path in paths:
            imgui.table_next_row()
            imgui.table_next_column()
            ran = path in engine.ran
            imgui.text_colored(theme.colour(theme.ACCENT if ran else theme.INK), path)
            imgui.table_next_column()
            imgui.text_disabled(f"{engine.runs[path]} ×")
            imgui.table_next_column()
            spent = session.times.get(path)
            imgui.text("" if spent is None or not engine.profiling else f"{spent:.2f} ms")
        imgui.end_table()
    compiled = session.last_reload
    if compiled is not None:
        imgui.text_disabled(f"files to picture {compiled.seconds * 1e3:.0f} ms")
        if compiled.trial:
            imgui.same_line(0, 0)
            imgui.text_disabled(f", {compiled.trial * 1e3:.0f} of them the trial")

"""What the pictures cost: milliseconds of each pass over time, texels, triangles, compiling.

Folded at first. While it is folded or off the screen nothing is timed and nothing recorded.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
from imgui_bundle import ImVec2, imgui, implot

from playground.sketch.model import Sketch
from playground.sketch.variants import any_variants
from playground.studio import theme
from playground.studio.cost.costs import Record
from playground.studio.cost.readout import Readout
from playground.studio.draw import OVERLAY, Area, explain, fitting, header, styled, table, window, wrapped
from playground.studio.inspect.inspection import Inspection
from playground.studio.interface import Interface
from playground.studio.language import numeral, tr
from playground.studio.session import Session
from playground.studio.theme import Theme
from playground.studio.widgets import plot, plot_line, series

_READOUT = OVERLAY | imgui.WindowFlags_.no_bring_to_front_on_focus
_MAX_ROWS = 6  # passes with a line of their own
_HIGH = 110.0  # of a plot
_TABLE = imgui.TableFlags_.row_bg | imgui.TableFlags_.sizing_stretch_prop


def draw_readout(
    readout: Readout, interface: Interface, inspection: Inspection, look: Theme, area: Area
) -> None:
    """Draw the corner of the picture; a click on it opens the costs, its menu hides it."""
    if not interface.preferences.shows_readout:
        return
    text = readout.text()
    if not text:
        return
    with look.font(look.text, theme.SMALL):
        size, pad = imgui.calc_text_size(text), 5 * look.scale
        wide, high = size.x + 2 * pad, size.y + 2 * pad
        if wide > area[2] or high > area[3]:
            return
        margin = 8 * look.scale
        imgui.set_next_window_pos(
            ImVec2(area[0] + max(area[2] - wide - margin, 0.0), area[1] + max(area[3] - high - margin, 0.0))
        )
        sizes: dict[imgui.StyleVar_, float | ImVec2] = {
            imgui.StyleVar_.window_padding: ImVec2(0, 0),
            imgui.StyleVar_.window_border_size: 0.0,
        }
        padding = ImVec2(imgui.get_style().window_padding.x, imgui.get_style().window_padding.y)
        ground = theme.colour(theme.palette.ground, 0.92)
        with window("readout", _READOUT, ground=ground, rounding=5 * look.scale, sizes=sizes):
            corner = imgui.get_cursor_screen_pos()
            if imgui.invisible_button("readout", ImVec2(wide, high), imgui.ButtonFlags_.enable_nav):
                interface.panel_shown, inspection.costs_asked = True, True
            ink = theme.palette.ink if imgui.is_item_hovered() else theme.palette.dim
            place = ImVec2(corner.x + pad, corner.y + pad)
            imgui.get_window_draw_list().add_text(place, theme.packed(ink), text)
            with styled(sizes={imgui.StyleVar_.window_padding: padding}):
                if imgui.is_item_hovered(imgui.HoveredFlags_.for_tooltip):
                    what = tr("Pictures of the last second, pixels, time of the last picture")
                    explain(what, tr("A click shows what costs it; F4 hides this"))
                if imgui.begin_popup_context_item("readout menu"):
                    if imgui.menu_item_simple(f"{tr('Hide')}###hide readout", "F4"):
                        interface.preferences.choose(shows_readout=False)
                    imgui.end_popup()


def draw_costs(sketch: Sketch, session: Session, inspection: Inspection, look: Theme) -> None:
    """Draw the plots, then the table of what ran, how often and how long."""
    engine, record = session.engine, inspection.record
    imgui.spacing()
    if inspection.costs_asked:
        imgui.set_next_item_open(True)
    opened = header(f"{tr('Cost')}###costs", look)
    if inspection.costs_asked:
        inspection.costs_asked = False
        imgui.set_scroll_here_y(0.0)
    if not opened:
        return
    inspection.costs_shown = True
    imgui.text_disabled(tr("by {clock}", clock=tr(engine.clock)))
    imgui.set_item_tooltip(
        tr("By the wall clock each pass waits for the one before, so pictures take a little longer")
    )
    if session.is_preview:
        across, down = session.picture.drawn_size
        imgui.text_disabled(tr("a preview of {across} x {down} pixels", across=across, down=down))
        imgui.set_item_tooltip(tr("While something changes; at rest it is drawn in full"))
    if record.pictures:
        _plots(record, look)
    if any_variants(sketch.graph):
        changed, plain = imgui.checkbox(tr("Plain form"), session.drafts.plain)
        imgui.set_item_tooltip(
            tr("Every technique by its plain text, no fast variant: slower, nearly the same")
        )
        if changed:
            session.drafts.run_plain(plain)
    own = {spec.name for spec in sketch.graph.passes}

    def name(path: str) -> None:
        ran = path in engine.record.ran
        rgb, sign = (theme.palette.accent, "• ") if ran else (theme.palette.ink, "")
        imgui.text_colored(theme.colour(rgb), f"{sign}{path}")
        if why := inspection.reasons.text(path):
            imgui.set_item_tooltip(why)

    rows = [
        (
            partial(name, path),
            partial(imgui.text_disabled, f"{runs} ×"),
            partial(imgui.text, f"{numeral(session.times[path], '.2f')} ms" if path in session.times else ""),
        )
        for path, runs in engine.runs.items()
        if path.partition(".")[0] in own
    ]
    table("costs", 3, rows, _TABLE)
    compiled = session.last_reload
    if compiled is not None:
        sandbox = (
            tr(", {value} of them the sandbox", value=f"{compiled.sandbox * 1e3:.0f}")
            if compiled.sandbox
            else ""
        )
        with wrapped():
            imgui.text_disabled(
                tr(
                    "files to picture {value} ms{sandbox}",
                    value=f"{compiled.seconds * 1e3:.0f}",
                    sandbox=sandbox,
                )
            )
    _compiling(engine.runner.compile_times)


def _plots(record: Record, look: Theme) -> None:
    """Draw each expensive pass over the last pictures, and what was computed and drawn for them."""
    size = ImVec2(-1, _HIGH * look.scale)
    axes = implot.AxisFlags_.no_decorations, implot.AxisFlags_.auto_fit
    held = len(record.whole)
    across: np.ndarray = np.arange(record.pictures - held, record.pictures, dtype=np.float64)
    expensive = record.most_expensive(_MAX_ROWS)
    with plot("##ms", size, implot.Flags_.no_legend.value) as drawn:
        if drawn:
            implot.setup_axes("", "", axes[0] | implot.AxisFlags_.auto_fit, axes[1])
            implot.setup_axis_format(implot.ImAxis_.y1, "%g ms")
            for number, path in enumerate(expensive):
                implot.plot_line(path, across, np.array(record.passes[path]), plot_line(number))
    draw, side = imgui.get_window_draw_list(), imgui.get_font_size() * 0.6
    for number, path in enumerate(expensive):
        spent = record.passes[path]
        corner = imgui.get_cursor_screen_pos()
        top = corner.y + (imgui.get_font_size() - side) / 2
        colour = theme.packed(series(number))
        draw.add_rect_filled(ImVec2(corner.x, top), ImVec2(corner.x + side, top + side), colour, 2)
        imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + 2 * side)
        text = tr(
            "{path}  {value} ms, most {max}",
            path=path,
            value=numeral(sum(spent) / len(spent), ".2f"),
            max=numeral(max(spent), ".2f"),
        )
        imgui.text_unformatted(fitting(text, imgui.get_content_region_avail().x))
    with wrapped():
        imgui.text_disabled(
            tr(
                "in all {value} ms; median of {held}: {median} ms",
                value=numeral(record.whole[-1], ".1f"),
                held=held,
                median=numeral(np.median(record.whole), ".1f"),
            )
        )
    for name, numbers in (
        (tr("texels computed"), record.texels),
        (tr("triangles drawn"), record.triangles),
    ):
        imgui.plot_lines(
            f"##{name}",
            np.array(numbers, np.float32),
            overlay_text=f"{numeral(numbers[-1], ',.0f')} {name}",
            scale_min=0.0,
            graph_size=ImVec2(-1, 2.2 * imgui.get_font_size()),
        )


def _compiling(times: Mapping[str, float]) -> None:
    """Draw how long the programs took that the driver compiled, most expensive first."""
    if not times or not imgui.tree_node_ex(
        f"{tr('Compiling: {ms} ms', ms=f'{sum(times.values()):.0f}')}###compiling"
    ):
        return

    def name(path: str) -> None:
        imgui.text_unformatted(Path(path).name)
        imgui.set_item_tooltip(path)

    ranked = sorted(times.items(), key=lambda item: -item[1])
    rows = [(partial(name, path), partial(imgui.text, f"{numeral(ms, '.1f')} ms")) for path, ms in ranked]
    table("compiled", 2, rows, _TABLE)
    imgui.tree_pop()

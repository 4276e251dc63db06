"""A map in the panel: its legend with units, how its numbers are spread; the box of values at the mouse."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
from imgui_bundle import ImVec2, ImVec4, imgui, implot

from playground.sketch.map_sketch import Map
from playground.studio import theme
from playground.studio.draw import OVERLAY, Area, button, fitting, table, window
from playground.studio.inspect.histogram import BINS, STEPS, Histogram, ends_of, ticks
from playground.studio.inspect.inspection import Inspection
from playground.studio.inspect.inspector import GroundPoint, PixelReport, Sample
from playground.studio.language import numeral, tr
from playground.studio.picture.view import View, ref_name
from playground.studio.session import Session
from playground.studio.theme import Theme
from playground.studio.widgets import plot, plot_line

_HIGH = 120.0
_CHANNELS = ("red", "green", "blue", "alpha")
_SHARE = 0.02


def draw_spread(session: Session, inspection: Inspection, look: Theme) -> None:
    """Draw it where a map is shown."""
    shown = session.view.map
    if shown is None:
        return
    if shown.value("channel") != 0:
        _legend(shown, session, inspection, look)
    if not imgui.tree_node_ex(f"{tr('Histogram')}###histogram"):
        return
    inspection.spread_shown = True
    result = inspection.counter.latest
    if result is None:
        imgui.text_disabled(tr("counting …"))
    else:
        _plot(result, shown, inspection, look)
        _table(result)
        if not result.whole:
            imgui.text_disabled(
                fitting(
                    tr("of {read} texels, whole rows of it", read=numeral(result.read, ",")), 300 * look.scale
                )
            )
        if not inspection.counter.fresh:
            imgui.text_disabled(tr("of a moment ago; counting again …"))
        _ranges(result, session.view)
    imgui.tree_pop()


def metres_of(session: Session) -> float | None:
    """Return how many metres the map's number 1 is, where it shows heights; None elsewhere."""
    shown, plan = session.view.map, session.plan
    return plan.terrain.relief if shown and plan and shown.ref.partition(":")[2] == "height" else None


def _legend(shown: Map, session: Session, inspection: Inspection, look: Theme) -> None:
    """Draw the ramp's colours with round numbers under them, metres where heights are shown."""
    ramp = shown.value("ramp")
    colours = inspection.colours(int(ramp) if isinstance(ramp, int) else 0)
    low, high = ends_of(shown)
    metres = metres_of(session)
    unit, factor = (" m", metres) if metres is not None else ("", 1.0)
    corner, wide = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail().x
    bar, line = 12 * look.scale, imgui.get_text_line_height()
    imgui.invisible_button("##legend", ImVec2(wide, bar + line + 4 * look.scale))
    draw = imgui.get_window_draw_list()
    for step, colour in enumerate(colours):
        # Each goes to the end, under the next, so that no seam is visible.
        start, end = ImVec2(corner.x + wide * step / STEPS, corner.y), ImVec2(corner.x + wide, corner.y + bar)
        draw.add_rect_filled(start, end, theme.packed(colour))
    if high == low:
        return
    marks = ticks(low * factor, high * factor)
    for which, mark in enumerate(marks):
        x = corner.x + wide * (mark / factor - low) / (high - low) if factor else corner.x
        draw.add_line(
            ImVec2(x, corner.y + bar),
            ImVec2(x, corner.y + bar + 3 * look.scale),
            theme.packed(theme.palette.ink),
        )
        text = f"{mark:g}{unit if which == len(marks) - 1 else ''}"
        size = imgui.calc_text_size(text).x
        left = min(max(x - size / 2, corner.x), corner.x + wide - size)
        draw.add_text(ImVec2(left, corner.y + bar + 3 * look.scale), theme.packed(theme.palette.dim), text)
    if imgui.is_item_hovered():
        fraction = (imgui.get_io().mouse_pos.x - corner.x) / wide
        number = low + fraction * (high - low)
        imgui.set_tooltip(
            f"{number:.6g}" + (f" = {numeral(number * factor, '.2f')} m" if metres is not None else "")
        )


def _plot(histogram: Histogram, shown: Map, inspection: Inspection, look: Theme) -> None:
    _, logarithmic = imgui.checkbox(tr("Logarithmic"), inspection.logarithmic)
    inspection.logarithmic = logarithmic
    span = histogram.high - histogram.low
    edges = histogram.low + (np.arange(BINS) + 0.5) * ((span or 1.0) / BINS)
    tallest = max(int(channel.bins.max()) for channel in histogram.channels)
    flags = implot.Flags_.no_legend.value | implot.Flags_.no_inputs.value
    floor = 0.5 if logarithmic else 0.0
    top = 1.3 * tallest if logarithmic else 1.05 * tallest
    with plot("##spread", ImVec2(-1, _HIGH * look.scale), flags) as drawn:
        if not drawn:
            return
        locked = implot.AxisFlags_.lock.value
        implot.setup_axes("", "", locked, locked | implot.AxisFlags_.no_tick_labels.value)
        implot.setup_axis_limits(
            implot.ImAxis_.x1, histogram.low, histogram.low + (span or 1.0), imgui.Cond_.always
        )
        if logarithmic:
            implot.setup_axis_scale(implot.ImAxis_.y1, implot.Scale_.log10)
        implot.setup_axis_limits(implot.ImAxis_.y1, floor, max(top, 1.0), imgui.Cond_.always)
        for number, channel in enumerate(histogram.channels):
            spec = implot.Spec()
            alone = len(histogram.channels) == 1
            ink = ImVec4(*(theme.palette.ink if alone else theme.palette.channels[number]), 1.0)
            spec.line_color, spec.fill_color, spec.fill_alpha = ink, ink, 0.25
            heights = np.maximum(channel.bins.astype(np.float64), floor)
            implot.plot_stairs(f"{tr(_CHANNELS[number])}##{number}", edges, heights, spec)
            implot.plot_shaded(f"{tr(_CHANNELS[number])}##{number}", edges, heights, floor, spec)
        implot.plot_inf_lines(tr("range"), np.array(ends_of(shown), np.float64), plot_line(0, 1.0))


def _table(document: Histogram) -> None:
    flags = imgui.TableFlags_.row_bg | imgui.TableFlags_.sizing_stretch_prop
    if not imgui.begin_table("spread", 5, flags):
        return
    for title in ("", tr("least"), tr("greatest"), tr("mean"), tr("deviation")):
        imgui.table_next_column()
        imgui.text_disabled(title)
    for number, channel in enumerate(document.channels):
        imgui.table_next_row()
        imgui.table_next_column()
        imgui.text_colored(theme.colour(theme.palette.channels[number]), tr(_CHANNELS[number]))
        for value in (channel.lowest, channel.highest, channel.mean, channel.deviation):
            imgui.table_next_column()
            imgui.text_unformatted(tr("none") if math.isnan(value) else numeral(value, ".4g"))
    imgui.end_table()
    for number, channel in enumerate(document.channels):
        if channel.nans or channel.infinities:
            text = tr(
                "{channel}: {nans} NaN, {infinities} infinite",
                channel=tr(_CHANNELS[number]),
                nans=numeral(channel.nans, ","),
                infinities=numeral(channel.infinities, ","),
            )
            imgui.text_colored(theme.colour(theme.palette.alarm), text)


def _ranges(histogram: Histogram, view: View) -> None:
    """Draw what sets the map's range from the numbers."""
    channel = view.map.value("channel") if view.map is not None else 0
    which = max(int(channel) - 1, 0) if isinstance(channel, int) else 0
    if which >= len(histogram.channels) or not histogram.channels[which].count:
        return
    mine = histogram.channels[which]
    bounds: tuple[float, float] | None = None
    if button(tr("All of it"), tr("The map's range from the least to the greatest number")):
        bounds = mine.lowest, mine.highest
    imgui.same_line()
    if button(tr("All but outliers"), tr("Without the least and the greatest 2 in 100")):
        bounds = histogram.between(which, _SHARE)
    imgui.same_line()
    if button(tr("Around the mean"), tr('The middle of "cool and warm" is the mean')):
        view.set_map("middle", mine.mean)
    if bounds is not None and bounds[0] < bounds[1]:
        for name, value in zip(("lowest", "highest"), bounds, strict=True):
            view.set_map(name, value)


_AWAY = 18.0  # of the box from the mouse
_POINTS = ("north", "north-east", "east", "south-east", "south", "south-west", "west", "north-west")


def draw_values(report: PixelReport, look: Theme, area: Area) -> None:
    """Draw it at the mouse, where there is room for it in the picture."""
    mouse, away = imgui.get_io().mouse_pos, _AWAY * look.scale
    x, y, wide, high = area
    right, low = mouse.x > x + wide / 2, mouse.y > y + high / 2
    corner = ImVec2(mouse.x + (-away if right else away), mouse.y + (-away if low else away))
    imgui.set_next_window_pos(corner, imgui.Cond_.always, ImVec2(float(right), float(low)))
    flags = OVERLAY | imgui.WindowFlags_.no_inputs | imgui.WindowFlags_.no_nav
    ground = theme.colour(theme.palette.popup, 0.94)

    def value(text: str, ink: theme.Rgb) -> None:
        with look.font(look.code):
            imgui.text_colored(theme.colour(ink), text)

    with window("values", flags, ground=ground, rounding=8 * look.scale):
        dim = theme.colour(theme.palette.dim)
        rows = [
            (partial(imgui.text_colored, dim, name), partial(value, text, ink))
            for name, text, ink in lines_of(report)
        ]
        table("readings", 2, rows, imgui.TableFlags_.sizing_fixed_fit)


def lines_of(report: PixelReport) -> list[tuple[str, str, theme.Rgb]]:
    """Return the box's lines: a name, what there is, and the colour it is written in."""
    shade = "".join(f"{byte:02x}" for byte in report.picture)
    lines = [(tr("pixel"), f"{report.pixel[0]}, {report.pixel[1]}  #{shade}", theme.palette.ink)]
    if report.ground is not None:
        lines += [(name, text, theme.palette.ink) for name, text in _place(report.ground)]
    if report.shown is not None:
        lines.append(_line(report.shown, theme.palette.accent))
    elif report.ground is None:
        lines.append((tr("terrain"), tr("none here"), theme.palette.dim))
    shown = report.shown.name if report.shown else ""
    lines += [_line(sample, theme.palette.ink) for sample in report.samples if sample.name != shown]
    if report.missing:
        listed = ", ".join(ref_name(name) for name in report.missing)
        lines.append((tr("not in this picture"), listed, theme.palette.dim))
    return lines


def _place(ground: GroundPoint) -> list[tuple[str, str]]:
    east, north, up = ground.normal
    names = [
        (
            tr("place"),
            tr(
                "{east} m east, {north} m north",
                east=numeral(ground.east, ".1f"),
                north=numeral(ground.north, ".1f"),
            ),
        ),
        (
            tr("ground"),
            tr(
                "{height} m, {above_sea} m above the sea",
                height=numeral(ground.height, ".2f"),
                above_sea=numeral(ground.above_sea, ".2f"),
            ),
        ),
        (tr("normal"), f"{east:+.3f} {north:+.3f} {up:+.3f}"),
    ]
    faces = ""
    if math.hypot(east, north) > 1e-6:
        azimuth = math.degrees(math.atan2(east, north)) % 360
        faces = tr(", faces {direction}", direction=tr(_POINTS[round(azimuth / 45) % 8]))
    return [*names, (tr("slope"), f"{numeral(ground.slope, '.1f')}°{faces}")]


def _line(sample: Sample, ink: theme.Rgb) -> tuple[str, str, theme.Rgb]:
    text = "  ".join(f"{value:.6g}" for value in sample.values)
    if sample.metres is not None and math.isfinite(sample.metres):
        text += f" = {numeral(sample.metres, '.2f')} m"
    text += tr("   at {value}, {value_2}", value=sample.texel[0], value_2=sample.texel[1])
    colour = ink if all(map(math.isfinite, sample.values)) else theme.palette.alarm
    return ref_name(sample.name), text, colour

"""The box at the mouse that shows what is under it."""

from __future__ import annotations

import math
from functools import partial

from imgui_bundle import ImVec2, imgui

from playground.studio import theme
from playground.studio.draw import OVERLAY, Area, table, window
from playground.studio.inspect.inspector import GroundPoint, PixelReport, Sample
from playground.studio.panel.head import ref_name
from playground.studio.theme import Theme

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
    ground = theme.colour((0.11, 0.118, 0.126), 0.94)

    def value(text: str, ink: theme.Rgb) -> None:
        with look.font(look.code):
            imgui.text_colored(theme.colour(ink), text)

    with window("values", flags, ground=ground, rounding=8 * look.scale):
        dim = theme.colour(theme.DIM)
        rows = [
            (partial(imgui.text_colored, dim, name), partial(value, text, ink))
            for name, text, ink in lines_of(report)
        ]
        table("readings", 2, rows, imgui.TableFlags_.sizing_fixed_fit)


def lines_of(report: PixelReport) -> list[tuple[str, str, theme.Rgb]]:
    """Return the box's lines: a name, what there is, and the colour it is written in."""
    shade = "".join(f"{byte:02x}" for byte in report.picture)
    lines = [("pixel", f"{report.pixel[0]}, {report.pixel[1]}  #{shade}", theme.INK)]
    if report.ground is not None:
        lines += [(name, text, theme.INK) for name, text in _place(report.ground)]
    if report.shown is not None:
        lines.append(_line(report.shown, theme.ACCENT))
    elif report.ground is None:
        lines.append(("terrain", "none here", theme.DIM))
    shown = report.shown.name if report.shown else ""
    lines += [_line(sample, theme.INK) for sample in report.samples if sample.name != shown]
    if report.missing:
        listed = ", ".join(ref_name(name) for name in report.missing)
        lines.append(("not in this picture", listed, theme.DIM))
    return lines


def _place(ground: GroundPoint) -> list[tuple[str, str]]:
    east, north, up = ground.normal
    names = [
        ("place", f"{ground.east:.1f} m east, {ground.north:.1f} m north"),
        ("ground", f"{ground.height:.2f} m, {ground.above_sea:.2f} m above the sea"),
        ("normal", f"{east:+.3f} {north:+.3f} {up:+.3f}"),
    ]
    faces = ""
    if math.hypot(east, north) > 1e-6:
        azimuth = math.degrees(math.atan2(east, north)) % 360
        faces = f", faces {_POINTS[round(azimuth / 45) % 8]}"
    return [*names, ("slope", f"{ground.slope:.1f}°{faces}")]


def _line(sample: Sample, ink: theme.Rgb) -> tuple[str, str, theme.Rgb]:
    text = "  ".join(f"{value:.6g}" for value in sample.values)
    if sample.metres is not None and math.isfinite(sample.metres):
        text += f" = {sample.metres:.2f} m"
    text += f"   at {sample.texel[0]}, {sample.texel[1]}"
    colour = ink if all(map(math.isfinite, sample.values)) else theme.ALARM
    return ref_name(sample.name), text, colour

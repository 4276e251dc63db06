"""The box beside the mouse that shows what lies under it."""

from __future__ import annotations

import math

from imgui_bundle import ImVec2, imgui

from playground.live import theme
from playground.live.overlay import Area
from playground.live.panel_head import ref_name
from playground.live.theme import Theme
from playground.workbench.inspect.inspector import Found, Reading, Spot

_AWAY = 18.0  # of the box from the mouse
_POINTS = ("north", "north-east", "east", "south-east", "south", "south-west", "west", "north-west")


def draw_glass(found: Found, look: Theme, area: Area) -> None:
    """Draw it at the mouse, where there is room for it in the picture."""
    mouse, away = imgui.get_io().mouse_pos, _AWAY * look.scale
    x, y, wide, high = area
    right, low = mouse.x > x + wide / 2, mouse.y > y + high / 2
    corner = ImVec2(mouse.x + (-away if right else away), mouse.y + (-away if low else away))
    imgui.set_next_window_pos(corner, imgui.Cond_.always, ImVec2(float(right), float(low)))
    flags = imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.no_inputs
    flags |= imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_saved_settings
    flags |= imgui.WindowFlags_.no_focus_on_appearing | imgui.WindowFlags_.no_nav
    imgui.push_style_var(imgui.StyleVar_.window_rounding, 8 * look.scale)
    imgui.push_style_color(imgui.Col_.window_bg, theme.colour((0.11, 0.118, 0.126), 0.94))
    imgui.begin("glass", None, flags)
    if imgui.begin_table("readings", 2, imgui.TableFlags_.sizing_fixed_fit):
        for name, text, colour in lines_of(found):
            imgui.table_next_row()
            imgui.table_next_column()
            imgui.text_colored(theme.colour(theme.DIM), name)
            imgui.table_next_column()
            with look.font(look.code):
                imgui.text_colored(theme.colour(colour), text)
        imgui.end_table()
    imgui.end()
    imgui.pop_style_color()
    imgui.pop_style_var()


def lines_of(found: Found) -> list[tuple[str, str, tuple[float, float, float]]]:
    """Return the box's lines: a name, what there is, and the colour it is written in."""
    shade = "".join(f"{byte:02x}" for byte in found.picture)
    lines = [("pixel", f"{found.pixel[0]}, {found.pixel[1]}  #{shade}", theme.INK)]
    if found.spot is not None:
        lines += [(name, text, theme.INK) for name, text in _place(found.spot)]
    if found.shown is not None:
        lines.append(_line(found.shown, theme.ACCENT))
    elif found.spot is None:
        lines.append(("land", "none here", theme.DIM))
    shown = found.shown.name if found.shown else ""
    lines += [_line(reading, theme.INK) for reading in found.readings if reading.name != shown]
    if found.missing:
        listed = ", ".join(ref_name(name) for name in found.missing)
        lines.append(("not in this picture", listed, theme.DIM))
    return lines


def _place(spot: Spot) -> list[tuple[str, str]]:
    east, north, up = spot.normal
    found = [
        ("place", f"{spot.east:.1f} m east, {spot.north:.1f} m north"),
        ("ground", f"{spot.height:.2f} m, {spot.above_sea:.2f} m above the sea"),
        ("normal", f"{east:+.3f} {north:+.3f} {up:+.3f}"),
    ]
    faces = ""
    if math.hypot(east, north) > 1e-6:
        turn = math.degrees(math.atan2(east, north)) % 360
        faces = f", faces {_POINTS[round(turn / 45) % 8]}"
    return [*found, ("slope", f"{spot.slope:.1f}°{faces}")]


def _line(reading: Reading, ink: tuple[float, float, float]) -> tuple[str, str, tuple[float, float, float]]:
    text = "  ".join(f"{value:.6g}" for value in reading.values)
    if reading.metres is not None and math.isfinite(reading.metres):
        text += f" = {reading.metres:.2f} m"
    text += f"   at {reading.texel[0]}, {reading.texel[1]}"
    colour = ink if all(map(math.isfinite, reading.values)) else theme.ALARM
    return ref_name(reading.name), text, colour

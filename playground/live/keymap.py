"""The key map: every key and every gesture, over the window."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from playground.live import theme
from playground.live.keys import KEYS
from playground.live.theme import Theme
from playground.workbench.actions import Actions

GESTURES = (
    ("drag", "turn the land"),
    ("Shift+drag, right drag", "move along the ground"),
    ("Ctrl+drag", "move the sun"),
    ("wheel", "nearer, farther"),
    ("double click, Ctrl+click", "type a value; pi/4 will do"),
    ("right click", "a parameter's menu"),
    ("drop a file", "open a sketch, or choose what reads an image"),
)
"""What a mouse does."""


_AROUND = 4
"""Lines that the heading and the margins take; where all do not fit, the text is small."""


def draw_keymap(actions: Actions, look: Theme) -> None:
    """Draw the key map in the middle of the window, while it is asked for."""
    if not actions.keymap_shown:
        return
    room = imgui.get_main_viewport().size
    imgui.set_next_window_pos(ImVec2(room.x / 2, room.y / 2), imgui.Cond_.always, ImVec2(0.5, 0.5))
    imgui.set_next_window_size_constraints(ImVec2(0, 0), ImVec2(room.x - 16, room.y - 16))
    imgui.push_style_var(imgui.StyleVar_.window_rounding, 8 * look.scale)
    imgui.push_style_var(
        imgui.StyleVar_.cell_padding, ImVec2(4 * look.scale, 0)
    )  # a small window has room for all
    imgui.push_style_color(imgui.Col_.window_bg, theme.colour((0.125, 0.135, 0.145), 0.98))
    flags = imgui.WindowFlags_.no_title_bar | imgui.WindowFlags_.no_move | imgui.WindowFlags_.no_resize
    flags |= imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_saved_settings
    imgui.begin("keys", None, flags | imgui.WindowFlags_.no_nav_inputs)
    with look.font(look.bold, theme.TEXT_SIZE + 2):
        imgui.text_unformatted("Keys")
    rows = *_joined(), *GESTURES
    fits = (len(rows) + _AROUND) * imgui.get_text_line_height() <= room.y
    with look.font(look.text, theme.TEXT_SIZE if fits else theme.SMALL):
        if imgui.begin_table("keys", 2, imgui.TableFlags_.sizing_fixed_fit):
            for name, meaning in rows:
                imgui.table_next_row()
                imgui.table_next_column()
                imgui.text_colored(theme.colour(theme.WARM), name)
                imgui.table_next_column()
                imgui.text_unformatted(meaning)
            imgui.end_table()
    outside = imgui.is_mouse_clicked(0) and not imgui.is_window_hovered(imgui.HoveredFlags_.child_windows)
    if outside and not imgui.is_window_appearing():
        actions.keymap_shown = False
    imgui.end()
    imgui.pop_style_color()
    imgui.pop_style_var(2)


def _joined() -> list[tuple[str, str]]:
    """Return the keys and their meanings, keys that mean the same on one line."""
    found: dict[str, list[str]] = {}
    for key in KEYS:
        found.setdefault(key.meaning, []).append(key.name)
    return [(", ".join(names), meaning) for meaning, names in found.items()]

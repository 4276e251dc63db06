"""The key map: every key and every gesture, over the window."""

from __future__ import annotations

from functools import partial

from imgui_bundle import ImVec2, imgui

from playground.studio import theme
from playground.studio.draw import POPUP_COLOUR, QUIET, table, window
from playground.studio.input.keys import KEYS
from playground.studio.interface import Interface
from playground.studio.theme import Theme

GESTURES = (
    ("drag", "orbit the terrain"),
    ("Shift+drag, right drag", "move along the ground"),
    ("Ctrl+drag", "move the sun"),
    ("wheel", "nearer, farther"),
    ("Ctrl, Shift, Ctrl+Shift+wheel", "the brush: wider, stronger, softer"),
    ("double click, Ctrl+click", "type a value; pi/4 will do"),
    ("right click", "a parameter's menu"),
    ("drop a file", "open a sketch, or choose what reads an image, a video or a sound"),
)
"""What a mouse does."""


_AROUND = 4
"""Lines that the heading and the margins take; where all do not fit, the text is small."""


def draw_keymap(interface: Interface, look: Theme) -> None:
    """Draw the key map in the middle of the window, while it is open."""
    if not interface.keymap_shown:
        return
    room = imgui.get_main_viewport().size
    imgui.set_next_window_pos(ImVec2(room.x / 2, room.y / 2), imgui.Cond_.always, ImVec2(0.5, 0.5))
    imgui.set_next_window_size_constraints(ImVec2(0, 0), ImVec2(room.x - 16, room.y - 16))
    flags = QUIET | imgui.WindowFlags_.no_title_bar | imgui.WindowFlags_.no_move
    flags |= imgui.WindowFlags_.no_resize | imgui.WindowFlags_.always_auto_resize
    cell = {imgui.StyleVar_.cell_padding: ImVec2(4 * look.scale, 0)}  # a small window has room for all
    with window("keys", flags, ground=POPUP_COLOUR, rounding=8 * look.scale, sizes=cell):
        with look.font(look.bold, theme.TEXT_SIZE + 2):
            imgui.text_unformatted("Keys")
        rows = *_joined(), *GESTURES
        fits = (len(rows) + _AROUND) * imgui.get_text_line_height() <= room.y
        with look.font(look.text, theme.TEXT_SIZE if fits else theme.SMALL):
            warm = theme.colour(theme.WARM)
            cells = [
                (partial(imgui.text_colored, warm, keys), partial(imgui.text_unformatted, meaning))
                for keys, meaning in rows
            ]
            table("keys", 2, cells, imgui.TableFlags_.sizing_fixed_fit)
        inside = imgui.is_window_hovered(imgui.HoveredFlags_.child_windows)
        if imgui.is_mouse_clicked(0) and not inside and not imgui.is_window_appearing():
            interface.keymap_shown = False


def _joined() -> list[tuple[str, str]]:
    """Return the keys and their meanings, keys that mean the same on one line."""
    keys_by_action: dict[str, list[str]] = {}
    for key in KEYS:
        keys_by_action.setdefault(key.meaning, []).append(key.name)
    return [(", ".join(names), meaning) for meaning, names in keys_by_action.items()]

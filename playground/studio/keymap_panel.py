"""The key map: every key by subject, in as many columns as there is room for, with a search."""

from __future__ import annotations

import itertools

from imgui_bundle import ImVec2, imgui

from playground.studio import theme
from playground.studio.draw import QUIET, await_field, button, letters, window, with_typed_ahead, wrapped
from playground.studio.interface import Interface
from playground.studio.keys import GESTURES, keys_by_subject
from playground.studio.language import shortcut, tr
from playground.studio.theme import Theme

_COLUMN = 330.0  # [units of scale 1] that a column is wide at least
_MOST = 3  # columns
_KEYS = 0.36  # fraction of a column that the names of keys take
_FLAGS = QUIET | imgui.WindowFlags_.no_title_bar | imgui.WindowFlags_.no_move | imgui.WindowFlags_.no_resize

Row = tuple[str, str]


def draw_keymap(interface: Interface, look: Theme) -> None:
    """Draw the key map over the window, while it is open."""
    if not interface.keymap_shown:
        return
    room, margin = imgui.get_main_viewport().size, 8 * look.scale
    wide = min(room.x - 2 * margin, _MOST * (_COLUMN + 40) * look.scale)
    imgui.set_next_window_pos(ImVec2(room.x / 2, room.y / 2), imgui.Cond_.always, ImVec2(0.5, 0.5))
    imgui.set_next_window_size(ImVec2(wide, min(room.y - 2 * margin, 960 * look.scale)))
    ground = theme.colour(theme.palette.popup, 0.98)
    with window("keys", _FLAGS, ground=ground, rounding=8 * look.scale):
        if _draw_head(interface, look):
            interface.keymap_shown = False
        imgui.begin_child("rows", ImVec2(0, 0), imgui.ChildFlags_.nav_flattened)
        _scroll()
        _draw_columns(_found(interface.keymap_search), look)
        imgui.end_child()
        inside = imgui.is_window_hovered(imgui.HoveredFlags_.child_windows)
        if imgui.is_mouse_clicked(0) and not inside and not imgui.is_window_appearing():
            interface.keymap_shown = False


def _draw_head(interface: Interface, look: Theme) -> bool:
    """Draw the title, the search and a cross; return whether that is pressed."""
    imgui.align_text_to_frame_padding()
    with look.font(look.bold, theme.TEXT_SIZE + 2):
        imgui.text_unformatted(tr("Keys"))
    imgui.same_line(0, 2 * imgui.get_style().item_spacing.x)
    if interface.searching:
        interface.searching = False
        await_field(interface.ahead)
        imgui.set_keyboard_focus_here()
    imgui.set_next_item_width(-2.2 * imgui.get_frame_height())
    before, typed = interface.keymap_search, letters()
    flags = imgui.InputTextFlags_.escape_clears_all
    _, text = imgui.input_text_with_hint("##search keys", tr("Search keys  /"), before, flags)
    interface.keymap_search = with_typed_ahead(interface.ahead, text, before, typed)
    imgui.same_line()
    return button("×###close keys", tr("Close (Esc)"))


def _scroll() -> None:
    """Scroll by keys, while no field or control has them."""
    if imgui.get_io().want_text_input or imgui.get_io().nav_visible:
        return
    page = 0.8 * imgui.get_window_height()
    step = imgui.get_text_line_height_with_spacing()
    ways = {imgui.Key.down_arrow: step, imgui.Key.up_arrow: -step}
    ways |= {imgui.Key.page_down: page, imgui.Key.page_up: -page}
    for key, by in ways.items():
        if imgui.is_key_pressed(key):
            imgui.set_scroll_y(min(max(imgui.get_scroll_y() + by, 0.0), imgui.get_scroll_max_y()))


def _found(search: str) -> dict[str, list[Row]]:
    """Return the rows that have every word of a search, in the window's language, by subject."""
    words = search.casefold().split()
    shown = {
        tr(subject): [(tr(row[0]) if row in GESTURES else shortcut(row[0]), tr(row[1])) for row in rows]
        for subject, rows in keys_by_subject().items()
    }
    found = {
        subject: [row for row in rows if all(word in " ".join((subject, *row)).casefold() for word in words)]
        for subject, rows in shown.items()
    }
    return {subject: rows for subject, rows in found.items() if rows}


def _draw_columns(subjects: dict[str, list[Row]], look: Theme) -> None:
    """Draw subjects in their order, so that the highest of the columns is as low as can be."""
    if not subjects:
        imgui.text_disabled(tr("No key matches"))
        return
    room = imgui.get_content_region_avail().x - imgui.get_style().item_spacing.x  # before the scroll bar
    count = max(min(int(room / (_COLUMN * look.scale)), _MOST, len(subjects)), 1)
    column = room / count - imgui.get_style().item_spacing.x
    heights = [_height(rows, column) for rows in subjects.values()]
    if not imgui.begin_table("columns", count, outer_size=ImVec2(room, 0)):
        return
    bounds, items = _shared(heights, count), list(subjects.items())
    for start, end in itertools.pairwise(bounds):
        imgui.table_next_column()
        for subject, rows in items[start:end]:
            with look.font(look.bold):
                imgui.text_unformatted(subject)
            _draw_rows(subject, rows)
            imgui.spacing()
    imgui.end_table()


def _height(rows: list[Row], column: float) -> float:
    """Return how high a subject is: its heading, and rows whose words are broken."""
    gap = 2 * imgui.get_style().cell_padding.y
    high = 2 * imgui.get_text_line_height_with_spacing()
    for keys, meaning in rows:
        left = imgui.calc_text_size(keys, False, _KEYS * column).y
        high += max(left, imgui.calc_text_size(meaning, False, (1 - _KEYS) * column).y) + gap
    return high


def _shared(heights: list[float], count: int) -> list[int]:
    """Return where columns begin and the last one ends: of all ways the one whose highest is the lowest."""
    if count == 1:
        return [0, len(heights)]
    ways = ([*_shared(heights[:cut], count - 1), len(heights)] for cut in range(count - 1, len(heights)))
    return min(ways, key=lambda at: max(sum(heights[a:b]) for a, b in itertools.pairwise(at)))


def _draw_rows(subject: str, rows: list[Row]) -> None:
    if not imgui.begin_table(subject, 2):
        return
    imgui.table_setup_column("keys", imgui.TableColumnFlags_.width_stretch, _KEYS)
    imgui.table_setup_column("meaning", imgui.TableColumnFlags_.width_stretch, 1 - _KEYS)
    for keys, meaning in rows:
        imgui.table_next_column()
        with wrapped():
            imgui.text_colored(theme.colour(theme.palette.warm), keys)
        imgui.table_next_column()
        with wrapped():
            imgui.text_unformatted(meaning)
    imgui.end_table()

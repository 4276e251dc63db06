"""A line of the panel: a label with its tooltip on the left, what can be changed on the right."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from imgui_bundle import ImVec2, imgui

from playground.studio import theme

_LABELS = 0.41  # share of the width that labels take
_TOOLTIP = 24.0  # width of a tooltip, in heights of its text
_fitted: dict[tuple[str, str, float, float], str] = {}  # text, how it is cut, width, font's size → what fits


@contextmanager
def row(
    label: str, note: str | Callable[[], str] = "", *, edited: bool = False, fixed: bool = False
) -> Iterator[None]:
    """Write a label, and let the block draw what belongs to it over the width that is left.

    ``note`` is what the label explains, or a function that says it when it is needed.
    ``edited`` colours the label. ``fixed`` is for rows above what scrolls: the scroll
    bar's room is left free there, so that the columns meet.
    """
    room = imgui.get_content_region_avail().x
    room -= imgui.get_style().scrollbar_size if fixed else 0.0
    slots = slots_width()
    labels = (room - slots) * _LABELS
    start, corner = imgui.get_cursor_pos_x(), imgui.get_cursor_screen_pos()
    imgui.align_text_to_frame_padding()
    size, text = fitting_label(label, labels - imgui.get_style().item_spacing.x)
    imgui.push_font(None, size)
    if edited:
        imgui.text_colored(theme.colour(theme.WARM), text)
    else:
        imgui.text_unformatted(text)
    imgui.pop_font()
    imgui.set_cursor_screen_pos(corner)
    imgui.dummy(ImVec2(labels, imgui.get_frame_height()))
    if imgui.is_item_hovered(imgui.HoveredFlags_.for_tooltip):
        explain(label, note() if callable(note) else note)
    imgui.same_line(start + labels)
    imgui.push_item_width(room - labels - slots)
    yield
    imgui.pop_item_width()


def explain(label: str, note: str) -> None:
    """Show a tooltip, its lines broken."""
    imgui.begin_tooltip()
    imgui.push_text_wrap_pos(imgui.get_font_size() * _TOOLTIP)
    imgui.text_unformatted(f"{label}\n{note}" if note else label)
    imgui.pop_text_wrap_pos()
    imgui.end_tooltip()


def slots_width() -> float:
    """Return the room that every row keeps for its lock and its reset: a slider must not shrink in a drag."""
    return 2 * slot() + 4


def slot() -> float:
    """Return the side of one small button at a row's end."""
    return imgui.get_font_size() + 2


def cross(label: str, note: str, high: float = 0.0) -> bool:
    """Draw a row's reset where the cursor is, as high as the row; return whether it is clicked on."""
    clicked, hovered, middle = slot_button(label, note, high)
    size, ink = imgui.calc_text_size("×"), theme.INK if hovered else theme.WARM
    position = ImVec2(middle.x - size.x / 2, middle.y - size.y / 2)
    imgui.get_window_draw_list().add_text(position, theme.packed(ink), "×")
    return clicked


def slot_button(label: str, note: str, high: float = 0.0) -> tuple[bool, bool, ImVec2]:
    """Make an empty button of one slot; return whether it is clicked on and hovered, and its middle."""
    side, high = slot(), high or imgui.get_frame_height()
    corner = imgui.get_cursor_screen_pos()
    clicked = imgui.invisible_button(label, ImVec2(side, high))
    hovered = imgui.is_item_hovered()
    if hovered:
        imgui.set_tooltip(note)
    return clicked, hovered, ImVec2(corner.x + side / 2, corner.y + high / 2)


def fitting(text: str, width: float) -> str:
    """Return a text cut off so that it fits a width, with an ellipsis."""
    return _fit(text, width, lambda left: f"{text[:left].rstrip()}…")


def fitting_path(path: str, width: float) -> str:
    """Return a path cut off so that it fits a width, with an ellipsis before its end: the file's name."""
    return _fit(path, width, lambda left: f"…{path[len(path) - left :]}")


def fitting_label(text: str, width: float) -> tuple[float, str]:
    """Return the size at which a label fits a width, and what fits: a small one before an ellipsis."""
    if fitting(text, width) == text:
        return theme.TEXT_SIZE, text
    imgui.push_font(None, theme.SMALL)
    cut = fitting(text, width)
    imgui.pop_font()
    return theme.SMALL, cut


def fitting_choice(text: str) -> str:
    """Return the choice that a closed list shows, cut off so that it ends before the list's arrow."""
    style = imgui.get_style()
    return fitting(text, imgui.calc_item_width() - imgui.get_frame_height() - 2 * style.frame_padding.x)


def _fit(text: str, width: float, cut: Callable[[int], str]) -> str:
    """Return a text, or what ``cut`` leaves of as many of its letters as fit a width."""
    key = (text, cut(1), width, imgui.get_font_size())
    if key not in _fitted:
        if len(_fitted) > 2000:
            _fitted.clear()
        left = len(text)
        while left > 1 and imgui.calc_text_size(text if left == len(text) else cut(left)).x > width:
            left -= 1
        _fitted[key] = text if left == len(text) else cut(left)
    return _fitted[key]

"""A line of the panel: a label with its tooltip on the left, what can be changed on the right."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from imgui_bundle import imgui

from playground.live import theme

_LABELS = 0.40  # share of the width that labels take
_TOOLTIP = 24.0  # width of a tooltip, in heights of its text


@contextmanager
def row(label: str, note: str = "", *, edited: bool = False, fixed: bool = False) -> Iterator[None]:
    """Write a label, and let the block draw what belongs to it over the width that is left.

    ``edited`` colours the label. ``fixed`` is for rows above what scrolls: the scroll
    bar's room is left free there, so that the columns meet.
    """
    room = imgui.get_content_region_avail().x
    room -= imgui.get_style().scrollbar_size if fixed else 0.0
    reset = reset_width()
    labels = (room - reset) * _LABELS
    start = imgui.get_cursor_pos_x()
    imgui.align_text_to_frame_padding()
    text = fitting(label, labels - imgui.get_style().item_spacing.x)
    imgui.text_colored(theme.colour(theme.WARM if edited else theme.INK), text)
    if imgui.is_item_hovered():
        imgui.begin_tooltip()
        imgui.push_text_wrap_pos(imgui.get_font_size() * _TOOLTIP)
        imgui.text(f"{label}\n{note}" if note else label)
        imgui.pop_text_wrap_pos()
        imgui.end_tooltip()
    imgui.same_line(start + labels)
    imgui.push_item_width(room - labels - reset)
    yield
    imgui.pop_item_width()


def reset_width() -> float:
    """Return the room that every row keeps for its reset button, lest a slider shrink while it is dragged."""
    return float(imgui.calc_text_size("×").x + 2 * imgui.get_style().frame_padding.x + 2)


def fitting(text: str, width: float) -> str:
    """Return a text cut off so that it fits a width, with an ellipsis."""
    if imgui.calc_text_size(text).x <= width:
        return text
    while len(text) > 1 and imgui.calc_text_size(text + "…").x > width:
        text = text[:-1]
    return text.rstrip() + "…"

"""imgui's paired calls as with-blocks, and widgets that several panels use.

A block that fails leaves what it began open: ``live.guard`` ends it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from typing import TypeVar

from imgui_bundle import ImVec2, ImVec4, imgui

from playground.studio import theme

Option = TypeVar("Option")
Area = tuple[float, float, float, float]
"""x, y from above, width, height, in the window's units."""

_F = imgui.WindowFlags_
QUIET = _F.no_saved_settings | _F.no_nav_inputs
"""A window that leaves nothing behind and takes no key."""
SIDE_PANEL = QUIET | _F.no_title_bar | _F.no_move | _F.no_collapse | _F.no_scrollbar
SIDE_PANEL |= _F.no_bring_to_front_on_focus
OVERLAY = QUIET | _F.no_decoration | _F.no_move | _F.always_auto_resize | _F.no_focus_on_appearing
"""A box over the picture, as large as what is in it."""
POPUP_COLOUR = theme.colour((0.125, 0.135, 0.145), 0.98)


@contextmanager
def styled(
    colours: Mapping[imgui.Col_, ImVec4] | None = None,
    sizes: Mapping[imgui.StyleVar_, float | ImVec2] | None = None,
) -> Iterator[None]:
    """Draw the block in other colours and sizes."""
    colours, sizes = colours or {}, sizes or {}
    for which, colour in colours.items():
        imgui.push_style_color(which, colour)
    for name, size in sizes.items():
        imgui.push_style_var(name, size)
    yield
    imgui.pop_style_var(len(sizes))
    imgui.pop_style_color(len(colours))


def inked(rgb: theme.Rgb) -> AbstractContextManager[None]:
    """Write the block's text in a colour."""
    return styled({imgui.Col_.text: theme.colour(rgb)})


@contextmanager
def window(
    name: str,
    flags: int,
    *,
    ground: ImVec4 | None = None,
    rounding: float | None = None,
    sizes: Mapping[imgui.StyleVar_, float | ImVec2] | None = None,
) -> Iterator[None]:
    """Draw the block in a window without a button that closes it."""
    sizes = dict(sizes or {})
    if rounding is not None:
        sizes[imgui.StyleVar_.window_rounding] = rounding
    with styled({imgui.Col_.window_bg: ground} if ground is not None else {}, sizes):
        imgui.begin(name, None, flags)
        yield
        imgui.end()


@contextmanager
def disabled(off: bool) -> Iterator[None]:
    """Draw the block so that it cannot be used, where that is so."""
    imgui.begin_disabled(off)
    yield
    imgui.end_disabled()


@contextmanager
def wrapped(edge: float = 0.0) -> Iterator[None]:
    """Break the block's lines at a place, or with 0 at the window's edge."""
    imgui.push_text_wrap_pos(edge)
    yield
    imgui.pop_text_wrap_pos()


@contextmanager
def pushed_id(name: str | int) -> Iterator[None]:
    """Draw the block with labels of its own."""
    imgui.push_id(name)
    yield
    imgui.pop_id()


def button(
    label: str, note: str = "", *, enabled: bool = True, small: bool = False, wide: float = 0.0
) -> bool:
    """Draw a button with a tooltip; return whether it is pressed."""
    with disabled(not enabled):
        pressed = imgui.small_button(label) if small else imgui.button(label, ImVec2(wide, 0))
    if note:
        imgui.set_item_tooltip(note)
    return bool(pressed)


def buttons(*row: tuple[str, str, Callable[[], object], bool], small: bool = False) -> None:
    """Draw buttons on one line: each a label, a tooltip, what it does, and whether it can be pressed."""
    for number, (label, note, act, enabled) in enumerate(row):
        if number:
            imgui.same_line()
        if button(label, note, enabled=enabled, small=small):
            act()


def tooltip_waits() -> bool:
    """Return whether the mouse is over an item whose tooltip is still to come: frames count its delay."""
    context, style = imgui.get_current_context(), imgui.get_style()
    rested = min(
        context.hover_item_delay_timer - style.hover_delay_normal,
        context.mouse_stationary_timer - style.hover_stationary_delay,
    )
    return context.hover_item_delay_id != 0 and rested < 0.0


def header(label: str, look: theme.Theme, flags: int = 0) -> bool:
    """Draw the bar that opens a part of the panel; return whether it is open."""
    with look.font(look.bold):
        return imgui.collapsing_header(label, flags)


def choose(
    label: str,
    shown: str,
    options: Iterable[Option],
    current: Option | None,
    *,
    name: Callable[[Option], str] = str,
    flags: int = 0,
) -> Option | None:
    """Draw a list that opens; return the option that is chosen in it, None while none is.

    ``shown`` is what the closed list shows, ``name`` writes an option.
    """
    chosen: Option | None = None
    if imgui.begin_combo(label, shown, flags):
        for option in options:
            if imgui.selectable(name(option), option == current)[0]:
                chosen = option
            if option == current:
                imgui.set_item_default_focus()
        imgui.end_combo()
    return chosen


@contextmanager
def menu(label: str, name: str, note: str) -> Iterator[bool]:
    """Draw a button that opens a popup; the block draws what is in it, where it is given True."""
    if button(label, note):
        imgui.open_popup(name)
    opened = imgui.begin_popup(name)
    yield opened
    if opened:
        imgui.end_popup()


def table(name: str, columns: int, rows: Iterable[tuple[Callable[[], object], ...]], flags: int) -> None:
    """Draw a table; each cell is a function that draws it."""
    if imgui.begin_table(name, columns, flags):
        for row in rows:
            imgui.table_next_row()
            for cell in row:
                imgui.table_next_column()
                cell()
        imgui.end_table()


def plate_size(text: str, padding: float, wrap: float = -1.0) -> ImVec2:
    """Return the size of a plate."""
    return imgui.calc_text_size(text, False, wrap) + ImVec2(2 * padding, 2 * padding)


def plate(
    draw: imgui.ImDrawList,
    text: str,
    position: tuple[float, float],
    *,
    ink: int,
    ground: int,
    padding: float,
    rounding: float,
    wrap: float = -1.0,
    align: tuple[float, float] = (0.0, 0.0),
) -> ImVec2:
    """Write text on a plate of its size; return the plate's lower right corner.

    ``position`` is the corner that ``align`` says: (0, 0) the upper left one, (1, 1) the lower right one.
    """
    size = plate_size(text, padding, wrap)
    low = ImVec2(position[0] - align[0] * size.x, position[1] - align[1] * size.y)
    corner = low + size
    draw.add_rect_filled(low, corner, ground, rounding)
    inner = ImVec2(low.x + padding, low.y + padding)
    draw.add_text(imgui.get_font(), imgui.get_font_size(), inner, ink, text, max(wrap, 0.0))
    return corner

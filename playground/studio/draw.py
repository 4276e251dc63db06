"""imgui's paired calls as with-blocks, and widgets that several panels use.

A block that fails leaves what it began open: ``Guard`` ends it.

A line of the panel has a label with its tooltip on the left, what can be changed on the right.

What is typed until a text field that is about to open takes the keys is its own, and no shortcut: imgui gives
a field the keys some frames after it was opened, and where a picture takes long, a person has typed by then.
While a field is awaited the letters are stored; it begins with them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from typing import TypeVar

from imgui_bundle import ImVec2, ImVec4, imgui

from playground.studio import theme
from playground.studio.interface import TypedAhead
from playground.studio.theme import Theme

Option = TypeVar("Option")
Area = tuple[float, float, float, float]
"""x, y from above, width, height, in the window's units."""

_F = imgui.WindowFlags_
QUIET = _F.no_saved_settings.value
"""A window that leaves nothing behind."""
SIDE_PANEL = QUIET | _F.no_title_bar | _F.no_move | _F.no_collapse | _F.no_scrollbar
SIDE_PANEL |= _F.no_bring_to_front_on_focus
_PULL = 20.0  # [units of scale 1] by which a key pulls a side panel's edge
OVERLAY = QUIET | _F.no_decoration | _F.no_move | _F.always_auto_resize | _F.no_focus_on_appearing
"""A box over the picture, as large as what is in it."""


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


def place_side_panel(
    width: float,
    limits: tuple[float, float],
    look: Theme,
    *,
    left: float = 0.0,
    beside: float,
    steps: int = 0,
) -> float:
    """Place the next window at the left side, over the whole height; return its width if nobody pulls it.

    ``width``, its ``limits`` and what stays ``beside`` it at least in units of scale 1, ``left`` and the
    result in the window's. imgui cuts a size to whole pixels; so is the result, or each scale would
    look like a pull. Keys pull it by ``steps``.
    """
    room = imgui.get_main_viewport().size
    widest = max(room.x - left - beside * look.scale, 160.0)
    low, target, high = (float(int(min(size * look.scale, widest))) for size in (limits[0], width, limits[1]))
    pulled = min(target + steps * _PULL * look.scale, widest)
    imgui.set_next_window_pos(ImVec2(left, 0))
    imgui.set_next_window_size(ImVec2(pulled, room.y))
    imgui.set_next_window_size_constraints(ImVec2(low, room.y), ImVec2(high, room.y))
    return target


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


def next_in_row(label: str) -> None:
    """Go on in the same line, where a button of this label has room in it."""
    style = imgui.get_style()
    edge = imgui.get_cursor_screen_pos().x + imgui.get_content_region_avail().x
    wide = imgui.calc_text_size(label, True).x + 2 * style.frame_padding.x + style.item_spacing.x
    if imgui.get_item_rect_max().x + wide <= edge:
        imgui.same_line()


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
def menu(label: str, name: str, note: str, *, small: bool = False) -> Iterator[bool]:
    """Draw a button that opens a popup below it; the block draws what is in it, where it is given True."""
    if button(label, note, small=small):
        imgui.open_popup(name)
        below = ImVec2(imgui.get_item_rect_min().x, imgui.get_item_rect_max().y)
        popups = imgui.get_current_context().open_popup_stack
        popups[len(popups) - 1].open_popup_pos = below
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


def draw_cross(
    draw: imgui.ImDrawList, middle: tuple[float, float], ink: theme.Rgb, far: float, look: Theme
) -> None:
    """Draw a cross that leaves its middle free; its dark edge shows it on light and on dark.

    ``far``: to where its arms go, in units of scale 1.
    """
    near, far = 3 * look.scale, far * look.scale
    for shade, thick in ((theme.packed((0.0, 0.0, 0.0), 0.9), 5.0), (theme.packed(ink), 2.0)):
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            start = ImVec2(middle[0] + near * dx, middle[1] + near * dy)
            end = ImVec2(middle[0] + far * dx, middle[1] + far * dy)
            draw.add_line(start, end, shade, thick * look.scale)


# ── lines of the panel ────────────────────────────────────────────────────────


_LABELS = 0.41  # fraction of the width that labels take
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
        imgui.text_colored(theme.colour(theme.palette.warm), text)
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
    clicked, hovered, middle = slot_button(label, note, high, imgui.ButtonFlags_.enable_nav)
    size, ink = imgui.calc_text_size("×"), theme.palette.ink if hovered else theme.palette.warm
    position = ImVec2(middle.x - size.x / 2, middle.y - size.y / 2)
    imgui.get_window_draw_list().add_text(position, theme.packed(ink), "×")
    return clicked


def slot_button(label: str, note: str, high: float = 0.0, flags: int = 0) -> tuple[bool, bool, ImVec2]:
    """Make an empty button of one slot; return whether it is clicked on and hovered, and its middle."""
    side, high = slot(), high or imgui.get_frame_height()
    corner = imgui.get_cursor_screen_pos()
    clicked = imgui.invisible_button(label, ImVec2(side, high), flags)
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


def first_lines(text: str, width: float, count: int, ending: str) -> tuple[list[str], bool]:
    """Return the first lines of a text broken at a width, and whether there were more.

    Then the last one leaves room for ``ending``, and itself ends with an ellipsis.
    """
    lines = [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".lstrip()
        if imgui.calc_text_size(longer).x <= width or not lines[-1]:
            lines[-1] = longer
        elif len(lines) < count:
            lines.append(word)
        else:
            while lines[-1] and imgui.calc_text_size(f"{lines[-1]}{ending}").x > width:
                lines[-1] = lines[-1].rpartition(" ")[0]
            return [*lines[:-1], f"{lines[-1].rstrip(' .,:;')}…"], True
    return lines, False


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


# ── text fields ───────────────────────────────────────────────────────────────


_FRAMES = 6
"""That a field may take to open; one that never does, since it is not visible, takes no key longer."""


def await_field(ahead: TypedAhead) -> None:
    """Begin to store what is typed: a field was opened."""
    ahead.frames, ahead.text = _FRAMES, ""


def keeps_keys(ahead: TypedAhead) -> bool:
    """Return whether this frame's keys are for a field that is about to open, and store its letters."""
    if not ahead.frames:
        return False
    if _is_active():
        ahead.frames = 0
        return True
    ahead.frames -= 1
    ahead.text += letters()
    return True


def with_typed_ahead(ahead: TypedAhead, text: str, before: str, typed: str) -> str:
    """Return the text of the field that was drawn last, after what was typed before it took the keys.

    ``before``: its text before this frame, which what is typed replaces; ``typed``: this frame's letters,
    of which the field took those itself that came once it had the keys.
    """
    if not imgui.is_item_active():
        return text
    before_field, ahead.text = ahead.text, ""
    if ahead.frames and imgui.is_item_activated():
        before_field += typed  # imgui drops those of the frame in which a field gets the keys
    if not before_field:
        return text
    imgui.get_current_context().input_text_state.reload_user_buf_and_move_to_end()
    return before_field + (text if text != before else "")


def left_a_field() -> bool:
    """Return whether a field had the keys when this frame began: its Esc is its own."""
    context = imgui.get_current_context()
    return context.active_id_previous_frame not in (0, None) and (
        context.active_id_previous_frame == context.input_text_state.id_
    )


def letters() -> str:
    """Return what was typed in this frame and not taken by a field yet."""
    return "".join(chr(letter) for letter in imgui.get_io().input_queue_characters)


def arrows() -> tuple[int, int]:
    """Return which way arrow keys that were pressed since the last frame, or repeated, go: right, down."""

    def way(on: imgui.Key, back: imgui.Key) -> int:
        return int(imgui.is_key_pressed(on)) - int(imgui.is_key_pressed(back))

    key = imgui.Key
    return way(key.right_arrow, key.left_arrow), way(key.down_arrow, key.up_arrow)


def ctrl_held() -> bool:
    """Return whether Ctrl is down, or went up in this frame, as in a slow one together with its key."""
    io = imgui.get_io()
    return bool(io.key_ctrl or io.key_super or imgui.is_key_released(imgui.Key.mod_ctrl))


def _is_active() -> bool:
    context = imgui.get_current_context()
    return context.active_id != 0 and context.active_id == context.input_text_state.id_

"""What lies over the picture: errors with their places, and notices that fade."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from playground.errors import Diagnostic, PlaygroundError
from playground.live import theme
from playground.live.actions import Actions
from playground.live.excerpt import cut, short_place
from playground.live.theme import Theme

MOST = 12  # diagnostics shown; more help nobody
_TALLEST = 0.5  # share of the picture that an error may cover
_FADE = 1.0  # [s]
Area = tuple[float, float, float, float]  # x, y from above, width, height, in the window's units


def draw_error(error: PlaygroundError, actions: Actions, look: Theme, area: Area) -> None:
    """Draw what is wrong over the lower part of the picture, with each offending line."""
    x, y, wide, high = area
    margin = 14 * look.scale
    width = max(wide - 2 * margin, 120.0)
    imgui.set_next_window_pos(ImVec2(x + margin, y + high - margin), imgui.Cond_.always, ImVec2(0, 1))
    imgui.set_next_window_size_constraints(ImVec2(width, 0), ImVec2(width, high * _TALLEST))
    imgui.push_style_color(imgui.Col_.window_bg, theme.colour((0.17, 0.075, 0.075), 0.95))
    imgui.push_style_var(imgui.StyleVar_.window_rounding, 8 * look.scale)
    flags = imgui.WindowFlags_.no_title_bar | imgui.WindowFlags_.no_move | imgui.WindowFlags_.no_resize
    flags |= imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_saved_settings
    flags |= imgui.WindowFlags_.no_focus_on_appearing | imgui.WindowFlags_.no_nav_inputs
    imgui.begin("error", None, flags)
    _headline(error, actions, look)
    folder = str(actions.session.path.parent.resolve())
    previous = None
    for diagnostic in error.diagnostics[:MOST]:
        _diagnostic(diagnostic, previous, folder, look)
        previous = diagnostic
    if len(error.diagnostics) > MOST:
        imgui.text_disabled(f"and {len(error.diagnostics) - MOST} more")
    imgui.end()
    imgui.pop_style_var()
    imgui.pop_style_color()


def _headline(error: PlaygroundError, actions: Actions, look: Theme) -> None:
    session = actions.session
    kept = "the last good picture stays" if session.shown is not None else "there is no picture yet"
    with look.font(look.bold):
        imgui.text_colored(theme.colour(theme.ALARM), f"This does not work yet; {kept}.")
    buttons = "Copy", "Dismiss"
    style = imgui.get_style()
    wide = sum(imgui.calc_text_size(b).x + 2 * style.frame_padding.x for b in buttons) + style.item_spacing.x
    right = imgui.get_window_width() - style.window_padding.x - wide
    if right > imgui.calc_text_size(kept).x * 2:
        imgui.same_line(right)
    if imgui.small_button("Copy"):
        imgui.set_clipboard_text(str(error))
    imgui.same_line()
    if imgui.small_button("Dismiss"):
        session.dismiss()


def _diagnostic(diagnostic: Diagnostic, previous: Diagnostic | None, folder: str, look: Theme) -> None:
    """Draw one mistake; the line it is on only if the one before was elsewhere."""
    imgui.spacing()
    if diagnostic.place:
        with look.font(look.code):
            imgui.text_colored(theme.colour(theme.WARM), short_place(diagnostic.place, folder))
        imgui.set_item_tooltip(diagnostic.place)
    imgui.push_text_wrap_pos(0)
    imgui.text(diagnostic.message)
    imgui.pop_text_wrap_pos()
    here = (diagnostic.file, diagnostic.line)
    repeated = previous is not None and here == (previous.file, previous.line)
    if diagnostic.excerpt.strip():
        _excerpt(diagnostic, look)
    if not repeated:
        with look.font(look.code, theme.SMALL):
            for place in reversed(diagnostic.chain):
                imgui.text_disabled(f"included from {short_place(place, folder)}")


def _excerpt(diagnostic: Diagnostic, look: Theme) -> None:
    """Draw the offending line and a mark under the column."""
    number = f"{diagnostic.line} | " if diagnostic.line else ""
    with look.font(look.code):
        room = int(imgui.get_content_region_avail().x / imgui.calc_text_size("M").x) - len(number)
        text, mark = cut(diagnostic.excerpt, diagnostic.column, room)
        imgui.push_style_var(imgui.StyleVar_.item_spacing, ImVec2(0, 0))
        imgui.text_disabled(number)
        imgui.same_line(0, 0)
        imgui.text(text)
        if mark >= 0:
            imgui.text_colored(theme.colour(theme.ALARM), " " * (len(number) + mark) + "^")
        imgui.pop_style_var()


def draw_waiting(text: str, look: Theme, area: Area) -> None:
    """Write a sentence in the middle of the picture, while there is none."""
    x, y, wide, high = area
    size = imgui.calc_text_size(text)
    place = ImVec2(x + (wide - size.x) / 2, y + (high - size.y) / 2)
    imgui.get_background_draw_list().add_text(place, theme.packed(theme.DIM), text)


def draw_notices(actions: Actions, look: Theme, area: Area) -> None:
    """Draw the notices in the upper right corner; each fades at its end."""
    x, y, wide, _ = area
    margin, padding = 14 * look.scale, 9 * look.scale
    room = max(min(wide - 2 * margin, 560 * look.scale) - 2 * padding, 80.0)
    top = y + margin
    draw = imgui.get_foreground_draw_list()
    for notice in reversed(actions.notices):
        alpha = min(max(notice.until - actions.now(), 0.0) / _FADE, 1.0)
        size = imgui.calc_text_size(notice.text, False, room)
        right = x + wide - margin
        low = ImVec2(right - size.x - 2 * padding, top)
        high = ImVec2(right, top + size.y + 2 * padding)
        draw.add_rect_filled(low, high, theme.packed(theme.GROUND, 0.92 * alpha), 6 * look.scale)
        draw.add_text(
            imgui.get_font(),
            imgui.get_font_size(),
            ImVec2(low.x + padding, low.y + padding),
            theme.packed(theme.INK, alpha),
            notice.text,
            room,
        )
        top = high.y + 6 * look.scale

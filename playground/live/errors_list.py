"""The list of errors and warnings over the lower part of the picture, and the badge that opens it."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from playground.errors import Diagnostic, counted
from playground.live import theme
from playground.live.overlay import Area
from playground.live.theme import Theme
from playground.workbench.actions import Actions
from playground.workbench.error_excerpt import numbered, short_place
from playground.workbench.open_source import editor_name, open_place, open_problem
from playground.workbench.problems import passes_of

MOST = 60
"""Diagnostics drawn; more help nobody."""
_TALLEST = 0.5  # share of the picture that the list may cover
_GROUND = (0.17, 0.075, 0.075)  # under errors
_MILD = (0.125, 0.118, 0.095)  # under warnings alone


def draw_errors(actions: Actions, look: Theme, area: Area) -> None:
    """Draw the list while it is open; while it is not, the badge, if there is anything to tell."""
    problems = actions.problems
    if not problems.errors and not problems.warnings:
        return
    if problems.open:
        _list(actions, look, area)
    else:
        _badge(actions, look, area)


def _window(name: str, place: ImVec2, actions: Actions, look: Theme) -> None:
    """Begin a window whose lower left corner is at a place, in the colour of what it tells."""
    imgui.set_next_window_pos(place, imgui.Cond_.always, ImVec2(0, 1))
    ground = _GROUND if actions.problems.errors else _MILD
    imgui.push_style_color(imgui.Col_.window_bg, theme.colour(ground, 0.95))
    imgui.push_style_var(imgui.StyleVar_.window_rounding, 8 * look.scale)
    flags = imgui.WindowFlags_.no_title_bar | imgui.WindowFlags_.no_move | imgui.WindowFlags_.no_resize
    flags |= imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_saved_settings
    flags |= imgui.WindowFlags_.no_focus_on_appearing | imgui.WindowFlags_.no_nav_inputs
    flags |= imgui.WindowFlags_.no_bring_to_front_on_focus
    imgui.begin(name, None, flags)


def _end() -> None:
    imgui.end()
    imgui.pop_style_var()
    imgui.pop_style_color()


def _badge(actions: Actions, look: Theme, area: Area) -> None:
    x, y, _, high = area
    margin = 14 * look.scale
    imgui.push_style_var(imgui.StyleVar_.window_padding, ImVec2(4 * look.scale, 4 * look.scale))
    imgui.push_style_var(imgui.StyleVar_.window_min_size, ImVec2(8, 8))
    _window("badge", ImVec2(x + margin, y + high - margin), actions, look)
    colour = theme.ALARM if actions.problems.errors else theme.WARM
    imgui.push_style_color(imgui.Col_.text, theme.colour(colour))
    if imgui.small_button(f"{actions.problems.headline()}##badge"):
        actions.problems.open = True
    imgui.pop_style_color()
    imgui.set_item_tooltip("Show the list (F8)")
    _end()
    imgui.pop_style_var(2)


def _list(actions: Actions, look: Theme, area: Area) -> None:
    x, y, wide, high = area
    problems, margin = actions.problems, 14 * look.scale
    width, tallest = max(wide - 2 * margin, 120.0), max(high * _TALLEST, 120.0)
    imgui.set_next_window_size_constraints(ImVec2(width, 0), ImVec2(width, tallest))
    imgui.push_style_color(imgui.Col_.text_link, theme.colour(theme.DIM))
    _window("error", ImVec2(x + margin, y + high - margin), actions, look)
    _headline(actions, look)
    room = tallest - imgui.get_cursor_pos_y() - imgui.get_style().window_padding.y
    imgui.set_next_window_size_constraints(ImVec2(0, 0), ImVec2(1e6, max(room, 40.0)))
    imgui.begin_child("list", ImVec2(0, 0), imgui.ChildFlags_.auto_resize_y)
    folder, number = str(actions.session.path.parent.resolve()), 0
    for file, mine in problems.by_file():
        if number >= MOST:
            break
        title = short_place(file, folder) if file else "no file"
        if problems.moved and number <= problems.at < number + len(mine):
            imgui.set_next_item_open(True)
        with look.font(look.bold):
            flags = imgui.TreeNodeFlags_.default_open | imgui.TreeNodeFlags_.span_avail_width
            opened = imgui.tree_node_ex(f"{title}   {_count(mine)}###file {file}", flags)
        previous = None
        for place, diagnostic in enumerate(mine[: MOST - number], number):
            if opened:
                imgui.push_id(place)
                again = previous is not None and previous.line == diagnostic.line
                _diagnostic(diagnostic, place, again, actions, look, folder)
                imgui.pop_id()
            previous = diagnostic
        if opened:
            imgui.tree_pop()
        number += len(mine)
    if (left := len(problems.all) - MOST) > 0:
        imgui.text_disabled(f"and {left} more; Copy has them all")
    problems.moved = False
    imgui.end_child()
    _end()
    imgui.pop_style_color()


def _count(mine: list[Diagnostic]) -> str:
    errors = sum(d.severity == "error" for d in mine)
    parts = [counted(errors, "error")] if errors else []
    parts += [counted(len(mine) - errors, "warning")] if errors < len(mine) else []
    return ", ".join(parts)


def _headline(actions: Actions, look: Theme) -> None:
    problems, session = actions.problems, actions.session
    kept = "the last good picture stays" if session.shown is not None else "there is no picture yet"
    text = f"{problems.headline()}; {kept}." if problems.errors else f"{problems.headline()}."
    buttons = "Copy", "Fold"
    style = imgui.get_style()
    wide = sum(imgui.calc_text_size(b).x + 2 * style.frame_padding.x for b in buttons) + style.item_spacing.x
    right = imgui.get_window_width() - style.window_padding.x - wide
    with look.font(look.bold):
        imgui.push_text_wrap_pos(right - style.item_spacing.x)
        imgui.text_colored(theme.colour(theme.ALARM if problems.errors else theme.WARM), text)
        imgui.pop_text_wrap_pos()
    imgui.same_line(right)
    if imgui.small_button("Copy##errors"):
        imgui.set_clipboard_text(problems.text())
        actions.say(f"copied {problems.headline()}")
    imgui.set_item_tooltip("All of it, to the clipboard")
    imgui.same_line()
    if imgui.small_button("Fold##errors"):
        problems.open = False
    imgui.set_item_tooltip("To a badge; F8 brings it back")


def _diagnostic(
    diagnostic: Diagnostic, place: int, again: bool, actions: Actions, look: Theme, folder: str
) -> None:
    """Draw one mistake: its place, its words, the lines around it, how it came to be included.

    ``again``: the one before is on the same line, so that its lines need not be shown twice.
    """
    looked_at, heights = actions.problems.at == place, actions.problems.heights
    start, size = imgui.get_cursor_screen_pos(), (place, imgui.get_content_region_avail().x)
    above = imgui.get_window_pos().y
    known = heights.get(size)
    away = start.y > above + imgui.get_window_height() or (known is not None and start.y + known < above)
    if known is not None and away and not actions.problems.moved and not imgui.is_any_item_active():
        imgui.dummy(ImVec2(1, known))
        return
    imgui.spacing()
    top = imgui.get_cursor_screen_pos()
    if looked_at and actions.problems.moved:
        imgui.set_scroll_here_y(0.0)
    imgui.begin_group()
    _links(diagnostic, actions, look, folder)
    colour = theme.INK if diagnostic.severity == "error" else theme.WARM
    _words("message", diagnostic.message, colour, look, wrapped=True)
    lines = [] if again else actions.problems.lines_around(diagnostic)
    if lines:
        _code(diagnostic, lines, look)
    for at, included in enumerate(() if again else reversed(diagnostic.chain)):
        with look.font(look.code, theme.SMALL):
            imgui.text_disabled("included from")
            imgui.same_line(0, imgui.calc_text_size(" ").x)
            if imgui.text_link(f"{short_place(included, folder)}##chain {at}"):
                open_place(actions, included)
    imgui.end_group()
    heights[size] = imgui.get_item_rect_max().y - start.y
    if looked_at:
        low = ImVec2(top.x - 6 * look.scale, top.y)
        high = ImVec2(top.x - 3 * look.scale, imgui.get_item_rect_max().y)
        imgui.get_window_draw_list().add_rect_filled(low, high, theme.packed(theme.ACCENT))


def _links(diagnostic: Diagnostic, actions: Actions, look: Theme, folder: str) -> None:
    """Draw the place, which opens the file, and the ways on from there."""
    if not diagnostic.file:
        return
    with look.font(look.code):
        imgui.push_style_color(imgui.Col_.text_link, theme.colour(theme.WARM))
        if imgui.text_link(f"{short_place(diagnostic.place, folder)}##place"):
            open_problem(actions, diagnostic)
        imgui.pop_style_color()
    if imgui.is_item_hovered():
        name = editor_name()
        imgui.set_tooltip(f"{diagnostic.place}\nOpens in {name or 'a window here'}")
    with look.font(look.text, theme.SMALL):
        imgui.same_line(0, 16 * look.scale)
        if imgui.text_link("edit here##here"):
            open_problem(actions, diagnostic, here=True)
        imgui.set_item_tooltip("Opens the file in a window of its own, here")
        for name in passes_of(actions.session.sketch, diagnostic)[:3]:
            imgui.same_line(0, 12 * look.scale)
            if imgui.text_link(f"pass {name}##pass"):
                actions.show_pass(name)
            imgui.set_item_tooltip("Shows the pass in the panel")


def _code(diagnostic: Diagnostic, lines: list[tuple[int, str]], look: Theme) -> None:
    """Draw lines of the file with their numbers, a mark under the column."""
    with look.font(look.code):
        room = int((imgui.get_content_region_avail().x - 4 * look.scale) / imgui.calc_text_size("M").x)
        rows, wrong = numbered(lines, diagnostic.line, diagnostic.column, room)
        line = imgui.get_text_line_height()
        low = imgui.get_cursor_screen_pos()
        low = ImVec2(low.x, low.y + wrong * line)
        high = ImVec2(low.x + imgui.get_content_region_avail().x, low.y + line)
        imgui.get_window_draw_list().add_rect_filled(low, high, theme.packed((1.0, 1.0, 1.0), 0.07))
        _words("code", "\n".join(rows), theme.DIM if diagnostic.severity != "error" else theme.INK, look)


def _words(
    label: str, text: str, rgb: tuple[float, float, float], look: Theme, *, wrapped: bool = False
) -> None:
    """Draw a text that can be selected and copied."""
    wide = imgui.get_content_region_avail().x
    size = imgui.calc_text_size(text, False, wide - 2 * look.scale if wrapped else -1.0)
    flags = imgui.InputTextFlags_.read_only | (imgui.InputTextFlags_.word_wrap if wrapped else 0)
    imgui.push_style_color(imgui.Col_.frame_bg, theme.colour(theme.GROUND, 0.0))
    imgui.push_style_color(imgui.Col_.text, theme.colour(rgb))
    imgui.push_style_var(imgui.StyleVar_.frame_padding, ImVec2(0, 0))
    imgui.push_style_var(imgui.StyleVar_.scrollbar_size, 4 * look.scale)
    imgui.input_text_multiline(f"##{label}", text, ImVec2(wide, size.y + 2), flags)
    imgui.pop_style_var(2)
    imgui.pop_style_color(2)

"""The list of errors and warnings over the lower part of the picture, the badge that opens it, its excerpts.

Likewise, in the upper part, which pass made the first number that is not finite.
"""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import cached_property

from imgui_bundle import ImVec2, imgui

from playground.engine.non_finite import NotFinite
from playground.errors import Diagnostic
from playground.paths import current_folder
from playground.studio import theme
from playground.studio.code.open_files import OpenFiles, editor_name
from playground.studio.draw import OVERLAY, QUIET, Area, button, inked, pushed_id, styled, window, wrapped
from playground.studio.interface import Interface
from playground.studio.language import counted, tr
from playground.studio.problems.non_finite import FiniteWatch, summary
from playground.studio.problems.problems import Problems, passes_of
from playground.studio.session import Session
from playground.studio.theme import Theme
from playground.studio.trace.tracing import Tracing

_BEFORE = 0.6  # fraction of the room that may lie before the column


def numbered(lines: list[tuple[int, str]], wrong: int, column: int, room: int) -> tuple[list[str], int]:
    """Return (lines of a file as rows, a mark below the wrong one's column; which row is wrong, from 0).

    ``lines`` are (number, text); ``wrong`` is a number, ``column`` counts from 1, 0 where it is
    unknown; rows have about ``room`` characters. What all lines are indented by goes, tabs become
    four spaces, and long lines are moved to the left together until the column is visible.
    """
    digits = len(str(lines[-1][0]))
    texts = {number: text.rstrip().expandtabs(4) for number, text in lines}
    indent = min((len(text) - len(text.lstrip()) for text in texts.values() if text), default=0)
    raw = dict(lines).get(wrong, "")
    mark = max(len(raw[: column - 1].expandtabs(4)) - indent, 0) if column else -1
    room = max(room - digits - 3, 8)
    longest = max(len(text) for text in texts.values()) - indent
    shift = 0
    if mark > room * _BEFORE and longest > room:
        shift = min(mark - int(room * _BEFORE), longest - room + 1)
    rows: list[str] = []
    at = 0
    for number, whole in texts.items():
        text = whole[indent:]
        if shift and text:
            text = f"…{text[shift + 1 :]}"
        if len(text) > room:
            text = f"{text[: room - 1]}…"
        if number == wrong:
            at = len(rows)
        rows.append(f"{number:>{digits}} | {text}".rstrip())
        if number == wrong and mark >= 0:
            rows.append(f"{' ' * digits} | {' ' * (mark - shift)}^")
    return rows, at


def short_place(location: str, folder: str) -> str:
    """Return "file:line:column" with the file named from a folder, if it lies in there."""
    name, colon, rest = location.partition(":") if not location[1:3] == ":\\" else (location, "", "")
    path = current_folder() / name
    if folder and path.is_relative_to(folder):
        return path.relative_to(folder).as_posix() + colon + rest
    return location


MAX_ROWS = 60
"""Diagnostics drawn at most."""
_MAX_HEIGHT = 0.5  # fraction of the picture that the list may cover
_FLAGS = QUIET | imgui.WindowFlags_.no_title_bar | imgui.WindowFlags_.no_move | imgui.WindowFlags_.no_resize
_FLAGS |= imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_focus_on_appearing
_FLAGS |= imgui.WindowFlags_.no_bring_to_front_on_focus


def draw_border(problems: Problems, look: Theme, area: Area) -> None:
    """Draw a thin red border around the picture that stays while what is written now does not compile."""
    if not problems.errors:
        return
    wide = 2 * look.scale
    low = ImVec2(area[0] + wide / 2, area[1] + wide / 2)
    far = ImVec2(area[0] + area[2] - wide / 2, area[1] + area[3] - wide / 2)
    imgui.get_background_draw_list().add_rect(low, far, theme.packed(theme.palette.alarm), 0.0, wide)


@dataclass(frozen=True)
class ErrorsList:
    """The list in one frame of a window, or the badge in its place."""

    problems: Problems
    files: OpenFiles
    session: Session
    interface: Interface

    def draw(self, look: Theme, area: Area) -> None:
        """Draw the list while it is open; while it is not, the badge, if there is any diagnostic."""
        if self.problems.errors or self.problems.warnings:
            (self._list if self.problems.open else self._badge)(look, area)

    @property
    def _ink(self) -> theme.Rgb:
        return theme.palette.alarm if self.problems.errors else theme.palette.warm

    def _window(self, name: str, area: Area, look: Theme, **sizes: ImVec2) -> AbstractContextManager[None]:
        """Draw a window in the lower left corner of an area, in the colour of their severity."""
        margin = 14 * look.scale
        position = ImVec2(area[0] + margin, area[1] + area[3] - margin)
        imgui.set_next_window_pos(position, imgui.Cond_.always, ImVec2(0, 1))
        rgb = theme.palette.wrong if self.problems.errors else theme.palette.mild
        ground = theme.colour(rgb, 0.95)
        named = {getattr(imgui.StyleVar_, key): value for key, value in sizes.items()}
        return window(name, _FLAGS, ground=ground, rounding=8 * look.scale, sizes=named)

    def _badge(self, look: Theme, area: Area) -> None:
        padding = ImVec2(4 * look.scale, 4 * look.scale)
        with self._window("badge", area, look, window_padding=padding, window_min_size=ImVec2(8, 8)):
            with inked(self._ink):
                if self.problems.errors:
                    note = tr("Goes to the line that is wrong")
                    if button(f"! {len(self.problems.errors)}###jump", note, small=True):
                        self._jump()
                    imgui.same_line()
                if imgui.small_button(f"{self.problems.headline()}##badge"):
                    self.problems.open = True
            imgui.set_item_tooltip(tr("Show the list (F8)"))

    def _jump(self) -> None:
        """Go to the mistake that is looked at, else the first: in the code pane, where it has a file."""
        problems = self.problems
        if problems.all[max(problems.at, 0)].file:
            self.files.open_current(problems, here=True)
        else:
            problems.open = True

    def _list(self, look: Theme, area: Area) -> None:
        problems, margin = self.problems, 14 * look.scale
        width, tallest = max(area[2] - 2 * margin, 120.0), max(area[3] * _MAX_HEIGHT, 120.0)
        imgui.set_next_window_size_constraints(ImVec2(width, 0), ImVec2(width, tallest))
        with (
            styled({imgui.Col_.text_link: theme.colour(theme.palette.dim)}),
            self._window("error", area, look),
        ):
            self._headline(look)
            room = tallest - imgui.get_cursor_pos_y() - imgui.get_style().window_padding.y
            imgui.set_next_window_size_constraints(ImVec2(0, 0), ImVec2(1e6, max(room, 40.0)))
            imgui.begin_child(
                "list", ImVec2(0, 0), imgui.ChildFlags_.auto_resize_y | imgui.ChildFlags_.nav_flattened
            )
            number = 0
            for file, mine in problems.by_file():
                if number < MAX_ROWS:
                    self._file(file, mine, number, look)
                number += len(mine)
            if (left := len(problems.all) - MAX_ROWS) > 0:
                imgui.text_disabled(tr("and {left} more; Copy has them all", left=left))
            problems.moved = False
            imgui.end_child()

    def _headline(self, look: Theme) -> None:
        problems, text = self.problems, self.problems.headline()
        if problems.errors:
            stays = tr("the last good picture stays") if self.session.shown else tr("there is no picture yet")
            text = "! " + tr("{errors}; {picture}", errors=text, picture=stays)
        style = imgui.get_style()
        wide = sum(imgui.calc_text_size(b).x + 2 * style.frame_padding.x for b in (tr("Copy"), tr("Fold")))
        right = imgui.get_window_width() - style.window_padding.x - wide - style.item_spacing.x
        with look.font(look.bold), wrapped(right - style.item_spacing.x):
            imgui.text_colored(theme.colour(self._ink), f"{text}.")
        imgui.same_line(right)
        if button(f"{tr('Copy')}##errors", tr("All of it, to the clipboard"), small=True):
            imgui.set_clipboard_text(problems.text())
            self.files.notices.say(tr("copied {headline}", headline=problems.headline()))
        imgui.same_line()
        if button(f"{tr('Fold')}##errors", tr("To a badge; F8 brings it back"), small=True):
            problems.open = False

    def _file(self, file: str, mine: list[Diagnostic], first: int, look: Theme) -> None:
        """Draw a file's mistakes, under its name."""
        if self.problems.moved and first <= self.problems.at < first + len(mine):
            imgui.set_next_item_open(True)
        with look.font(look.bold):
            flags = imgui.TreeNodeFlags_.default_open | imgui.TreeNodeFlags_.span_avail_width
            title = self._short(file) if file else tr("no file")
            opened = imgui.tree_node_ex(f"{title}   {_count(mine)}###file {file}", flags)
        if not opened:
            return
        shown = mine[: MAX_ROWS - first]
        for index, (before, diagnostic) in enumerate(zip([None, *shown], shown, strict=False), first):
            again = before is not None and before.line == diagnostic.line
            with pushed_id(index):
                self._diagnostic(diagnostic, index, again, look)
        imgui.tree_pop()

    def _diagnostic(self, diagnostic: Diagnostic, index: int, again: bool, look: Theme) -> None:
        """Draw one mistake: its place, its message, the lines around it, how it came to be included.

        ``again``: the one before is on the same line, so that its lines need not be shown twice.
        """
        problems = self.problems
        current, heights = problems.at == index, problems.heights
        start, size = imgui.get_cursor_screen_pos(), (index, imgui.get_content_region_avail().x)
        above = imgui.get_window_pos().y
        row_height = heights.get(size)
        away = start.y > above + imgui.get_window_height() or (
            row_height is not None and start.y + row_height < above
        )
        if row_height is not None and away and not problems.moved and not imgui.is_any_item_active():
            imgui.dummy(ImVec2(1, row_height))
            return
        imgui.spacing()
        top = imgui.get_cursor_screen_pos()
        if current and problems.moved:
            imgui.set_scroll_here_y(0.0)
        imgui.begin_group()
        self._links(diagnostic, look)
        is_error = diagnostic.severity == "error"
        message = diagnostic.message
        _text(
            "message",
            message if is_error else tr("warning: {message}", message=message),
            theme.palette.ink if is_error else theme.palette.warm,
            look,
            wrap=True,
        )
        lines = [] if again else problems.lines_around(diagnostic)
        if lines:
            _code(diagnostic, lines, look)
        for at, included in enumerate(() if again else reversed(diagnostic.chain)):
            with look.font(look.code, theme.SMALL):
                imgui.text_disabled(tr("included from"))
                imgui.same_line(0, imgui.calc_text_size(" ").x)
                if imgui.text_link(f"{self._short(included)}##chain {at}"):
                    self.files.open_place(included)
        imgui.end_group()
        heights[size] = imgui.get_item_rect_max().y - start.y
        if current:
            low = ImVec2(top.x - 6 * look.scale, top.y)
            high = ImVec2(top.x - 3 * look.scale, imgui.get_item_rect_max().y)
            imgui.get_window_draw_list().add_rect_filled(low, high, theme.packed(theme.palette.accent))

    def _links(self, diagnostic: Diagnostic, look: Theme) -> None:
        """Draw the place, which opens the file, and the ways on from there."""
        if not diagnostic.file:
            return
        with look.font(look.code), styled({imgui.Col_.text_link: theme.colour(theme.palette.warm)}):
            if imgui.text_link(f"{self._short(diagnostic.location)}##place"):
                self.files.open_problem(diagnostic)
        if imgui.is_item_hovered():
            imgui.set_tooltip(
                diagnostic.location
                + "\n"
                + tr("Opens in {editor}", editor=editor_name() or tr("the code pane"))
            )
        with look.font(look.text, theme.SMALL):
            imgui.same_line(0, 16 * look.scale)
            if imgui.text_link(f"{tr('edit here')}##here"):
                self.files.open_problem(diagnostic, here=True)
            imgui.set_item_tooltip(tr("Opens the file in the code pane"))
            for name in passes_of(self.session.sketch, diagnostic)[:3]:
                imgui.same_line(0, 12 * look.scale)
                if imgui.text_link(f"{tr('pass {name}', name=name)}##pass"):
                    self.interface.show_pass(name)
                imgui.set_item_tooltip(tr("Shows the pass in the panel"))

    def _short(self, location: str) -> str:
        return short_place(location, self._folder)

    @cached_property
    def _folder(self) -> str:
        return str(self.session.path.parent.resolve())


def _count(mine: list[Diagnostic]) -> str:
    errors = sum(d.severity == "error" for d in mine)
    parts = [counted(errors, "error")] if errors else []
    parts += [counted(len(mine) - errors, "warning")] if errors < len(mine) else []
    return ", ".join(parts)


def _code(diagnostic: Diagnostic, lines: list[tuple[int, str]], look: Theme) -> None:
    """Draw lines of the file with their numbers, a mark under the column."""
    with look.font(look.code):
        room = int((imgui.get_content_region_avail().x - 4 * look.scale) / imgui.calc_text_size("M").x)
        rows, wrong = numbered(lines, diagnostic.line, diagnostic.column, room)
        line = imgui.get_text_line_height()
        low = imgui.get_cursor_screen_pos()
        low = ImVec2(low.x, low.y + wrong * line)
        high = ImVec2(low.x + imgui.get_content_region_avail().x, low.y + line)
        imgui.get_window_draw_list().add_rect_filled(low, high, theme.packed(theme.palette.ink, 0.07))
        _text(
            "code",
            "\n".join(rows),
            theme.palette.dim if diagnostic.severity != "error" else theme.palette.ink,
            look,
        )


def _text(label: str, text: str, rgb: theme.Rgb, look: Theme, *, wrap: bool = False) -> None:
    """Draw a text that can be selected and copied."""
    wide = imgui.get_content_region_avail().x
    size = imgui.calc_text_size(text, False, wide - 2 * look.scale if wrap else -1.0)
    flags = imgui.InputTextFlags_.read_only | (imgui.InputTextFlags_.word_wrap if wrap else 0)
    colours = {
        imgui.Col_.frame_bg: theme.colour(theme.palette.ground, 0.0),
        imgui.Col_.text: theme.colour(rgb),
    }
    var = imgui.StyleVar_
    with styled(
        colours,
        {var.frame_padding: ImVec2(0, 0), var.frame_border_size: 0.0, var.scrollbar_size: 4 * look.scale},
    ):
        imgui.input_text_multiline(f"##{label}", text, ImVec2(wide, size.y + 2), flags)


_MAGENTA = (1.0, 0.42, 1.0)  # over a black ring: the texels themselves are as the map has them
_RING = 14.0  # [units of scale 1] radius of the mark around the first texel


def ref_of(first: NotFinite) -> str:
    """Return the texture that it is in, as a map takes it."""
    return f"{first.path}:{first.output}"


def place_in(first: NotFinite, area: Area) -> tuple[float, float]:
    """Return where a map over an area shows the first texel, in the window's units, y from above."""
    x, y, wide, high = area
    across, up = first.size
    worst = max(across / wide, up / high)
    east = (first.texel[0] + 0.5 - across / 2) / worst + wide / 2
    north = (first.texel[1] + 0.5 - up / 2) / worst + high / 2
    return x + east, y + high - north


def draw_not_finite(watch: FiniteWatch, session: Session, tracing: Tracing, look: Theme, area: Area) -> None:
    """Draw the message in the picture's upper left corner; a click goes to the texture and back."""
    if not watch.non_finite:
        return
    first, shown = watch.non_finite[0], session.view.map
    ref = ref_of(first)
    shows = shown is not None and shown.ref == ref
    if shows:
        centre = ImVec2(*place_in(first, area))
        draw = imgui.get_background_draw_list()
        draw.add_circle(centre, _RING * look.scale, theme.packed((0, 0, 0), 0.8), 0, 4 * look.scale)
        draw.add_circle(centre, _RING * look.scale, theme.packed(_MAGENTA), 0, 2 * look.scale)
    margin = 14 * look.scale
    imgui.set_next_window_pos(ImVec2(area[0] + margin, area[1] + margin))
    widest = max(min(area[2] - 2 * margin, 460 * look.scale), 80.0)
    imgui.set_next_window_size_constraints(ImVec2(0, 0), ImVec2(widest, area[3]))
    ground = theme.colour(theme.palette.ground, 0.92)
    with window("not finite", OVERLAY, ground=ground, rounding=6 * look.scale):
        with wrapped(widest - 2 * imgui.get_style().window_padding.x):
            imgui.text_colored(theme.colour(theme.palette.not_finite), summary(watch.non_finite))
        imgui.set_item_tooltip("\n".join(map(str, watch.non_finite)))
        if shows:
            if button(tr("Back to the picture"), small=True):
                session.show(None)
            imgui.same_line()
        elif session.can_show(ref):
            if button(tr("Show it"), tr("That texture from above, those texels in magenta"), small=True):
                session.show(ref)
            imgui.same_line()
        if button(tr("Trace it"), tr("The line that first gives such a number"), small=True):
            tracing.trace_not_finite(first)

"""What lies over the picture: the tools that are on, a message while there is none, notices that fade."""

from __future__ import annotations

from operator import itemgetter
from typing import TYPE_CHECKING

from imgui_bundle import ImVec2, imgui

from playground.studio import theme
from playground.studio.bench import Workbench
from playground.studio.channels.channels import source_label
from playground.studio.compare.panel import draw_ab
from playground.studio.draw import Area, plate, plate_size
from playground.studio.drops import Drops, is_terrain
from playground.studio.inspect.inspector import Inspector
from playground.studio.inspect.panel import draw_values
from playground.studio.keyframes.panel import draw_timeline, height_of_timeline
from playground.studio.land.panel import draw_land
from playground.studio.language import numeral, tr, tr_label
from playground.studio.notices import Notices
from playground.studio.session import Session
from playground.studio.theme import Theme

if TYPE_CHECKING:
    import moderngl

_FADE = 1.0  # [s]
_PADDING = 9  # [units of scale 1] around a notice's text
PATIENCE = 0.3
"""[s] without a new picture after which the window says what is checked."""


def draw_waiting(text: str, area: Area) -> None:
    """Write a message in the middle of the picture, while there is none."""
    x, y, wide, high = area
    size = imgui.calc_text_size(text)
    position = ImVec2(x + (wide - size.x) / 2, y + (high - size.y) / 2)
    imgui.get_background_draw_list().add_text(position, theme.packed(theme.palette.dim), text)


def draw_checking(session: Session, look: Theme, area: Area) -> None:
    """Show what the sandbox checks, once it has taken longer than ``PATIENCE``."""
    checking = session.drafts.checking
    if checking is not None and checking[1] >= PATIENCE:
        margin = 14 * look.scale
        _plate(checking_text(*checking), (area[0] + margin, area[1] + margin), look, ink=theme.palette.warm)


def draw_behind(session: Session, look: Theme, area: Area) -> None:
    """Show how far the frames before the wanted one, or a source, have come, after ``PATIENCE``."""
    behind = session.catch_up.behind
    if behind is not None and session.catch_up.seconds >= PATIENCE:
        margin = 14 * look.scale
        text, low = behind_text(*behind, session.catch_up.source), (area[0] + margin, area[1] + margin)
        corner = _plate(text, low, look, ink=theme.palette.warm)
        if session.catch_up.source:
            _bar(behind[0] / behind[1], low[0], corner, look)


def _bar(fraction: float, left: float, corner: ImVec2, look: Theme) -> None:
    """Draw how much is done as a bar along the lower edge of a plate."""
    top, paint = corner.y - 3 * look.scale, imgui.get_foreground_draw_list()
    end = ImVec2(left + (corner.x - left) * fraction, corner.y)
    paint.add_rect_filled(ImVec2(left, top), end, theme.packed(theme.palette.warm))


def behind_text(done: int, total: int, source: str = "") -> str:
    """Return "computing frame 1,200 of 36,000 …", or of a source "making height … 34 %"."""
    if source:
        return tr("making {source} … {percent} %", source=source, percent=done * 100 // total)
    return tr("computing frame {done} of {total} …", done=numeral(done, ","), total=numeral(total, ","))


def checking_text(subject: str, seconds: float) -> str:
    """Return "checking terrain.glsl … 3 s"."""
    return tr("checking {subject} …", subject=subject) + (f" {int(seconds)} s" if seconds >= 1 else "")


def draw_notices(notices: Notices, look: Theme, area: Area) -> None:
    """Draw the notices in the upper right corner; each fades at its end."""
    x, y, wide, _ = area
    margin = 14 * look.scale
    room = max(min(wide - 2 * margin, 560 * look.scale) - 18 * look.scale, 80.0)
    top, gap = y + margin, 6 * look.scale
    for notice in reversed(notices.items):
        alpha = min(max(notice.until - notices.now(), 0.0) / _FADE, 1.0)
        size = plate_size(notice.text, _PADDING * look.scale, room)
        for left, bar_top, right, bar_low in _close_buttons():  # which a notice would cover for seconds
            if left < x + wide - margin and right > x + wide - margin - size.x:
                top = bar_low + gap if bar_top < top + size.y and bar_low > top else top
        corner = _plate(notice.text, (x + wide - margin, top), look, alpha=alpha, wrap=room, align=(1.0, 0.0))
        top = corner.y + gap


def _close_buttons() -> list[tuple[float, float, float, float]]:
    """List where the windows over the picture are closed, from the top: left, top, right, lower edge."""
    shown = [window for window in imgui.get_current_context().windows if window.was_active]
    bars = [window.title_bar_rect() for window in shown if window.has_close_button]
    return sorted(((b.max.x - b.get_height(), b.min.y, b.max.x, b.max.y) for b in bars), key=itemgetter(1))


def _plate(
    text: str,
    corner: tuple[float, float],
    look: Theme,
    *,
    ink: theme.Rgb | None = None,
    alpha: float = 1.0,
    wrap: float = -1.0,
    align: tuple[float, float] = (0.0, 0.0),
) -> ImVec2:
    return plate(
        imgui.get_foreground_draw_list(),
        text,
        corner,
        ink=theme.packed(ink or theme.palette.ink, alpha),
        ground=theme.packed(theme.palette.ground, 0.92 * alpha),
        padding=_PADDING * look.scale,
        rounding=6 * look.scale,
        wrap=wrap,
        align=align,
    )


def draw_inspection(
    bench: Workbench, picture: moderngl.Texture | None, look: Theme, area: Area, density: float
) -> None:
    """Draw all of it that is on; ``picture`` is what the session's last ``frame`` returned."""
    inspection = bench.inspection
    if picture is not None:
        inspection.compare.follow(picture)
    inspection.graph.end()
    below = height_of_timeline(bench.session, bench.interface, look)
    draw_land(bench.session, bench.walk, look, (*area[:3], area[3] - below))
    draw_ab(inspection.compare, bench.undo, look, area)
    draw_timeline(bench.undo, bench.interface, look, area)
    if picture is not None:
        _inspect(inspection.inspector, picture, look, area, density)
    inspection.update()


def _inspect(
    inspector: Inspector, picture: moderngl.Texture, look: Theme, area: Area, density: float
) -> None:
    if not inspector.on or imgui.get_io().want_capture_mouse:
        return
    inspector.inner = imgui.get_io().key_shift
    mouse = imgui.get_mouse_pos()
    across = int((mouse.x - area[0]) * density // 1)
    down = int((mouse.y - area[1]) * density // 1)
    report = inspector.at((across, picture.size[1] - 1 - down), picture)
    if report is not None:
        draw_values(report, look, area)


_DROPPED = "dropped"


def draw_drops(drops: Drops, look: Theme) -> None:
    """Draw the choice of what the dropped file that waits is for."""
    if drops.asks:
        drops.asks = False
        imgui.open_popup(_DROPPED)
    if not drops.waiting:
        return
    room = imgui.get_main_viewport().size
    imgui.set_next_window_pos(ImVec2(room.x / 2, room.y / 2), imgui.Cond_.always, ImVec2(0.5, 0.5))
    if not imgui.begin_popup(_DROPPED):
        drops.waiting = []  # a click outside closed it
        return
    with look.font(look.bold):
        imgui.text_unformatted(tr("Put {file} where?", file=drops.waiting[0].name))
    draft = drops.actions.session.shown
    if is_terrain(drops.waiting[0]) and imgui.selectable(tr("Into a sketch of its own"), False)[0]:
        drops.open()
    for taker in drops.channels(drops.waiting[0]) if drops.waiting else ():
        if imgui.selectable(f"{taker.channel.path}##channel {taker.channel.path}", False)[0]:
            drops.feed(taker)
            break
        if draft is not None:
            imgui.same_line(0, 2 * imgui.get_style().item_spacing.x)
            imgui.text_disabled(tr("now {value}", value=source_label(draft.base, taker.channel.source)))
    for path, parameter, now in drops.parameters(drops.waiting[0]) if drops.waiting else ():
        if imgui.selectable(f"{tr_label(parameter.title)}   {path}##{path}", False)[0]:
            drops.put(path)
            break
        if now:
            imgui.set_item_tooltip(tr("now {value}", value=now))
    imgui.end_popup()

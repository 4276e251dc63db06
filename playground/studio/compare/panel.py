"""A and B on the screen: painted, divided by a line that the mouse moves, with a bar of buttons."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imgui_bundle import ImVec2, imgui

from playground.studio import theme
from playground.studio.compare.compare import PERIOD, Compare, Mode
from playground.studio.draw import OVERLAY, Area, button, choose, window
from playground.studio.edits.undo import Undo
from playground.studio.language import tr
from playground.studio.picture.full_screen import Blend
from playground.studio.picture.gestures import GRAB_DISTANCE, divider_position
from playground.studio.theme import Theme
from playground.studio.widgets import slide

if TYPE_CHECKING:
    import moderngl


def paint_both(
    compare: Compare,
    second: moderngl.Texture,
    target: moderngl.Framebuffer,
    area: tuple[int, int, int, int],
    now: float,
) -> bool:
    """Paint A and B as they are shown; return whether there is an A."""
    first = compare.picture
    if first is None:
        return False
    if compare.blend is None or compare.blend.ctx is not compare.session.engine.ctx:
        compare.blend = Blend(compare.session.engine.ctx)
    split = compare.split
    if compare.mode is Mode.FLICKER:
        split = 1.0 if shows_first(now) else 0.0
    gain = compare.gain if compare.mode is Mode.DIFFERENCE else 0.0
    compare.blend.paint((first, second), target, area, split=split, gain=gain)
    return True


def shows_first(now: float) -> bool:
    """Return whether A is shown at a moment [s] of flickering."""
    return int(now / PERIOD) % 2 == 0


def drag_line(compare: Compare, area: Area) -> bool:
    """Move the line where the mouse holds it; return whether it does."""
    io = imgui.get_io()
    if not compare.on or compare.mode is not Mode.DIVIDER:
        compare.held = False
        return False
    across = io.mouse_pos.x - area[0]
    near = abs(across - compare.split * area[2]) <= GRAB_DISTANCE and not io.want_capture_mouse
    if not imgui.is_mouse_down(0):
        compare.held = False
    elif imgui.is_mouse_clicked(0) and near:
        compare.held = True
    if compare.held:
        compare.split = divider_position(across, area[2])
    if compare.held or near:
        imgui.set_mouse_cursor(imgui.MouseCursor_.resize_ew)
    return compare.held


def draw_ab(compare: Compare, undo: Undo, look: Theme, area: Area) -> None:
    """Draw the line, the letters and the bar."""
    if not compare.on:
        return
    x, y, wide, high = area
    scale = look.scale
    if compare.mode is Mode.DIVIDER:
        line = x + compare.split * wide
        draw = imgui.get_background_draw_list()
        draw.add_line(
            ImVec2(line, y), ImVec2(line, y + high), theme.packed(theme.palette.ink, 0.9), 1.5 * scale
        )
        middle = y + high / 2
        for letter, away in (("A", -18.0), ("B", 10.0)):
            position = ImVec2(line + away * scale, middle)
            draw.add_text(ImVec2(position.x + 1, position.y + 1), theme.packed((0.0, 0.0, 0.0)), letter)
            draw.add_text(position, theme.packed(theme.palette.ink), letter)
    margin = 12 * scale
    imgui.set_next_window_pos(ImVec2(x + margin, y + margin))
    with window("ab", OVERLAY, ground=theme.colour(theme.palette.ground, 0.9), rounding=8 * scale):
        _bar(compare, undo, look)


def below_bar(compare: Compare, look: Theme, area: Area) -> Area:
    """Return what the bar leaves free of an area."""
    taken = 52 * look.scale if compare.on else 0.0
    return area[0], area[1] + taken, area[2], max(area[3] - taken, 1.0)


def _bar(compare: Compare, undo: Undo, look: Theme) -> None:
    now = undo.notices.now()
    letters = {
        Mode.DIVIDER: "A | B",
        Mode.FLICKER: "A" if shows_first(now) else "B",
        Mode.DIFFERENCE: "A - B",
    }
    imgui.align_text_to_frame_padding()
    with look.font(look.bold):
        imgui.text_colored(theme.colour(theme.palette.warm), f"{letters[compare.mode]:5}")
    imgui.same_line()
    imgui.set_next_item_width(100 * look.scale)
    mode = choose("##how", tr(compare.mode.value), Mode, compare.mode, name=lambda m: tr(m.value))
    compare.mode = mode or compare.mode
    if compare.mode is Mode.DIFFERENCE:
        imgui.same_line()
        imgui.set_next_item_width(90 * look.scale)
        gain = slide("##gain", compare.gain, (1.0, 64.0), "x %.0f", logarithmic=True)
        compare.gain = compare.gain if gain is None else gain
    for label, note, act in (
        (tr("Swap"), tr("Go on from A; the current picture becomes A"), compare.swap),
        (tr("Back to A"), tr("Go on from A, which stays"), compare.back),
        (tr("Keep"), tr("The current picture becomes A"), compare.keep),
        (tr("End"), tr("Let A go (A)"), compare.end),
    ):
        imgui.same_line()
        if button(label, note):
            with undo.step(label):
                act()

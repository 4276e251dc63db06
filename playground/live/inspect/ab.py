"""A and B on the screen: painted, parted by a line that the mouse moves, with a bar of buttons."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imgui_bundle import ImVec2, imgui

from playground.live import theme
from playground.live.dividers import REACH, moved
from playground.live.overlay import Area
from playground.live.sliders import slide
from playground.live.theme import Theme
from playground.workbench.actions import Actions
from playground.workbench.inspect.blend import Beside
from playground.workbench.inspect.compare import PERIOD, Compare, Mode

if TYPE_CHECKING:
    import moderngl


def paint_both(
    compare: Compare,
    second: moderngl.Texture,
    target: moderngl.Framebuffer,
    area: tuple[int, int, int, int],
    now: float,
) -> bool:
    """Paint A and B as they are to be seen; say whether there is an A."""
    first = compare.picture
    if first is None:
        return False
    if compare.beside is None or compare.beside.ctx is not compare.session.engine.ctx:
        compare.beside = Beside(compare.session.engine.ctx)
    split = compare.split
    if compare.mode is Mode.FLICKER:
        split = 1.0 if shows_first(now) else 0.0
    gain = compare.gain if compare.mode is Mode.DIFFERENCE else 0.0
    compare.beside.paint((first, second), target, area, split=split, gain=gain)
    return True


def shows_first(now: float) -> bool:
    """Say whether A is seen at a moment [s] of flickering."""
    return int(now / PERIOD) % 2 == 0


def drag_line(compare: Compare, area: Area) -> bool:
    """Move the line where the mouse holds it; say whether it does."""
    io = imgui.get_io()
    if not compare.on or compare.mode is not Mode.DIVIDER:
        compare.held = False
        return False
    across = io.mouse_pos.x - area[0]
    near = abs(across - compare.split * area[2]) <= REACH and not io.want_capture_mouse
    if not imgui.is_mouse_down(0):
        compare.held = False
    elif imgui.is_mouse_clicked(0) and near:
        compare.held = True
    if compare.held:
        compare.split = moved(across, area[2])
    if compare.held or near:
        imgui.set_mouse_cursor(imgui.MouseCursor_.resize_ew)
    return compare.held


def draw_ab(actions: Actions, look: Theme, area: Area) -> None:
    """Draw the line, the letters and the bar."""
    compare = actions.see.compare
    if not compare.on:
        return
    x, y, wide, high = area
    scale = look.scale
    if compare.mode is Mode.DIVIDER:
        line = x + compare.split * wide
        draw = imgui.get_background_draw_list()
        draw.add_line(ImVec2(line, y), ImVec2(line, y + high), theme.packed(theme.INK, 0.9), 1.5 * scale)
        middle = y + high / 2
        for letter, beside in (("A", -18.0), ("B", 10.0)):
            place = ImVec2(line + beside * scale, middle)
            draw.add_text(ImVec2(place.x + 1, place.y + 1), theme.packed((0.0, 0.0, 0.0)), letter)
            draw.add_text(place, theme.packed(theme.INK), letter)
    margin = 12 * scale
    imgui.set_next_window_pos(ImVec2(x + margin, y + margin))
    flags = imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.no_move
    flags |= imgui.WindowFlags_.always_auto_resize | imgui.WindowFlags_.no_saved_settings
    flags |= imgui.WindowFlags_.no_focus_on_appearing | imgui.WindowFlags_.no_nav_inputs
    imgui.push_style_var(imgui.StyleVar_.window_rounding, 8 * scale)
    imgui.push_style_color(imgui.Col_.window_bg, theme.colour(theme.GROUND, 0.9))
    imgui.begin("ab", None, flags)
    _bar(actions, look)
    imgui.end()
    imgui.pop_style_color()
    imgui.pop_style_var()


def below_bar(actions: Actions, look: Theme, area: Area) -> Area:
    """Return what the bar leaves free of an area."""
    taken = 52 * look.scale if actions.see.compare.on else 0.0
    return area[0], area[1] + taken, area[2], max(area[3] - taken, 1.0)


def _bar(actions: Actions, look: Theme) -> None:
    compare, now = actions.see.compare, actions.now()
    letters = {
        Mode.DIVIDER: "A | B",
        Mode.FLICKER: "A" if shows_first(now) else "B",
        Mode.DIFFERENCE: "A - B",
    }
    imgui.align_text_to_frame_padding()
    with look.font(look.bold):
        imgui.text_colored(theme.colour(theme.WARM), f"{letters[compare.mode]:5}")
    imgui.same_line()
    imgui.set_next_item_width(100 * look.scale)
    if imgui.begin_combo("##how", compare.mode.value):
        for mode in Mode:
            if imgui.selectable(mode.value, mode is compare.mode)[0]:
                compare.mode = mode
        imgui.end_combo()
    if compare.mode is Mode.DIFFERENCE:
        imgui.same_line()
        imgui.set_next_item_width(90 * look.scale)
        gain = slide("##gain", compare.gain, (1.0, 64.0), "x %.0f", logarithmic=True)
        compare.gain = compare.gain if gain is None else gain
    for label, note, act in (
        ("Swap", "Go on from A; what is shown now becomes A", compare.swap),
        ("Back to A", "Go on from A, which stays", compare.back),
        ("Keep", "What is shown now becomes A", compare.keep),
        ("End", "Let A go (A)", compare.end),
    ):
        imgui.same_line()
        if imgui.button(label):
            actions.look_back(False)
            actions.history.call(label)
            act()
            actions.look_back(False)
            actions.history.call("")  # where nothing changed, the name is no later step's
        imgui.set_item_tooltip(note)

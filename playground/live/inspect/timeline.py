"""The bar of time under the picture of a sketch that moves."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from playground.live import theme
from playground.live.overlay import Area
from playground.live.theme import Theme
from playground.sketch.model import Sketch
from playground.workbench.actions import Actions
from playground.workbench.inspect.time_range import SPEEDS, marks_of, span_of

_HIGH = 40.0
_NEAR = 5.0  # a mark this near to the mouse is taken for the time meant


def height_of_timeline(actions: Actions, look: Theme) -> float:
    """Return how much of the picture it covers from below, in the window's units; 0 where there is none."""
    return _HIGH * look.scale if actions.session.animated and actions.panel_shown else 0.0


def draw_timeline(actions: Actions, look: Theme, area: Area) -> None:
    """Draw it, and do what the mouse says on it; ``area`` is the picture."""
    session, sketch = actions.session, actions.session.sketch
    high = height_of_timeline(actions, look)
    if sketch is None or not high:
        return
    x, y, wide, tall = area
    imgui.set_next_window_pos(ImVec2(x, y + tall - high))
    imgui.set_next_window_size(ImVec2(wide, high))
    flags = imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.no_move
    flags |= imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_focus_on_appearing
    flags |= imgui.WindowFlags_.no_nav_inputs | imgui.WindowFlags_.no_bring_to_front_on_focus
    imgui.push_style_color(imgui.Col_.window_bg, theme.colour(theme.GROUND, 0.82))
    imgui.push_style_var(imgui.StyleVar_.window_padding, ImVec2(10 * look.scale, 8 * look.scale))
    imgui.begin("timeline", None, flags)
    clock = session.clock
    if imgui.button("Pause" if clock.playing else "Play", ImVec2(58 * look.scale, 0)):
        clock.toggle()
    imgui.set_item_tooltip("Space")
    for label, frames, note in (("<", -1, "a frame back  ,"), (">", 1, "a frame on  .")):
        imgui.same_line(0, 4 * look.scale)
        if imgui.button(label):
            actions.step_time(frames)
        imgui.set_item_tooltip(note)
    imgui.same_line(0, 4 * look.scale)
    if imgui.button("To 0"):
        actions.rewind()
    imgui.same_line(0, 4 * look.scale)
    looping = clock.loop is not None
    if looping:
        imgui.push_style_color(imgui.Col_.button, theme.colour(theme.ACCENT, 0.5))
    if imgui.button("Loop"):
        actions.toggle_loop()
    if looping:
        imgui.pop_style_color()
    imgui.set_item_tooltip("Go round and round (L); Shift+drag on the bar chooses from when to when")
    imgui.same_line(0, 4 * look.scale)
    imgui.set_next_item_width(64 * look.scale)
    if imgui.begin_combo("##speed", f"{clock.speed:g} x", imgui.ComboFlags_.no_arrow_button):
        for speed in SPEEDS:
            if imgui.selectable(f"{speed:g} x", speed == clock.speed)[0]:
                clock.speed = speed
        imgui.end_combo()
    imgui.set_item_tooltip("Seconds of the sketch in a second")
    imgui.same_line(0, 4 * look.scale)
    imgui.set_next_item_width(84 * look.scale)
    changed, time = imgui.drag_float("##time", clock.time, 0.02, 0.0, 1e6, "%.2f s")
    if changed:
        actions.seek(time)
    imgui.set_item_tooltip("Drag, or Ctrl+click to type")
    imgui.same_line(0, 10 * look.scale)
    _bar(sketch, actions, look)
    imgui.end()
    imgui.pop_style_var()
    imgui.pop_style_color()


def _bar(sketch: Sketch, actions: Actions, look: Theme) -> None:
    clock, span, marks = actions.session.clock, span_of(sketch, actions.session.clock), marks_of(sketch)
    corner = imgui.get_cursor_screen_pos()
    wide, high = max(imgui.get_content_region_avail().x, 30.0), imgui.get_frame_height()
    imgui.invisible_button("##timeline", ImVec2(wide, high))
    mouse = imgui.get_io().mouse_pos.x

    def time_at(across: float) -> float:
        near = [mark for mark in marks if abs(mark / span * wide - across) <= _NEAR * look.scale]
        return near[0] if near else round(min(max(across / wide, 0.0), 1.0) * span, 3)

    if imgui.is_item_active():
        time = time_at(mouse - corner.x)
        if imgui.get_io().key_shift:
            start = mouse - imgui.get_mouse_drag_delta(0, 0.0).x
            clock.set_loop(time_at(start - corner.x), time)
        else:
            actions.seek(time)
    elif imgui.is_item_hovered():
        imgui.set_tooltip(f"{time_at(mouse - corner.x):.2f} s")
    draw = imgui.get_window_draw_list()
    middle, scale = corner.y + high / 2, look.scale

    def at(time: float) -> float:
        return corner.x + time / span * wide

    draw.add_rect_filled(
        ImVec2(corner.x, middle - 3 * scale),
        ImVec2(corner.x + wide, middle + 3 * scale),
        theme.packed(theme.RAISED),
        3 * scale,
    )
    if clock.loop is not None:
        low, top = (
            ImVec2(at(clock.loop[0]), middle - 6 * scale),
            ImVec2(at(clock.loop[1]), middle + 6 * scale),
        )
        draw.add_rect_filled(low, top, theme.packed(theme.ACCENT, 0.35), 2 * scale)
    for mark in marks:
        draw.add_ngon_filled(ImVec2(at(mark), middle), 5 * scale, theme.packed(theme.WARM), 4)
    now = at(min(clock.time, span))
    draw.add_line(ImVec2(now, corner.y), ImVec2(now, corner.y + high), theme.packed(theme.INK), 2 * scale)

"""Keyframes in the panel, a line each, and the bar of time under the picture of a sketch that moves."""

from __future__ import annotations

from dataclasses import dataclass, field

from imgui_bundle import ImVec2, imgui

from playground.sketch.keyframes import EASES
from playground.sketch.model import Sketch
from playground.studio import theme
from playground.studio.clock import SPEEDS, marks_of, span_of
from playground.studio.draw import QUIET, Area, button, choose, cross, header, pushed_id, slot, styled, window
from playground.studio.edits.undo import Undo
from playground.studio.interface import Interface
from playground.studio.keyframes.keyframe_edits import STEP, KeyframeEdits, summary
from playground.studio.language import numeral, shortcut, tr, tr_label
from playground.studio.panel.parameter_list import items_of
from playground.studio.session import Session
from playground.studio.theme import Theme


@dataclass
class KeyframeList:
    """What is chosen for the next keyframe."""

    camera: bool = True
    changed: bool = True  # every edited parameter
    paths: list[str] = field(default_factory=list)  # parameters besides

    def selected_paths(self, edits: KeyframeEdits) -> list[str]:
        """Return the parameters that the next keyframe takes."""
        return list(dict.fromkeys([*(edits.changed_paths if self.changed else []), *self.paths]))

    def draw(self, edits: KeyframeEdits, look: Theme) -> None:
        """Draw the list, folded unless there is a keyframe."""
        keyframes = edits.keyframes
        imgui.spacing()
        opened = header(
            f"{tr('Keyframes')}###keyframes", look, imgui.TreeNodeFlags_.default_open if keyframes else 0
        )
        if not opened:
            return
        with pushed_id("keyframes"):
            for index in range(len(keyframes)):
                with pushed_id(index):
                    changed = _line(index, edits)
                if changed:  # the list is another from here on
                    break
            self._adding(edits, look)

    def _adding(self, edits: KeyframeEdits, look: Theme) -> None:
        clock, draft = edits.session.clock, edits.session.shown
        _, self.camera = imgui.checkbox(tr("Camera"), self.camera)
        imgui.same_line()
        _, self.changed = imgui.checkbox(f"{tr('Changed values')} ({len(edits.changed_paths)})", self.changed)
        imgui.set_item_tooltip(tr("Every parameter that was edited"))
        imgui.set_next_item_width(-1)
        also = ", ".join(self.paths)
        if imgui.begin_combo("##also", tr("and {also}", also=also) if also else tr("and further parameters")):
            for path in items_of(draft):
                picked = path in self.paths
                if imgui.selectable(path, picked, imgui.SelectableFlags_.no_auto_close_popups)[0]:
                    (self.paths.remove if picked else self.paths.append)(path)
            imgui.end_combo()
        imgui.set_next_item_width(96 * look.scale)
        changed, time = imgui.drag_float("##now", clock.time, 0.05, 0.0, 1e6, "%.2f s")
        imgui.set_item_tooltip(tr("The time of the next keyframe, and of the picture"))
        if changed:
            clock.playing = False
            edits.undo.seek(time)
        imgui.same_line()
        if button(tr("Add keyframe here"), wide=-1):
            clock.playing = False
            edits.add_here(self.selected_paths(edits), camera=self.camera)


def _line(index: int, edits: KeyframeEdits) -> bool:
    """Draw a keyframe; return whether the list has changed."""
    keyframe, clock = edits.keyframes[index], edits.session.clock
    if imgui.radio_button("##go", abs(clock.time - keyframe.time) < STEP / 2):
        edits.undo.seek(keyframe.time)
        clock.playing = False
    imgui.set_item_tooltip(
        tr("Go to {time} s", time=numeral(keyframe.time)) + "\n" + tr("sets {what}", what=summary(keyframe))
    )
    imgui.same_line()
    rest = imgui.get_content_region_avail().x - slot() - 2 * imgui.get_style().item_spacing.x
    imgui.set_next_item_width(rest * 0.5)
    enter = imgui.InputTextFlags_.enter_returns_true
    entered, time = imgui.input_float("##time", keyframe.time, 0.0, 0.0, "%.2f s", enter)
    imgui.set_item_tooltip(tr("Its time; Enter moves it"))
    imgui.same_line()
    imgui.set_next_item_width(rest * 0.5)
    ease = choose("##ease", tr_label(keyframe.ease), EASES, keyframe.ease, name=tr_label)
    imgui.set_item_tooltip(tr("How values go from here to the next"))
    imgui.same_line()
    if cross(
        "##delete",
        tr("Delete the keyframe at {time} s", time=numeral(keyframe.time)),
        imgui.get_frame_height(),
    ):
        return edits.delete(index)
    if entered and time != keyframe.time:
        return edits.move(index, time)
    return ease is not None and ease != keyframe.ease and edits.set_ease(index, ease)


_HIGH = 40.0
_NO_ARROW = imgui.ComboFlags_.no_arrow_button.value
_NEAR = 5.0  # a mark this near to the mouse is taken for the time meant


def height_of_timeline(session: Session, interface: Interface, look: Theme) -> float:
    """Return how much of the picture it covers from below, in the window's units; 0 where there is none."""
    return _HIGH * look.scale if session.animated and interface.panel_shown else 0.0


def draw_timeline(undo: Undo, interface: Interface, look: Theme, area: Area) -> None:
    """Draw it, and do what the mouse says on it; ``area`` is the picture."""
    session, sketch = undo.session, undo.session.sketch
    high = height_of_timeline(session, interface, look)
    if sketch is None or not high:
        return
    x, y, wide, tall = area
    imgui.set_next_window_pos(ImVec2(x, y + tall - high))
    imgui.set_next_window_size(ImVec2(wide, high))
    flags = QUIET | imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.no_move
    flags |= imgui.WindowFlags_.no_focus_on_appearing | imgui.WindowFlags_.no_bring_to_front_on_focus
    padding = {imgui.StyleVar_.window_padding: ImVec2(10 * look.scale, 8 * look.scale)}
    with window("timeline", flags, ground=theme.colour(theme.palette.ground, 0.92), sizes=padding):
        _controls(undo, look)
        imgui.same_line(0, 10 * look.scale)
        _bar(sketch, undo, look)


def _controls(undo: Undo, look: Theme) -> None:
    clock, gap = undo.session.clock, 4 * look.scale
    if button(tr("Pause") if clock.playing else tr("Play"), shortcut("Space"), wide=58 * look.scale):
        clock.toggle()
    for label, frames, note in (("<", -1, f"{tr('a frame back')}  ,"), (">", 1, f"{tr('a frame on')}  .")):
        imgui.same_line(0, gap)
        if button(label, note):
            undo.step_time(frames)
    imgui.same_line(0, gap)
    if button(tr("To 0")):
        undo.seek(0.0)
    imgui.same_line(0, gap)
    with styled({imgui.Col_.button: theme.colour(theme.palette.accent, 0.5)} if clock.loop else {}):
        if button(f"{'●' if clock.loop else '○'} {tr('Loop')}###loop"):
            undo.toggle_loop()
    imgui.set_item_tooltip(tr("Repeat a span of time (L); Shift+drag on the bar chooses from when to when"))
    imgui.same_line(0, gap)
    imgui.set_next_item_width(64 * look.scale)
    shown = _times(clock.speed)
    clock.speed = choose("##speed", shown, SPEEDS, clock.speed, name=_times, flags=_NO_ARROW) or clock.speed
    imgui.set_item_tooltip(tr("Seconds of the sketch in a second"))
    imgui.same_line(0, gap)
    imgui.set_next_item_width(84 * look.scale)
    changed, time = imgui.drag_float("##time", clock.time, 0.02, 0.0, 1e6, "%.2f s")
    if changed:
        undo.seek(time)
    imgui.set_item_tooltip(tr("Drag, or Ctrl+click to type"))


def _times(speed: float) -> str:
    return f"{numeral(speed)} x"


def _bar(sketch: Sketch, undo: Undo, look: Theme) -> None:
    clock = undo.session.clock
    span, marks = span_of(sketch, clock), marks_of(sketch)
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
            undo.seek(time)
    elif imgui.is_item_hovered():
        imgui.set_tooltip(f"{numeral(time_at(mouse - corner.x), '.2f')} s")
    draw = imgui.get_window_draw_list()
    middle, scale = corner.y + high / 2, look.scale

    def at(time: float) -> float:
        return corner.x + time / span * wide

    draw.add_rect_filled(
        ImVec2(corner.x, middle - 3 * scale),
        ImVec2(corner.x + wide, middle + 3 * scale),
        theme.packed(theme.palette.raised),
        3 * scale,
    )
    if clock.loop is not None:
        low, top = (
            ImVec2(at(clock.loop[0]), middle - 6 * scale),
            ImVec2(at(clock.loop[1]), middle + 6 * scale),
        )
        draw.add_rect_filled(low, top, theme.packed(theme.palette.accent, 0.35), 2 * scale)
    for mark in marks:
        draw.add_ngon_filled(ImVec2(at(mark), middle), 5 * scale, theme.packed(theme.palette.warm), 4)
    now = at(min(clock.time, span))
    draw.add_line(
        ImVec2(now, corner.y), ImVec2(now, corner.y + high), theme.packed(theme.palette.ink), 2 * scale
    )

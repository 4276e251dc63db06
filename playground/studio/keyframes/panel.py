"""The keyframes in the panel: a line each, with its time, ease and end, and a button to add one here."""

from __future__ import annotations

from dataclasses import dataclass, field

from imgui_bundle import imgui

from playground.sketch.keyframes import EASES
from playground.studio.draw import button, choose, header, pushed_id
from playground.studio.keyframes.keyframe_edits import STEP, KeyframeEdits, summary
from playground.studio.panel.parameter_list import Listing
from playground.studio.panel.rows import cross, slot
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
        opened = header("Keyframes###keyframes", look, imgui.TreeNodeFlags_.default_open if keyframes else 0)
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
        _, self.camera = imgui.checkbox("Camera", self.camera)
        imgui.same_line()
        _, self.changed = imgui.checkbox(f"Changed values ({len(edits.changed_paths)})", self.changed)
        imgui.set_item_tooltip("Every parameter that was edited")
        imgui.set_next_item_width(-1)
        also = ", ".join(self.paths)
        if imgui.begin_combo("##also", f"and {also}" if also else "and further parameters"):
            for section in Listing().sections(draft) if draft is not None else ():
                for item in section.items:
                    picked = item.path in self.paths
                    if imgui.selectable(item.path, picked, imgui.SelectableFlags_.no_auto_close_popups)[0]:
                        (self.paths.remove if picked else self.paths.append)(item.path)
            imgui.end_combo()
        imgui.set_next_item_width(96 * look.scale)
        changed, time = imgui.drag_float("##now", clock.time, 0.05, 0.0, 1e6, "%.2f s")
        imgui.set_item_tooltip("The time of the next keyframe, and of the picture")
        if changed:
            clock.playing = False
            edits.undo.seek(time)
        imgui.same_line()
        if button("Add keyframe here", wide=-1):
            clock.playing = False
            edits.add_here(self.selected_paths(edits), camera=self.camera)


def _line(index: int, edits: KeyframeEdits) -> bool:
    """Draw a keyframe; return whether the list has changed."""
    keyframe, clock = edits.keyframes[index], edits.session.clock
    if imgui.radio_button("##go", abs(clock.time - keyframe.time) < STEP / 2):
        edits.undo.seek(keyframe.time)
        clock.playing = False
    imgui.set_item_tooltip(f"Go to {keyframe.time:g} s\nsets {summary(keyframe)}")
    imgui.same_line()
    rest = imgui.get_content_region_avail().x - slot() - 2 * imgui.get_style().item_spacing.x
    imgui.set_next_item_width(rest * 0.5)
    enter = imgui.InputTextFlags_.enter_returns_true
    entered, time = imgui.input_float("##time", keyframe.time, 0.0, 0.0, "%.2f s", enter)
    imgui.set_item_tooltip("Its time; Enter moves it")
    imgui.same_line()
    imgui.set_next_item_width(rest * 0.5)
    ease = choose("##ease", keyframe.ease, EASES, keyframe.ease)
    imgui.set_item_tooltip("How values go from here to the next")
    imgui.same_line()
    if cross("##delete", f"Delete the keyframe at {keyframe.time:g} s", imgui.get_frame_height()):
        return edits.delete(index)
    if entered and time != keyframe.time:
        return edits.move(index, time)
    return ease is not None and ease != keyframe.ease and edits.set_ease(index, ease)

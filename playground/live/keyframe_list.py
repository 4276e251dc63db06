"""The keyframes in the panel: a line each, with its time, ease and end, and a button to add one here."""

from __future__ import annotations

from dataclasses import dataclass, field

from imgui_bundle import ImVec2, imgui

from playground.live.panel_rows import cross, slot
from playground.live.theme import Theme
from playground.sketch.keyframes import EASES
from playground.workbench import keyframe_edits as keying
from playground.workbench.actions import Actions
from playground.workbench.parameter_list import Listing


@dataclass
class KeyframeList:
    """What is chosen for the next keyframe."""

    camera: bool = True
    changed: bool = True  # what is set by hand
    paths: list[str] = field(default_factory=list)  # parameters besides

    def wanted(self, actions: Actions) -> list[str]:
        """Return the parameters that the next keyframe takes."""
        found = keying.changed_paths(actions) if self.changed else []
        return list(dict.fromkeys([*found, *self.paths]))

    def draw(self, actions: Actions, look: Theme) -> None:
        """Draw the list, folded unless there is a keyframe."""
        known = keying.keyframes_of(actions)
        imgui.spacing()
        flags = imgui.TreeNodeFlags_.default_open if known else 0
        with look.font(look.bold):
            opened = imgui.collapsing_header("Keyframes###keyframes", flags)
        if not opened:
            return
        imgui.push_id("keyframes")
        for index in range(len(known)):
            imgui.push_id(index)
            drawn = self._line(index, actions)
            imgui.pop_id()
            if not drawn:  # the list is another from here on
                break
        self._adding(actions, look)
        imgui.pop_id()

    def _line(self, index: int, actions: Actions) -> bool:
        keyframe = keying.keyframes_of(actions)[index]
        here = abs(actions.session.clock.time - keyframe.time) < keying.STEP / 2
        if imgui.radio_button("##go", here):
            actions.seek(keyframe.time)
            actions.session.clock.playing = False
        imgui.set_item_tooltip(f"Go to {keyframe.time:g} s\nsets {keying.said(keyframe)}")
        imgui.same_line()
        rest = imgui.get_content_region_avail().x - slot() - 2 * imgui.get_style().item_spacing.x
        imgui.set_next_item_width(rest * 0.5)
        enter = imgui.InputTextFlags_.enter_returns_true
        entered, time = imgui.input_float("##time", keyframe.time, 0.0, 0.0, "%.2f s", enter)
        imgui.set_item_tooltip("Its time; Enter moves it")
        imgui.same_line()
        imgui.set_next_item_width(rest * 0.5)
        chosen = ""
        if imgui.begin_combo("##ease", keyframe.ease):
            for ease in EASES:
                if imgui.selectable(ease, ease == keyframe.ease)[0] and ease != keyframe.ease:
                    chosen = ease
            imgui.end_combo()
        imgui.set_item_tooltip("How values go from here to the next")
        imgui.same_line()
        if cross("##delete", f"Delete the keyframe at {keyframe.time:g} s", imgui.get_frame_height()):
            return not keying.delete(actions, index)
        if entered and time != keyframe.time:
            return not keying.move(actions, index, time)
        return not (chosen and keying.set_ease(actions, index, chosen))

    def _adding(self, actions: Actions, look: Theme) -> None:
        clock, count = actions.session.clock, len(keying.changed_paths(actions))
        _, self.camera = imgui.checkbox("Camera", self.camera)
        imgui.same_line()
        _, self.changed = imgui.checkbox(f"Changed values ({count})", self.changed)
        imgui.set_item_tooltip("Every parameter that is set by hand")
        draft = actions.session.shown
        imgui.set_next_item_width(-1)
        also = ", ".join(self.paths)
        if imgui.begin_combo("##also", f"and {also}" if also else "and further parameters"):
            for section in Listing().sections(draft) if draft is not None else ():
                for item in section.items:
                    picked = item.path in self.paths
                    flags = imgui.SelectableFlags_.no_auto_close_popups
                    if imgui.selectable(item.path, picked, flags)[0]:
                        (self.paths.remove if picked else self.paths.append)(item.path)
            imgui.end_combo()
        imgui.set_next_item_width(96 * look.scale)
        changed, time = imgui.drag_float("##now", clock.time, 0.05, 0.0, 1e6, "%.2f s")
        imgui.set_item_tooltip("The time of the next keyframe, and of the picture")
        if changed:
            clock.playing = False
            actions.seek(time)
        imgui.same_line()
        if imgui.button("Add keyframe here", ImVec2(-1, 0)):
            clock.playing = False
            keying.add_here(actions, self.wanted(actions), camera=self.camera)

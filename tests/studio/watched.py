"""Where each widget of a window is drawn, by its label: what a tour of the window clicks on.

``python watched.py PLACES WORDS…`` runs the command line with WORDS, and writes after each frame to the file
PLACES, as JSON. ``places``: label → x, y, width, height of what is in sight. ``cut``: labels of buttons,
boxes and menu items whose words do not fit into their pane.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from imgui_bundle import imgui

WORDED = ("button", "small_button", "menu_item_simple", "selectable", "checkbox", "radio_button")
"""Widgets that are as wide as their words."""
WIDGETS = (
    *WORDED,
    "begin_combo",
    "text_link",
    "begin_tab_item",
    "tab_item_button",
    "input_text_with_hint",
    "input_text",
    "input_int",
    "input_double",
    "input_float",
    "invisible_button",
    "drag_float",
    "drag_int",
    "slider_float",
    "slider_int",
    "tree_node_ex",
    "collapsing_header",
)


_GROWS = 5
"""Frames that a popup takes at most until it is as wide as what is in it."""


class Places:
    """What was drawn since the last frame was written."""

    def __init__(self, path: Path) -> None:
        self.path, self.partial = path, path.with_suffix(".part")
        self.places: dict[str, tuple[float, ...]] = {}
        self.cut: Counter[str] = Counter()
        self._written = ""
        for name in WIDGETS:
            setattr(imgui, name, self._watched(getattr(imgui, name), is_worded=name in WORDED))
        imgui.render = self._writing(imgui.render)

    def _watched(self, draw: Callable[..., Any], *, is_worded: bool) -> Callable[..., Any]:
        def watched(label: str, *rest: Any, **named: Any) -> Any:
            # A child or popup that opens in the call would have other items: they have other functions.
            answer = draw(label, *rest, **named)
            if imgui.is_item_visible():
                low, size = imgui.get_item_rect_min(), imgui.get_item_rect_size()
                self.places[label] = low.x, low.y, size.x, size.y
                right = imgui.get_window_draw_list().get_clip_rect_max().x
                words = imgui.calc_text_size(label.partition("##")[0]).x
                if is_worded and low.x + words > right + 1:
                    self.cut[label] += 1  # a popup that opens takes a few frames to grow
            return answer

        return watched

    def _writing(self, render: Callable[[], None]) -> Callable[[], None]:
        def written() -> None:
            render()
            text = json.dumps(
                {"places": self.places, "cut": [name for name, count in self.cut.items() if count > _GROWS]}
            )
            if text != self._written:
                self.partial.write_text(text, encoding="utf-8")
                self.partial.replace(self.path)
                self._written = text
            self.places.clear()

        return written


if __name__ == "__main__":
    Places(Path(sys.argv[1]))
    from playground import cli

    sys.exit(cli.main(sys.argv[2:]))

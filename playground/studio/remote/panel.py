"""The lines on MIDI in a parameter's menu: what sets it, to learn another, to forget it."""

from __future__ import annotations

from imgui_bundle import imgui

from playground.shader.parameter import part_names
from playground.studio.language import tr
from playground.studio.panel.parameter_list import Item
from playground.studio.remote.controllers import Controllers


def draw_controllers(controllers: Controllers, item: Item) -> None:
    """Draw what a parameter's menu says of MIDI controllers."""
    bound = controllers.of(item.path)
    imgui.separator()
    for binding in bound:
        imgui.text_disabled(f"MIDI {binding.source}{': ' + binding.part if binding.part else ''}")
    for part in part_names(item.parameter) or ("",):
        if imgui.menu_item_simple(tr("Learn MIDI") + (f": {part}" if part else ""), tr("move a knob")):
            controllers.learn(item.path, part)
    if controllers.learning is not None and imgui.menu_item_simple(tr("Stop learning MIDI")):
        controllers.cancel()
    if bound and imgui.menu_item_simple(tr("Unlearn MIDI")):
        controllers.unlearn(item.path)

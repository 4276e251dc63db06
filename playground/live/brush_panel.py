"""The brush in the panel: which layer it paints, how wide, how strongly; strokes undone."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from imgui_bundle import imgui

from playground.live.draw import buttons, choose
from playground.live.panel_rows import row
from playground.live.sliders import slide
from playground.workbench.brush import ERASER
from playground.workbench.painting import NARROWEST, WIDEST, Painting

_LAYERS = {0: "the first", 1: "the second", 2: "the third", 3: "the fourth", ERASER: "none: erase"}


def draw_paintbox(painting: Painting) -> None:
    """Draw the brush's controls, where the sketch has a mask to paint on."""
    if not painting.target:
        return
    imgui.set_next_item_open(painting.on)
    opened = imgui.collapsing_header("Paint###paint")
    imgui.set_item_tooltip(f"Paint on {painting.target} with the left button (B)")
    if opened != painting.on:
        painting.toggle()
    if not opened or not painting.on:
        return
    brush = painting.brush
    with row("Layer", "The layer that the brush puts on; erased, the rules show again", fixed=True):
        layer = choose("##layer", _LAYERS[brush.layer], _LAYERS, brush.layer, name=_LAYERS.__getitem__)
        if layer is not None:
            brush = replace(brush, layer=layer)
    widths = NARROWEST * painting.side, WIDEST * painting.side
    for name, note, ends, form in (
        ("radius", "The brush's, on the ground", widths, "%.0f m"),
        ("strength", "How much of what was there one pass over a place covers", (0.01, 1.0), "%.2f"),
        ("softness", "The share of the radius over which the brush fades", (0.0, 1.0), "%.2f"),
    ):
        with row(name.capitalize(), note, fixed=True):
            value = slide(f"##{name}", getattr(brush, name), ends, form, logarithmic=name == "radius")
        if value is not None:
            changed: dict[str, Any] = {name: value}
            brush = replace(brush, **changed)
    painting.brush = brush
    canvas = painting.canvas
    undoes, redoes = (canvas.can_undo, canvas.can_redo) if canvas is not None else (False, False)
    buttons(
        ("Undo stroke", "Ctrl+Z, while painting", painting.undo, undoes),
        ("Redo stroke", "Ctrl+Shift+Z or Ctrl+Y, while painting", painting.redo, redoes),
        ("Clear", "Remove all paint; that can be undone", painting.clear, True),
    )
    if canvas is not None:
        imgui.text_disabled(canvas.path.name)
        imgui.set_item_tooltip(str(canvas.path))

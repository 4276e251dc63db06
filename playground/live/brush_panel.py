"""The brush in the panel: which layer it paints, how wide, how strongly; strokes taken back."""

from __future__ import annotations

from dataclasses import replace

from imgui_bundle import imgui

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
        if imgui.begin_combo("##layer", _LAYERS[brush.layer]):
            for layer, name in _LAYERS.items():
                if imgui.selectable(name, brush.layer == layer)[0]:
                    brush = replace(brush, layer=layer)
            imgui.end_combo()
    side = painting.side
    with row("Radius", "The brush's, on the ground", fixed=True):
        ends = NARROWEST * side, WIDEST * side
        radius = slide("##radius", brush.radius, ends, "%.0f m", logarithmic=True)
        if radius is not None:
            brush = replace(brush, radius=radius)
    with row("Strength", "How much of what was there one pass over a place covers", fixed=True):
        strength = slide("##strength", brush.strength, (0.01, 1.0), "%.2f")
        if strength is not None:
            brush = replace(brush, strength=strength)
    with row("Softness", "The share of the radius over which the brush fades", fixed=True):
        softness = slide("##softness", brush.softness, (0.0, 1.0), "%.2f")
        if softness is not None:
            brush = replace(brush, softness=softness)
    painting.brush = brush
    canvas = painting.canvas
    imgui.begin_disabled(canvas is None or not canvas.can_undo)
    if imgui.button("Undo stroke"):
        painting.undo()
    imgui.end_disabled()
    imgui.set_item_tooltip("Ctrl+Z, while the brush is in the hand")
    imgui.same_line()
    imgui.begin_disabled(canvas is None or not canvas.can_redo)
    if imgui.button("Redo stroke"):
        painting.redo()
    imgui.end_disabled()
    imgui.set_item_tooltip("Ctrl+Shift+Z or Ctrl+Y, while the brush is in the hand")
    imgui.same_line()
    if imgui.button("Clear"):
        painting.clear()
    imgui.set_item_tooltip("Take all paint away; that can be undone")
    if canvas is not None:
        imgui.text_disabled(canvas.path.name)
        imgui.set_item_tooltip(str(canvas.path))

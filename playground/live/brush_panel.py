"""The brush in the panel: which layer it paints, how wide, how strongly; strokes undone."""

from __future__ import annotations

from dataclasses import replace

from imgui_bundle import imgui

from playground.live.draw import button, choose
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
    undoes, redoes = (canvas.can_undo, canvas.can_redo) if canvas is not None else (False, False)
    if button("Undo stroke", "Ctrl+Z, while painting", enabled=undoes):
        painting.undo()
    imgui.same_line()
    if button("Redo stroke", "Ctrl+Shift+Z or Ctrl+Y, while painting", enabled=redoes):
        painting.redo()
    imgui.same_line()
    if button("Clear", "Remove all paint; that can be undone"):
        painting.clear()
    if canvas is not None:
        imgui.text_disabled(canvas.path.name)
        imgui.set_item_tooltip(str(canvas.path))

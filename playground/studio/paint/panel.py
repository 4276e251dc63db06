"""The brush in the panel: what it paints on, its layer or tool, how wide, how strongly; strokes undone."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from imgui_bundle import ImVec2, imgui

from playground.studio.draw import buttons, choose, header, row
from playground.studio.language import numeral, shortcut, tr, tr_label
from playground.studio.paint.brush import ERASER, TOOLS, Brush
from playground.studio.paint.painting import MAX_RADIUS, MIN_RADIUS, Painting
from playground.studio.theme import Theme
from playground.studio.widgets import slide

_CHANNELS = {0: "the first", 1: "the second", 2: "the third", 3: "the fourth", ERASER: "none: erase"}


def draw_paintbox(painting: Painting, look: Theme) -> None:
    """Draw the brush's controls, where the sketch has a mask to paint on."""
    if not painting.target:
        return
    fits = imgui.ChildFlags_.auto_resize_y | imgui.ChildFlags_.nav_flattened
    imgui.begin_child("paint", ImVec2(0, 0), fits)  # in which a header is as wide as what is below it
    _draw_controls(painting, look)
    imgui.end_child()


def _draw_controls(painting: Painting, look: Theme) -> None:
    imgui.set_next_item_open(painting.on)
    opened = header(f"{tr('Paint')}###paint", look)
    imgui.set_item_tooltip(tr("Paint on {target} with the left button (B)", target=painting.target))
    if opened != painting.on:
        painting.toggle()
    if not opened or not painting.on:
        return
    if len(painting.targets) > 1:
        with row(tr("On"), tr("What the brush paints on"), fixed=True):
            target = choose("##target", painting.target, painting.targets, painting.target, name=str)
            if target is not None:
                painting.choose(target)
    brush = _with_tool(painting) if painting.sculpts else _with_channel(painting.brush)
    widths = MIN_RADIUS * painting.side, MAX_RADIUS * painting.side
    for name, note, ends, form in (
        ("radius", tr("The brush's, on the ground"), widths, "%.0f m"),
        ("strength", _strength(painting), (0.01, 1.0), "%.2f"),
        ("softness", tr("The fraction of the radius over which the brush fades"), (0.0, 1.0), "%.2f"),
    ):
        with row(tr_label(name.capitalize()), note, fixed=True):
            value = slide(f"##{name}", getattr(brush, name), ends, form, logarithmic=name == "radius")
        if value is not None:
            changed: dict[str, Any] = {name: value}
            brush = replace(brush, **changed)
    painting.brush = brush
    layer = painting.layer
    undoes, redoes = (layer.can_undo, layer.can_redo) if layer is not None else (False, False)
    buttons(
        (tr("Undo stroke"), tr("{keys}, while painting", keys=shortcut("Ctrl+Z")), painting.undo, undoes),
        (
            tr("Redo stroke"),
            tr("{keys}, while painting", keys=shortcut("Ctrl+Shift+Z, Ctrl+Y")),
            painting.redo,
            redoes,
        ),
        (tr("Clear"), tr("Remove all paint; that can be undone"), painting.clear, True),
    )
    if layer is not None:
        imgui.text_disabled(layer.path.name)
        imgui.set_item_tooltip(str(layer.path))


def _with_channel(brush: Brush) -> Brush:
    """Draw the choice of a mask's channel; return the brush as it is chosen."""
    with row(tr("Layer"), tr("The layer that the brush puts on; erased, the rules show again"), fixed=True):
        channel = choose(
            "##layer",
            tr(_CHANNELS[brush.channel]),
            _CHANNELS,
            brush.channel,
            name=lambda channel: tr(_CHANNELS[channel]),
        )
    return brush if channel is None else replace(brush, channel=channel)


def _with_tool(painting: Painting) -> Brush:
    """Draw the choice of a tool, and what flatten goes to; return the brush as it is chosen."""
    brush = painting.brush
    with row(
        tr("Tool"),
        tr("What the brush does while the button is down (1 to {len})", len=len(TOOLS)),
        fixed=True,
    ):
        tool = choose("##tool", tr(brush.tool), painting.tools, brush.tool, name=tr)
    if tool is not None:
        brush = replace(brush, tool=tool)
    if brush.tool == "erode":
        with row(
            tr("Technique"),
            tr("What erodes while the button is down; erode(…) in its file names it"),
            fixed=True,
        ):
            imgui.text_disabled(painting.erodes_by)
    if brush.tool != "flatten":
        return brush
    note = tr("Flatten to the height where each stroke begins, or to the level below")
    with row(tr("Stated level"), note, fixed=True):
        clicked, stated = imgui.checkbox("##stated", brush.level is not None)
    if clicked:
        brush = replace(brush, level=sum(painting.levels) / 2 if stated else None)
    if brush.level is not None:
        with row(tr("Level"), tr("What flatten goes to: above height 0"), fixed=True):
            level = slide("##level", brush.level, painting.levels, "%.5g")
        brush = brush if level is None else replace(brush, level=level)
    return brush


def _strength(painting: Painting) -> str:
    """Return what the brush's strength means for what it paints on."""
    if not painting.sculpts:
        return tr("How much of what was there one step of a stroke covers")
    return tr(
        "Of the tool, while the button is down; raise and lower: {rate} a second",
        rate=numeral(painting.rate, ".3g"),
    )

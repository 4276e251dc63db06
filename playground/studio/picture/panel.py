"""Name the parts of a picture that lines part: by the pass that each part shows, and its method.

A view whose dividing kernel has ``divider`` parameters puts one picture between each two lines.
Which pass makes a part is what the part's own inputs are wired to: of inputs that all parts
share nothing is shown. Only the window writes the names over the picture; in a shot, or a
picture that is saved, there is nothing but the picture.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from imgui_bundle import ImVec2, imgui

from playground.shader.parameter import label_of
from playground.sketch.assign import values_of
from playground.sketch.model import Graph, Kernel, PassSpec, Sketch
from playground.studio import theme
from playground.studio.draw import Area
from playground.studio.language import tr, tr_label
from playground.studio.theme import Theme

_MIN_WIDTH = 48.0  # [units of scale 1] a part that is narrower has no room for a name
_MAX_WIDTH = 260.0


@dataclass(frozen=True)
class PictureRegion:
    """One picture between two lines, or the whole where they are blended."""

    start: float  # fraction of the picture's width from its left
    end: float
    name: str
    method: str


def parts_of(sketch: Sketch) -> list[PictureRegion]:
    """Return the parts of a sketch's picture, from the left; none where no line parts it."""
    view = sketch.graph.find("view")
    if view is None or not isinstance(view.technique, Graph):
        return []
    divide = next((spec for spec in view.technique.passes if _dividers(spec)), None)
    if divide is None:
        return []
    names, methods = _named(sketch, view, view.technique, divide)
    if not names:
        return []
    values = values_of(sketch)
    if any(values[f"view.{divide.name}.{menu}"] != 0 for menu in _menus(divide)):
        return [PictureRegion(0.0, 1.0, tr(" against ").join(names), "")]
    lines = [0.0]
    for name in _dividers(divide):
        value = values[f"view.{divide.name}.{name}"]
        assert isinstance(value, int | float)
        lines.append(min(max(float(value), lines[-1]), 1.0))
    spans = pairwise([*lines, 1.0])
    return [
        PictureRegion(*span, name, method) for span, name, method in zip(spans, names, methods, strict=True)
    ]


def _dividers(spec: PassSpec) -> list[str]:
    kernel = spec.technique
    if not isinstance(kernel, Kernel):
        return []
    names = [p.name for p in kernel.parameters if p.widget.kind == "divider"]
    return names if names and len(kernel.inputs) == len(names) + 1 else []


def _menus(spec: PassSpec) -> list[str]:
    """Return the dividing kernel's menus: any choice but the first blends the pictures."""
    assert isinstance(spec.technique, Kernel)
    return [p.name for p in spec.technique.parameters if p.widget.kind == "menu"]


def _named(sketch: Sketch, view: PassSpec, graph: Graph, divide: PassSpec) -> tuple[list[str], list[str]]:
    """Return the names of the passes that the parts show, and their methods; nothing where all show one."""
    assert isinstance(divide.technique, Kernel)
    wired, own = dict(divide.inputs), []
    for texture in divide.technique.inputs:
        inner = wired.get(texture.name, texture.name).partition(":")[0]
        own.append(_own_sources(view, graph, inner))
    shared = set.intersection(*(set(sources) for sources in own))
    differing = [name for name in own[0] if name in shared and len({sources[name] for sources in own}) > 1]
    if not differing:
        return [], []
    names = [
        tr(" and ").join(tr_label(label_of(sources[name].partition(".")[0])) for name in differing)
        for sources in own
    ]
    return names, _methods(sketch, [sources[differing[0]] for sources in own], differing[0])


def _own_sources(view: PassSpec, graph: Graph, inner: str) -> dict[str, str]:
    """Return what a pass inside the view reads through inputs of its own, by their names inside."""
    outside, sources = dict(view.inputs), {}
    for export in graph.inputs:
        ends = [target.partition(".") for target in export.targets]
        if len(ends) == 1 and ends[0][0] == inner:
            sources[ends[0][2]] = outside.get(export.name, export.name).partition(":")[0]
    return sources


def _methods(sketch: Sketch, sources: list[str], texture: str) -> list[str]:
    """Return the titles of the techniques that tell the parts apart.

    Where all parts go through one technique, as a filter, it is what is before it that differs.
    """
    chains = [_titles(sketch, source, texture) for source in sources]
    for titles in zip(*chains, strict=False):
        if len(set(titles)) == len(titles):
            return list(titles)
    return [chain[0] if chain else "" for chain in chains]


def _titles(sketch: Sketch, source: str, texture: str) -> list[str]:
    """Return the title of the pass that makes a texture, and of each that it goes on from."""
    titles: list[str] = []
    spec = sketch.graph.find(source.partition(".")[0])
    while spec is not None and len(titles) < len(sketch.graph.passes):
        titles.append(tr_label(spec.technique.title))
        before = dict(spec.inputs).get(texture, "")
        spec = sketch.graph.find(before.partition(":")[0].partition(".")[0]) if before else None
    return titles


def draw_part_labels(sketch: Sketch, look: Theme, area: Area) -> None:
    """Write the names of the parts over a picture that fills ``area``, each in the middle of its own."""
    x, y, wide, _ = area
    margin, padding = 12 * look.scale, 7 * look.scale
    draw = imgui.get_background_draw_list()
    for part in parts_of(sketch):
        room = (part.end - part.start) * wide - 2 * margin
        if room < _MIN_WIDTH * look.scale:
            continue
        room = min(room, _MAX_WIDTH * look.scale) - 2 * padding
        lines = [
            (part.name, look.bold, theme.TEXT_SIZE, theme.palette.ink),
            (part.method, look.text, theme.SMALL, theme.palette.dim),
        ]
        sizes = []
        for text, font, size, _ in lines:
            with look.font(font, size):
                sizes.append(imgui.calc_text_size(text, False, room) if text else ImVec2(0, 0))
        across, high = max(size.x for size in sizes), sum(size.y for size in sizes)
        left = x + (part.start + part.end) / 2 * wide - across / 2 - padding
        low, corner = (
            ImVec2(left, y + margin),
            ImVec2(left + across + 2 * padding, y + margin + high + 2 * padding),
        )
        draw.add_rect_filled(low, corner, theme.packed(theme.palette.ground, 0.85), 6 * look.scale)
        top = low.y + padding
        for (text, font, size, ink), extent in zip(lines, sizes, strict=True):
            if text:
                position, points = ImVec2(low.x + padding, top), size * look.scale
                draw.add_text(font, points, position, theme.packed(ink), text, room)
            top += extent.y

"""Resolve the textures that an export is made of, and what they hold."""

from __future__ import annotations

from playground.engine.plan import Plan, view_height
from playground.errors import SketchError
from playground.publish.extensions import COLOUR, HEIGHT, NUMBERS


def height_of(plan: Plan) -> str:
    """Return the heights that the picture shows; raise ``SketchError`` where there are none."""
    height = view_height(plan)
    if not height:
        there = ", ".join(spec.name for spec in plan.sketch.graph.passes if spec.name != "view")
        hint = f"; its textures are {there}" if there else ""
        raise SketchError(f"sketch {plan.sketch.name} has no height to export{hint}")
    return height


def kind_of(plan: Plan, texture: str) -> str:
    """Return what a texture holds, by the name of the output and, if it is not named, of the pass."""
    for name in _names(plan, texture):
        if name == HEIGHT:
            return HEIGHT
        if name in (COLOUR, "light"):
            return COLOUR
    return NUMBERS


def is_light(plan: Plan, texture: str) -> bool:
    """Return whether a texture holds light, by the same names."""
    return next((name for name in _names(plan, texture) if name in (HEIGHT, COLOUR, "light")), "") == "light"


def _names(plan: Plan, texture: str) -> list[str]:
    path, _, output = texture.partition(":")
    last = path.rpartition(".")[2]
    outputs = plan.flat.outputs[path]
    return [output] if output else [last, last if last in outputs else next(iter(outputs))]

"""Find the textures that an export is made of, and tell what they hold."""

from __future__ import annotations

from playground.capture.endings import COLOUR, HEIGHT, NUMBERS
from playground.engine.plan import Plan
from playground.errors import SketchError
from playground.sketch.flatten import Ref, leaves_of


def height_of(plan: Plan) -> str:
    """Return the heights that the picture shows; raise ``SketchError`` where there are none."""
    found = seen(plan, "height")
    if not found:
        there = ", ".join(spec.name for spec in plan.sketch.graph.passes if spec.name != "view")
        hint = f"; its textures are {there}" if there else ""
        raise SketchError(f"sketch {plan.sketch.name} has no height to export{hint}")
    return found


def seen(plan: Plan, name: str) -> str:
    """Return the texture that the picture shows as ``height``, ``colour`` or ``light``; "" if there is none.

    It is what the view is wired to, else what an unwired input of that name would take.
    """
    flat = plan.flat
    wired = flat.wires.get("view", {}).get(name)
    for leaf in leaves_of(flat.nodes):
        if leaf.path == "view":
            wired = dict(leaf.inputs).get(name, wired)
    if isinstance(wired, Ref):
        named = [
            f"{path}:{output}"
            for path, outputs in sorted(flat.outputs.items(), key=lambda item: item[0].count("."))
            for output, ref in outputs.items()
            if ref == wired
        ]
        return named[0]
    passes = [spec.name for spec in reversed(plan.sketch.graph.passes) if spec.name != "view"]
    for path in passes:
        if path == name:
            return f"{path}:{name}" if name in flat.outputs[path] else path
    return next((f"{path}:{name}" for path in passes if name in flat.outputs[path]), "")


def kind_of(plan: Plan, texture: str) -> str:
    """Return what a texture holds, told by the names of the output and, if it is not named, of the pass."""
    path, _, output = texture.partition(":")
    last = path.rpartition(".")[2]
    outputs = plan.flat.outputs[path]
    names = [output] if output else [last, last if last in outputs else next(iter(outputs))]
    for name in names:
        if name == HEIGHT:
            return HEIGHT
        if name in (COLOUR, "light"):
            return COLOUR
    return NUMBERS

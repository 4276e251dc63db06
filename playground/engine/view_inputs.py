"""Report which textures the picture shows: the view's height, its colour, its light."""

from __future__ import annotations

from playground.engine.plan import Plan
from playground.sketch.flat import Ref, leaves_of
from playground.sketch.wiring import input_names


def view_input(plan: Plan, name: str) -> str:
    """Return the texture that the view takes as its input ``name``; "" if there is none.

    It is what the view is wired to, else what an unwired input of that name would take. A view
    that has no such input shows none of that name, but a pass that is named so is returned.
    """
    flat = plan.flat
    view = plan.sketch.graph.passes[-1]
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
    if name in passes:
        return f"{name}:{name}" if name in flat.outputs[name] else name
    if view.name == "view" and name not in input_names(view.technique):
        return ""
    return next((f"{path}:{name}" for path in passes if name in flat.outputs[path]), "")


def view_height(plan: Plan) -> str:
    """Return the terrain's heights: those that the view shows, else the latest there are; "" without any."""
    found = view_input(plan, "height")
    passes = [spec.name for spec in reversed(plan.sketch.graph.passes) if spec.name != "view"]
    return found or next((f"{path}:height" for path in passes if "height" in plan.flat.outputs[path]), "")

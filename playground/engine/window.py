"""Draw a part of a picture so that it is what the whole picture would show there.

A picture may be larger than any texture. Its passes that have a texel for each pixel then
run for a window of it at a time: they get the size of the whole and where the window
lies, and everything else, the terrain, its light, is made once and stays. The camera is that
of the whole picture, and so are a draw's clip space and its viewport, clipped to the window.

What reads such a texture anywhere but at its own texel cannot be drawn in parts, and a message says so, and
which parameter switches it off if one does: a kernel that runs no step hands on what it begins with, part by
part. ``shader.window_text`` changes a kernel's text for that.
"""

from __future__ import annotations

from dataclasses import replace

from playground.engine.plan import LoopStep, Plan, PlanNode, Step, Window, sources_of, walk
from playground.errors import SketchError
from playground.shader.expressions import names_in
from playground.shader.window_text import for_window
from playground.sketch.flat import Ref
from playground.sketch.model import ComputeVariant, CpuSource, PlainCompute, TexelKernel


def windowed(plan: Plan, other: Plan, window: Window) -> Plan:
    """Return a plan whose passes with a texel for each pixel run for one window of the picture.

    ``plan`` is that of the whole picture, ``other`` that of the same sketch in a picture of
    another width and height: what is as large as the picture in both belongs to its pixels.
    Raises ``SketchError`` at a pass that cannot be drawn in parts.
    """
    sizes = {step.path: step.size for step in other.walk()}
    of_pixels = {
        step.path
        for step in plan.walk()
        if step.size == plan.frame_size and sizes.get(step.path) == other.frame_size
    }
    nodes = tuple(_in_window(node, of_pixels, window) for node in plan.nodes)
    return replace(plan, nodes=nodes)


def _in_window(node: PlanNode, of_pixels: set[str], window: Window) -> PlanNode:
    inside = [step.path for step in walk((node,)) if step.path in of_pixels]
    if isinstance(node, LoopStep):
        if inside or _read(node, of_pixels):
            raise _refused(node, "it repeats")
        return node
    read = _read(node, of_pixels)
    if isinstance(node.kernel, TexelKernel) and not node.repeat:  # it hands on what it begins with, or zeros
        return replace(node, size=window.size, window=window) if inside else node
    if not inside:
        if read:
            raise _refused(node, f"it reads '{read[0]}', whose size is another", _switch(node))
        return node
    if isinstance(node.kernel, CpuSource | ComputeVariant | PlainCompute):
        raise _refused(node, f"it is a {node.kernel.kind.replace('_', ' ')} shader")
    names = tuple(n for n, source in node.inputs if isinstance(source, Ref) and source.path in of_pixels)
    kernel = for_window(node.kernel, names)
    if isinstance(kernel, str):
        raise _refused(node, kernel, _switch(node))
    return replace(node, kernel=kernel, size=window.size, window=window)


def _read(node: PlanNode, of_pixels: set[str]) -> list[str]:
    return [s.path for s in sources_of(node) if isinstance(s, Ref) and s.path in of_pixels]


def _refused(node: PlanNode, why: str, switch: str = "") -> SketchError:
    instead = f"turn '{switch}' off or choose" if switch else "choose"
    return node.spec.error(f"pass '{node.path}' cannot be drawn in parts: {why}; {instead} a smaller picture")


def _switch(step: Step) -> str:
    """Return the parameter that alone says whether a kernel runs; "" where there is none."""
    counted = names_in(step.kernel.repeat)
    names = [p.name for p in step.kernel.parameters if p.name in counted]
    return names[0] if len(names) == 1 and " else 0" in step.kernel.repeat else ""

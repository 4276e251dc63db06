"""Draw a sketch hastily where the processor draws: what is being changed shows at once, and in full at rest.

One sample a pixel instead of several, and a mesh of a quarter of the vertices where nobody
asked for a number of them. Each pass before the draw, and the picture's size, stay as they
are, so that the picture in full differs from the hasty one along edges alone.
"""

from __future__ import annotations

from dataclasses import replace

from playground.sketch.assign import values_of
from playground.sketch.model import Sketch, kernels_of
from playground.terrain.meshes import mesh_parameters

GRID = 129  # vertices a side
_FINENESS = "grid"  # the draw's parameter that its mesh is as fine as


def hastily(sketch: Sketch) -> Sketch:
    """Return a sketch to draw hastily; the same object where that would make no difference."""
    draws = [(path, kernel) for path, kernel in kernels_of(sketch.graph) if kernel.kind == "draw"]
    if not draws:
        return sketch
    values = values_of(sketch)
    coarse = []
    for path, kernel in draws:
        fineness = kernel.parameter(_FINENESS) if _FINENESS in mesh_parameters(kernel.registry) else None
        name = f"{path}.{_FINENESS}"
        if fineness is not None and values[name] == fineness.default and int(fineness.default) > GRID:  # type: ignore[arg-type]
            coarse.append((name, GRID))
    if sketch.samples == 1 and not coarse:
        return sketch
    return replace(sketch, samples=1, overrides=(*sketch.overrides, *coarse))

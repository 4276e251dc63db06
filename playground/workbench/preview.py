"""Draw a preview on a software renderer: what is being changed shows at once, and in full when it rests.

One sample a pixel instead of several, and a mesh of a quarter of the vertices where the user set no
number of them; of a seventh where the picture has fewer pixels too. Each pass before the draw stays
as it is, so that the full picture differs from the preview along edges alone. Samples go first:
for what four of them cost in a third of the pixels a side, half of the pixels a side are drawn with one.
"""

from __future__ import annotations

from dataclasses import replace

from playground.sketch.assign import values_of
from playground.sketch.model import Sketch
from playground.sketch.traits import traits_of
from playground.terrain.meshes import mesh_parameters

Size = tuple[int, int]

GRID = 129  # vertices a side
GRID_OF_FEWER = 97  # for fewer pixels than the picture has
_RESOLUTION = "grid"  # the draw's parameter that sets the resolution of its mesh


def as_preview(sketch: Sketch, size: Size = (1, 1), pixels: Size = (1, 1)) -> Sketch:
    """Return a sketch to draw as a preview; the same object where that would make no difference.

    ``pixels`` are drawn of a picture of a ``size``, and enlarged.
    """
    draws = [(path, k) for path, k in traits_of(sketch).draws if _RESOLUTION in mesh_parameters(k.registry)]
    values = values_of(sketch) if draws else {}
    coarse, grid = [], GRID if pixels[0] >= size[0] else GRID_OF_FEWER
    for path, kernel in draws:
        found = kernel.parameter(_RESOLUTION)
        name = f"{path}.{_RESOLUTION}"
        if found is not None and values[name] == found.default and int(found.default) > grid:  # type: ignore[arg-type]
            coarse.append((name, grid))
    if not traits_of(sketch).draws or (sketch.samples == 1 and not coarse):
        return sketch
    return replace(sketch, samples=1, overrides=(*sketch.overrides, *coarse))

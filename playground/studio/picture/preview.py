"""Draw a preview on a software renderer: what is being changed shows at once, and in full when it rests.

One sample a pixel instead of several, and a mesh of a quarter of the vertices where the user set no
number of them; of a seventh where the picture has fewer pixels too. Each pass before the draw stays
as it is, so that the full picture differs from the preview along edges alone. Samples go first:
for what four of them cost in a third of the pixels a side, half of the pixels a side are drawn with one.
Of a pass that runs anyway, as one of shadows while the sun is dragged, a menu has the choice that its
annotation gives for previews, unless somebody set that menu or something of the same group. A number
has the one for previews where these have fewer pixels than the picture.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

from playground.engine.meshes import mesh_parameters
from playground.sketch.assign import values_of
from playground.sketch.model import Kernel, Parameter, Sketch, Value
from playground.sketch.traits import traits_of

Size = tuple[int, int]

GRID = 129  # vertices a side
GRID_OF_FEWER = 97  # for fewer pixels than the picture has
_RESOLUTION = "grid"  # the draw's parameter that sets the resolution of its mesh


def as_preview(
    sketch: Sketch, size: Size = (1, 1), pixels: Size = (1, 1), faster: Collection[str] = ()
) -> Sketch:
    """Return a sketch to draw as a preview; the same object where that would make no difference.

    ``pixels`` are drawn of a picture of a ``size``, and enlarged; ``faster`` are the paths of passes
    whose menus have the choices of previews.
    """
    traits = traits_of(sketch)
    draws = [(path, k) for path, k in traits.draws if _RESOLUTION in mesh_parameters(k.mesh)]
    fewer = pixels[0] < size[0]
    quick = [(path, k) for path, k in traits.faster if path in faster or fewer]
    values = values_of(sketch) if draws or quick else {}
    coarse: list[tuple[str, Value]] = []
    grid = GRID_OF_FEWER if fewer else GRID
    for path, kernel in draws:
        parameter = kernel.parameter(_RESOLUTION)
        name = f"{path}.{_RESOLUTION}"
        if parameter is not None and values[name] == parameter.default and int(parameter.default) > grid:  # type: ignore[arg-type]
            coarse.append((name, grid))
    chosen = [
        (f"{path}.{parameter.name}", parameter.widget.preview)
        for path, kernel in quick
        for parameter in kernel.parameters
        if parameter.widget.preview is not None
        and (path in faster if parameter.widget.kind == "menu" else fewer)
        and _is_unset(path, parameter, kernel, values)
    ]
    samples = 1 if traits.draws else sketch.picture.samples
    if sketch.picture.samples == samples and not coarse and not chosen:
        return sketch
    sketch = replace(sketch, overrides=(*sketch.overrides, *coarse, *chosen))
    return sketch.with_picture(samples=samples)


def _is_unset(path: str, parameter: Parameter, kernel: Kernel, values: Mapping[str, Value]) -> bool:
    """Return whether a parameter has its default, and of a menu all else of its group has.

    Who has set something of a menu's group wants to see what that does, and another form may not read it.
    """
    group = [p for p in kernel.parameters if p.group and p.group == parameter.group]
    if parameter.widget.kind != "menu" or not group:
        group = [parameter]
    return all(values[f"{path}.{p.name}"] == p.default for p in group)

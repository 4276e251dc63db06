"""Check that what is wired to an input has the size that the input's shape asks for."""

from __future__ import annotations

from collections.abc import Callable

from playground.gpu.shapes import misfit
from playground.sketch.flat import Fed, Flat, Leaf, Source


def check_shapes(leaf: Leaf, flat: Flat, size_of: Callable[[Source], tuple[int, int]]) -> None:
    """Raise ``SketchError`` for what is wired to a cube map, a volume or an array and cannot be one.

    ``size_of`` returns the size in texels of what an input reads.
    """
    shapes = {declared.name: declared.shape for declared in leaf.kernel.inputs if declared.shape}
    for name, source in leaf.inputs if shapes else ():
        if source is None or name not in shapes:
            continue
        size = size_of(source)
        if isinstance(source, Fed):
            output = dict(flat.specs[source.loop].feedback)[source.name]
            source = flat.outputs[source.loop][output]
        if wrong := misfit(shapes[name], size):
            message = f"{name} reads '{source.path}', {size[0]} x {size[1]} texels; {wrong}"
            raise flat.user(leaf.path).error(f"pass '{leaf.path}': {message}")

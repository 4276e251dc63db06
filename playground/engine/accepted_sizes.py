"""Find the sizes that the kernels of a flat sketch take."""

from __future__ import annotations

from playground.sketch import expressions
from playground.sketch.flat import Flat, Leaf
from playground.sketch.flatten import flatten
from playground.sketch.model import Sketch
from playground.sketch.variant_check import INSIDE


def smallest_terrain(sketch: Sketch, least: int = 33) -> tuple[int, int]:
    """Return the smallest terrain of ``least`` texels a side or more that all its kernels take."""
    flat = flatten(sketch)
    return accepted_by(flat, (least, least))


def accepted_by(flat: Flat, size: tuple[int, int]) -> tuple[int, int]:
    """Return the size that every kernel of the terrain's own size takes: this one, or the nearest larger."""
    for leaf in flat.leaves:
        at_land_size = leaf.spec.size is None and leaf.path.partition(".")[0] != "view"
        if at_land_size and leaf.kernel.accepts and not expressions.is_accepted(leaf.kernel.accepts, size):
            size = expressions.nearest_accepted(leaf.kernel.accepts, size)[-1]
    return size


def sizes_of_variant(leaf: Leaf, flat: Flat) -> tuple[str, str]:
    """Return which technique a fast variant's kernel runs for, and the sizes that it takes; else nothing."""
    if leaf.kernel.kind == "compute":
        return leaf.path, leaf.kernel.own_accepts
    path, inside, _ = leaf.path.partition(f".{INSIDE}.")
    is_variant = inside and flat.specs[path].technique.variants
    return (path, leaf.kernel.accepts) if is_variant else (path, "")

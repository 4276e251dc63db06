"""Find the sizes that the kernels of a flat sketch take."""

from __future__ import annotations

from playground.sketch.flat import Flat, Leaf
from playground.sketch.flatten import flatten
from playground.sketch.model import Sketch
from playground.sketch.variant_check import INSIDE


def smallest_terrain(sketch: Sketch, least: int = 33) -> tuple[int, int]:
    """Return the smallest terrain of ``least`` texels a side or more that all its kernels take."""
    return flatten(sketch).accepted((least, least))


def sizes_of_variant(leaf: Leaf, flat: Flat) -> tuple[str, str]:
    """Return which technique a fast variant's kernel runs for, and the sizes that it takes; else nothing."""
    if leaf.kernel.kind == "compute":
        return leaf.path, leaf.kernel.own_accepts
    path, inside, _ = leaf.path.partition(f".{INSIDE}.")
    is_variant = inside and flat.specs[path].technique.variants
    return (path, leaf.kernel.accepts) if is_variant else (path, "")

"""Interpolate between the texels that a run computed which is stopped early.

A kernel with a ``stride`` sets, iteration by iteration, the nodes of an ever closer lattice; all else is
still 0. Its header says how the nodes are joined (``between``). Only pictures are interpolated:
values that are read stay as they are, and a run goes on from those. ``fill_between.frag`` does it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from playground.shader import expressions
from playground.shader.expressions import ExpressionError, Number
from playground.sketch.flat import Leaf
from playground.sketch.model import Kernel
from playground.sketch.wiring import initial_names

SQUARES, TRIANGLES, CENTRES = 0, 1, 2


class Between(NamedTuple):
    """How the texels that a stopped run knows are joined."""

    stride: int  # texels from one node of the lattice to the next
    form: int  # SQUARES, TRIANGLES, or CENTRES: of the lattice only squares' corners and centres are known


def between_of(leaf: Leaf, repeat: int, whole: int, names: Mapping[str, Number]) -> Between | None:
    """Return how the texels known after ``repeat`` iterations of ``whole`` are joined; None where nothing is.

    A stride that stays for two iterations is that of a lattice of which the first iteration sets the
    squares' centres and the second the rest. Raises ``ShaderError`` at a stride that is none.
    """
    kernel = leaf.kernel
    if not kernel.between or not 0 < repeat < whole or _begins_with_something(leaf):
        return None
    now, coming = (_stride(kernel, {**names, "iterations": whole}, done) for done in (repeat - 1, repeat))
    if now < 1:
        where = f"pass '{leaf.path}': stride '{kernel.stride}'"
        raise kernel.error(f"{where} gives {now} for iteration {repeat - 1}")
    if now == coming:
        return Between(now, CENTRES)
    return Between(now, TRIANGLES if kernel.between == "triangles" else SQUARES)


def _stride(kernel: Kernel, names: Mapping[str, Number], iteration: int) -> int:
    try:
        return expressions.evaluate(kernel.stride, {**names, "iteration": iteration})
    except ExpressionError as error:
        raise kernel.error(f"stride {error}") from None


def _begins_with_something(leaf: Leaf) -> bool:
    """Return whether a kernel begins with other textures: then texels off its lattice count as well."""
    return any(source is not None for name, source in leaf.inputs if name in initial_names(leaf.kernel))

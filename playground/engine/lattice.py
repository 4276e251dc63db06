"""The lattice that a kernel fills ever more closely, and what is shown between its nodes.

A kernel with a ``stride`` sets, iteration by iteration, the nodes of an ever closer lattice; all else is
still 0: the fragment driver fills no more than the lattice. A picture of a run that is stopped early joins
the nodes, as the header says (``between``). Only pictures are interpolated:
values that are read stay as they are, and a run goes on from those. ``fill_between.frag`` does it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from playground.shader import expressions
from playground.shader.expressions import ExpressionError, Number
from playground.sketch.flat import Leaf
from playground.sketch.model import TexelKernel
from playground.sketch.wiring import initial_names

SQUARES, TRIANGLES, CENTRES = 0, 1, 2


class Between(NamedTuple):
    """How the texels that a stopped run knows are joined."""

    stride: int  # texels from one node of the lattice to the next
    form: int  # SQUARES, TRIANGLES, or CENTRES: of the lattice only squares' corners and centres are known

    @property
    def uniforms(self) -> dict[str, int]:
        """What ``fill_between.frag`` is given."""
        return {"k_stride": self.stride, "k_form": self.form}


def between_of(leaf: Leaf, repeat: int, total: int, names: Mapping[str, Number]) -> Between | None:
    """Return how the texels known after ``repeat`` iterations of ``total`` are joined; None where nothing is.

    A stride that stays for two iterations is that of a lattice of which the first iteration sets the
    squares' centres and the second the rest. Raises ``ShaderError`` at a stride that is none.
    """
    kernel = leaf.kernel
    if not isinstance(kernel, TexelKernel) or not kernel.between or not 0 < repeat < total:
        return None
    if _begins_with_something(leaf):
        return None
    now, coming = (_stride(kernel, {**names, "iterations": total}, done) for done in (repeat - 1, repeat))
    if now < 1:
        where = f"pass '{leaf.path}': stride '{kernel.stride}'"
        raise kernel.error(f"{where} gives {now} for iteration {repeat - 1}")
    if now == coming:
        return Between(now, CENTRES)
    return Between(now, TRIANGLES if kernel.between == "triangles" else SQUARES)


def shift_after(kernel: TexelKernel, path: str, iteration: int, names: Mapping[str, Number]) -> int:
    """Return the power of two that the texels of a pass known after an iteration lie apart.

    Raises ``ShaderError`` at a stride that is no power of two.
    """
    stride = _stride(kernel, names, iteration, f"pass '{path}': ")
    if stride < 1 or stride & (stride - 1):
        message = f"stride '{kernel.stride}' gives {stride} for iteration {iteration}"
        raise kernel.error(f"pass '{path}': {message}; a power of two was expected")
    return stride.bit_length() - 1


def _stride(kernel: TexelKernel, names: Mapping[str, Number], iteration: int, where: str = "") -> int:
    try:
        return expressions.evaluate(kernel.stride, {**names, "iteration": iteration})
    except ExpressionError as error:
        raise kernel.error(f"{where}stride {error}") from None


def _begins_with_something(leaf: Leaf) -> bool:
    """Return whether a kernel begins with other textures: then texels off its lattice count as well."""
    return any(source is not None for name, source in leaf.inputs if name in initial_names(leaf.kernel))

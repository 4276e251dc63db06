"""Have a text's texels read by samplers that take the nearest, which a software renderer does sooner.

llvmpipe looks up the level of a fetch for each texel anew, and compiles that for each fetch of a text: a
quarter of the time that a new kernel takes until it runs. In the middle of a texel such a sampler gives
the same bits. Where all inputs have the size of the pass itself, a text need not ask for theirs, and what
it would do for others is left out as it is compiled: as much again.

A text with loops fetches as it says: whether Mesa unrolls a loop depends on how long it is, and with
that which constants it multiplies beforehand, so that sums may be rounded otherwise.

No line and no column of a text changes: macros stand before it.
"""

from __future__ import annotations

from dataclasses import replace

from playground.gpu.own_shaders import own_part
from playground.gpu.wrap import Wrapped
from playground.sketch.model import Kernel
from playground.sketch.reserved_names import LEVEL_0, OWN_SIZE

_LOOPS = frozenset({"for", "while"})
_GIVEN_SIZE = "uniform ivec2 size;\n"
_ASKED = "textureSize(k_input, 0)", "(1.0 / vec2(k_texels))"


def reads_nearest(kernel: Kernel) -> bool:
    """Return whether a kernel without loops fetches texels, and all its samplers take the nearest one."""
    if not kernel.inputs or kernel.file_parameters or not kernel.reads("texelFetch"):
        return False
    if not kernel.source.names.isdisjoint(_LOOPS):
        return False
    return all(
        one.sampling.filter == "nearest" == (one.sampling.magnify or "nearest")
        and not (one.sampling.mipmap or one.shape)
        for one in kernel.inputs
    )


def with_nearest_texels(wrapped: Wrapped, *, own_size: bool) -> Wrapped:
    """Return a kernel's stages with its texels read so; ``own_size``: all inputs have the pass's own."""
    stage = wrapped.stages["fragment"]
    lines = stage.text.splitlines(keepends=True)
    head, rest = "".join(lines[1 : stage.first - 1]), "".join(lines[stage.first - 1 :])
    before, (texels, share) = lines[0], _ASKED
    if own_size:
        head = head.replace(_GIVEN_SIZE, "")
        before += own_part("own_size.glsl", size=OWN_SIZE) + "\n"
        texels, share = "k_own_size", "k_own_share"
    before += own_part("nearest_texels.glsl", fetch=LEVEL_0, texels=texels, share=share) + "\n"
    stage = replace(stage, text=before + head + rest, first=(before + head).count("\n") + 1)
    return replace(wrapped, stages={**wrapped.stages, "fragment": stage})

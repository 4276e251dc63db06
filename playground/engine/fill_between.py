"""Fill what lies between the nodes of a lattice, as ``between`` says how they are joined."""

from __future__ import annotations

from typing import TYPE_CHECKING

from playground.engine.between import Between
from playground.engine.results import Result
from playground.gpu.own_shaders import own_shader
from playground.gpu.textures import make_framebuffer
from playground.sketch.model import Sampling

if TYPE_CHECKING:
    from playground.engine.kernels import Kernels


def filled(kernels: Kernels, result: Result, between: Between) -> Result:
    """Return new textures, the caller's, with what lies between the nodes of a result filled."""
    made = kernels.pool.take(result.size, result.outputs)
    for output in result.outputs:
        single = make_framebuffer(kernels.ctx, [made.textures[output.name]])
        single.use()
        program = kernels.programs.own(own_shader("fill_between.frag"))
        kernels.binder.texture(program, "k_picture", 0, result.textures[output.name], Sampling())
        program.set("k_stride", between.stride)
        program.set("k_form", between.form)
        program.fill()
        single.release()
    return made

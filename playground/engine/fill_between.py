"""Fill what lies between the nodes of a lattice, as ``between`` says how they are joined."""

from __future__ import annotations

from typing import TYPE_CHECKING

from playground.engine.between import Between
from playground.engine.results import Pool, Result
from playground.gpu.textures import make_framebuffer
from playground.sketch.model import Sampling

if TYPE_CHECKING:
    from playground.engine.kernels import Kernels

_FILL = """#version 330
uniform sampler2D k_picture;
uniform int k_stride;
uniform int k_form;
out vec4 k_out;

vec4 at(ivec2 texel) {
    return texelFetch(k_picture, min(texel, textureSize(k_picture, 0) - 1), 0);
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    int side = k_form == 2 ? 2 * k_stride : k_stride;
    ivec2 low = texel / side * side;
    float x = float(texel.x - low.x) / float(side);
    float y = float(texel.y - low.y) / float(side);
    vec4 sw = at(low), se = at(low + ivec2(side, 0));
    vec4 nw = at(low + ivec2(0, side)), ne = at(low + side);
    if (k_form == 0) {  // bilinear in the square
        k_out = (sw * (1.0 - x) + se * x) * (1.0 - y) + (nw * (1.0 - x) + ne * x) * y;
        return;
    }
    if (k_form == 1) {  // linear in two triangles, which the diagonal from south-west to north-east parts
        k_out = x >= y ? sw * (1.0 - x) + se * (x - y) + ne * y : sw * (1.0 - y) + nw * (y - x) + ne * x;
        return;
    }
    // Linear in four triangles around the square's centre. Each corner counts by how far the
    // texel is from the diagonal that does not go through it, on the corner's own side.
    float nearest = min(min(x, 1.0 - x), min(y, 1.0 - y));
    k_out = at(low + side / 2) * (2.0 * nearest);
    k_out += sw * max(1.0 - x - y, 0.0) + ne * max(x + y - 1.0, 0.0);
    k_out += se * max(x - y, 0.0) + nw * max(y - x, 0.0);
}
"""


def filled(kernels: Kernels, pool: Pool, result: Result, between: Between) -> Result:
    """Return new textures, the caller's, with what lies between the nodes of a result filled."""
    made = pool.take(result.size, result.outputs)
    for output in result.outputs:
        single = make_framebuffer(kernels.ctx, [made.textures[output.name]])
        single.use()
        program = kernels.programs.own(_FILL)
        kernels.binder.texture(program, "k_picture", 0, result.textures[output.name], Sampling())
        program.set("k_stride", between.stride)
        program.set("k_form", between.form)
        program.fill()
        single.release()
    return made

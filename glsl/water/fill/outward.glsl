// water/fill/outward.glsl -- a way to an edge for each texel: down where that leads there.
//
//   gives    receiver, the number of a neighbour
//   needs    water/texels.glsl
//   units    numbers of texels, as water/texels.glsl counts them
//   source   none: made here
//   tested   tests/glsl/test_fill.py: each way ends at an edge
//
// Water that ends in a pit goes straight towards the nearest edge instead, until it meets a way
// that leads down to one. So no way goes in a circle.
#include "water/texels.glsl"
#pragma kernel(output = "receiver:r32f", \
               accepts = "n up to 4096, m up to 4096")

uniform sampler2D receiver;  //! input
uniform sampler2D outlet;    //! input

float kernel(ivec2 texel) {
    float down = texelFetch(receiver, texel, 0).r;
    if (on_edge(texel_of(texelFetch(outlet, texel, 0).r, size), size)) return down;
    ivec2 far = size - 1 - texel;
    int nearest = min(min(texel.x, texel.y), min(far.x, far.y));
    ivec2 towards = nearest == texel.x ? ivec2(-1, 0)
        : nearest == far.x ? ivec2(1, 0)
        : nearest == texel.y ? ivec2(0, -1) : ivec2(0, 1);
    return number_of(texel + towards, size);
}

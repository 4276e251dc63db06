// simulation/fluid/divergence.glsl -- what flows out of each cell and not in.
//
//   gives    divergence
//   needs    simulation/fluid/torus.glsl
//   units    1/s, cells being 1 wide
//   source   Harlow and Welch 1965, Physics of Fluids 8(12): velocities on the cells' sides
//   tested   tests/glsl/test_fluid.py, against differences in NumPy
#include "simulation/fluid/torus.glsl"
#pragma kernel(output = "divergence:r32f")

uniform sampler2D velocity;  //! input

float kernel(ivec2 texel) {
    vec2 here = texelFetch(velocity, texel, 0).xy;
    float east = texelFetch(velocity, on_torus(texel + ivec2(1, 0), size), 0).x;
    float north = texelFetch(velocity, on_torus(texel + ivec2(0, 1), size), 0).y;
    return east - here.x + north - here.y;
}

// simulation/fluid/projected.glsl -- the velocity without the gradient of the pressure.
//
//   gives    velocity, as simulation/fluid/carried
//   needs    simulation/fluid/torus.glsl
//   units    cells a second
//   source   Stam 1999, "Stable Fluids", SIGGRAPH, section 2.1: the projection
//   tested   tests/glsl/test_fluid.py, by its divergence
#include "simulation/fluid/torus.glsl"
#pragma kernel(output = "velocity:rg32f")

uniform sampler2D velocity;  //! input
uniform sampler2D pressure;  //! input

vec2 kernel(ivec2 texel) {
    float here = texelFetch(pressure, texel, 0).r;
    float west = texelFetch(pressure, on_torus(texel - ivec2(1, 0), size), 0).r;
    float south = texelFetch(pressure, on_torus(texel - ivec2(0, 1), size), 0).r;
    return texelFetch(velocity, texel, 0).xy - vec2(here - west, here - south);
}

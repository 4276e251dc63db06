// erosion/hydraulic/flux.glsl -- what leaves each texel through pipes to its four neighbours.
//
//   gives    flux: to the west, east, south and north
//   needs    erosion/hydraulic/clock.glsl; state and flux of the step before
//   units    metres of water a step
//   source   Mei, Decaudin and Hu 2007, "Fast Hydraulic Erosion Simulation and Visualization on
//            GPU", Pacific Graphics, section 3.2.2: pipes after O'Brien and Hodgins 1995
//   tested   tests/glsl/test_hydraulic.py, against a step in float64
//
// A pipe's flow grows by c^2 times the difference of the water's levels, where c is the share of
// a texel that a wave goes in a step. Each side of a texel has two pipes, one each way, and one
// stops where the other starts: at c^2 = 1/4 a checkerboard of the levels turns into its negative
// every step, for ever. Below that, friction damps it as it does all waves. What leaves is never
// more than there is.
#include "erosion/hydraulic/clock.glsl"
#pragma kernel(output = "flux:rgba32f")

uniform sampler2D state;  //! input
uniform sampler2D flux;   //! input

uniform float friction = 0.02;  //! slider(0, 1) step(0.001) unit("1/h")
                                //! What a flow loses that nothing drives
uniform int edges = 0;          //! menu("open", "closed") Whether water leaves at the edges

const float COURANT_SQUARED = 0.2;

vec4 kernel(ivec2 texel) {
    ivec2 last = size - 1;
    vec4 here = texelFetch(state, texel, 0);
    vec2 west = texelFetch(state, ivec2(max(texel.x - 1, 0), texel.y), 0).xy;
    vec2 east = texelFetch(state, ivec2(min(texel.x + 1, last.x), texel.y), 0).xy;
    vec2 south = texelFetch(state, ivec2(texel.x, max(texel.y - 1, 0)), 0).xy;
    vec2 north = texelFetch(state, ivec2(texel.x, min(texel.y + 1, last.y)), 0).xy;
    // Differences of beds and of depths apart: sums would lose a film of water on a mountain.
    vec4 head = (here.x - vec4(west.x, east.x, south.x, north.x))
              + (here.y - vec4(west.y, east.y, south.y, north.y));
    // Past an open edge lies dry ground as high as the edge's own; a closed edge lets nothing out.
    bvec4 border = bvec4(texel.x == 0, texel.x == last.x, texel.y == 0, texel.y == last.y);
    float beyond = edges == 0 ? here.y : -1e30;
    if (border.x) head.x = beyond;
    if (border.y) head.y = beyond;
    if (border.z) head.z = beyond;
    if (border.w) head.w = beyond;
    vec2 reach = min(spacing.x, spacing.y) / spacing;
    vec4 drive = COURANT_SQUARED * (reach * reach).xxyy;
    // anchor: pipes
    float kept = max(1.0 - friction * step_hours(size), 0.0);
    vec4 out_ = max(kept * texelFetch(flux, texel, 0) + drive * head, 0.0);
    float total = (out_.x + out_.y) + (out_.z + out_.w);
    return total > here.y ? out_ * (here.y / total) : out_;
    // end: pipes
}

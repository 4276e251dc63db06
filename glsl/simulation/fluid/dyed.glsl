// simulation/fluid/dyed.glsl -- the dye after a frame: carried along, faded, added at stirrers.
//
//   gives    dye, a linear colour, 0..1
//   needs    simulation/fluid/stirrers.glsl, simulation/fluid/torus.glsl
//   units    cells a second; a frame is 1/60 s
//   source   Stam 1999, "Stable Fluids", SIGGRAPH, section 2.3, what the fluid carries
//   tested   tests/glsl/test_fluid.py: no more dye anywhere than was put in
//
// Each step is a mean of colours that are there, so no colour leaves the range of the sources'.
#include "simulation/fluid/stirrers.glsl"
#include "simulation/fluid/torus.glsl"
#pragma kernel(output = "dye:rgba32f")

uniform sampler2D velocity;   //! input
uniform sampler2D dye;        //! input("zero")
uniform float radius = 0.05;  //! slider(0.01, 0.2) step(0.005) Of a stirrer, a share of the field
uniform float rate = 0.4;  //! slider(0, 1) step(0.01) How much of a stirrer's colour a frame adds
uniform float fade = 0.003;   //! slider(0, 0.1) step(0.001) What the dye loses in a frame

const float FRAME = 1.0 / 60.0;  // [s]

vec4 kernel(ivec2 texel) {
    // The velocity in the middle of the cell: the mean of that on its sides.
    vec2 here = texelFetch(velocity, texel, 0).xy;
    float east = texelFetch(velocity, on_torus(texel + ivec2(1, 0), size), 0).x;
    float north = texelFetch(velocity, on_torus(texel + ivec2(0, 1), size), 0).y;
    vec2 flow = 0.5 * (here + vec2(east, north));
    vec3 colour = (1.0 - fade) * value_on_torus(dye, vec2(texel) - FRAME * flow).rgb;
    for (int k = 0; k < STIRRERS; k++) {
        vec2 place = (vec2(texel) + 0.5) / vec2(size);
        float near = nearness(place, stirrer_place(k, time), radius);
        colour = mix(colour, stirrer_colour(k), rate * near);
    }
    return vec4(colour, 1.0);
}

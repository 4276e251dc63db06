// simulation/fluid/carried.glsl -- the velocity after a frame: carried along by itself, stirred.
//
//   gives    velocity: red eastwards through a cell's western side, green northwards through
//            its southern side
//   needs    simulation/fluid/stirrers.glsl, simulation/fluid/torus.glsl
//   units    cells a second; a frame is 1/60 s
//   source   Stam 1999, "Stable Fluids", SIGGRAPH, section 2.2: go back along the velocity, and
//            take what was there
//   tested   tests/glsl/test_fluid.py, by a uniform flow and by a shear
//
// Components lie on the cells' sides (Harlow and Welch 1965), so that the divergence of the
// gradient is the usual five points, and the projection loses no mode of it.
#include "simulation/fluid/stirrers.glsl"
#include "simulation/fluid/torus.glsl"
#pragma kernel(output = "velocity:rg32f")

uniform sampler2D velocity;    //! input("zero")
uniform float force = 1.0;  //! slider(0, 4) step(0.05) How fast the fluid goes at a stirrer, times
                               //! its own speed
uniform float radius = 0.05;   //! slider(0.01, 0.2) step(0.005) Of a stirrer, a share of the field

const float FRAME = 1.0 / 60.0;  // [s]

// The velocity at a place; whole numbers are the cells' south-western corners, x then y.
vec2 velocity_at(vec2 place) {
    return vec2(value_on_torus(velocity, place - vec2(0.0, 0.5)).x,
                value_on_torus(velocity, place - vec2(0.5, 0.0)).y);
}

vec2 stirred(vec2 flow, vec2 place) {
    for (int k = 0; k < STIRRERS; k++) {
        float near = nearness(place / vec2(size), stirrer_place(k, time), radius);
        flow = mix(flow, force * stirrer_motion(k, time) * vec2(size), near);
    }
    return flow;
}

vec2 kernel(ivec2 texel) {
    vec2 west = vec2(texel) + vec2(0.0, 0.5), south = vec2(texel) + vec2(0.5, 0.0);
    vec2 from_west = velocity_at(west - FRAME * velocity_at(west));
    vec2 from_south = velocity_at(south - FRAME * velocity_at(south));
    return vec2(stirred(from_west, west).x, stirred(from_south, south).y);
}

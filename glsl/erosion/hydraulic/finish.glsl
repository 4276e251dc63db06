// erosion/hydraulic/finish.glsl -- the terrain after the water, and what the water did to it.
//
//   gives    height; water, its depth; wear and deposit, how much lower or higher the ground is
//            than it was; flow, the discharge of a metre of width; wetness, 0..1
//   needs    erosion/hydraulic/clock.glsl, maths/land.glsl; the state, and the height before
//   units    heights in units of relief; metres; flow in square metres an hour
//   source   none: made here
//   tested   tests/glsl/test_hydraulic.py, against the state
//
// What the water still carries is laid down where it is.
#include "erosion/hydraulic/clock.glsl"
#include "maths/land.glsl"
#pragma kernel(output = "height:r32f, water:r32f, wear:r32f, deposit:r32f, flow:r32f, \
                         wetness:r32f")

uniform sampler2D state;   //! input
uniform sampler2D before;  //! input

uniform float damp = 20.0;     //! log_slider(0.1, 10000) unit("m²/h")
                               //! The flow that leaves the ground half wet
uniform int hours = 600;       //! log_slider(1, 5000) unit("h") How long it rains and flows
uniform bool watched = false;  //! Whether the hours go by with time, to be watched
uniform int pace = 8;          //! slider(1, 60) unit("h") Hours a frame where they are watched

void kernel(ivec2 texel, out float height, out float water, out float wear, out float deposit,
            out float flow, out float wetness) {
    vec4 now = texelFetch(state, texel, 0);
    ivec2 grid = textureSize(before, 0);
    ivec2 there = ivec2(place_on(grid, texel, size) + 0.5);
    float was = relief * texelFetch(before, there, 0).r;
    float ground = now.x + now.z;
    height = ground / max(relief, 1e-3);
    water = now.y;
    wear = max(was - ground, 0.0);
    deposit = max(ground - was, 0.0);
    flow = now.w * min(spacing.x, spacing.y) / step_hours(size);
    wetness = 1.0 - exp(-0.69314718 * flow / damp);
}

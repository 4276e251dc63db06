// water/fill/chain.glsl -- what the ways of the water say of each texel's level: one step of them.
//
//   gives    chain: the level is max(red, level of texel number blue + green)
//   needs    water/least_fall.glsl, water/texels.glsl
//   units    heights without unit
//   source   none: made here
//   tested   tests/glsl/test_fill.py
#include "water/least_fall.glsl"
#include "water/texels.glsl"
#pragma kernel(output = "chain:rgba32f")

uniform sampler2D height;    //! input
uniform sampler2D receiver;  //! input

const float NO_FALL = -1e30;  // where a way ends

vec4 kernel(ivec2 texel) {
    float next = texelFetch(receiver, texel, 0).r;
    vec2 offset = vec2(texel_of(next, size) - texel) * spacing;
    float fall = offset == vec2(0.0) ? NO_FALL : least_fall(spacing, relief) * length(offset);
    return vec4(texelFetch(height, texel, 0).r, fall, next, 0.0);
}

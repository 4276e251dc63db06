// water/levels/resampled.glsl -- the terrain before its rivers, read at a level's texels.
//
//   gives    height
//   needs    water/levels/parameters/keep.glsl, terrain/heightfield.glsl
//   units    heights without unit
//   source   none: made here
//   tested   tests/glsl/test_stream_power.py
#include "water/levels/parameters/keep.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "height:r32f")

uniform sampler2D height;  //! input

float kernel(ivec2 texel) {
    vec2 last = vec2(textureSize(height, 0) - 1);
    return keep * height_at(height, vec2(texel) * last / vec2(max(size - 1, 1)));
}

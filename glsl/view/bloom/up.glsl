// view/bloom/up.glsl -- a level of the glow: half its own light, half the wider glow's.
//
//   gives    spread: linear light
//   needs    two levels of light, `wider` of fewer texels
//   units    light without unit
//   source   levels one over the other as in Jimenez 2014, "Next Generation Post Processing in
//            Call of Duty: Advanced Warfare" (SIGGRAPH course)
//   tested   tests/glsl/test_after.py: the mean of all pixels stays
#pragma kernel(output = "spread:rgba16f", repeat = "1 if bloom > 0 else 0")

uniform sampler2D picture;  //! input
uniform sampler2D wider;    //! input("linear")
#include "view/parameters/bloom.glsl"

vec4 kernel(ivec2 texel) {
    vec4 around = textureLod(wider, (vec2(texel) + 0.5) / vec2(size), 0.0);
    return 0.5 * (texelFetch(picture, texel, 0) + around);
}

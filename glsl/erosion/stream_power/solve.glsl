// erosion/stream_power/solve.glsl -- chains of links put together: each height from its outlet's.
//
//   gives    link: red the new height, once blue is the number of an outlet
//   needs    water/texels.glsl
//   units    heights without unit
//   source   pointer jumping: Wyllie 1979, "The complexity of parallel computations"; the links
//            are those of erosion/stream_power/link.glsl
//   tested   tests/glsl/test_stream_power.py, against the same links solved one after another
//
// After n steps ways of 2^n texels are known, and none is longer than the terrain has texels.
#include "water/texels.glsl"
#pragma kernel(output = "link:rgba32f", repeat = "bits(size.x * size.y)", \
                until = "unchanged")

vec4 kernel(ivec2 texel) {
    vec4 here = previous(texel);
    vec4 next = previous(texel_of(here.z, size));
    return vec4(here.x + here.y * next.x, here.y * next.y, next.z, 0.0);
}

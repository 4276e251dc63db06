// water/fill/along.glsl -- the level at which water leaves by a known way: chains put together.
//
//   gives    chain: red the level, once blue is the number of the way's last texel
//   needs    water/texels.glsl
//   units    heights without unit
//   source   pointer jumping: Wyllie 1979, "The complexity of parallel computations"; that
//            max(a, x + b) of max(c, y + d) is max(max(a, c + b), y + (d + b)), derived here
//   tested   tests/glsl/test_fill.py, against a walk along each way
//
// After n steps ways of 2^n texels are known, and none is longer than the terrain has texels.
#include "water/texels.glsl"
#pragma kernel(output = "chain:rgba32f", repeat = "bits(size.x * size.y)", \
                until = "unchanged")

vec4 kernel(ivec2 texel) {
    vec4 here = previous(texel);
    vec4 next = previous(texel_of(here.z, size));
    float level = max(here.x, next.x + here.y);
    return vec4(level, max(here.y + next.y, -1e30), next.z, 0.0);
}

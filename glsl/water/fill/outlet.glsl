// water/fill/outlet.glsl -- where the water of each texel ends: each step doubles the known way.
//
//   gives    outlet, the number of an edge's texel, or of a pit's
//   needs    water/texels.glsl
//   units    numbers of texels, as water/texels.glsl counts them
//   source   pointer jumping: Wyllie 1979, "The complexity of parallel computations"
//   tested   tests/glsl/test_fill.py
//
// After n steps ways of 2^n texels are known, and none is longer than the terrain has texels.
#include "water/texels.glsl"
#pragma kernel(output = "outlet:r32f", repeat = "bits(size.x * size.y)", \
                until = "unchanged")

float kernel(ivec2 texel) {
    return previous(texel_of(previous(texel), size));
}

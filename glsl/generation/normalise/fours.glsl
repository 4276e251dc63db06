// generation/normalise/fours.glsl -- heights stretched where they lie, four at a time.
//
//   gives    stretch_fours
//   needs    generation/normalise/{stretch,tell}.glsl; a buffer `height:vec4`,
//            (size.x + 3) / 4 fours a row
//   units    as the heights
//   source   as generation/normalise/stretch.glsl
//   tested   tests/glsl/test_fast_variants.py, as part of the fast variants that normalise
#ifndef GENERATION_NORMALISE_FOURS
#define GENERATION_NORMALISE_FOURS
#ifdef COMPUTE_STAGE
#include "generation/normalise/stretch.glsl"
#include "generation/normalise/tell.glsl"

const int STRETCHED = 1024;  // fours to a group

// By the range that is told, one group's share.
void stretch_fours(int mode) {
    vec2 by = told_stretch(mode);
    int begin = int(gl_WorkGroupID.x) * STRETCHED;
    int last = min(begin + STRETCHED, ((size.x + 3) >> 2) * size.y);
    int readers = int(gl_WorkGroupSize.x);
    for (int four = begin + int(gl_LocalInvocationIndex); four < last; four += readers) {
        height[four] = stretched(read_height(four), by, mode);
    }
}
#endif
#endif

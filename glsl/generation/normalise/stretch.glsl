// generation/normalise/stretch.glsl -- heights moved and stretched by a range, four at a time.
//
//   gives    stretch_of, stretched
//   needs    terrain/extremes.glsl
//   units    heights without unit; the range in the same
//   source   generation/normalise/apply.glsl, which tells what the modes are
//   tested   tests/glsl/test_filters.py and tests/glsl/test_fast_variants.py, against that
//
// Only for speed: what the fast variants that normalise share.
#ifndef GENERATION_NORMALISE_STRETCH
#define GENERATION_NORMALISE_STRETCH
#include "terrain/extremes.glsl"

// What is taken off a height, and what it is then divided by; neither changes a height where
// it stays as it is.
vec2 stretch_of(vec2 range, int mode) {
    float low = mode == 1 ? 0.0 : range.x;
    float span = mode == 0 ? 0.0 : span_of(vec2(low, range.y));
    if (span > 0.0) return vec2(low, span);
    // Without a range to stretch it stays, or by "minmax" becomes 0: over infinity.
    return vec2(0.0, mode == 2 ? uintBitsToFloat(0x7f800000u) : 1.0);
}

vec4 stretched(vec4 h, vec2 stretch, int mode) {
    vec4 share = (h - stretch.x) / stretch.y;
    return mode == 2 ? clamp(share, 0.0, 1.0) : share;
}
#endif

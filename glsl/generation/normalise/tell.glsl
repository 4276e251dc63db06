// generation/normalise/tell.glsl -- the range of all heights, told by those who make them.
//
//   gives    Told, nothing_told, told_also, tell, told_stretch
//   needs    generation/normalise/stretch.glsl, terrain/{extremes,order}.glsl; a buffer
//            `bounds:uint:2` that begins as zeros
//   units    as the heights
//   source   none: a reduction
//   tested   tests/glsl/test_fast_variants.py, as part of the fast variants that normalise
//
// Only for speed: a terrain whose range is known when its last height is made need not be read
// again to find it.
#ifndef GENERATION_NORMALISE_TELL
#define GENERATION_NORMALISE_TELL
#ifdef COMPUTE_STAGE
#include "generation/normalise/stretch.glsl"
#include "terrain/extremes.glsl"
#include "terrain/order.glsl"

// The least and the most of what a thread has made, of every fourth height each.
struct Told {
    vec4 minimum, maximum;
};

Told nothing_told() {
    return Told(vec4(NO_RANGE.x), vec4(NO_RANGE.y));
}

// As in `widened`: what is no number is neither.
Told told_also(Told told, vec4 heights) {
    return Told(mix(told.minimum, heights, lessThan(heights, told.minimum)),
                mix(told.maximum, heights, greaterThan(heights, told.maximum)));
}

void tell(Told told) {
    vec4 l = told.minimum;
    vec4 m = told.maximum;
    uint highest = key_of_height(max(max(m.x, m.y), max(m.z, m.w)));
    uint lowest = ~key_of_height(min(min(l.x, l.y), min(l.z, l.w)));
    // Most threads have nothing to change, and see that sooner than an atomic tells them.
    if (highest > bounds[0]) atomicMax(bounds[0], highest);
    if (lowest > bounds[1]) atomicMax(bounds[1], lowest);
}

vec2 told_stretch(int mode) {
    return stretch_of(vec2(height_of_key(~bounds[1]), height_of_key(bounds[0])), mode);
}
#endif
#endif

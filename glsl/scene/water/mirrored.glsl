// scene/water/mirrored.glsl -- where a ray that leaves the water meets the terrain and its woods.
//
//   gives    meets_terrain, MISSES
//   asks     of the kernel that includes it: wood_height
//   needs    lighting/leaps.glsl, maths/square.glsl; heights and their block maxima come as
//            arguments
//   units    metres
//   source   the march of lighting/leaps.glsl; the last step as a secant: made here
//   tested   tests/glsl/test_scene_water.py: calm water mirrors a peak within a pixel, and the sea
//            beyond the terrain does
#ifndef SCENE_WATER_MIRRORED
#define SCENE_WATER_MIRRORED
#include "lighting/leaps.glsl"
#include "maths/square.glsl"

// How high woods stand at a share of the terrain [m], and the most that they can be.
float wood_height(vec2 share);

const float MISSES = -1.0;

float tallest_woods;  // [m] by so much the march runs lower, so that no block with woods is passed
vec2 last_texel;

float top_of_woods(vec2 place) {
    return tallest_woods > 0.0 ? wood_height(place / last_texel) : 0.0;
}

float after_step(float found, March march, float t, float terrain) {
    float top = terrain + top_of_woods(march.start + t * march.ahead) - tallest_woods;
    return top > march.foot + t * march.climb ? t : 0.0;
}

bool is_decided(float found) { return found > 0.0; }

// How far it is from a point, over the terrain or beside it, to the terrain, in a direction that
// does not fall, or MISSES.
float meets_terrain(sampler2D field, sampler2D block_maxima, vec3 from, vec3 to, vec2 metres,
                    float metres_of_relief, float tallest) {
    last_texel = vec2(textureSize(field, 0) - 1);
    tallest_woods = tallest;
    vec2 place = from.xy / metres * last_texel;
    vec2 along = to.xy / metres * last_texel;
    vec2 span = span_through(place, along, last_texel);
    float entry = max(span.x, 0.0);
    if (entry >= span.y) return MISSES;
    place = clamp(place + entry * along, vec2(0.0), last_texel);
    March march = march_from(field, place, to, metres, metres_of_relief, 1.0);
    march.foot = from.z + entry * to.z - tallest;
    float found = leaping_march(march, field, block_maxima, INTERPOLATED, march.climb, 0.0);
    if (found <= 0.0) return MISSES;
    // Between the last step over the ground and the first under it, as along a straight line.
    vec2 at = march.start + found * march.ahead;
    float after = height_at(field, at) * metres_of_relief + top_of_woods(at) - tallest
            - march.foot - found * march.climb;
    at -= march.ahead;
    float before = height_at(field, at) * metres_of_relief + top_of_woods(at) - tallest
            - march.foot - (found - 1.0) * march.climb;
    float back = before < 0.0 ? clamp(after / (after - before), 0.0, 1.0) : 1.0;
    return entry + (found - back) * march.path;
}
#endif

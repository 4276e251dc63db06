// lighting/ray_cast/visibility.glsl -- whether a ray towards the sun meets terrain.
//
//   gives    visibility: the visible part of the sun, 1 where no terrain is in the way, else 0
//   needs    lighting/daylight_reading.glsl, lighting/march.glsl, lighting/parameters/; block
//            maxima and range of the heights, or their swept horizon, as inputs
//   units    without unit
//   source   Belaiche 2010, section 3.5.4
//   tested   tests/glsl/test_lighting.py and tests/glsl/test_shadows.py, against marches in NumPy
//            and walls' shadows in metres
//
// From each texel's own height a ray goes to the sun, a step at a time. Terrain above the ray
// hides the sun; a ray above the highest height, or off the terrain, is free.
//
// Different from the thesis: it reads the texel that the ray's place is cut down to, which moves
// every shadow half a texel to the south-west; here heights are interpolated between texels'
// centres, and the terrain ends at the last one. Its way remains a choice, for comparison.
#include "lighting/march.glsl"

// anchor: march
// What is seen of the sun after a step: nothing, if the terrain there is above the ray.
float after_step(float seen, March march, float t, float terrain) {
    float ray = march.foot + t * march.climb;
    return terrain > ray ? 0.0 : seen;
}
// end: march

bool is_decided(float seen) {
    return seen == 0.0;
}

// The computation
#include "lighting/daylight_reading.glsl"
#pragma kernel(output = "visibility:r32f")

#include "lighting/parameters/sun.glsl"
#include "lighting/parameters/form.glsl"
#include "lighting/parameters/march.glsl"

float kernel(ivec2 texel) {
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    if (light.z < 0.0) return 0.0;
    // A horizon of one texel was not swept: there are no compute shaders. A constant on a software
    // renderer, which then has no march to go through.
    bool swept = form == 1 && matches_horizon;
    if (swept) return texelFetch(horizon, texel, 0).r * length(light.xy) > light.z ? 0.0 : 1.0;
    ivec2 grid = textureSize(height, 0);
    vec2 place = place_on(grid, texel, size);
    March march = march_from(height, place, size == grid, light, extent, relief, step_length);
    march.count = steps_below(march, march.climb, texelFetch(range, ivec2(0), 0).g * relief);
    return marched(march, height, block_maxima, sampling, march.climb, 1.0);
}

// lighting/ray_cast/leaping.glsl -- rays towards the sun that leap over low terrain.
//
//   gives    visibility, as lighting/ray_cast/visibility.glsl
//   needs    lighting/daylight_reading.glsl, lighting/leaps.glsl, lighting/parameters/; block
//            maxima of the heights and their range as inputs
//   units    without unit
//   source   as lighting/leaps.glsl
//   tested   tests/glsl/test_fast_variants.py, against lighting/ray_cast/visibility.glsl
#include "lighting/daylight_reading.glsl"
#include "lighting/leaps.glsl"
#pragma kernel(output = "visibility:r32f")

uniform sampler2D block_maxima;  //! input
uniform sampler2D range;         //! input
#include "lighting/parameters/sun.glsl"
#include "lighting/parameters/form.glsl"
#include "lighting/parameters/march.glsl"

float kernel(ivec2 texel) {
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    if (light.z < 0.0) return 0.0;
    // A constant on a software renderer, which then has no march to go through.
    bool swept = form == SWEEP && matches_horizon;
    if (swept) return texelFetch(horizon, texel, 0).r * length(light.xy) > light.z ? 0.0 : 1.0;
    ivec2 grid = textureSize(height, 0);
    vec2 place = place_on(grid, texel, size);
    March march = march_from(height, place, light, extent, relief, step_length);
    march.count = steps_below(march, march.climb, texelFetch(range, ivec2(0), 0).g * relief);
    return leaping_march_from_texel(size == grid, march, height, block_maxima, sampling,
                                    march.climb, 1.0);
}

float after_step(float visible, March march, float t, float terrain) {
    return terrain > march.foot + t * march.climb ? 0.0 : visible;
}

bool is_decided(float visible) {
    return visible == 0.0;
}

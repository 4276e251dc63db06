// lighting/soft_cylinder/leaping.glsl -- cylinders towards the sun that leap over low terrain.
//
//   gives    visibility, as lighting/soft_cylinder/visibility.glsl
//   needs    lighting/daylight_reading.glsl, lighting/leaps.glsl, lighting/parameters/; block
//            maxima of the heights and their range as inputs
//   units    without unit
//   source   as lighting/leaps.glsl
//   tested   tests/glsl/test_fast_variants.py, against lighting/soft_cylinder/visibility.glsl
#include "lighting/daylight_reading.glsl"
#include "lighting/leaps.glsl"
#pragma kernel(output = "visibility:r32f")

uniform sampler2D block_maxima;  //! input
uniform sampler2D range;         //! input
#include "lighting/parameters/sun.glsl"
uniform float radius = 0.5;  //! slider(0, 64) step(0.1) group("Cylinder") unit("grey levels")
                             //! Half of the cylinder's width; 255 grey levels are the height from
                             //! 0 to 1
#include "lighting/parameters/march.glsl"

float kernel(ivec2 texel) {
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    if (light.z < 0.0) return 0.0;
    ivec2 grid = textureSize(height, 0);
    vec2 place = place_on(grid, texel, size);
    March march = march_from(height, place, light, extent, relief, step_length);
    // The beginning leaves a half: only terrain over the cylinder's middle takes more.
    march.count = steps_below(march, march.climb, texelFetch(range, ivec2(0), 0).g * relief);
    return leaping_march_from_texel(size == grid, march, height, block_maxima, sampling,
                                    march.climb, 0.5);
}

float after_step(float part, March march, float t, float terrain) {
    float clearance = march.foot + t * march.climb - terrain;
    float radius_in_metres = radius / 255.0 * march.relief;
    return min(part, clamp(0.5 + clearance / max(2.0 * radius_in_metres, 1e-20), 0.0, 1.0));
}

bool is_decided(float part) {
    return part == 0.0;
}

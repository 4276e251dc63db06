// lighting/sun_disc/leaping.glsl -- horizons towards the sun by marches that leap.
//
//   gives    visibility, as lighting/sun_disc/visibility.glsl
//   needs    lighting/daylight_reading.glsl, lighting/leaps.glsl, lighting/sun_disc/area.glsl,
//            lighting/parameters/; block maxima of the heights and their range as inputs
//   units    without unit; angles in degrees
//   source   as lighting/leaps.glsl
//   tested   tests/glsl/test_fast_variants.py, against lighting/sun_disc/visibility.glsl
#include "lighting/daylight_reading.glsl"
#include "lighting/leaps.glsl"
#include "lighting/sun_disc/area.glsl"
#pragma kernel(output = "visibility:r32f")

uniform sampler2D block_maxima;  //! input
uniform sampler2D range;         //! input
#include "lighting/parameters/sun.glsl"
uniform float diameter = 0.53;  //! slider(0.1, 20) step(0.01) group("Sun") unit("°")
                                //! How wide the sun is
#include "lighting/parameters/form.glsl"
#include "lighting/parameters/march.glsl"

float disc_hidden_from;  // the tangent of a horizon that hides all of the disc

float kernel(ivec2 texel) {
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    float elevation = sun_elevation(wired_daylight, daylight, sun);
    // A constant on a software renderer, which then has no march to go through.
    bool swept = form == SWEEP && matches_horizon;
    if (swept) return disc_over(max(texelFetch(horizon, texel, 0).r, 0.0), elevation, diameter);
    ivec2 grid = textureSize(height, 0);
    vec2 place = place_on(grid, texel, size);
    March march = march_from(height, place, light, extent, relief, step_length);
    // Horizons below the disc need not be distinguished, nor those above it.
    float least = max(tangent_of(elevation - 0.5 * diameter), 0.0);
    disc_hidden_from = tangent_of(elevation + 0.5 * diameter);
    march.count = steps_below(march, least * march.run, texelFetch(range, ivec2(0), 0).g * relief);
    float tangent = leaping_march_from_texel(size == grid, march, height, block_maxima, sampling,
                                             least * march.run, least);
    return disc_over(tangent, elevation, diameter);
}

// The horizon's tangent after a step: the steepest so far.
float after_step(float tangent, March march, float t, float terrain) {
    return max(tangent, (terrain - march.foot) / (t * march.run));
}

bool is_decided(float tangent) {
    return tangent > disc_hidden_from;
}

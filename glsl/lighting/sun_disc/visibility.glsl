// lighting/sun_disc/visibility.glsl -- how much of the sun's disc is over the horizon.
//
//   gives    visibility: the visible part of the disc's area, 0..1
//   needs    lighting/daylight_reading.glsl, lighting/march.glsl, lighting/sun_disc/area.glsl,
//            lighting/parameters/; block maxima and range of the heights, or their swept horizon,
//            as inputs
//   units    without unit; angles in degrees
//   source   beyond Belaiche 2010, whose eqs 3.8 and 4.3 fall evenly across the sun; the sun's
//            diameter from section 3.4
//   tested   tests/glsl/test_shadows.py, against quadrature of the disc over a horizon in NumPy
//
// The horizon is that of the sun's own azimuth, and is taken to be level across the disc: it is
// half a degree wide, and few ridges turn much in that. Beyond its edges the terrain is taken for
// a plain without end, so no horizon is below 0, and the sun sets evenly there.
#include "lighting/march.glsl"

// The horizon's tangent after a step: the steepest so far.
float after_step(float tangent, March march, float t, float terrain) {
    return max(tangent, (terrain - march.foot) / (t * march.run));
}

float disc_hidden_from;  // the tangent of a horizon that hides all of the disc

bool is_decided(float tangent) {
    return tangent > disc_hidden_from;
}

// The computation
#include "lighting/daylight_reading.glsl"
#include "lighting/sun_disc/area.glsl"
#pragma kernel(output = "visibility:r32f")

#include "lighting/parameters/sun.glsl"
uniform float diameter = 0.53;  //! slider(0.1, 20) step(0.01) group("Sun") unit("°")
                                //! How wide the sun is
#include "lighting/parameters/form.glsl"
#include "lighting/parameters/march.glsl"

float kernel(ivec2 texel) {
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    float elevation = sun_elevation(wired_daylight, daylight, sun);
    // A horizon of one texel was not swept: there are no compute shaders. A constant on a software
    // renderer, which then has no march to go through.
    bool swept = form == 1 && matches_horizon;
    if (swept) return disc_over(max(texelFetch(horizon, texel, 0).r, 0.0), elevation, diameter);
    ivec2 grid = textureSize(height, 0);
    vec2 place = place_on(grid, texel, size);
    March march = march_from(height, place, size == grid, light, extent, relief, step_length);
    // Horizons below the disc need not be distinguished, nor those above it.
    float least = max(tangent_of(elevation - 0.5 * diameter), 0.0);
    disc_hidden_from = tangent_of(elevation + 0.5 * diameter);
    march.count = steps_below(march, least * march.run, texelFetch(range, ivec2(0), 0).g * relief);
    float tangent = marched(march, height, block_maxima, sampling, least * march.run, least);
    return disc_over(tangent, elevation, diameter);
}

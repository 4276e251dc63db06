// lighting/horizon_sun/stand.glsl -- where the sun is among the horizons.
//
//   gives    stand: texel 0, which two horizons the sun is between (see between_horizons) and by
//            what their angles are multiplied and summed to give its own; texel 1, the sky's light
//            on open level ground, and in alpha the elevation of the disc's upper edge
//   needs    lighting/daylight_reading.glsl, lighting/horizon_sun/arc.glsl
//   units    horizon and edge in diameters of the sun; the angles are shares of 90 degrees
//   source   Belaiche 2010, section 3.4, eq. 3.8
//   tested   tests/glsl/test_analytic.py, against float64
//
// It is the same for all texels, and is worked out once.
#include "lighting/daylight_reading.glsl"
#include "lighting/horizon_sun/arc.glsl"
#pragma kernel(output = "stand:rgba32f")

#include "lighting/parameters/sun.glsl"
uniform float diameter = 0.53;           //! slider(0, 20) step(0.01) group("Sun") unit("°")
                                         //! How wide the sun is
#include "lighting/parameters/arc.glsl"
uniform vec3 sky_colour = vec3(1.0);     //! colour group("Sky") Colour of the sky's light
uniform float ambient = 0.0;             //! slider(0, 1) step(0.01) group("Sky")
                                         //! Strength of the sky's light

vec4 kernel(ivec2 texel) {
    Sunlight given = sunlight(wired_daylight, daylight, towards_sun, sun, vec3(0.0), sky_colour);
    vec3 to_sun = given.direction;
    if (texel.x == 0) {
        int count = directions_for(to_sun, arc, measured, wired_daylight);
        Between found = between_horizons(to_sun, arc, count);
        return vec4(vec2(found.which), found.weights * in_diameters(90.0, diameter));
    }
    float upper_edge = elevation_of(to_sun) + 0.5 * diameter;
    return vec4(given.sky * ambient, in_diameters(upper_edge, diameter));
}

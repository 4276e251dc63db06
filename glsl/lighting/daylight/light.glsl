// lighting/daylight/light.glsl -- what sun and sky come to, under clouds and to the adapted eye.
//
//   gives    light, a row of texels: 0 direction to the sun, elevation; 1 its light, azimuth; 2
//            the sky's light on level ground, turbidity; 3 the zenith, what all is multiplied by
//            for the eye; 4 the mean horizon, latitude; 5 sun and sky on level ground,
//            days from the first of January; 6 what clouds send down, share of open sky; from 7
//            on the mean horizon as seen from each height of sky/dome.glsl, with the first how far
//            the sky of stars has turned
//   needs    colour/luminance.glsl, sky/clouds.glsl, sky/columns.glsl, sky/dome.glsl,
//            lighting/sun.glsl; the sun's place, the air, the cover and two tables
//   units    light without unit, 1 that of the sun outside the air on a surface that faces it;
//            degrees
//   source   see sky/clouds.glsl and sky/columns.glsl; the adapted eye: a light meter for incident
//            light, whose reading to the power -adaptation is the exposure
//   tested   tests/glsl/test_daylight.py, against float64, and for every place of the sun
//
// From noon to the end of twilight light falls by eight powers of ten, which neither the eye
// nor half floats follow. So exposure by the light begins here, where floats are whole;
// view/present has the rest. Adaptation 1 keeps level ground as bright all day, 0 keeps nature's
// numbers.
#include "colour/luminance.glsl"
#include "lighting/sun.glsl"
#include "sky/clouds.glsl"
#include "sky/columns.glsl"
#include "sky/dome.glsl"
#pragma kernel(output = "light:rgba32f")

uniform sampler2D place;           //! input
uniform sampler2D date;            //! input
uniform sampler2D columns;         //! input
uniform sampler2D dome;            //! input
uniform sampler2D air;             //! input
uniform sampler2D cover;           //! input
uniform float adaptation = 0.75;   //! slider(0, 1) step(0.01)
                                   //! How much of the light's loss the eye makes up for

const int AROUND = 24;
const int UP = 24;
const float HORIZON = 0.03;  // the sine of where the horizon's colour is taken

vec3 towards(float rise, float turned, vec3 sun) {
    vec2 ahead = dot(sun.xy, sun.xy) > 1e-12 ? normalize(sun.xy) : vec2(0.0, 1.0);
    vec2 level = cos(turned) * ahead + sin(turned) * vec2(-ahead.y, ahead.x);
    return vec3(sqrt(max(1.0 - rise * rise, 0.0)) * level, rise);
}

vec4 kernel(ivec2 texel) {
    vec2 at = texelFetch(place, ivec2(0), 0).rg;
    vec3 sun = to_sun(at);
    float turbidity = texelFetch(air, ivec2(0), 0).r;
    float clouds = texelFetch(cover, ivec2(0), 0).r;
    vec3 beam = left_of_sunlight(columns, air_of(turbidity), 0.0, sun.z);
    vec3 sky = vec3(0.0);
    vec3 horizon = vec3(0.0);
    float height = dome_height(clamp(texel.x - 7, 0, DOMES - 1));
    float horizon_at = horizon_rise(height) + HORIZON;
    for (int column = 0; column < AROUND; column++) {
        // The half turns on both sides of the sun are alike.
        float turned = (float(column) + 0.5) / float(AROUND) * 3.14159265;
        horizon += dome_at(dome, 0, towards(horizon_at, turned, sun), sun, height) / float(AROUND);
        for (int row = 0; row < UP; row++) {
            // Equal steps of the squared sine weigh each direction by its sine, as level ground
            // does.
            float rise = sqrt((float(row) + 0.5) / float(UP));
            sky += dome_at(dome, 0, towards(rise, turned, sun), sun, 0.0) / float(AROUND * UP);
        }
    }
    vec3 zenith = dome_at(dome, 0, vec3(0.0, 0.0, 1.0), sun, 0.0);

    float level = max(sun.z, 0.0);
    float open = 1.0 - clouds;
    vec3 whole = (beam * level + sky) * under_clouds(clouds);
    beam *= beam_through_clouds(clouds);
    // What clouds take from the sun and hide of the sky, less what they hold back, they send down.
    vec3 cloud = max(whole - beam * level - open * sky, 0.0);
    float adapted = pow(max(luminance(whole), 1e-12), -adaptation);
    vec4 found = vec4(adapted * cloud, open);
    if (texel.x == 0) found = vec4(sun, at.y);
    if (texel.x == 1) found = vec4(adapted * beam, at.x);
    if (texel.x == 2) found = vec4(adapted * (open * sky + cloud), turbidity);
    if (texel.x == 3) found = vec4(adapted * (open * zenith + cloud * overcast(1.0)), adapted);
    if (texel.x == 4 || texel.x >= 7) {
        found = vec4(adapted * (open * horizon + cloud * overcast(HORIZON)), 1.0);
    }
    if (texel.x == 4) found.a = texelFetch(date, ivec2(0), 0).g;
    if (texel.x == 7) found.a = texelFetch(date, ivec2(0), 0).b;
    if (texel.x == 5) found = vec4(adapted * whole, texelFetch(date, ivec2(0), 0).r);
    return found;
}

// lighting/daylight_reading.glsl -- sun and sky from lighting/daylight where it is wired, else from parameters.
//
//   gives    Sunlight, sunlight, sun_place, is_daylight
//   needs    lighting/sun.glsl; the output of lighting/daylight, or one black texel
//   units    azimuth and elevation in degrees; light without unit, 1 that of the sun outside the air
//   source   none: the order of texels in lighting/daylight/light
//   tested   tests/glsl/test_daylight.py, wired and not
#ifndef LIGHTING_DAYLIGHT_READING
#define LIGHTING_DAYLIGHT_READING
#include "lighting/sun.glsl"

struct Sunlight {
    vec3 direction;  // towards the sun
    vec2 place;      // its azimuth and elevation
    vec3 sun;        // its light on a surface that faces it
    vec3 sky;        // the sky's light on open level ground
};

// Whether an input is wired: if not, it is one black texel. Its size is known without reading it,
// which would cost every texel of a light map.
bool is_daylight(sampler2D daylight) {
    return textureSize(daylight, 0).x > 1;
}

// The sun's azimuth and elevation, for what asks no more.
vec2 sun_place(sampler2D daylight, vec2 sun) {
    vec2 found = sun;
    // A loop, because software renderers take both ways of an if: unwired, it has no turn.
    int turns = is_daylight(daylight) ? 1 : 0;
    for (int k = 0; k < turns; k++) {
        found = vec2(texelFetch(daylight, ivec2(1, 0), 0).a, texelFetch(daylight, ivec2(0), 0).a);
    }
    return found;
}

Sunlight sunlight(sampler2D daylight, vec2 sun, vec3 sun_colour, vec3 sky_colour) {
    Sunlight found = Sunlight(to_sun(sun), sun, sun_colour, sky_colour);
    int turns = is_daylight(daylight) ? 1 : 0;
    for (int k = 0; k < turns; k++) {
        vec4 first = texelFetch(daylight, ivec2(0), 0);
        vec4 second = texelFetch(daylight, ivec2(1, 0), 0);
        vec4 third = texelFetch(daylight, ivec2(2, 0), 0);
        found = Sunlight(first.rgb, vec2(second.a, first.a), second.rgb, third.rgb);
    }
    return found;
}
#endif

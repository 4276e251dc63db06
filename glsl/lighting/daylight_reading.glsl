// lighting/daylight_reading.glsl -- sun and sky from lighting/daylight, or from parameters.
//
//   gives    Sunlight, sunlight, sun_direction, sun_elevation
//   needs    the output of lighting/daylight, or one black texel, and whether it is wired
//   units    azimuth and elevation in degrees; light without unit, 1 that of the sun outside the
//            air
//   source   none: the order of texels in lighting/daylight/light
//   tested   tests/glsl/test_daylight.py, wired and not
#ifndef LIGHTING_DAYLIGHT_READING
#define LIGHTING_DAYLIGHT_READING
struct Sunlight {
    vec3 direction;  // towards the sun
    vec2 place;      // its azimuth and elevation
    vec3 sun;        // its light on a surface that faces it
    vec3 sky;        // the sky's light on open level ground
};

// The direction of the sun, for what asks no more. `towards` is what is given for the parameter.
vec3 sun_direction(bool wired, sampler2D daylight, vec3 towards) {
    return wired ? texelFetch(daylight, ivec2(0), 0).rgb : towards;
}

// Its elevation.
float sun_elevation(bool wired, sampler2D daylight, vec2 sun) {
    return wired ? texelFetch(daylight, ivec2(0), 0).a : sun.y;
}

Sunlight sunlight(bool wired, sampler2D daylight, vec3 towards, vec2 sun, vec3 sun_colour,
                  vec3 sky_colour) {
    if (!wired) return Sunlight(towards, sun, sun_colour, sky_colour);
    vec4 first = texelFetch(daylight, ivec2(0), 0);
    vec4 second = texelFetch(daylight, ivec2(1, 0), 0);
    vec4 third = texelFetch(daylight, ivec2(2, 0), 0);
    return Sunlight(first.rgb, vec2(second.a, first.a), second.rgb, third.rgb);
}
#endif

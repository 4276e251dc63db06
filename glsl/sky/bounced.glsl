// sky/bounced.glsl -- the table of light that was scattered twice or more.
//
//   gives    LEAST_BOUNCED, bounced_start, bounced_at
//   needs    sky/shell.glsl; a table made by lighting/daylight/bounced
//   units    sines of the sun's elevation; kilometres; light per unit of the sun's, per steradian
//   source   Hillaire 2020, eq. 10; axes and logarithm made here
//   tested   tests/glsl/test_air.py, against a finer sum in float64
//
// Here are its axes, and how it is read.
//
// Light fades in twilight by a factor of ten in two degrees. Logarithms are straight there, so
// the table may be coarse. The sun is followed down to 21 degrees below the horizon.
#ifndef SKY_BOUNCED
#define SKY_BOUNCED
#include "sky/shell.glsl"

const float LEAST_BOUNCED = 1e-13;
const float LOWEST_SUN = -0.36;

// The sine of the sun's elevation and the height that a place in the table represents, both 0..1.
vec2 bounced_start(vec2 share) {
    return vec2(mix(LOWEST_SUN, 1.0, share.x), AIR_HEIGHT * share.y * share.y);
}

vec3 bounced_at(sampler2D bounced, float height, float sun_rise) {
    vec2 share = vec2((sun_rise - LOWEST_SUN) / (1.0 - LOWEST_SUN),
                      sqrt(max(height, 0.0) / AIR_HEIGHT));
    ivec2 last = textureSize(bounced, 0) - 1;
    vec2 place = clamp(share, 0.0, 1.0) * vec2(last);
    ivec2 low = ivec2(place);
    ivec2 high = min(low + 1, last);
    vec2 part = place - vec2(low);
    vec3 south = mix(texelFetch(bounced, low, 0).rgb,
                     texelFetch(bounced, ivec2(high.x, low.y), 0).rgb, part.x);
    vec3 north = mix(texelFetch(bounced, ivec2(low.x, high.y), 0).rgb,
                     texelFetch(bounced, high, 0).rgb, part.x);
    return max(exp(mix(south, north, part.y)) - LEAST_BOUNCED, 0.0);
}
#endif

// lighting/daylight_sky.glsl -- the colour of the sky in any direction, from lighting/daylight.
//
//   gives    sky_towards, air_rise, air_towards, horizon_of, level_light
//   needs    sky/dome.glsl; the output of lighting/daylight
//   units    heights of the eye over the sea in kilometres; light without unit: what is seen is as
//            bright as a white surface in as much light
//   source   none: the order of texels in lighting/daylight/light
//   tested   tests/glsl/test_air.py, against light worked out in each direction in float64
#ifndef LIGHTING_DAYLIGHT_SKY
#define LIGHTING_DAYLIGHT_SKY
#include "sky/dome.glsl"

// Without the sun itself; below the horizon, what is on the horizon above it.
vec3 sky_towards(sampler2D daylight, vec3 direction, float height) {
    return dome_at(daylight, 1, direction, texelFetch(daylight, ivec2(0), 0).rgb, height);
}

// The sine of the elevation just above the horizon from a height.
float air_rise(float height) {
    return horizon_rise(height) + 0.03;
}

// What air far away adds on the path there: the sky just above the horizon on that side.
vec3 air_towards(sampler2D daylight, vec3 direction, float height) {
    float rise = air_rise(height);
    vec2 level = sqrt(1.0 - rise * rise) * direction.xy / max(length(direction.xy), 1e-6);
    return sky_towards(daylight, vec3(level, rise), height);
}

// The mean of the sky all round, just above the horizon.
vec3 horizon_of(sampler2D daylight, float height) {
    float place = dome_between(height);
    int low = int(place);
    vec3 below = texelFetch(daylight, ivec2(7 + low, 0), 0).rgb;
    return mix(below, texelFetch(daylight, ivec2(7 + min(low + 1, DOMES - 1), 0), 0).rgb,
               place - float(low));
}

// What open level ground receives from sun and sky together.
vec3 level_light(sampler2D daylight) {
    return texelFetch(daylight, ivec2(5, 0), 0).rgb;
}
#endif

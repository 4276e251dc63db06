// clouds/sunlight.glsl -- the light that comes to clouds: sun, sky and ground.
//
//   gives    CloudLight, cloud_light, aureole
//   needs    sky/columns.glsl, sky/drops.glsl, lighting/daylight_reading.glsl,
//            lighting/daylight_weather.glsl; a daylight and two of its tables
//   units    light as of lighting/daylight: that of a surface which faces it, and for `above` and
//            `below` that of a surface which has them all around
//   source   none: what daylight says, at the height of the clouds
//   tested   tests/glsl/test_cloud_pictures.py: no cloud is brighter than what it receives
#ifndef CLOUDS_SUNLIGHT
#define CLOUDS_SUNLIGHT
#include "lighting/daylight_reading.glsl"
#include "lighting/daylight_weather.glsl"
#include "sky/columns.glsl"
#include "sky/drops.glsl"

struct CloudLight {
    vec3 to_sun;
    vec3 sun;    // its beam over the clouds, which the ones below have not dimmed
    vec3 above;  // of the sky
    vec3 below;  // of the ground
};

// After a path [km] in a direction from a height [km], to clouds at another.
CloudLight cloud_light(sampler2D daylight, sampler2D columns, sampler2D bounced, float from,
                       vec3 ahead, float path, float height) {
    Sunlight day = sunlight(true, daylight, vec3(0.0), vec2(0.0), vec3(0.0), vec3(0.0));
    Weather now = weather(daylight);
    float rise = ((EARTH_RADIUS + from) * day.direction.z + path * dot(ahead, day.direction))
            / (EARTH_RADIUS + height);
    vec3 beam = left_of_sunlight(columns, air_of(now.turbidity), height, rise);
    return CloudLight(day.direction, now.adapted * beam, day.sky,
                      texelFetch(bounced, ivec2(0), 0).a * now.level);
}

// What drops turn so little that the beam counts it as its own: a glow around the sun where clouds
// are thin, by what they leave of that beam.
vec3 aureole(vec3 beam, float left, float together) {
    float straight = pow(left, 1.0 / (1.0 - UNSCATTERED));
    return 3.14159265 * beam * (max(left - straight, 0.0) * drops_peak(together));
}
#endif

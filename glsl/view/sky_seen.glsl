// view/sky_seen.glsl -- the colour of the sky at a pixel.
//
//   gives    SkyView, sky_seen
//   needs    lighting/daylight_reading.glsl, lighting/daylight_sky.glsl, lighting/sun_image.glsl;
//            the camera and the daylight come as arguments
//   units    colours linear; pixels from the picture's south-west corner
//   source   the colours: none, a backdrop; the sky: see lighting/daylight/dome
//   tested   tests/glsl/test_view.py and tests/glsl/test_daylight.py, by view/sky
#ifndef VIEW_SKY_SEEN
#define VIEW_SKY_SEEN
#include "lighting/daylight_reading.glsl"
#include "lighting/daylight_sky.glsl"
#include "lighting/sun_image.glsl"

struct SkyView {
    mat4 world_from_clip;
    vec3 eye;
    vec2 size;      // of the picture, in pixels
    float height;   // of the eye  [km above sea level]
};

vec3 direction_of(SkyView view, vec2 pixel) {
    vec4 far_point = view.world_from_clip * vec4(pixel / view.size * 2.0 - 1.0, 1.0, 1.0);
    return normalize(far_point.xyz / far_point.w - view.eye);
}

// How much of a pixel the sun's disc covers.
float disc_in(vec3 towards, vec3 sun, float pixel, float height) {
    return towards.z < horizon_rise(height) ? 0.0
            : clamp((radians(SUN_RADIUS) - distance(towards, sun)) / pixel + 0.5, 0.0, 1.0);
}

vec3 daylight_in(sampler2D daylight, vec3 towards, float pixel, float height, vec3 nadir) {
    vec3 seen = sky_towards(daylight, towards, height);
    Sunlight from = sunlight(true, daylight, vec3(0.0), vec2(0.0), vec3(0.0), vec3(0.0));
    vec3 disc = sun_image(from.sun, SUN_OVER_WHITE);
    seen = mix(seen, max(disc, seen), disc_in(towards, from.direction, pixel, height));
    vec3 below = nadir * level_light(daylight);
    return towards.z < 0.0 ? mix(seen, below, 1.0 - exp(3.0 * towards.z)) : seen;
}

// Three colours, or by day the sky of a daylight with the sun in it.
vec3 sky_seen(SkyView view, vec2 pixel, bool by_day, sampler2D daylight, vec3 zenith, vec3 horizon,
              vec3 nadir) {
    vec3 towards = direction_of(view, pixel);
    // Both halves leave the horizon at the same pace, so that no line is seen there.
    float share = 1.0 - exp(-3.0 * abs(towards.z));
    vec3 seen = mix(horizon, towards.z > 0.0 ? zenith : nadir, share);
    if (by_day) {
        float wide = distance(towards, direction_of(view, pixel + vec2(0.0, 1.0)));
        seen = daylight_in(daylight, towards, max(wide, 1e-6), view.height, nadir);
    }
    return seen;
}
#endif

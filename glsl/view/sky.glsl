// view/sky.glsl -- what is behind the terrain.
//
//   gives    frame, linear light
//   needs    lighting/daylight_reading.glsl, lighting/daylight_sky.glsl, lighting/sun_image.glsl;
//            the camera; daylight if there is any
//   units    colours linear
//   source   the colours: none, a backdrop; the sky: see lighting/daylight/dome
//   tested   tests/glsl/test_view.py: the horizon's colour at the horizon, overhead's above; and
//            tests/glsl/test_daylight.py: the sky's colours and the sun's disc where they belong
//
// Three colours, or the sky of a daylight with the sun in it.
#include "lighting/daylight_reading.glsl"
#include "lighting/daylight_sky.glsl"
#include "lighting/sun_image.glsl"
#pragma kernel(output = "frame:rgba16f")

uniform sampler2D daylight;  //! input("black")
uniform int sky = 0;         //! menu("colours", "daylight") group("Sky")
                             //! What is behind the terrain: the colours below, or the sky of
                             //! lighting/daylight if the sketch has it
uniform vec3 zenith = vec3(0.105, 0.245, 0.56);  //! colour group("Sky") Straight overhead
uniform vec3 horizon = vec3(0.60, 0.70, 0.80);   //! colour group("Sky") Level with the eye
uniform vec3 nadir = vec3(0.125, 0.19, 0.27);     //! colour group("Sky")
                                                  //! Straight underfoot, where there is no
                                                  //! terrain; under daylight, what it is in white
                                                  //! light

vec3 direction_of(vec2 pixel) {
    vec4 away = world_from_clip * vec4(pixel / vec2(size) * 2.0 - 1.0, 1.0, 1.0);
    return normalize(away.xyz / away.w - eye);
}

// How much of a pixel the sun's disc covers.
float disc_in(vec3 towards, vec3 sun, float pixel, float height) {
    return towards.z < horizon_rise(height) ? 0.0
            : clamp((radians(SUN_RADIUS) - distance(towards, sun)) / pixel + 0.5, 0.0, 1.0);
}

vec3 daylight_in(vec3 towards, float pixel) {
    float height = 0.001 * max(base_elevation + eye.z, 0.0);
    vec3 seen = sky_towards(daylight, towards, height);
    Sunlight from = sunlight(true, daylight, vec3(0.0), vec2(0.0), vec3(0.0), vec3(0.0));
    vec3 disc = sun_image(from.sun, SUN_OVER_WHITE);
    seen = mix(seen, max(disc, seen), disc_in(towards, from.direction, pixel, height));
    vec3 below = nadir * level_light(daylight);
    return towards.z < 0.0 ? mix(seen, below, 1.0 - exp(3.0 * towards.z)) : seen;
}

vec4 kernel(ivec2 texel) {
    vec3 towards = direction_of(vec2(texel) + 0.5);
    // Both halves leave the horizon at the same pace, so that no line is seen there.
    float share = 1.0 - exp(-3.0 * abs(towards.z));
    vec3 seen = mix(horizon, towards.z > 0.0 ? zenith : nadir, share);
    if (sky == 1 && wired_daylight) {
        float pixel = distance(towards, direction_of(vec2(texel) + vec2(0.5, 1.5)));
        seen = daylight_in(towards, max(pixel, 1e-6));
    }
    return vec4(seen, 1.0);
}

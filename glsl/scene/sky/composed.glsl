// scene/sky/composed.glsl -- sky, sun and stars, and what is in front of them.
//
//   gives    sky, linear light
//   needs    lighting/daylight_weather.glsl, lighting/sun_image.glsl, sky/columns.glsl,
//            sky/drops.glsl, sky/stars.glsl, scene/surfaces.glsl, maths/drape.glsl; the camera;
//            scene/sky/backdrop, scene/sky/through_air, a daylight and one of its tables
//   units    light as of lighting/daylight
//   source   see lighting/daylight/dome and scene/air
//   tested   tests/glsl/test_cloud_pictures.py: as the sky where there is no cloud; at the horizon
//            as the air
//
// Where no clouds are drawn the sky is as lighting/daylight has it, its cover spread evenly. Where
// they are, it is the clear sky, and the clouds make the cover.
#include "lighting/daylight_weather.glsl"
#include "lighting/sun_image.glsl"
#include "maths/drape.glsl"
#include "scene/surfaces.glsl"
#include "sky/columns.glsl"
#include "sky/drops.glsl"
#include "sky/stars.glsl"
#pragma kernel(output = "sky:rgba16f")

uniform sampler2D daylight;  //! input
uniform sampler2D columns;   //! input
uniform sampler2D backdrop;  //! input("linear")
uniform sampler2D in_front;  //! input("linear")
uniform sampler2D seen;      //! input("black")
#include "clouds/parameters/drawn.glsl"

// For a brighter sky the eye is adapted less, and stars are lost in it.
const float STARS_FROM = 1000.0;

vec3 direction_of(vec2 pixel) {
    vec4 far_point = world_from_clip * vec4(pixel / vec2(size) * 2.0 - 1.0, 1.0, 1.0);
    return normalize(far_point.xyz / far_point.w - eye);
}

// The sun's disc in a pixel: how much of it, times what is left of its light.
vec3 disc_in(vec3 towards, vec3 sun, float pixel, float height, Weather now) {
    float part = clamp((radians(SUN_RADIUS) - distance(towards, sun)) / pixel + 0.5, 0.0, 1.0);
    if (towards.z < horizon_rise(height) || part <= 0.0) return vec3(0.0);
    vec3 beam = now.adapted * left_of_sunlight(columns, air_of(now.turbidity), height, sun.z);
    return part * sun_image(beam, SUN_OVER_WHITE);
}

vec4 kernel(ivec2 texel) {
    if (wired_seen && !is_sky(texelFetch(seen, texel, 0).a)) return vec4(0.0, 0.0, 0.0, 1.0);
    if (skips_rest()) return vec4(0.0);
    vec2 share = (vec2(texel) + 0.5) / vec2(size);
    vec3 towards = direction_of(vec2(texel) + 0.5);
    float height = 0.001 * max(base_elevation + eye.z, 0.0);
    vec3 sun = texelFetch(daylight, ivec2(0), 0).rgb;
    vec4 front = textureLod(in_front, share, 0.0);
    vec3 found = textureLod(backdrop, drape_uv(share, textureSize(backdrop, 0)), 0.0).rgb;
    found = found * front.a + front.rgb;
    // What comes straight through clouds: nothing that was turned aside.
    Weather now = weather(daylight);
    float straight = clouds == 0 ? now.open
            : pow(clamp(front.a, 0.0, 1.0), 1.0 / (1.0 - UNSCATTERED));
    float near = distance(towards, direction_of(vec2(texel) + vec2(0.5, 1.5)));
    if (distance(towards, sun) < 0.1) {
        found += straight * disc_in(towards, sun, max(near, 1e-6), height, now);
    }
    if (now.adapted > STARS_FROM && straight > 0.0) {
        vec3 celestial = celestial_of(towards, now.latitude, now.sidereal);
        vec3 left = left_of_sunlight(columns, air_of(now.turbidity), height, towards.z);
        float shown = straight * now.adapted * smoothstep(1.0, 4.0, now.adapted / STARS_FROM);
        found += min(shown * left * (stars_towards(celestial, near) + milky_way(celestial)),
                     DAZZLING);
    }
    return vec4(found, 1.0);
}

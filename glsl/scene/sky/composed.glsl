// scene/sky/composed.glsl -- sky, sun and clouds, and the land beyond the terrain, through air.
//
//   gives    sky, linear light
//   needs    lighting/daylight_weather.glsl, sky/columns.glsl, sky/drops.glsl, maths/drape.glsl,
//            scene/air_reading.glsl; the camera; a daylight and one of its tables, scene/air,
//            scene/sky/backdrop, scene/sky/through_air; where a scene has something else, if any
//   units    light as of lighting/daylight
//   source   see lighting/daylight/dome and scene/air
//   tested   tests/glsl/test_cloud_pictures.py: as the sky where there is no cloud; at the horizon
//            as the air
//
// Where no clouds are drawn the sky is as lighting/daylight has it, its cover spread evenly. Where
// they are, it is the clear sky, and the clouds make the cover.
#include "lighting/daylight_weather.glsl"
#include "maths/drape.glsl"
#include "scene/air_reading.glsl"
#include "sky/columns.glsl"
#include "sky/drops.glsl"
#pragma kernel(output = "sky:rgba16f")

uniform sampler2D seen;           //! input("zero")
uniform sampler2D daylight;       //! input
uniform sampler2D backdrop;       //! input("linear")
uniform sampler2D columns;        //! input
uniform sampler2D drift;          //! input("black")
uniform sampler2D scattered;      //! input("linear")
uniform sampler2D left;           //! input("linear")
uniform sampler2D cloud_picture;  //! input("linear")
uniform int clouds = 2;           //! menu("none", "flat", "heaped")
                                  //! What clouds are drawn: none, a flat layer for slow
                                  //! renderers, or heaps
uniform vec3 beyond = vec3(0.07, 0.10, 0.05);  //! colour
                                  //! Of the flat land beyond the terrain

// The sun is 47,000 times as bright as white paper in its light, far past what half floats hold.
const float BRIGHTEST = 60.0;

vec3 direction_of(vec2 pixel) {
    vec4 away = world_from_clip * vec4(pixel / vec2(size) * 2.0 - 1.0, 1.0, 1.0);
    return normalize(away.xyz / away.w - eye);
}

// The sun's disc in a pixel: how much of it, times what is left of its light.
vec3 disc_in(vec3 towards, vec3 sun, float pixel, float height, Weather now) {
    float part = clamp((radians(SUN_RADIUS) - distance(towards, sun)) / pixel + 0.5, 0.0, 1.0);
    if (towards.z < horizon_rise(height) || part <= 0.0) return vec3(0.0);
    vec3 beam = now.adapted * left_of_sunlight(columns, air_of(now.turbidity), height, sun.z);
    float lit = dot(beam, vec3(0.2126, 0.7152, 0.0722));
    return beam * (part * min(46750.0, BRIGHTEST / max(lit, 1e-9)));
}

vec4 kernel(ivec2 texel) {
    // Nothing is seen of it where a scene has something else.
    if (wired_seen && texelFetch(seen, texel, 0).w != 0.0) return vec4(0.0);
    vec2 share = (vec2(texel) + 0.5) / vec2(size);
    vec3 towards = direction_of(vec2(texel) + 0.5);
    float height = 0.001 * max(base_elevation + eye.z, 0.0);
    vec3 sun = texelFetch(daylight, ivec2(0), 0).rgb;
    Weather now = weather(daylight);
    vec4 cloud = vec4(vec3(0.0), clouds == 0 ? now.open : 1.0);
    if (clouds != 0) cloud = textureLod(cloud_picture, share, 0.0);
    float ground = way_to_ground(height, towards.z);
    float base = 0.001 * (base_elevation + texelFetch(drift, ivec2(0), 0).z);
    if (clouds != 0 && ground >= 0.0 && height < base) cloud = vec4(vec3(0.0), 1.0);
    vec3 found = textureLod(backdrop, drape_uv(share, textureSize(backdrop, 0)), 0.0).rgb;
    if (ground >= 0.0) {
        Aerial air = aerial(scattered, left, share, 1000.0 * ground);
        found = beyond * now.level * air.left + air.scattered;
    }
    if (clouds != 0) found *= cloud.a;
    if (ground < 0.0 && distance(towards, sun) < 0.1) {
        float pixel = distance(towards, direction_of(vec2(texel) + vec2(0.5, 1.5)));
        // Of the disc's own light nothing that was turned aside.
        float straight = clouds == 0 ? cloud.a
                : pow(clamp(cloud.a, 0.0, 1.0), 1.0 / (1.0 - UNSCATTERED));
        found += straight * disc_in(towards, sun, max(pixel, 1e-6), height, now);
    }
    if (clouds != 0) found += cloud.rgb;
    return vec4(found, 1.0);
}

// scene/sky/backdrop.glsl -- the sky without sun and clouds, as a small picture.
//
//   gives    backdrop
//   needs    lighting/daylight_sky.glsl, lighting/daylight_weather.glsl; the camera; a daylight
//            and its dome
//   units    light as of lighting/daylight
//   source   see lighting/daylight/dome
//   tested   tests/glsl/test_cloud_pictures.py: as the sky itself
//
// The sky is smooth: a sixty-fourth of the pixels is enough, and it is the dearest of what a pixel
// of the sky needs. Below the horizon it goes on as it is there.
#include "lighting/daylight_sky.glsl"
#include "lighting/daylight_weather.glsl"
#pragma kernel(output = "backdrop:rgba16f")

uniform sampler2D daylight;  //! input
uniform sampler2D dome;      //! input
#include "clouds/parameters/drawn.glsl"

vec4 kernel(ivec2 texel) {
    // The first and the last lie on the picture's edges.
    vec2 share = vec2(texel) / vec2(max(size - 1, 1));
    vec4 far = world_from_clip * vec4(share * 2.0 - 1.0, 1.0, 1.0);
    vec3 towards = normalize(far.xyz / far.w - eye);
    float height = 0.001 * max(base_elevation + eye.z, 0.0);
    if (clouds == 0) return vec4(sky_towards(daylight, towards, height), 1.0);
    vec3 sun = texelFetch(daylight, ivec2(0), 0).rgb;
    return vec4(weather(daylight).adapted * dome_at(dome, 0, towards, sun, height), 1.0);
}

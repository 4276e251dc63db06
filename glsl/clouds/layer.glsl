// clouds/layer.glsl -- clouds by four looks at their tile, for slow renderers.
//
//   gives    clouds: the light that they send to the eye, and in alpha what of the sky behind they
//            leave; the air in front of them is left to what reads it
//   needs    clouds/crossing.glsl, clouds/heap_light.glsl, clouds/shadow.glsl,
//            clouds/sunlight.glsl, scene/sky/hidden.glsl; the camera; a tile of clouds, a drift,
//            a daylight and two of its tables
//   units    metres; light as of lighting/daylight
//   source   as clouds/seen, with one look towards the sun, whose depth is tuned for it
//   tested   tests/glsl/test_cloud_pictures.py: the cover is that of the shadows; they hide as
//            much and are as bright as heaped ones
//
// Each look is at a fourth of the layer, so clouds have sides and hide the more of the sky the
// lower one looks; it is as wide as the looks are apart, so they do not show as sheets.
#include "clouds/crossing.glsl"
#include "clouds/heap_light.glsl"
#include "clouds/shadow.glsl"
#include "clouds/sunlight.glsl"
#include "scene/sky/hidden.glsl"
#pragma kernel(output = "clouds:rgba16f")

uniform sampler2D daylight;  //! input
uniform sampler2D columns;   //! input
uniform sampler2D bounced;   //! input
uniform sampler2D cloud;     //! input("linear", "repeat", "mipmap")
uniform sampler2D drift;     //! input
uniform sampler2D seen;      //! input("black")

const int LOOKS = 4;
const float NEAR_SUN = 250.0;  // [m] towards the sun from a place, where its light is asked for
const float AROUND = 0.5;      // how thick clouds are around one, over how thick it is
const float LONGEST = 12.0;    // [km] of the layer
const float FARTHEST = 300.0;  // [km] past any horizon

vec3 direction_of(vec2 pixel) {
    vec4 far_point = world_from_clip * vec4(pixel / vec2(size) * 2.0 - 1.0, 1.0, 1.0);
    return normalize(far_point.xyz / far_point.w - eye);
}

vec4 kernel(ivec2 texel) {
    if (wired_seen && sky_hidden(seen, texel, size)) return vec4(0.0, 0.0, 0.0, 1.0);
    vec3 ahead = direction_of(vec2(texel) + 0.5);
    float angle = distance(ahead, direction_of(vec2(texel) + vec2(0.5, 1.5)));
    vec4 wind = texelFetch(drift, ivec2(0), 0);
    float from = 0.001 * max(base_elevation + eye.z, 0.0);
    float base = 0.001 * (base_elevation + wind.z);
    ahead = over_horizon(ahead, from, base);
    vec2 span = layer_crossing(from, ahead.z, base, base + 0.001 * CLOUD_TALL);
    if (span.y <= span.x || span.x > FARTHEST) return vec4(0.0, 0.0, 0.0, 1.0);
    float texel_wide = wind.w / float(textureSize(cloud, 0).x);
    float longest = 1000.0 * min(span.y - span.x, LONGEST) / float(LOOKS);
    float spread = longest * sqrt(1.0 - ahead.z * ahead.z);
    float level = log2(max(max(1000.0 * span.x * angle, 0.2 * spread) / texel_wide, 1.0));
    vec3 to_sun = sun_direction(true, daylight, vec3(0.0));
    float together = dot(ahead, to_sun);
    float transmittance = 1.0;
    vec3 part = vec3(0.0);
    for (int k = 0; k < LOOKS; k++) {
        float path = 1000.0 * span.x + (float(k) + 0.5) * longest;
        float up = (1000.0 * (height_along(from, ahead.z, 0.001 * path) - base)) / CLOUD_TALL;
        vec2 at = tile_of(eye.xy + ahead.xy * path, wind);
        float thick = textureLod(cloud, at, level).r;
        float steep = 1.0 / (1.0 / CLOUD_STEEP + longest / CLOUD_TALL * 0.3);
        float much = clamp(0.5 + (thick - up) * steep, 0.0, 1.0) * min(CLOUD_STEEP * thick, 1.0);
        if (much <= 0.0) continue;
        vec3 to = to_sun * NEAR_SUN;
        float there = textureLod(cloud, at + to.xy / wind.w, level).r;
        float depth = CLOUD_DEPTH * clamp(0.42 + there - up - to.z / CLOUD_TALL, 0.0, 1.0);
        float above = CLOUD_DEPTH * max(thick - up, 0.0);
        float whole = CLOUD_DEPTH * max(thick, up);
        float from_sun = sun_in_heap(depth, above, whole, thick * AROUND, to_sun.z, together,
                                     ahead.z);
        float left = exp(-much * CLOUD_DEPTH * longest / CLOUD_TALL);
        part += transmittance * (1.0 - left)
                * vec3(from_sun, 1.0, share_from_below(above, whole));
        transmittance *= left;
    }
    if (transmittance == 1.0) return vec4(0.0, 0.0, 0.0, 1.0);
    CloudLight light = cloud_light(daylight, columns, bounced, from, ahead, span.x, base);
    vec3 found = part.x * light.sun + (part.y - part.z) * light.above + part.z * light.below;
    return vec4(found + aureole(light.sun, transmittance, together), transmittance);
}

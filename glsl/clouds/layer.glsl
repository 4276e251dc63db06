// clouds/layer.glsl -- clouds as a flat layer, for slow renderers.
//
//   gives    clouds: the light that they send to the eye, and in alpha what of the sky behind they
//            leave; the air in front of them is left to what reads it
//   needs    clouds/crossing.glsl, clouds/shadow.glsl, clouds/sunlight.glsl; the camera; a tile of
//            clouds, a drift, a daylight and two of its tables
//   units    metres; light as of lighting/daylight
//   source   what comes out below and above of a layer that absorbs nothing: sky/drops.glsl
//   tested   tests/glsl/test_cloud_pictures.py: the cover is that of the shadows
//
// It lies where the shadows take the clouds to be.
#include "clouds/crossing.glsl"
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

const float LOWEST_SUN = 0.1;  // below it clouds are lit from the side, which a flat layer has not
const float FARTHEST = 300.0;  // [km] past any horizon

vec3 direction_of(vec2 pixel) {
    vec4 away = world_from_clip * vec4(pixel / vec2(size) * 2.0 - 1.0, 1.0, 1.0);
    return normalize(away.xyz / away.w - eye);
}

vec4 kernel(ivec2 texel) {
    if (wired_seen && sky_hidden(seen, texel, size)) return vec4(0.0, 0.0, 0.0, 1.0);
    vec3 ahead = direction_of(vec2(texel) + 0.5);
    float angle = distance(ahead, direction_of(vec2(texel) + vec2(0.5, 1.5)));
    vec4 wind = texelFetch(drift, ivec2(0), 0);
    float from = 0.001 * max(base_elevation + eye.z, 0.0);
    float height = 0.001 * (base_elevation + wind.z + CLOUD_MIDDLE);
    ahead = over_horizon(ahead, from, height);
    vec2 span = layer_crossing(from, ahead.z, height, height + 1e-3);
    if (span.y <= span.x || span.x > FARTHEST) return vec4(0.0, 0.0, 0.0, 1.0);
    float texel_wide = wind.w / float(textureSize(cloud, 0).x);
    float pixel = 1000.0 * span.x * angle;
    // Seen at an angle a pixel is longer than wide; between the two little flickers or blurs.
    float stretched = pixel * inversesqrt(max(abs(ahead.z), 0.02));
    float level = max(log2(max(stretched, 1e-3) / texel_wide), 0.0);
    vec4 here = textureLod(cloud, tile_of(eye.xy + ahead.xy * (1000.0 * span.x), wind), level);
    if (here.a > 0.9995) return vec4(0.0, 0.0, 0.0, 1.0);
    CloudLight light = cloud_light(daylight, columns, bounced, from, ahead, span.x, height);
    float whole = depth_straight_up(here.r);
    float sine = max(light.to_sun.z, LOWEST_SUN);
    Crossing crossed = crossing(whole, sine);
    float scattered = from < height ? crossed.through - exp(-min(whole / sine, 80.0))
            : crossed.reflected;
    vec3 found = light.sun * (sine * scattered)
            + (1.0 - here.a) * diffuse_between(light.above, light.below,
                                               from < height ? whole : 0.0, whole);
    return vec4(found + aureole(light.sun, here.a, dot(ahead, light.to_sun)), here.a);
}

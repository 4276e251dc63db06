// scene/water/mirrored_sky.glsl -- the sky in a direction from the water, with its clouds.
//
//   gives    sky_of, clouds_towards
//   needs    clouds/shadow.glsl, scene/water/heaven_reading.glsl; the table of
//            scene/water/heaven, a tile by clouds/field and a drift come as arguments
//   units    metres; light as of lighting/daylight
//   source   the heaps of clouds/seen, by few steps: what is mirrored is never as sharp
//   tested   tests/glsl/test_scene_water.py: mirrored clouds have the cover of those above
#ifndef SCENE_WATER_MIRRORED_SKY
#define SCENE_WATER_MIRRORED_SKY
#include "clouds/shadow.glsl"
#include "scene/water/heaven_reading.glsl"

const int CLOUD_STEPS = 8;
const float LONGEST_STEP = 500.0;  // [m]

vec3 sky_of(sampler2D heaven, int which, vec3 to) {
    return textureLod(heaven, heaven_place(to, which, textureSize(heaven, 0)), 0.0).rgb;
}

// The light of the clouds that a ray from a place meets, and in alpha what they leave of the sky
// behind; `blur` is how wide what is mirrored blurs [radians]. Heaped, or as a flat layer.
vec4 clouds_towards(sampler2D cloud, sampler2D heaven, vec4 drift, vec3 place, vec3 to,
                    float blur, bool heaped) {
    vec3 bright = sky_of(heaven, THIN_SKY, to);
    vec3 dark = sky_of(heaven, THICK_SKY, to);
    float rise = max(to.z, 0.03);
    float way = max(drift.z - place.z, 0.0) / rise;
    float texel = drift.w / float(textureSize(cloud, 0).x);
    float level = max(log2(max(blur * way, 1.0) / texel), 0.0);
    if (!heaped) {
        way += CLOUD_MIDDLE / rise;
        vec4 tile = textureLod(cloud, tile_of(place.xy + to.xy * way, drift), level);
        float deep = clamp((tile.r - THIN_CLOUD) / (THICK_CLOUD - THIN_CLOUD), 0.0, 1.0);
        return vec4(mix(bright, dark, deep) * (1.0 - tile.a), tile.a);
    }
    float climb = CLOUD_TALL / float(CLOUD_STEPS);
    float step_of = min(climb / rise, LONGEST_STEP);
    float left = 1.0;
    vec3 found = vec3(0.0);
    for (int k = 0; k < CLOUD_STEPS; k++) {
        float path = way + (float(k) + 0.5) * step_of;
        float up = (float(k) + 0.5) * step_of * rise / CLOUD_TALL;
        float deep = textureLod(cloud, tile_of(place.xy + to.xy * path, drift), level).r;
        float much = clamp((deep - up) * 6.0, 0.0, 1.0);
        float passed = exp(-much * CLOUD_DEPTH / CLOUD_TALL * step_of);
        // Their feet are dark, their heads bright.
        float shade = clamp((deep - up - THIN_CLOUD) / (THICK_CLOUD - THIN_CLOUD), 0.0, 1.0);
        found += left * (1.0 - passed) * mix(bright, dark, shade);
        left *= passed;
    }
    return vec4(found, left);
}
#endif

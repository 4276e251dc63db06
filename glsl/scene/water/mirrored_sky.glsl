// scene/water/mirrored_sky.glsl -- the sky in a direction from the water, with its clouds.
//
//   gives    sky_of, LOBE, clouds_towards
//   needs    clouds/shadow.glsl, scene/water/heaven_reading.glsl; the table of
//            scene/water/heaven, a tile by clouds/field and a drift come as arguments
//   units    metres; light as of lighting/daylight
//   source   the clouds' outlines by few looks at their tile, from which share of a wide look is
//            under cloud and how thick that is: made here
//   tested   tests/glsl/test_scene_water.py: mirrored clouds have the light and the colour of
//            those above
//
// A wide look at how thick clouds are is a mean: to ask whether that is more than some height has
// yes or no for an answer, and an edge where there should be none. What clouds leave of the light
// is a mean that can be taken as it is. So each look is at that first, and the mean thickness only
// says how high those clouds are.
#ifndef SCENE_WATER_MIRRORED_SKY
#define SCENE_WATER_MIRRORED_SKY
#include "clouds/shadow.glsl"
#include "scene/water/heaven_reading.glsl"

const int CLOUD_LOOKS = 4;
const float UP_TO = 0.8;            // of the layer's height, where there is much of them
const float MAX_RUN = 4000.0;  // [m] through the layer that looks are spread over

// A mirror whose slopes have a variance, of both axes together, turns rays by twice the deviation
// of one; a level of detail with texels of a width has a deviation of half of it.
const float LOBE = 2.83;

vec3 sky_of(sampler2D heaven, int which, vec3 to) {
    return textureLod(heaven, heaven_place(to, which, textureSize(heaven, 0)), 0.0).rgb;
}

// The light of the clouds that a ray from a place meets, and in alpha what they leave of the sky
// behind; `blur` is how wide what is mirrored blurs [radians]. Heaped, or as a flat layer.
vec4 clouds_towards(sampler2D cloud, sampler2D heaven, vec4 drift, vec3 place, vec3 to,
                    float blur, bool heaped) {
    float rise = max(to.z, 0.03);
    float run = max(drift.z - place.z, 0.0) / rise;
    float through = heaped ? min(UP_TO * CLOUD_TALL / rise, MAX_RUN) : 0.0;
    float texel = drift.w / float(textureSize(cloud, 0).x);
    float wide = max(blur * run, 0.3 * through * length(to.xy));
    float level = max(log2(max(wide, 1.0) / texel), 0.0);
    float left = 1.0;
    float deep = 0.0;
    for (int k = 0; k < CLOUD_LOOKS; k++) {
        float part = float(k) / float(CLOUD_LOOKS);
        vec2 there = place.xy + to.xy * (run + part * through);
        vec4 tile = textureLod(cloud, tile_of(there, drift), level);
        float hidden = 1.0 - tile.a;
        float thick = tile.r / max(hidden, 0.02);
        // Of clouds that thick on the mean, some up to twice as much, what reaches up to the ray.
        float tall = clamp(1.0 - 0.5 * UP_TO * part / max(thick, 0.02), 0.0, 1.0);
        left = min(left, 1.0 - hidden * tall);
        deep = max(deep, thick);
        if (!heaped) break;
    }
    vec3 light = mix(sky_of(heaven, THIN_SKY, to), sky_of(heaven, THICK_SKY, to),
                     share_of_thick(deep));
    return vec4(light * (1.0 - left), left);
}
#endif

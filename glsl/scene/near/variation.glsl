// scene/near/variation.glsl -- the ground's colour from patch to patch, tens of metres wide.
//
//   gives    Variation, variation_at, dried
//   needs    noise/gradient.glsl, scene/near/ladder.glsl
//   units    metres; all of it between -1 and 1, of mean 0; colours linear
//   source   made here
//   tested   tests/glsl/test_near.py: means of colour are unchanged
//
// A noise's slopes are two more fields that share nothing with its heights at a place, and cost
// nothing more: heights tell where the ground is dry, slopes to the east where it is light.
#ifndef SCENE_NEAR_VARIATION
#define SCENE_NEAR_VARIATION
#include "noise/gradient.glsl"
#include "scene/near/ladder.glsl"

struct Variation {
    float dry;    // straw where above 0, fresh green where below
    float light;
    float broad;  // of the widest patches alone
};

const uint VARIATION_SALT = 0x72263dffu;  // CRC-32 of "scene/near/variation"
const float WIDEST = 420.0;               // [m] cells of the widest patches
const int PATCHES = 5;

Variation variation_at(vec2 place, float pixel) {
    Variation v = Variation(0.0, 0.0, 0.0);
    float cell = WIDEST;
    float strength = 0.9;
    for (int k = 0; k < PATCHES; k++) {
        vec3 noise = perlin(place / cell + 0.37 * float(k), lattice_seed(VARIATION_SALT, k));
        float part = strength * shown_to(cell, pixel);
        if (k == 0) v.broad = noise.x;
        v.dry += part * noise.x;
        v.light += 0.3 * part * noise.y;
        cell *= 0.39;
        strength *= 0.75;
    }
    return Variation(clamp(v.dry, -1.0, 1.0), clamp(v.light, -1.0, 1.0), v.broad);
}

// Dry grass has more red and less blue than fresh grass of the same brightness. Each channel is
// multiplied by 1 and an odd share, so that no channel's mean changes.
vec3 dried(vec3 colour, Variation v, float strength) {
    vec3 share = v.dry * vec3(0.32, 0.10, -0.20) + 0.25 * v.light;
    return colour * max(1.0 + strength * share, 0.0);
}
#endif

// scene/near/strata.glsl -- layers of rock, by height, bent a little.
//
//   gives    Layer, LAYER_HUE, strata_at
//   needs    noise/hash.glsl, scene/near/ladder.glsl
//   units    metres; a layer's tone between -1 and 1, of mean 0; its rise in tone per metre; how
//            far the rock steps out, in metres per metre of height
//   source   made here: banks of even tone with short steps between, thick ones and thin ones
//   tested   tests/glsl/test_near.py: they follow the height, and the rise is the derivative
#ifndef SCENE_NEAR_STRATA
#define SCENE_NEAR_STRATA
#include "noise/hash.glsl"
#include "scene/near/ladder.glsl"

struct Layer {
    float tone;
    float rise;
    float ledge;
};

const vec3 LAYER_HUE = vec3(1.12, 1.0, 0.84);  // light layers are warmer, dark ones colder
const uint STRATA_SALT = 0x701b7413u;  // CRC-32 of "scene/near/strata"

// A bank that is lighter by 1 stands out by that share of its thickness.
const float LEDGE = 0.12;

// One set of banks, each with a tone of its own; between two the tone changes over a third of one.
// The border of two lies up to a third off its place: banks of one thickness look like corduroy.
Layer banks(float height, float thick, int set) {
    float at = height / thick;
    int bank = int(floor(at + 0.5));
    float border = float(bank) + 0.33 * random_signed(ivec2(bank, set + 8), STRATA_SALT);
    float t = clamp((at - border) * 3.0 + 0.5, 0.0, 1.0);
    float low = random_signed(ivec2(bank - 1, set), STRATA_SALT);
    float high = random_signed(ivec2(bank, set), STRATA_SALT);
    float rise = (high - low) * 18.0 * t * (1.0 - t) / thick;
    return Layer(low + (high - low) * t * t * (3.0 - 2.0 * t), rise, LEDGE * thick * rise);
}

// At a height, `bent` metres above where it was laid down; `tall` is how much height a pixel has.
Layer strata_at(float height, float bent, float thick, float tall) {
    Layer sum = Layer(0.0, 0.0, 0.0);
    float strength = 0.5;
    for (int k = 0; k < 3; k++) {
        Layer one = banks(height - bent, thick, k);
        float part = strength * shown_to(thick, tall);
        sum.tone += part * one.tone;
        sum.rise += part * one.rise;
        sum.ledge += one.ledge * shown_to(thick, tall);
        thick *= 0.29;
        strength *= 0.65;
    }
    return sum;
}
#endif

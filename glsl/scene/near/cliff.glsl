// scene/near/cliff.glsl -- bare rock: bumps in space, so that they are not drawn out on walls.
//
//   gives    Cliff, cliff_at, add_cliff
//   needs    noise/solid.glsl, scene/near/ladder.glsl, scene/near/strata.glsl, scene/surface.glsl
//   units    metres; the push is the gradient of heights along the normal, metres over metres
//   source   solid noise on any surface: Perlin 1985, "An Image Synthesizer" (SIGGRAPH); creases
//            where noise is 0: the same, "turbulence"
//   tested   tests/glsl/test_near.py, against differences in float64
//
// Blocks bulge and cracks between them are sharp: every other octave is of the noise without its
// sign. Layers that stand out are lighter and smoother, and make ledges.
#ifndef SCENE_NEAR_CLIFF
#define SCENE_NEAR_CLIFF
#include "noise/solid.glsl"
#include "scene/near/ladder.glsl"
#include "scene/near/strata.glsl"
#include "scene/surface.glsl"

struct Cliff {
    vec3 push;
    float variance;
    float tone;
};

const uint CLIFF_SALT = 0x4f396ea5u;  // CRC-32 of "scene/near/rock"
const float CRAGS = 0.24;             // rms slope of the widest octave
const float GRAINS = 0.12;            // and of the finest
const float SOLID_FOLDED = 0.17883;   // mean of the noise without its sign

// Turned, since the noise's gradients lie along a cube's diagonals.
const mat3 CLIFF_TURN = mat3(0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6);

// Small blocks break along their layers, large ones make ribs that run down the slope: places are
// flattened, or drawn out, by that much.
const float BEDDING = 2.0;
const float RIBS = 0.45;
const float A_RIB = 4.0;  // [m] cells of the smallest

// No octave is added where `share` of rock is 0.
Cliff cliff_at(vec3 place, float share, float strength, float layers, Layer layer, float pixel,
               float spacing) {
    Cliff c = Cliff(vec3(0.0), 0.0, 0.0);
    int end = share > 0.0 ? last_rung(pixel) : 0;
    strength *= 1.0 - 0.8 * layers * clamp(layer.tone, -0.6, 0.6);
    for (int k = first_rung(spacing); k < end; k++) {
        float cell = cell_of(k);
        vec3 stretch = vec3(1.0, 1.0, cell < A_RIB ? BEDDING : RIBS);
        float part = shown_to(cell, pixel) * beyond_map(cell, spacing);
        vec4 noise = solid(CLIFF_TURN * (place * stretch / cell) + 0.618034 * float(k),
                           lattice_seed(CLIFF_SALT, k));
        vec3 slope = noise.yzw * CLIFF_TURN * stretch;
        bool folded = (k & 1) == 0;
        float side = folded && noise.x < 0.0 ? -1.0 : 1.0;
        float rough = part * strength * mix(CRAGS, GRAINS, float(k) / float(RUNGS));
        c.push += side * rough / SOLID_SLOPE * slope;
        c.variance += rough * rough;
        c.tone += part * strength * 0.4 * (noise.x * side - (folded ? SOLID_FOLDED : 0.0));
    }
    c.push.z += layers * layer.ledge;
    c.tone += layers * layer.tone;
    return c;
}

// A share of bare rock, of that colour.
void add_cliff(inout Surface surface, Cliff cliff, float share, vec3 bare) {
    surface.push += share * cliff.push;
    surface.variance += share * share * cliff.variance;
    vec3 toned = bare * max(1.0 + cliff.tone * LAYER_HUE, 0.1);
    surface.albedo = mix(surface.albedo, toned, share);
}
#endif

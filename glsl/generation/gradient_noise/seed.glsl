// generation/gradient_noise/seed.glsl -- the seed of gradient noise and of fbm.
//
//   gives    octaves_seed
//   needs    noise/octaves.glsl
//   units    whole numbers modulo 2^32
//   source   see noise/hash.glsl for salts
//   tested   tests/glsl/test_salts.py
//
// Both techniques are the same sum and differ in what weakens their octaves; each has a salt.
#ifndef GENERATION_GRADIENT_NOISE_SEED
#define GENERATION_GRADIENT_NOISE_SEED
#include "noise/octaves.glsl"

const uint GRADIENT_NOISE_SALT = 0xc70dcbf6u;  // CRC-32 of "generation/gradient_noise"
const uint FBM_SALT = 0x4b648e88u;  // CRC-32 of "generation/fbm"

uint octaves_seed(int strength, uint seed) {
    return seed + (strength == BY_HURST ? FBM_SALT : GRADIENT_NOISE_SALT);
}
#endif

// generation/gradient_noise/salt.glsl -- what gradient noise adds to its seed.
//
//   gives    GRADIENT_NOISE_SALT
//   needs    nothing
//   units    whole numbers modulo 2^32
//   source   see noise/hash.glsl for salts
//   tested   tests/glsl/test_generation.py
#ifndef GENERATION_GRADIENT_NOISE_SALT
#define GENERATION_GRADIENT_NOISE_SALT
const uint GRADIENT_NOISE_SALT = 0xc70dcbf6u;  // CRC-32 of "generation/gradient_noise"
#endif

// generation/fbm/salt.glsl -- what fractional Brownian motion adds to its seed.
//
//   gives    FBM_SALT
//   needs    nothing
//   units    whole numbers modulo 2^32
//   source   see noise/hash.glsl for salts
//   tested   tests/glsl/test_generation.py
#ifndef GENERATION_FBM_SALT
#define GENERATION_FBM_SALT
const uint FBM_SALT = 0x4b648e88u;  // CRC-32 of "generation/fbm"
#endif

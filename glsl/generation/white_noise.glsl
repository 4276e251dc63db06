// generation/white_noise.glsl -- a random height for every texel, which makes no terrain.
//
//   gives    height, 0..1, for any terrain
//   needs    noise/hash.glsl
//   units    heights without unit, even over 0..1
//   source   Belaiche 2010, section 1.3.9, figures 1.29 and 1.30
//   tested   tests/glsl/test_noise.py, against the statistics that random numbers must have
//
// No height knows of its neighbours, so there is nothing that the eye could take for a hill;
// the thesis shows it for what the methods after it add. It is a number a texel by definition:
// of all techniques it alone is another terrain at another size.
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")

uniform uint seed = 7u; //! slider(0, 9999) Which terrain

const uint SALT = 0x93e2094du;  // CRC-32 of "generation/white_noise"

// anchor: kernel
float kernel(ivec2 texel) {
    return random(texel, seed + SALT);
}
// end: kernel

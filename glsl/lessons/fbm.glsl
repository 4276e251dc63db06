// lessons/fbm.glsl -- fractional Brownian motion: octaves of noise, each finer and weaker.
//
//   gives    height, for any terrain; not normalised
//   needs    generation/gradient_noise/seed.glsl, noise/octaves.glsl
//   units    height without unit; the first octave lies in -1..1
//   source   Belaiche 2010, section 1.2.1; as a sum of octaves after Musgrave, in Ebert and
//            others 2003, "Texturing and Modeling", chapter 16
//   tested   tests/glsl/test_lesson_fbm.py, in float64 and against generation/fbm
//
// As long as the last octave's cells are two texels wide or more it is generation/fbm: that
// technique leaves out what is finer.
#include "generation/gradient_noise/seed.glsl"
#include "noise/octaves.glsl"
#pragma kernel(output = "height:r32f")

uniform float hurst = 0.8;      //! slider(0, 1) step(0.01) Roughness: the smaller, the rougher
uniform int octaves = 8;        //! slider(0, 12) Sums of noise
uniform float frequency = 2.0;  //! log_slider(0.25, 64) Cells along the terrain's width in the
                                //! first octave
uniform uint seed = 7u;         //! slider(0, 9999) Which terrain

float noise(vec2 place, int which) {
    return perlin(place + OCTAVE_SHIFT, lattice_seed(octaves_seed(BY_HURST, seed), which)).x;
}

// anchor: sum
float kernel(ivec2 texel) {
    vec2 place = vec2(texel) * spacing * frequency / extent.x;
    float gain = exp2(-hurst);
    float strength = 1.0;
    float total = 0.0;
    for (int k = 0; k < octaves; k++) {
        total += strength * noise(place, k);
        place *= 2.0;
        strength *= gain;
    }
    return total;
}
// end: sum

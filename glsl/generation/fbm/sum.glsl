// generation/fbm/sum.glsl -- fractional Brownian motion: octaves of noise, each finer and weaker.
//
//   gives    height, for any terrain; not normalised
//   needs    generation/fbm/salt.glsl, noise/octaves.glsl
//   units    height without unit; the first octave lies in -1..1
//   source   Belaiche 2010, section 1.2.1; as a sum of octaves after Musgrave, in Ebert and
//            others 2003, "Texturing and Modeling", chapter 16
//   tested   tests/glsl/test_gradient_noise.py, in float64
//
//     h(p) = sum over k of g^k noise_k(l^k p),   g = l^-H
//
// with the lacunarity l and the Hurst exponent H. A cell must be wider than a texel to be seen: an
// octave fades out between two texels a cell and one, so a larger size adds detail to the same
// terrain.
#include "generation/fbm/salt.glsl"
#include "noise/octaves.glsl"
#pragma kernel(output = "height:r32f", warns = "\
    (octaves > 0) * (2 * frequency > size.x - 1): \
    frequency leaves a cell less than two texels, and is lowered until it has two")

uniform float hurst = 0.8;      //! slider(0, 1) step(0.01) label("Hurst exponent") Near 1 the
                                //! terrain is smooth, near 0 rubble
uniform int octaves = 8;        //! slider(0, 16) Sums of noise; those too fine for the texels are
                                //! left out
uniform float frequency = 4.0;  //! log_slider(0.25, 1024) Cells along the terrain's width in the
                                //! first octave
uniform float lacunarity = 2.0; //! slider(1.1, 4) step(0.05) Cells of an octave to one of the
                                //! octave before
uniform uint seed = 7u;         //! slider(0, 9999) Which terrain

float noise(vec2 place, int k) {
    return perlin(place + OCTAVE_SHIFT, lattice_seed(seed + FBM_SALT, k)).x;
}

// anchor: sum
float kernel(ivec2 texel) {
    float cells = cells_a_metre(frequency, extent, spacing);
    vec2 place = vec2(texel) * (spacing * cells);
    float texels = 1.0 / (cells * max(spacing.x, spacing.y));  // to a cell of this octave
    float gain = pow(lacunarity, -hurst);
    float strength = 1.0;
    float total = 0.0;
    for (int k = 0; k < octaves && texels > 1.0; k++) {
        total += strength * octave_weight(texels) * noise(place, k);
        place *= lacunarity;
        texels /= lacunarity;
        strength *= gain;
    }
    return total;
}
// end: sum

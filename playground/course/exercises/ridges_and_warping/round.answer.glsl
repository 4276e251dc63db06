// generation/gradient_noise/ridges.glsl -- mountain ridges, step by step: noise folded at zero.
//
//   gives    height, for any terrain; not normalised
//   needs    generation/gradient_noise/salt.glsl, noise/octaves.glsl
//   units    heights without unit; each octave in -1..1, folded in 0..1, times its strength
//   source   Musgrave, in Ebert and others 2003, "Texturing and Modeling", chapter 16
//            (RidgedMultifractal, offset 1 and gain 2)
//   tested   tests/glsl/test_gradient_noise.py, against float64, and against the choice
//            "ridged" of generation/gradient_noise/sum
//
// Noise is positive here and negative there, and 0 along lines between. Folded, those lines are
// the crests. With sharp ridges and weighed octaves it is what generation/gradient_noise makes
// with the shape "ridged", as long as the last octave's cells are two texels wide or more: that
// technique leaves out what is finer, this text for reading does not.
#include "generation/gradient_noise/salt.glsl"
#include "noise/octaves.glsl"
#pragma kernel(output = "height:r32f")

uniform int fold = 3;           //! menu("none", "valleys", "ridges", "sharp ridges") Noise as it
                                //! is; folded up along its zeros; folded down; and squared
uniform bool weighed = true;    //! Each octave is weighed by what the octave before it gave there
uniform int octaves = 6;        //! slider(0, 12) Sums of noise
uniform float frequency = 3.0;  //! log_slider(0.25, 64) Cells along the terrain's width in the
                                //! first octave
uniform float gain = 0.42;      //! slider(0, 1) step(0.01) Strength of an octave over the one
                                //! before
uniform uint seed = 7u;         //! slider(0, 9999) Which terrain

float folded(float noise) {
    if (fold == 0) return noise;
    float valley = abs(noise);      // what was below 0 is turned up
    if (fold == 1) return valley;
    float ridge = 1.0 - valley;     // highest where the noise is 0
    return fold == 2 ? 1.0 - noise * noise : ridge * ridge;
}

float kernel(ivec2 texel) {
    vec2 place = vec2(texel) * spacing * frequency / extent.x;
    float total = 0.0;
    float strength = 1.0;
    float before = 1.0;
    for (int k = 0; k < octaves; k++) {
        uint which = lattice_seed(seed + GRADIENT_NOISE_SALT, k);
        float height = folded(perlin(place + OCTAVE_SHIFT, which).x);
        if (weighed) height *= clamp(2.0 * before, 0.0, 1.0);
        before = height;
        total += strength * height;
        place *= 2.0;
        strength *= gain;
    }
    return total;
}

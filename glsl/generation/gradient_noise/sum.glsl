// generation/gradient_noise/sum.glsl -- hills of gradient noise, octave upon octave.
//
//   gives    height, for any land; not normalised
//   needs    generation/gradient_noise/seed.glsl, noise/octaves.glsl
//   units    heights without unit; the first octave lies in -1..1, ridged in 0..1
//   source   see noise/octaves.glsl
//   tested   tests/glsl/test_gradient_noise.py, against float64 twins
//
// Places are counted in metres over the land's width, so the same seed at another size is the
// same land, and hills are as wide as they are long whatever the land's shape.
#include "generation/gradient_noise/seed.glsl"
#include "noise/octaves.glsl"
#pragma kernel(output = "height:r32f")

uniform int basis = 0;           //! menu("Perlin", "simplex") On a lattice of squares or of triangles
uniform int shape = 0;           //! menu("plain", "ridged", "billow", "warped") The sum itself; sharp ridges; soft hills between creases; a sum bent by two others
uniform int octaves = 6;         //! slider(0, 16) Sums of noise; those too fine for the texels are left out
uniform float frequency = 4.0;   //! log_slider(0.25, 1024) Cells along the land's width in the first octave
uniform float lacunarity = 2.0;  //! slider(1.1, 4) step(0.05) Cells of an octave to one of the octave before
uniform int strength = 0;        //! menu("gain", "Hurst exponent") What tells how octaves weaken
uniform float gain = 0.5;        //! slider(0, 1) step(0.01) Strength of an octave over the one before, also called persistence
uniform float hurst = 0.8;       //! slider(0, 1) step(0.01) label("Hurst exponent") The gain is lacunarity^-H: near 1 the land is smooth, near 0 it is rubble
uniform float warp = 0.4;        //! slider(0, 2) step(0.01) Warped: how far a place is moved, in cells of the first octave
uniform uint seed = 7u;          //! slider(0, 9999) Which land

float kernel(ivec2 texel) {
    float scale = cells_a_metre(frequency, extent, spacing);
    float texels = 1.0 / (scale * max(spacing.x, spacing.y));
    Octaves o = Octaves(basis, octaves, lacunarity, gain_of(strength, gain, hurst, lacunarity), texels, octaves_seed(strength, seed));
    return octaves_shaped(shape, vec2(texel) * (spacing * scale), o, warp).x;
}

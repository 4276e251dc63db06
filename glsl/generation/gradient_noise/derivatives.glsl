// generation/gradient_noise/derivatives.glsl -- the slopes of hills of gradient noise, without differences.
//
//   gives    slope: to the east and to the north, of the land that gradient_noise/sum makes
//   needs    generation/gradient_noise/seed.glsl, noise/octaves.glsl
//   units    height per metre; height is that of the sum, not normalised
//   source   see noise/octaves.glsl
//   tested   tests/glsl/test_gradient_noise.py, against finite differences
//
// A slope from two texels is the slope between them; this is the slope at the texel, however
// far apart texels are. Where the height is normalised, divide by the range of the sum.
#include "generation/gradient_noise/seed.glsl"
#include "noise/octaves.glsl"
#pragma kernel(output = "slope:rg32f")

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

vec2 kernel(ivec2 texel) {
    float scale = cells_a_metre(frequency, extent, spacing);
    float texels = 1.0 / (scale * max(spacing.x, spacing.y));
    Octaves o = Octaves(basis, octaves, lacunarity, gain_of(strength, gain, hurst, lacunarity), texels, octaves_seed(strength, seed));
    return scale * octaves_shaped(shape, vec2(texel) * (spacing * scale), o, warp).yz;
}

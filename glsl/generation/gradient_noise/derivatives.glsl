// generation/gradient_noise/derivatives.glsl -- the slopes of gradient noise, without differences.
//
//   gives    slope: to the east and to the north, of the terrain that gradient_noise/sum makes
//   needs    generation/gradient_noise/{parameters/octaves,salt}.glsl, noise/octaves.glsl
//   units    height per metre; height is that of the sum, not normalised
//   source   see noise/octaves.glsl
//   tested   tests/glsl/test_gradient_noise.py, against finite differences
//
// A slope from two texels is the slope between them; this is the slope at the texel, however
// far apart texels are. Where the height is normalised, divide by the range of the sum.
#include "generation/gradient_noise/salt.glsl"
#include "noise/octaves.glsl"
#pragma kernel(output = "slope:rg32f")

#include "generation/gradient_noise/parameters/octaves.glsl"

vec2 kernel(ivec2 texel) {
    float scale = cells_a_metre(frequency, extent, spacing);
    float texels = 1.0 / (scale * max(spacing.x, spacing.y));
    Octaves o = Octaves(basis, octaves, lacunarity, gain, texels, seed + GRADIENT_NOISE_SALT);
    return scale * octaves_sum(shape, vec2(texel) * (spacing * scale), o, warp).yz;
}

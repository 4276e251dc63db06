// generation/gradient_noise/sum.glsl -- hills of gradient noise, octave upon octave.
//
//   gives    height, for any terrain; not normalised
//   needs    generation/gradient_noise/{parameters/octaves,salt}.glsl, noise/octaves.glsl
//   units    heights without unit; the first octave lies in -1..1, ridged in 0..1
//   source   see noise/octaves.glsl
//   tested   tests/glsl/test_gradient_noise.py, against float64 twins
//
//     h(p) = sum over k of gain^k noise_k(lacunarity^k p)
//
// Places p are counted in metres over the terrain's width, so the same seed at another size is
// the same terrain, and hills are as wide as they are long whatever the terrain's shape.
#include "generation/gradient_noise/salt.glsl"
#include "noise/octaves.glsl"
#pragma kernel(output = "height:r32f", warns = "\
    (octaves > 0) * (2 * frequency > size.x - 1): \
    frequency leaves a cell less than two texels, and is lowered until it has two")

#include "generation/gradient_noise/parameters/octaves.glsl"

float kernel(ivec2 texel) {
    float scale = cells_a_metre(frequency, extent, spacing);
    float texels = 1.0 / (scale * max(spacing.x, spacing.y));
    Octaves o = Octaves(basis, octaves, lacunarity, gain, texels, seed + GRADIENT_NOISE_SALT);
    return octaves_sum(shape, vec2(texel) * (spacing * scale), o, warp).x;
}

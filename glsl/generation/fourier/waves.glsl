// generation/fourier/waves.glsl -- the spectrum of a grid of random numbers, drawn wave by wave.
//
//   gives    waves: a complex number for each frequency
//   needs    generation/fourier/wave.glsl
//   units    as the transform of a grid whose numbers have the mean square 1/3
//   source   Belaiche 2010, section 1.3.3, step 1
//   tested   tests/glsl/test_fourier.py, against NumPy; tests/glsl/test_generation.py
//
// The thesis's first step is a grid of random numbers. Drawn texel by texel, a seed would be
// another terrain at every size: the long waves of a grid are sums of all of its numbers. So
// its waves are drawn instead, each by its own frequency, and the backward transform adds them
// up to the grid. That is as random, no texel knows of another, and its numbers are spread as
// sums of many are: by a bell curve. The steps after it are the thesis's.
#include "generation/fourier/wave.glsl"
#pragma kernel(output = "waves:rg32f")

uniform uint seed = 7u; //! slider(0, 9999) Which terrain

vec2 kernel(ivec2 texel) {
    ivec2 waves = texel - size * ivec2(greaterThan(2 * texel, size));
    return sqrt(float(size.x) * float(size.y)) * wave_number(waves, size, seed);
}

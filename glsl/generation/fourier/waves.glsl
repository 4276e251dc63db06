// generation/fourier/waves.glsl -- the spectrum of a grid of random numbers, drawn wave by wave.
//
//   gives    waves: a complex number for each frequency, for any land of 2^n or 2^n + 1 texels
//            along each side
//   needs    generation/fourier/wave.glsl
//   units    as the transform of a grid whose numbers have the mean square 1/3
//   source   Belaiche 2010, section 1.3.3, step 1
//   tested   tests/glsl/test_fourier.py, against NumPy; tests/glsl/test_sizes.py
//
// The thesis's first step is a grid of random numbers. Drawn texel by texel, a seed would be
// another terrain at every size: the long waves of a grid are sums of all of its numbers. So
// its waves are drawn instead, each by its own frequency, and the backward transform adds them
// up to the grid. That is as random, no texel knows of another, and its numbers are spread as
// sums of many are: by a bell curve. The steps after it are the thesis's.
#include "generation/fourier/wave.glsl"
#pragma kernel(output = "waves:rg32f", accepts = "2**(n + 1) or 2**n + 1, 2**(m + 1) or 2**m + 1")

uniform uint seed = 7u; //! slider(0, 9999) Which land

vec2 kernel(ivec2 texel) {
    ivec2 period = size - (size & 1);
    // Along a side of 2^n + 1 the last texel is the first again, one period further on.
    ivec2 within = texel & (period - 1);
    ivec2 waves = within - period * ivec2(greaterThan(2 * within, period));
    return sqrt(float(period.x) * float(period.y)) * wave_number(waves, period, seed);
}

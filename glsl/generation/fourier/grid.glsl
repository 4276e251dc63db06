// generation/fourier/grid.glsl -- a random number for each texel of a land that repeats.
//
//   gives    grid, for any land of 2^n or 2^n + 1 texels along each side
//   needs    noise/hash.glsl
//   units    numbers without unit, -1..1
//   source   Belaiche 2010, section 1.3.3, step 1
//   tested   tests/glsl/test_fourier.py, against the same numbers in Python
//
// Along a side of 2^n + 1 the last texel is the first again, one period further on. Texels
// half a period apart, north and south, share one hash and take a number each.
//
// The mean of the grid is the land's. Numbers from 0 up would have one of 0.5, and the
// heights of a large land, a thousandth of that, would lose their last digits to it.
#include "noise/hash.glsl"
#pragma kernel(output = "grid:r32f", accepts = "2**(n + 1) or 2**n + 1, 2**(m + 1) or 2**m + 1")

uniform uint seed = 7u; //! slider(0, 9999) Which land

float kernel(ivec2 texel) {
    ivec2 period = size - (size & 1);
    ivec2 within = texel & (period - 1);
    int half_way = period.y >> 1;
    vec2 pair = random_pair(ivec2(within.x, within.y & (half_way - 1)), seed);
    return (within.y < half_way ? pair.x : pair.y) * 2.0 - 1.0;
}

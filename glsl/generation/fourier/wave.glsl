// generation/fourier/wave.glsl -- the random number of each wave, the same at every size.
//
//   gives    wave_number
//   needs    noise/hash.glsl
//   units    complex numbers; over all waves the mean square of one is 1/3
//   source   derived here: a real grid's spectrum has conjugates at opposite frequencies
//   tested   tests/glsl/test_fourier.py, against the same numbers in Python
//
// The key is the wave's own frequency, with its sign, so that a larger grid has the waves of a
// smaller one and finer ones besides. Opposite frequencies are one wave: one of the two is
// drawn, and the other is its conjugate. A frequency that is its own opposite has a real number.
#ifndef GENERATION_FOURIER_WAVE
#define GENERATION_FOURIER_WAVE
#include "noise/hash.glsl"

const uint FOURIER_SALT = 0xce22992eu;  // CRC-32 of "generation/fourier"

// For signed frequencies of a period of so many texels; half the period has no minus sign.
vec2 wave_number(ivec2 waves, ivec2 period, uint seed) {
    ivec2 opposite = period * ivec2(equal(2 * waves, period)) - waves;
    bool is_drawn = waves.x > opposite.x || (waves.x == opposite.x && waves.y >= opposite.y);
    vec2 pair = random_pair(is_drawn ? waves : opposite, seed + FOURIER_SALT) * 2.0 - 1.0;
    // Two numbers with half of the mean square each, or one with all of it.
    if (waves == opposite) return vec2(pair.x, 0.0);
    return 0.70710678 * vec2(pair.x, is_drawn ? pair.y : -pair.y);
}
#endif

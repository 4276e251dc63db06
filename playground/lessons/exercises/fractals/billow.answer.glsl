// A sum of octaves of noise.
#include "generation/gradient_noise/seed.glsl"
#include "noise/octaves.glsl"
#pragma kernel(output = "height:r32f")

uniform float hurst = 0.8;      //! slider(0, 1) step(0.01) Roughness: the smaller, the rougher
uniform int octaves = 8;        //! slider(0, 12) Sums of noise
uniform float frequency = 2.0;  //! log_slider(0.25, 64) Cells along the terrain's width in the
                                //! first octave
uniform uint seed = 7u;         //! slider(0, 9999) Which terrain

float noise(vec2 place, int which) {
    return perlin(place + OCTAVE_SHIFT, lattice_seed(octaves_seed(BY_HURST, seed), which)).x;
}

float kernel(ivec2 texel) {
    vec2 place = vec2(texel) * spacing * frequency / extent.x;
    float gain = exp2(-hurst);
    float strength = 1.0;
    float total = 0.0;
    for (int k = 0; k < octaves; k++) {
        total += strength * abs(noise(place, k));
        place *= 2.0;
        strength *= gain;
    }
    return total;
}

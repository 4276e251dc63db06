// noise/fade.glsl -- the curve by which noise passes from one lattice point to the next.
//
//   gives    quintic, quintic_slope
//   needs    nothing: pure functions, no uniforms, no textures
//   units    shares of a cell, 0..1
//   source   Perlin 2002, "Improving Noise" (SIGGRAPH): 6t^5 - 15t^4 + 10t^3
//   tested   tests/glsl/test_gradient_noise.py: its ends, and its slope against differences
#ifndef NOISE_FADE
#define NOISE_FADE

// 0 to 1 with neither slope nor bend at the ends.
float quintic(float t) {
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

vec2 quintic(vec2 t) {
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

float quintic_slope(float t) {
    return 30.0 * t * t * (t * (t - 2.0) + 1.0);
}

vec2 quintic_slope(vec2 t) {
    return 30.0 * t * t * (t * (t - 2.0) + 1.0);
}
#endif

// generation/multiply/product.glsl -- the product of two terrains.
//
//   gives    height, 0..1; not above either factor
//   needs    terrain/extremes.glsl
//   units    heights without unit; the ranges in the same
//   source   Belaiche 2010, section 1.3.4
//   tested   tests/glsl/test_layered_noise.py, against NumPy
//
// All heights fall, low ones more than high ones. That needs factors in 0..1: one that leaves
// that range is brought to it, lowest to 0 and highest to 1; one that does not is left alone.
#include "terrain/extremes.glsl"
#pragma kernel(output = "height:r32f")

uniform sampler2D first;        //! input
uniform sampler2D second;       //! input
uniform sampler2D first_range;  //! input
uniform sampler2D second_range; //! input

float factor(float h, vec2 range) {
    if (range.x >= 0.0 && range.y <= 1.0) return h;
    float span = span_of(range);
    // Flat terrain has no range to stretch.
    return span > 0.0 ? clamp((h - range.x) / span, 0.0, 1.0) : 0.0;
}

float kernel(ivec2 texel) {
    float a = factor(texelFetch(first, texel, 0).r, texelFetch(first_range, ivec2(0), 0).rg);
    float b = factor(texelFetch(second, texel, 0).r, texelFetch(second_range, ivec2(0), 0).rg);
    return a * b;
}

// generation/finer.glsl -- a coarse height at more texels, smooth between those that it had.
//
//   gives    height
//   needs    maths/land.glsl; a height of any size
//   units    heights without unit
//   source   Keys 1981, "Cubic Convolution Interpolation for Digital Image Processing" (IEEE
//            Transactions on Acoustics, Speech and Signal Processing 29), with a = -1/2
//   tested   tests/glsl/test_filters.py, by parabolas, which it keeps, and by the texels it goes
//            through
//
// Heights between four texels are those of two planes' edges, and light shows the edges. Here
// slopes are continuous too. What is finer, gullies or noise, is for the next pass.
#include "maths/land.glsl"
#pragma kernel(output = "height:r32f")

uniform sampler2D coarse;  //! input

// Weights of the four nodes around a place that is so far after the second.
vec4 weights_of(float t) {
    float s = 1.0 - t;
    vec2 inner = 2.0 - vec2(t * t, s * s) * (5.0 - 3.0 * vec2(t, s));
    return 0.5 * vec4(-t * s * s, inner, -s * t * t);
}

float row_of(ivec2 node, vec4 weights, ivec2 last) {
    float sum = 0.0;
    for (int k = 0; k < 4; k++) {
        sum += weights[k] * texelFetch(coarse, clamp(node + ivec2(k - 1, 0), ivec2(0), last), 0).r;
    }
    return sum;
}

float kernel(ivec2 texel) {
    ivec2 last = textureSize(coarse, 0) - 1;
    vec2 place = place_on(last + 1, texel, size);
    ivec2 node = min(ivec2(place), max(last - 1, ivec2(0)));
    vec4 x = weights_of(place.x - float(node.x));
    vec4 y = weights_of(place.y - float(node.y));
    float sum = 0.0;
    for (int k = 0; k < 4; k++) sum += y[k] * row_of(node + ivec2(0, k - 1), x, last);
    return sum;
}

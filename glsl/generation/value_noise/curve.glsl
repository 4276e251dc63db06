// generation/value_noise/curve.glsl -- value noise along a line, and its derivative.
//
//   gives    height: row 0 the noise, row 1 half of its derivative
//   needs    noise/hash.glsl
//   units    noise in -1..1, its derivative in noise per cell
//   source   the derivative by the chain rule, derived here
//   tested   tests/glsl/test_noise.py, against NumPy and finite differences
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")

uniform int cells = 7;     //! slider(1, 32) Cells along the line
uniform int passage = 1;   //! menu("line", "cubic", "quintic")
                           //! How the height passes from node to node
uniform uint seed = 7u;    //! slider(0, 9999) Which line

const uint SALT = 0xebf5aec0u;  // CRC-32 of "lessons/value_noise_curve"

// anchor: derivative
// The passage from 0 to 1, and how fast it rises.
vec2 bent(float a) {
    if (passage == 0) return vec2(a, 1.0);
    if (passage == 1) return vec2(a * a * (3.0 - 2.0 * a), 6.0 * a * (1.0 - a));
    return vec2(a * a * a * (a * (6.0 * a - 15.0) + 10.0), 30.0 * a * a * (a - 1.0) * (a - 1.0));
}

float kernel(ivec2 texel) {
    float place = float(cells) * float(texel.x) / float(max(size.x - 1, 1));
    int node = min(int(place), cells - 1);
    float from = random_signed(ivec2(node, 0), seed + SALT);
    float to = random_signed(ivec2(node + 1, 0), seed + SALT);
    vec2 passed = bent(place - float(node));
    return texel.y == 0 ? mix(from, to, passed.x) : 0.5 * (to - from) * passed.y;
}
// end: derivative

// simulation/gray_scott/start.glsl -- one substance everywhere, squares with some of the other.
//
//   gives    amounts: red the substance that is fed, U, green the one that feeds on it, V
//   needs    noise/hash.glsl
//   units    concentrations without unit
//   source   Pearson 1993, "Complex Patterns in a Simple System", Science 261: U = 1 and
//            V = 0, and a square of U = 1/2 and V = 1/4, of 20 cells a side there
//   tested   tests/glsl/test_gray_scott.py, by its values
//
// Pearson has one square and disturbs it by 1 %. Several squares fill the field sooner, and
// where each lies is what is random.
#include "noise/hash.glsl"
#pragma kernel(output = "amounts:rg32f")

uniform int spots = 24;  //! slider(1, 64) How many squares
uniform uint seed = 1u;  //! slider(0, 9999) Where they lie

const uint SALT = 0xee9487d2u;  // CRC-32 of "simulation/gray_scott/start"
const int HALF = 5;  // cells from a square's middle to its side

vec2 kernel(ivec2 texel) {
    for (int k = 0; k < spots; k++) {
        ivec2 middle = ivec2(random_pair(ivec2(k, 0), seed + SALT) * vec2(size));
        ivec2 offset = abs(texel - middle);
        offset = min(offset, size - offset);
        if (max(offset.x, offset.y) < HALF) return vec2(0.5, 0.25);
    }
    return vec2(1.0, 0.0);
}

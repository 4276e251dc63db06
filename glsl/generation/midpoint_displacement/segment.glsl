// generation/midpoint_displacement/segment.glsl -- a segment with displaced midpoints, row by row.
//
//   gives    height, 2^n + 1 texels long; row k, from 0 in the south, is the line after k steps
//   needs    noise/finest.glsl, noise/hash.glsl
//   units    heights without unit
//   source   Belaiche 2010, section 1.3.5, the three pictures before figure 1.23
//   tested   tests/glsl/test_halving.py, against a list of points that grows
//
// Row 0 is the segment, of height 0. A step displaces the middle of every piece by a random
// number in [-d, d]; the first step's d is 1, each next step's `roughness` times the one
// before. Between the points that a row knows the line is straight. After n steps every texel
// is a point, and further rows repeat the last.
#include "noise/finest.glsl"
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f", accepts = "2**n + 1, m + 1")

uniform float roughness = 0.5;  //! slider(0, 1) step(0.01) Each step's random numbers, over those
                                //! of the step before
uniform uint seed = 7u;         //! slider(0, 9999) Which line

const uint SALT = 0x4039243eu;  // CRC-32 of "generation/midpoint_displacement/segment"

float kernel(ivec2 texel) {
    // The piece that holds the texel, halved once a step: its ends' places and heights.
    int west = 0;
    int east = size.x - 1;
    vec2 ends = vec2(0.0);
    float amplitude = 1.0;
    for (int k = 0; k < texel.y; k++) {
        if (east - west < 2) break;
        int middle = (west + east) >> 1;
        float number = random_signed(finest_point(ivec2(middle, 0), size.x - 1), seed + SALT);
        float h = (ends.x + ends.y) * 0.5 + number * amplitude;
        bool is_eastern = texel.x >= middle;
        west = is_eastern ? middle : west;
        east = is_eastern ? east : middle;
        ends = is_eastern ? vec2(h, ends.y) : vec2(ends.x, h);
        amplitude *= roughness;
    }
    return ends.x + (ends.y - ends.x) * (float(texel.x - west) / float(east - west));
}

// generation/delaunay/tables.glsl -- a triangulation's tables, and areas without rounding.
//
//   gives    entry, lattice_sides, exact_cross, exact_place
//   needs    maths/whole.glsl; the tables of generation/delaunay/triangulation.glsl
//   units    lattice spacings, and squares of them
//   source   derived here: products of whole numbers digit by digit, base 4096
//   tested   tests/glsl/test_delaunay.py, against Python's whole numbers
//
// A triangle along the border may be as long as the terrain and thousands of times less high. In
// floats its area would be the small difference of large products: heights among ten thousand
// points came out wrong by 1.5e-5. So the difference is taken in whole numbers, and rounded once.
#ifndef GENERATION_DELAUNAY_TABLES
#define GENERATION_DELAUNAY_TABLES
#include "maths/whole.glsl"

// Entry k of a table.
vec4 entry(sampler2D table, int k) {
    int width = textureSize(table, 0).x;
    int row = quotient(k, width);
    return texelFetch(table, ivec2(k - row * width, row), 0);
}

// The terrain's sides: the north-eastern corner is the fourth point.
ivec2 lattice_sides(sampler2D places) {
    return ivec2(entry(places, 3).xy);
}

// a.x b.y - a.y b.x, rounded once, for components from -2^24 to 2^24.
float exact_cross(ivec2 a, ivec2 b) {
    // Shifts round down, so the upper digit carries the sign and the lower is 0 to 4095.
    ivec2 a1 = a >> 12;
    ivec2 a0 = a & 4095;
    ivec2 b1 = b >> 12;
    ivec2 b0 = b & 4095;
    int high = a1.x * b1.y - a1.y * b1.x;
    int middle = a1.x * b0.y + a0.x * b1.y - a1.y * b0.x - a0.y * b1.x;
    int low = a0.x * b0.y - a0.y * b0.x;
    middle += low >> 12;
    high += middle >> 12;
    return float(high) * 16777216.0 + float(((middle & 4095) << 12) | (low & 4095));
}

// Where a texel is on a side of the lattice, a multiple of 4096: whole spacings, then the rest
// of one.
vec2 exact_place(int texel, int texels, int side) {
    int intervals = max(texels - 1, 1);
    int upper = texel * (side >> 12);
    int first = quotient(upper, intervals);
    int lower = (upper - first * intervals) << 12;
    int second = quotient(lower, intervals);
    return vec2((first << 12) + second, float(lower - second * intervals) / float(intervals));
}
#endif

// noise/simplex.glsl -- simplex noise in the plane, with its slopes.
//
//   gives    simplex
//   needs    noise/gradient.glsl, noise/lattice.glsl
//   units    places in cells, triangles with sides of length 1; noise in [-1, 1], its slopes in
//            noise per cell
//   source   Perlin 2001, "Noise hardware" (SIGGRAPH course 36); slopes derived here
//   tested   tests/glsl/test_gradient_noise.py, against the sum over all lattice points in float64
//
// The plane is cut into equal triangles. Each of a triangle's corners adds the plane of its
// gradient, faded by (1/2 - r^2)^4 to nothing at r = sqrt(1/2), in the skew's units. That is the
// height of a triangle: a corner reaches no further than the triangles that touch it, and
// nothing is cut off. Three corners instead of four, and lattice lines in three directions.
#ifndef NOISE_SIMPLEX
#define NOISE_SIMPLEX
#include "noise/gradient.glsl"

const float SIMPLEX_SIDE = 0.81649658;    // sqrt(2/3): a triangle's side, in the skew's units
const float SIMPLEX_SKEW = 0.36602540;    // (sqrt(3) - 1) / 2: makes squares of pairs of triangles
const float SIMPLEX_UNSKEW = 0.21132487;  // (3 - sqrt(3)) / 6: and back
const float SIMPLEX_SCALE = 100.0;        // one over the gradients' most, 0.009996

// What one corner adds: its noise, and its slopes.
vec3 simplex_corner(uint bits, vec2 offset) {
    vec2 gradient = gradient_of(bits);
    float near = max(0.5 - dot(offset, offset), 0.0);
    float cubed = near * near * near;
    float plane = dot(gradient, offset);
    return vec3(near * plane, near * gradient - 8.0 * plane * offset) * cubed;
}

// Noise in x, its slopes to the east and to the north in y and z.
vec3 simplex(vec2 place, uint seed) {
    vec2 there = place * SIMPLEX_SIDE;
    vec2 cell = floor(there + (there.x + there.y) * SIMPLEX_SKEW);
    // Far from the origin this order loses no digits: the difference is exact.
    vec2 first = (there - cell) + (cell.x + cell.y) * SIMPLEX_UNSKEW;
    // The square's lower or upper triangle.
    bool lower = first.x > first.y;
    vec2 second = first - (lower ? vec2(1.0, 0.0) : vec2(0.0, 1.0)) + SIMPLEX_UNSKEW;
    vec2 third = first - 1.0 + 2.0 * SIMPLEX_UNSKEW;
    uvec2 columns = lattice_columns(int(cell.x), seed);
    uvec2 rows = lattice_rows(int(cell.y), seed);
    return SIMPLEX_SCALE * vec3(1.0, SIMPLEX_SIDE, SIMPLEX_SIDE) * (
        simplex_corner(columns.x * rows.x, first)
        + simplex_corner(lower ? columns.y * rows.x : columns.x * rows.y, second)
        + simplex_corner(columns.y * rows.y, third)
    );
}
#endif

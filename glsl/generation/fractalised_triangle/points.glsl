// generation/fractalised_triangle/points.glsl -- a triangle's corners, then edges' middles.
//
//   gives    point: x and y of each point (i, j) of a triangle's lattice, i + j at most the side
//   needs    noise/hash.glsl
//   units    the triangle is about 1 wide, in the middle of the plane
//   source   Belaiche 2010, section 1.2.1, figure 1.4, after Fournier, Fussell and Carpenter
//            1982 (Communications of the ACM 25, 6)
//   tested   tests/glsl/test_deterministic_fractal.py, against a recursion in Python
//
// The thesis shows this figure and does not say how far a middle moves: here anywhere in a
// square of `roughness` times the edge's length. A point keeps its place however deep the
// triangle is divided.
#include "noise/hash.glsl"
#pragma kernel(output = "point:rg32f", repeat = "depth + 1", accepts = "2**n + 1")

uniform int depth = 5;          //! slider(0, 6) How many times each edge is halved
uniform uint seed = 7u;         //! slider(0, 9999) Which triangle
uniform float roughness = 0.15; //! slider(0, 0.5) step(0.01) How far a middle moves, over the
                                //! edge's length

const uint SALT = 0x62d29298u;  // CRC-32 of "generation/fractalised_triangle"
const int DEEPEST = 6;

vec2 kernel(ivec2 texel) {
    int side = size.x - 1;
    if (texel.x + texel.y > side) return vec2(0.0);
    if (iteration == 0) {
        if (texel == ivec2(0)) return vec2(-0.5, -0.4330127);
        if (texel == ivec2(side, 0)) return vec2(0.5, -0.4330127);
        return texel == ivec2(0, side) ? vec2(0.0, 0.4330127) : vec2(0.0);
    }
    // Half an edge of this step, in texels.
    int r = side >> iteration;
    ivec2 odd = ivec2(texel.x & r, texel.y & r);
    if (((texel.x | texel.y) & (r - 1)) != 0 || odd == ivec2(0)) return previous(texel);
    // Along a row, along a column, or along the third direction, where both are odd.
    ivec2 along = odd.y == 0 ? ivec2(r, 0) : odd.x == 0 ? ivec2(0, r) : ivec2(r, -r);
    vec2 one = previous(texel - along);
    vec2 other = previous(texel + along);
    vec2 move = random_pair(texel * max((1 << DEEPEST) / side, 1), seed + SALT) * 2.0 - 1.0;
    return 0.5 * (one + other) + move * (roughness * length(other - one));
}

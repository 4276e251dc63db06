// trees/list/budget.glsl -- the key below which so many trees remain as a list has room for.
//
//   gives    limit, 0..1
//   needs    how many trees there are, in one texel
//   units    trees
//   source   keys are ranks over shares, so they are uniform in 0..1: of N trees, q N are below q,
//            with a deviation of no more than sqrt(q N)
//   tested   tests/glsl/test_trees.py
//
// Six deviations are left free, so that the list overflows once in a billion pictures.
#pragma kernel(output = "limit:r32f")

uniform sampler2D total;    //! input
#include "trees/parameters/budget.glsl"

float kernel(ivec2 texel) {
    float wanted = texelFetch(total, ivec2(0), 0).r;
    float room = float(trees);
    return wanted <= room ? 1.0 : max(room - 6.0 * sqrt(room), 0.5 * room) / wanted;
}

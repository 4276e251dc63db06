// trees/list/starts.glsl -- how many trees all blocks before a block have, row by row.
//
//   gives    start
//   needs    counts of blocks, and their sums by rows
//   units    trees
//   source   prefix sums in two steps: of rows, then within one
//   tested   tests/glsl/test_trees.py
#pragma kernel(output = "start:r32f")

uniform sampler2D count;  //! input
uniform sampler2D rows;   //! input

float kernel(ivec2 texel) {
    float total = 0.0;
    for (int k = 0; k < texel.y; k++) total += texelFetch(rows, ivec2(0, k), 0).r;
    for (int k = 0; k < texel.x; k++) total += texelFetch(count, ivec2(k, texel.y), 0).r;
    return total;
}

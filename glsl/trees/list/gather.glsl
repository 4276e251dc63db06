// trees/list/gather.glsl -- the trees of a table one after the other, so that a draw meets no gap.
//
//   gives    tree: foot and height as in trees/place, the height as the distance makes it; 0 after
//            the last
//   needs    maths/whole.glsl, trees/level.glsl; a table of trees and keys; counts and starts of
//            its blocks; a limit
//   units    metres
//   source   Ziegler, Tevs, Theobalt and Seidel 2006, "On-the-fly Point Clouds through Histogram
//            Pyramids" (VMV): each place of the list looks for its tree, by binary search
//   tested   tests/glsl/test_trees.py, as a set against the table
#include "maths/whole.glsl"
#include "trees/level.glsl"
#pragma kernel(output = "tree:rgba32f")

uniform sampler2D table;  //! input
uniform sampler2D key;    //! input
uniform sampler2D count;  //! input
uniform sampler2D start;  //! input
uniform sampler2D limit;  //! input("white")

const int DEEPEST = 24;  // the starts of 2^24 blocks

ivec2 block_of(int k, int across) {
    int row = quotient(k, across);
    return ivec2(k - row * across, row);
}

vec4 kernel(ivec2 texel) {
    float which = float(texel.y * size.x + texel.x);
    ivec2 blocks = textureSize(start, 0);
    int low = 0;
    int high = blocks.x * blocks.y - 1;
    for (int k = 0; k < DEEPEST && low < high; k++) {
        int middle = (low + high + 1) / 2;
        bool after = texelFetch(start, block_of(middle, blocks.x), 0).r > which;
        high = after ? middle - 1 : high;
        low = after ? low : middle;
    }
    ivec2 at = block_of(low, blocks.x);
    float rest = which - texelFetch(start, at, 0).r;
    if (rest >= texelFetch(count, at, 0).r) return vec4(0.0);
    ivec2 cells = textureSize(table, 0);
    ivec2 block = (cells + blocks - 1) / blocks;
    float maximum = texelFetch(limit, ivec2(0), 0).r;
    ivec2 from = at * block;
    vec2 found = vec2(0.0);
    for (int k = 0; k < block.x * block.y && rest >= 0.0; k++) {
        from = at * block + block_of(k, block.x);
        found = any(greaterThanEqual(from, cells)) ? vec2(maximum) : texelFetch(key, from, 0).rg;
        if (found.r < maximum) rest -= 1.0;
    }
    vec4 tree = texelFetch(table, from, 0);
    return vec4(tree.xyz, tree.w * shrunk(found.r, found.g, maximum) * pow(maximum, GROWTH));
}

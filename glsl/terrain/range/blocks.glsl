// terrain/range/blocks.glsl -- the lowest and the highest height in each block of a terrain.
//
//   gives    range: lowest in red, highest in green; a block of the terrain for each texel
//   needs    terrain/extremes.glsl, maths/whole.glsl
//   units    as the heights
//   source   none: a reduction
//   tested   tests/glsl/test_filters.py, against NumPy
//
// The first of the two passes of terrain/range. It works at every size of its own, whatever
// the terrain's: the blocks cover the terrain and do not overlap, and where there are more blocks
// than texels, some are empty and tell a range that holds nothing.
#include "maths/whole.glsl"
#include "terrain/extremes.glsl"
#pragma kernel(output = "range:rg32f")

uniform sampler2D height; //! input
uniform int sought = 2;   //! menu("nothing", "highest", "lowest and highest")
                          //! With nothing, 0 and 1 are told without a look at the terrain

vec2 kernel(ivec2 texel) {
    if (sought == 0) return vec2(0.0, 1.0);
    ivec2 land = textureSize(height, 0);
    ivec2 from = ivec2(quotient(texel.x * land.x, size.x), quotient(texel.y * land.y, size.y));
    ivec2 to = ivec2(quotient((texel.x + 1) * land.x, size.x),
                     quotient((texel.y + 1) * land.y, size.y));
    vec2 found = NO_RANGE;
    for (int y = from.y; y < to.y; y++) {
        for (int x = from.x; x < to.x; x++) {
            found = widened(found, vec2(texelFetch(height, ivec2(x, y), 0).r));
        }
    }
    return found;
}

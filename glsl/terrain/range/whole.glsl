// terrain/range/whole.glsl -- one range that holds all of a texture's ranges.
//
//   gives    range: lowest in red, highest in green; 1 texel is enough
//   needs    terrain/extremes.glsl
//   units    as the ranges
//   source   none: a reduction
//   tested   tests/glsl/test_filters.py, against NumPy
#include "terrain/extremes.glsl"
#pragma kernel(output = "range:rg32f")

uniform sampler2D blocks; //! input

vec2 kernel(ivec2 texel) {
    ivec2 all_blocks = textureSize(blocks, 0);
    vec2 found = NO_RANGE;
    for (int y = 0; y < all_blocks.y; y++) {
        for (int x = 0; x < all_blocks.x; x++) {
            found = widened(found, texelFetch(blocks, ivec2(x, y), 0).rg);
        }
    }
    return found;
}

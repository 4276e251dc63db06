// lighting/block_maxima.glsl -- the highest height in each block of 16 texels, for ray marches.
//
//   gives    block_maxima: a texel a block; each knows the texels just after it as well
//   needs    terrain/blocks.glsl
//   units    as the heights
//   source   made here
//   tested   tests/glsl/test_shadows.py, against NumPy
//
// Its size is for whoever uses it to give: sixteenths of the heightmap's, rounded up.
#include "terrain/blocks.glsl"
#pragma kernel(output = "block_maxima:r32f")

uniform sampler2D height;  //! input

float kernel(ivec2 texel) {
    ivec2 last = textureSize(height, 0) - 1;
    ivec2 from = min(texel << BLOCK_SHIFT, last);
    ivec2 to = min((texel + 1) << BLOCK_SHIFT, last);
    float highest = texelFetch(height, from, 0).r;
    for (int y = from.y; y <= to.y; y++) {
        for (int x = from.x; x <= to.x; x++) {
            highest = max(highest, texelFetch(height, ivec2(x, y), 0).r);
        }
    }
    return highest;
}

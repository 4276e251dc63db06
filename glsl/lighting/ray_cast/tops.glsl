// lighting/ray_cast/tops.glsl -- the highest height in each block of 16 texels of a land, for walks that leap over low blocks.
//
//   gives    tops: a texel a block; each knows the texels just after it as well
//   needs    lighting/walk.glsl
//   units    as the heights
//   source   made here
//   tested   tests/glsl/test_shadows.py, against NumPy
//
// Its size is for whoever uses it to give: sixteenths of the land's, rounded up.
#include "lighting/walk.glsl"
#pragma kernel(output = "tops:r32f")

uniform sampler2D height;  //! input

float kernel(ivec2 texel) {
    ivec2 last = textureSize(height, 0) - 1;
    ivec2 from = min(texel << TOP_SHIFT, last);
    ivec2 to = min((texel + 1) << TOP_SHIFT, last);
    float top = texelFetch(height, from, 0).r;
    for (int y = from.y; y <= to.y; y++) {
        for (int x = from.x; x <= to.x; x++) top = max(top, texelFetch(height, ivec2(x, y), 0).r);
    }
    return top;
}

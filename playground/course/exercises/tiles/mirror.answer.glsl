// generation/layered_noise/parts.glsl -- a terrain cut into parts, one tile on each.
//
//   gives    place_in_part
//   needs    maths/whole.glsl
//   units    texels
//   source   Belaiche 2010, section 4.3.2
//   tested   tests/glsl/test_layered_noise.py, against NumPy
//
// Neighbours share the texels between them, which belong to the eastern and the northern
// part: a tile is one texel wider than a part. Only the last part shows its last texels.
#ifndef GENERATION_LAYERED_NOISE_PARTS
#define GENERATION_LAYERED_NOISE_PARTS
#include "maths/whole.glsl"

// Where a texel lies on the tile of its part. Where a terrain is no whole number of parts wide,
// the last part is cut.
ivec2 place_in_part(ivec2 texel, ivec2 tile, int tiles) {
    ivec2 wide = max(tile - 1, ivec2(1));
    ivec2 part = ivec2(quotient(texel.x, wide.x), quotient(texel.y, wide.y));
    part = min(part, ivec2(tiles - 1));
    ivec2 inside = texel - part * wide;
    return inside + (part & 1) * (wide - 2 * inside);
}
#endif

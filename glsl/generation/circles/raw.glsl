// generation/circles/raw.glsl -- domes added to the land, one over each disc.
//
//   gives    height, for any land; not normalised
//   needs    generation/circles/dome.glsl, maths/bits.glsl, maths/whole.glsl
//   units    heights without unit
//   source   Belaiche 2010, section 1.3.7; named Lau 1993 there
//   tested   tests/glsl/test_circles.py, against a twin in NumPy
//
// A turn is a disc; one run takes as many as are asked for, in their order, and of each texel's
// tile those alone that touch it. Outside every disc the land keeps its height to the last bit.
#include "generation/circles/dome.glsl"
#include "maths/bits.glsl"
#include "maths/whole.glsl"
#pragma kernel(output = "height:r32f", repeat = "discs", at_once = "discs")

uniform sampler2D disc;      //! input
uniform sampler2D touching;  //! input
uniform int discs = 200;     //! slider(0, 1000) How many
uniform int dome = 0;        //! menu("half a cosine", "half a sphere") Its shape: level at the rim, or upright

float kernel(ivec2 texel) {
    vec2 place = vec2(texel) * spacing / land_side(extent);
    int end = min(until, min(discs, textureSize(disc, 0).x));
    int blocks = max(quotient(discs + 95, 96), 1);
    ivec2 tiles = textureSize(touching, 0);
    tiles.x = max(quotient(tiles.x, blocks), 1);
    ivec2 most = max(size - 1, ivec2(1));
    ivec2 tile = min(ivec2(quotient(texel.x * tiles.x, most.x), quotient(texel.y * tiles.y, most.y)), tiles - 1);
    float height = previous(texel);
    for (int block = 0; block < blocks; block++) {
        int first = block * 96;
        ivec4 from = clamp(iteration - first - ivec4(0, 24, 48, 72), 0, 24);
        ivec4 to = max(clamp(end - first - ivec4(0, 24, 48, 72), 0, 24), from);
        uvec4 asked = (uvec4(1u) << uvec4(to)) - (uvec4(1u) << uvec4(from));
        uvec4 marks = uvec4(texelFetch(touching, ivec2(block * tiles.x + tile.x, tile.y), 0)) & asked;
        uint bits = marks.x;
        marks = uvec4(marks.yzw, 0u);
        // One loop for the four channels, as in generation/fault_formation/by_tiles.glsl.
        while ((bits | marks.x | marks.y | marks.z) != 0u) {
            if (bits == 0u) {
                bits = marks.x;
                marks = uvec4(marks.yzw, 0u);
                first += 24;
            }
            if (bits != 0u) {
                vec4 one = texelFetch(disc, ivec2(first + lowest_bit(bits), 0), 0);
                float share = disc_share(place - one.xy, one.z);
                if (share < 1.0) height += one.w * dome_of_share(share, dome == 1);
                bits &= bits - 1u;
            }
        }
    }
    return height;
}

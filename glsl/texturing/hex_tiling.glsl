// texturing/hex_tiling.glsl -- the three copies of an image that meet at a place.
//
//   gives    HexCopies, hex_copies, hex_sharpened
//   needs    noise/hash.glsl
//   units    places in tiles of the image; weights sum to 1
//   source   Heitz and Neyret 2018, "High-Performance By-Example Noise using a
//            Histogram-Preserving Blending Operator" (Proc. ACM CGIT 1(2)): the triangle grid;
//            sharper weights after Mikkelsen 2022, "Practical Real-Time Hex-Tiling" (JCGT 11(3))
//   tested   tests/glsl/test_texturing_hex.py, against the distances to a triangle's sides
//
// A grid of triangles lies over the terrain. Each of its corners shows the image from a place of
// its own, chosen by chance, in a hexagon around it; at a place the three corners of its
// triangle are mixed. So no two places a tile apart show the same, but by chance.
#ifndef TEXTURING_HEX_TILING
#define TEXTURING_HEX_TILING
#include "noise/hash.glsl"

struct HexCopies {
    vec3 weights;     // of the three corners, summing to 1
    ivec2 corner[3];  // which corners of the grid
};

// `cells` corners lie along the width of a tile.
HexCopies hex_copies(vec2 tile, float cells) {
    // Sheared so that the equilateral triangles become halves of unit squares.
    vec2 place = vec2(tile.x - 0.57735027 * tile.y, 1.15470054 * tile.y) * cells;
    vec2 low = floor(place);
    vec2 part = place - low;
    ivec2 square = ivec2(low);
    // Above or below the square's diagonal.
    bool upper = part.x + part.y > 1.0;
    HexCopies found;
    found.corner[0] = square + (upper ? ivec2(1) : ivec2(0));
    found.corner[1] = square + ivec2(0, 1);
    found.corner[2] = square + ivec2(1, 0);
    found.weights = upper ? vec3(part.x + part.y - 1.0, 1.0 - part.x, 1.0 - part.y)
                          : vec3(1.0 - part.x - part.y, part.y, part.x);
    return found;
}

// Weights nearer to 0 and 1, by a power from 1 up; they still sum to 1.
vec3 hex_sharpened(vec3 weights, float power) {
    vec3 raised = pow(max(weights, vec3(1e-6)), vec3(power));
    return raised / (raised.x + raised.y + raised.z);
}
#endif

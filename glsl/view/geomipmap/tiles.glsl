// view/geomipmap/tiles.glsl -- where the nodes of a tiled terrain are.
//
//   gives    TILE, cells_of_tiles, share_of_node, height_of_node
//   needs    maths/drape.glsl
//   units    nodes counted from the terrain's south-west corner; shares 0..1 of its sides
//   source   Belaiche 2010, section 2.5: tiles of a power of two
//   tested   tests/glsl/test_view_geomipmap.py
//
// A tile is 16 x 16 cells, from 512 triangles down to 2 in five levels. So many tiles lie over a
// terrain that a cell is no larger than a texel; where the texels less one are a multiple of 16,
// each node is on a texel, and elsewhere between texels, so that all cells are equal.
#ifndef VIEW_GEOMIPMAP_TILES
#define VIEW_GEOMIPMAP_TILES
#include "maths/drape.glsl"

const int TILE = 16;

// Cells a side.
ivec2 cells_of_tiles(ivec2 texels) {
    return (texels + TILE - 2) / TILE * TILE;
}

// Two tiles that share a node work out the same bits for it: their sums are the same whole number.
vec2 share_of_node(vec2 node, ivec2 texels) {
    return node / vec2(cells_of_tiles(texels));
}

float height_of_node(sampler2D height, ivec2 node) {
    ivec2 texels = textureSize(height, 0);
    return textureLod(height, drape_uv(share_of_node(vec2(node), texels), texels), 0.0).r;
}
#endif

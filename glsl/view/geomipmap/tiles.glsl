// view/geomipmap/tiles.glsl -- where the nodes of a tiled terrain are.
//
//   gives    TILE, cells_of_tiles, share_of_node, height_of_node
//   needs    nothing
//   units    nodes counted from the terrain's south-west corner; shares 0..1 of its sides
//   source   Belaiche 2010, section 2.5: tiles of a power of two
//   tested   tests/glsl/test_view_geomipmap.py
//
// A tile is 16 x 16 cells, from 512 triangles down to 2 in five levels, and a cell lies between
// texels: so each node is on a texel, whatever the terrain's size. Where the texels less one are
// no multiple of 16, the tiles at the eastern and northern edge have fewer cells: the nodes
// beyond the edge lie on it, and the triangles between them have no area.
#ifndef VIEW_GEOMIPMAP_TILES
#define VIEW_GEOMIPMAP_TILES

const int TILE = 16;

// Cells a side.
ivec2 cells_of_tiles(ivec2 texels) {
    return max(texels - 1, ivec2(1));
}

// Two tiles that share a node work out the same bits for it: their sums are the same whole number.
vec2 share_of_node(vec2 node, ivec2 texels) {
    vec2 cells = vec2(cells_of_tiles(texels));
    return min(node, cells) / cells;
}

float height_of_node(sampler2D height, ivec2 node) {
    return texelFetch(height, min(node, textureSize(height, 0) - 1), 0).r;
}
#endif

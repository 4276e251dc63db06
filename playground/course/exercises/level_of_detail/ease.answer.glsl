// view/vertices.glsl -- where the vertices of mesh "land" are.
//
//   gives    vertex_of_mesh, share_of_vertex
//   needs    maths/drape.glsl, view/geomipmap/tiles.glsl, view/surface.glsl; clip_from_world,
//            eye, extent and relief; in a draw's vertex stage only
//   units    shares 0..1 of the terrain's sides, east and north; nodes as in
//            view/geomipmap/tiles.glsl
//   source   Strugar 2009, "Continuous Distance-Dependent Level of Detail for Rendering
//            Heightmaps", Journal of Graphics, GPU, and Game Tools 14(4): one grid for every
//            node of a quadtree, whose vertices slide with the distance; how far levels reach,
//            and which way vertices slide, made here
//   tested   tests/glsl/test_view_geomipmap.py, tests/glsl/test_view_morph.py
//
// They are those of a full grid, of tiles, or of tiles that morph.
//
// A morphing tile has 16 x 16 quads of 1, 2, 4 ... cells, as its level says. Between eight tenths
// of the distance that its level reaches and all of it, each vertex that the next level lacks
// slides to a neighbour that it has, so that there both levels are the same surface. It slides
// towards the middle of the next level's fan, and so the triangles left are that fan. Neighbours
// agree about every vertex they share, as each knows its own distance to the eye: no crack, no
// stitching. Vertices stay on the terrain while they slide.
#ifndef VIEW_VERTICES
#define VIEW_VERTICES
#ifdef VERTEX_STAGE
#include "maths/drape.glsl"
#include "view/geomipmap/tiles.glsl"
#include "view/surface.glsl"

// START in playground/engine/lod.py (a test compares the two), which sees to it that no level
// begins to slide where the one before ends. What rounds off must not keep a vertex from the end
// of its way.
const float MORPH_START = 0.8;
const float MORPH_END = 0.99;

// `tile`: the node of its south-west corner, its level, and the distance in metres that it
// reaches.
vec2 morphed_share(sampler2D height, vec2 corner, vec4 tile) {
    ivec2 texels = textureSize(height, 0);
    vec2 cells = vec2(cells_of_tiles(texels));
    float quad = float(1 << int(tile.z));
    vec2 share = min(tile.xy + corner * quad, cells) / cells;
    float up = textureLod(height, drape_uv(share, texels), 0.0).r * relief;
    float eye_distance = distance(eye, vec3(share * extent, isnan(up) || isinf(up) ? 0.0 : up));
    float morph = (eye_distance / tile.w - MORPH_START) / (MORPH_END - MORPH_START);
    float slid = clamp(morph, 0.0, 1.0);
    slid = slid * slid * (3.0 - 2.0 * slid);
    // 1 and 3 go to 2, 5 and 7 to 6.
    vec2 direction = mod(corner, 2.0) * (2.0 - mod(corner, 4.0));
    return min(tile.xy + (corner + slid * direction) * quad, cells) / cells;
}

// `detail` as the draw's own parameter: 0 a grid, 1 tiles, 2 tiles that morph.
vec2 share_of_vertex(sampler2D height, int detail, vec3 corner, vec4 tile) {
    if (detail == 0) return corner.xy;
    if (detail == 1) return share_of_node(tile.xy + corner.xy, textureSize(height, 0));
    return morphed_share(height, corner.xy, tile);
}

// A vertex in the picture; its place on the terrain, and a mark as of place_of_vertex.
vec4 vertex_of_mesh(sampler2D height, int detail, vec3 corner, vec4 tile,
                    float skirt, out vec3 position, out float mark) {
    vec2 share = share_of_vertex(height, detail, corner, tile);
    vec4 place = place_of_vertex(height, share, corner.z, extent, relief, skirt);
    position = place.xyz;
    mark = place.w;
    return clip_from_world * vec4(position, 1.0);
}
#endif
#endif

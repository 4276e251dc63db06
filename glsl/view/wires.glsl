// view/wires.glsl -- a mesh's edges by arithmetic, smooth at any distance.
//
//   gives    wires, wires_of_tile, wires_of_tiles, colour_of_level; in a draw's fragment stage
//            only
//   needs    derivatives
//   units    places in cells of the mesh, widths in pixels
//   source   made here: the distance to a line over its change from pixel to pixel
//   tested   tests/glsl/test_view.py: lines where edges are, and the mean grey far away
#ifndef VIEW_WIRES
#define VIEW_WIRES
#ifdef FRAGMENT_STAGE

// How much of a pixel the edges of its triangles cover, `width` pixels wide.
// Edges are whole numbers east, whole numbers north, and the diagonals between.
float wires(vec2 cell, float width) {
    vec3 place = vec3(cell, cell.x - cell.y);
    vec3 along = dFdx(place);
    vec3 across = dFdy(place);
    vec3 change = max(sqrt(along * along + across * across), 1e-9);
    vec3 off = abs(fract(place + 0.5) - 0.5) / change;
    vec3 cover = clamp(0.5 * width + 0.5 - off, 0.0, 1.0);
    // Where cells are smaller than lines are wide apart, their mean replaces them: no moire.
    cover = mix(cover, min(width * change, 1.0), smoothstep(0.25, 0.7, change));
    return 1.0 - (1.0 - cover.x) * (1.0 - cover.y) * (1.0 - cover.z);
}

// The same of a tile of view/geomipmap: `place` in its 16 cells, and the sides (1 south, 2 east,
// 4 north, 8 west) where the neighbour is one level coarser. At the last level there are none,
// and 1 says that the tile is cut from its south-east to its north-west.
float wires_of_tile(vec2 place, int level, int coarser, float width) {
    // Before any branch: derivatives are of all pixels of a triangle or of none.
    float whole = wires(vec2(coarser == 1 ? 16.0 - place.x : place.x, place.y) / 16.0, width);
    float quad = float(1 << level), last = 16.0 / quad - 1.0;
    vec2 cell = place / quad;
    vec4 line = vec4(cell, 0.5 * (cell.x - cell.y), 0.5 * (cell.x + cell.y));
    vec4 along = dFdx(line), across = dFdy(line);
    vec4 change = max(sqrt(along * along + across * across), 1e-9);
    vec4 off = abs(fract(line + 0.5) - 0.5) / change;
    vec4 cover = mix(clamp(0.5 * width + 0.5 - off, 0.0, 1.0), min(width * change, 1.0),
                     smoothstep(0.25, 0.7, change));
    // From the middle of a block to the middle of its side there is no edge where that middle is
    // left out.
    bvec2 odd = equal(mod(floor(cell + 0.5), 2.0), vec2(1.0));
    bool upright = odd.x && (((coarser & 1) != 0 && cell.y < 1.0)
                             || ((coarser & 4) != 0 && cell.y > last));
    bool sideways = odd.y && (((coarser & 8) != 0 && cell.x < 1.0)
                              || ((coarser & 2) != 0 && cell.x > last));
    if (upright) cover.x = 0.0;
    if (sideways) cover.y = 0.0;
    cover = 1.0 - cover;
    return level == 4 ? whole : 1.0 - cover.x * cover.y * cover.z * cover.w;
}

// The edges of a pixel's tile, by what view/land.glsl knows of it: the place in the tile, its
// level, and how it is joined to its neighbours.
float wires_of_tiles(vec4 net, bool morphs) {
    // A tile that morphs has all of its triangles at any level; those that vanish have no pixels.
    int level = morphs ? 0 : int(net.z + 0.5);
    return wires_of_tile(net.xy, level, morphs ? 0 : int(net.w + 0.5), 1.0);
}

// Blue where the mesh is finest, then green, yellow, orange, red and, of tiles that morph, purple.
vec3 colour_of_level(int level) {
    return level <= 0 ? vec3(0.05, 0.25, 1.0) : level == 1 ? vec3(0.02, 0.75, 0.25)
         : level == 2 ? vec3(0.95, 0.8, 0.02) : level == 3 ? vec3(1.0, 0.3, 0.02)
         : level == 4 ? vec3(0.85, 0.02, 0.05) : vec3(0.5, 0.05, 0.9);
}
#endif
#endif

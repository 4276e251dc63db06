// view/wires.glsl -- a mesh's edges by arithmetic, smooth at any distance.
//
//   gives    wires; in a draw's fragment stage only
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
#endif
#endif

// trees/quad.glsl -- two triangles for each tree of a list, of mesh "triangles".
//
//   gives    tree_of, quad_of, NOWHERE
//   needs    nothing; a list of trees comes as an argument
//   units    corners of a square from -1 to 1
//   source   none
//   tested   tests/glsl/test_trees.py
#ifndef TREES_QUAD
#define TREES_QUAD

const vec4 NOWHERE = vec4(2.0, 2.0, 2.0, 1.0);  // all vertices of a triangle that is not wanted

// The tree of a triangle. `corner`: which triangle, and which of its vertices.
vec4 tree_of(sampler2D list, vec3 corner) {
    int which = int(corner.x) / 2;
    ivec2 texels = textureSize(list, 0);
    if (which >= texels.x * texels.y) return vec4(0.0);
    return texelFetch(list, ivec2(which % texels.x, which / texels.x), 0);
}

vec2 quad_of(vec3 corner) {
    int point = int(corner.y + 0.5);
    float side = (int(corner.x) & 1) == 1 ? 1.0 : -1.0;
    return side * (point == 0 ? vec2(1.0) : point == 1 ? vec2(-1.0, 1.0) : vec2(1.0, -1.0));
}
#endif

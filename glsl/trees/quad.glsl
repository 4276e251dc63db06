// trees/quad.glsl -- a square for each tree of a list: mesh "sheet", as many instances as trees.
//
//   gives    tree_of, square_of, NOWHERE
//   needs    maths/whole.glsl; a list of trees comes as an argument
//   units    corners of a square from -1 to 1
//   source   none
//   tested   tests/glsl/test_trees_light.py
#ifndef TREES_QUAD
#define TREES_QUAD
#include "maths/whole.glsl"

const vec4 NOWHERE = vec4(2.0, 2.0, 2.0, 1.0);  // all vertices of a square that is not wanted

// The tree of an instance; 0 tall where the list has none.
vec4 tree_of(sampler2D list, int which) {
    ivec2 texels = textureSize(list, 0);
    if (which >= texels.x * texels.y) return vec4(0.0);
    int row = quotient(which, texels.x);
    return texelFetch(list, ivec2(which - row * texels.x, row), 0);
}

vec2 square_of(vec3 corner) { return 2.0 * corner.xy - 1.0; }
#endif

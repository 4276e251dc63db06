// maths/nodes.glsl -- the nodes around a place on a grid, and how much each of them counts.
//
//   gives    Nodes, nodes_around, node_at, weight_of
//   needs    nothing: pure functions, no uniforms, no textures
//   units    texels, which are nodes; weights 0..1, whose sum is 1
//   source   bilinear interpolation, as a weighted mean
//   tested   tests/glsl/test_maths.py, against float64
//
// What is to be interpolated need not be a texel: a slope, or a mixture by numbers that have no
// mean. On a node it is one step:
//
//     Nodes around = nodes_around(place);
//     for (int k = 0; k < around.count; k++) {
//         total += weight_of(around, k) * value(node_at(around, k));
//     }
#ifndef MATHS_NODES
#define MATHS_NODES

struct Nodes {
    ivec2 low;  // the south-western one
    vec2 part;  // how far the place lies east and north of it
    int wide;   // how many count from west to east, 1 or 2
    int count;  // and in all: 1, 2 or 4
};

Nodes nodes_around(vec2 place) {
    ivec2 low = ivec2(place);
    vec2 part = place - vec2(low);
    int wide = part.x > 0.0 ? 2 : 1;
    return Nodes(low, part, wide, part.y > 0.0 ? 2 * wide : wide);
}

// East and north of the lowest, 0 or 1.
ivec2 corner_of(Nodes around, int k) {
    return around.wide == 2 ? ivec2(k & 1, k >> 1) : ivec2(0, k);
}

ivec2 node_at(Nodes around, int k) {
    return around.low + corner_of(around, k);
}

float weight_of(Nodes around, int k) {
    ivec2 corner = corner_of(around, k);
    float east = corner.x == 1 ? around.part.x : 1.0 - around.part.x;
    return east * (corner.y == 1 ? around.part.y : 1.0 - around.part.y);
}
#endif

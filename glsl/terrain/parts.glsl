// terrain/parts.glsl -- endless terrain, cut into square parts: which node of it a texel is.
//
//   gives    node_of, cell_of
//   needs    nothing: pure functions, no uniforms, no textures
//   units    nodes and texels, whole numbers; shares 0..1 of a cell
//   source   Belaiche 2010, section 5.6; whole nodes: made here
//   tested   tests/glsl/test_endless.py, against Python's whole numbers
//
// Nodes are counted over the whole terrain, east and north, from any of its parts: a node has the
// same number whatever part it is reached from, and what is worked out from that number alone
// is the same to the last bit. Neighbours share the nodes on the border between them.
//
//     | apron |      part       | apron |      a texture of size.x texels
//     0       apron             .       size.x - 1
#ifndef TERRAIN_PARTS
#define TERRAIN_PARTS

// anchor: node
// The node of a texel, where a texture holds one part with so many texels of its neighbours on
// each side.
ivec2 node_of(ivec2 texel, ivec2 part, int apron, ivec2 size) {
    return part * max(size - 1 - 2 * apron, ivec2(1)) + texel - apron;
}
// end: node

// The cell that a node lies in, of a lattice so many nodes wide, and how far it lies in it. A
// node's own number, in the millions, has no room for a fraction in a float; the rest has.
// anchor: cell
ivec2 cell_of(ivec2 node, int wide, out vec2 share) {
    ivec2 cell = node / wide;
    ivec2 rest = node - cell * wide;
    // Division goes towards zero, and a cell's first node lies south-west of it.
    ivec2 back = ivec2(lessThan(rest, ivec2(0)));
    share = vec2(rest + back * wide) / float(wide);
    return cell - back;
}
// end: cell
#endif

// generation/layered_noise/layers.glsl -- the lattice of each layer: how many intervals, and the nodes around a texel.
//
//   gives    finer, within_a_part, upright, nodes_around, node_beyond
//   needs    maths/whole.glsl
//   units    texels; part of an interval, 0..1
//   source   Belaiche 2010, section 1.3.9
//   tested   tests/glsl/test_layered_noise.py, against exact fractions
//
// Layer k = 0, 1, .. has frequency^(k+1) intervals a side. More intervals than gaps between
// texels become as many; along a side that is longer or shorter there are more or fewer, so
// that hills stay round.
#ifndef GENERATION_LAYERED_NOISE_LAYERS
#define GENERATION_LAYERED_NOISE_LAYERS
#include "maths/whole.glsl"

// Intervals in the layer after one that has so many; before the first, 1.
int finer(int intervals, int frequency, int side) {
    return min(intervals * frequency, max(side - 1, 1));
}

// Of so many intervals, those that one part has where the side is cut into so many.
int within_a_part(int intervals, int tiles) {
    return max(quotient(intervals + (tiles >> 1), tiles), 1);
}

// Intervals from south to north in a layer that has so many from west to east.
int upright(int intervals, ivec2 land) {
    ivec2 most = max(land - 1, ivec2(1));
    return clamp(quotient(intervals * most.y + (most.x >> 1), most.x), 1, most.y);
}

// The nodes before and after a place along one side, and how far it is between them. Nodes
// stand at floor(q side / intervals), the last one at side - 1.
void nodes_around(int place, int side, int intervals, out ivec2 nodes, out float part) {
    int q = quotient(place * intervals, side);
    nodes = ivec2(quotient(q * side, intervals), min(quotient((q + 1) * side, intervals), side - 1));
    part = float(place - nodes.x) / float(max(nodes.y - nodes.x, 1));
}

// The node whose random number the one after stands for: where seams are mended, a part's
// last node has the number of the next part's first one, and all parts are alike.
// anchor: beyond
int node_beyond(int node, int side, bool mended) {
    return mended && node == side - 1 ? 0 : node;
}
// end: beyond
#endif

// generation/layered_noise/layers.glsl -- the lattice of each layer: how many intervals, and the nodes around a texel.
//
//   gives    finer, within_a_part, upright, nodes_around, numbers_around
//   needs    maths/whole.glsl
//   units    texels; part of an interval, 0..1
//   source   Belaiche 2010, section 1.3.9
//   tested   tests/glsl/test_layered_noise.py, against exact fractions
//
// Layer k = 0, 1, .. has frequency^(k+1) intervals a side. More intervals than gaps between
// texels become as many; along a side that is longer or shorter there are more or fewer, so
// that hills stay round.
//
// The thesis's layer of random numbers has as many as the land has texels, and a node reads the
// one it stands on: so at each size the same seed is another land. Here the layer has 32768
// numbers a side, whatever the land's size, and a node reads the one at its share of the side.
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
// `before` is the number of the node before, counted from 0.
void nodes_around(int place, int side, int intervals, out int before, out ivec2 nodes, out float part) {
    before = quotient(place * intervals, side);
    nodes = ivec2(quotient(before * side, intervals), min(quotient((before + 1) * side, intervals), side - 1));
    part = float(place - nodes.x) / float(max(nodes.y - nodes.x, 1));
}

const int RANDOM_SIDE = 32768;

// Which numbers of the random layer the nodes before and after read, on one of so many parts a
// side. Where seams are mended, a part's last node reads the number of the next part's first
// one, and all parts are alike.
// anchor: beyond
ivec2 numbers_around(int before, int intervals, int tiles, bool mended) {
    int after = mended && before + 1 == intervals ? 0 : before + 1;
    int most = intervals * tiles;
    return ivec2(quotient(before * RANDOM_SIDE, most), quotient(after * RANDOM_SIDE, most));
}
// end: beyond
#endif

// generation/layered_noise/layers.glsl -- the lattice of each layer, and the nodes around a texel.
//
//   gives    seed_of_layer, finer, intervals_of_part, intervals_along_y, Nodes, nodes_around
//   needs    maths/whole.glsl
//   units    texels; shares of an interval, 0..1
//   source   Belaiche 2010, sections 1.3.9 and 4.3.4
//   tested   tests/glsl/test_layered_noise.py, against exact fractions
//
// Layer k = 0, 1, .. has frequency^(k+1) intervals along x. More intervals than gaps between
// texels become as many; along a y axis that is longer or shorter there are more or fewer, so
// that hills stay round.
//
// The thesis's layer of random numbers has as many as the terrain has texels, and a node reads
// the one it is on: so at each size the same seed is another terrain. Here the layer has
// 32768 numbers a side, whatever the size, and a node reads the one at its share of the side.
#ifndef GENERATION_LAYERED_NOISE_LAYERS
#define GENERATION_LAYERED_NOISE_LAYERS
#include "maths/whole.glsl"

const uint LAYERED_NOISE_SALT = 0x31b64f5bu;  // CRC-32 of "generation/layered_noise"

// An odd number far from every seed: the second layer of one terrain is not another's first.
uint seed_of_layer(uint seed, int layer) {
    return seed + LAYERED_NOISE_SALT + uint(layer) * 2654435769u;
}

// Intervals in the layer after one that has so many; before the first, 1.
int finer(int intervals, int frequency, int side) {
    return min(intervals * frequency, max(side - 1, 1));
}

// Intervals along y in a layer that has so many along x.
int intervals_along_y(int intervals, ivec2 texels) {
    ivec2 maximum = max(texels - 1, ivec2(1));
    return clamp(quotient(intervals * maximum.y + (maximum.x >> 1), maximum.x), 1, maximum.y);
}

// Of a layer's intervals, those of one part, along x and y, where the side is cut into so many.
ivec2 intervals_of_part(int intervals, int tiles, ivec2 texels) {
    int along_x = max(quotient(intervals + (tiles >> 1), tiles), 1);
    return ivec2(along_x, intervals_along_y(along_x, texels));
}

// The nodes before and after a place along one side.
struct Nodes {
    int first;    // which number of the random layer the node before reads
    int second;   // and the node after
    float share;  // of the way from one to the other
    int apart;    // texels between them, 1 or more
};

const int RANDOM_SIDE = 32768;

// Nodes are at floor(q side / intervals), the last one at side - 1. On one of so many parts a
// side that fit each other, the last node reads the number of the next part's first one, and all
// parts are alike.
// anchor: beyond
Nodes nodes_around(int place, int side, int intervals, int tiles, bool wraps) {
    int before = quotient(place * intervals, side);
    int from = quotient(before * side, intervals);
    int to = min(quotient((before + 1) * side, intervals), side - 1);
    int apart = max(to - from, 1);
    int after = wraps && before + 1 == intervals ? 0 : before + 1;
    int maximum = intervals * tiles;
    return Nodes(quotient(before * RANDOM_SIDE, maximum), quotient(after * RANDOM_SIDE, maximum),
                 float(place - from) / float(apart), apart);
}
// end: beyond
#endif

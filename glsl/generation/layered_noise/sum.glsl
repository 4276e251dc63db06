// generation/layered_noise/sum.glsl -- a sum of random layers, each finer and weaker than the one before.
//
//   gives    height, for any land; not normalised
//   needs    noise/hash.glsl, maths/whole.glsl
//   units    heights without unit: 0..1, where the overflow menu says "divide"
//   source   Belaiche 2010, section 1.3.9 (there "Perlin"; it is what is now called value noise)
//   tested   tests/glsl/test_layered_noise.py, against a twin in NumPy written as its loops
//
// Layer k = 0, 1, .. has frequency^(k+1) intervals a side and the weight persistence^(k+1).
// Its nodes stand at floor(q side / intervals), the last one at side - 1, and take their
// heights from one texel each of a layer of random numbers; texels between are interpolated.
// So heights follow the size of the land: the same seed at another size is another land.
//
// Mended: the thesis's curve returns the second node wherever nodes are one texel apart, also
// at the first node itself (slip 4). Its bytes are floats here, so a sum wraps at 1 where
// bytes wrap after 255. More intervals than texels between the edges become as many; along a
// side that is longer or shorter there are more or fewer, so that hills stay round.
#include "noise/hash.glsl"
#include "maths/whole.glsl"
#pragma kernel(output = "height:r32f")

uniform int frequency = 4;       //! log_slider(1, 1024) Intervals a side in the first layer; each next layer has this many times more
uniform int octaves = 2;         //! slider(0, 8) Layers
uniform float persistence = 0.2; //! slider(0, 1) step(0.01) Weight of the first layer; each next layer has this share of it
uniform uint seed = 7u;          //! slider(0, 9999) Which land
uniform int interpolation = 1;   //! menu("linear", "smooth") Between nodes: a line, or 3a² - 2a³
uniform int random_layers = 0;   //! menu("one", "independent") All layers read one random layer, or each its own
uniform int overflow = 0;        //! menu("divide", "clamp", "wrap") A sum above 1: divided by the weights' sum, cut, or begun again at 0 (a fault, to look at)
uniform int layer = 0;           //! slider(0, 8) Show this layer alone, at full weight; 0: their sum

// The nodes before and after a texel along one side, and how far it is between them, 0..1.
void between(int place, int side, int intervals, out ivec2 nodes, out float part) {
    int q = quotient(place * intervals, side);
    nodes = ivec2(quotient(q * side, intervals), min(quotient((q + 1) * side, intervals), side - 1));
    part = float(place - nodes.x) / float(max(nodes.y - nodes.x, 1));
    if (interpolation == 1) part = part * part * (3.0 - 2.0 * part);
}

float towards(float from, float to, float part) {
    return from + (to - from) * part;
}

// Layer k at a texel, 0..1; `intervals` along the side from west to east.
float one_layer(ivec2 texel, int k, int intervals, ivec2 most) {
    int upright = intervals;
    if (size.x != size.y) upright = clamp(quotient(intervals * most.y + (most.x >> 1), most.x), 1, most.y);
    ivec2 x, y;
    vec2 part;
    between(texel.x, size.x, intervals, x, part.x);
    between(texel.y, size.y, upright, y, part.y);
    // An odd number far from every seed, so that the second layer of one land is not the first of the next.
    uint which = random_layers == 1 ? seed + uint(k) * 2654435769u : seed;
    float south = towards(random(ivec2(x.x, y.x), which), random(ivec2(x.y, y.x), which), part.x);
    float north = towards(random(ivec2(x.x, y.y), which), random(ivec2(x.y, y.y), which), part.x);
    return towards(south, north, part.y);
}

float kernel(ivec2 texel) {
    ivec2 most = max(size - 1, ivec2(1));
    int intervals = 1;
    if (layer > 0) {
        for (int k = 0; k < layer; k++) intervals = min(intervals * frequency, most.x);
        return one_layer(texel, layer - 1, intervals, most);
    }
    float weight = 1.0;
    float total = 0.0;
    float weights = 0.0;
    for (int k = 0; k < octaves; k++) {
        intervals = min(intervals * frequency, most.x);
        weight *= persistence;
        total += weight * one_layer(texel, k, intervals, most);
        weights += weight;
    }
    if (overflow == 0) return weights > 0.0 ? total / weights : 0.0;
    if (overflow == 1) return min(total, 1.0);
    return total > 1.0 ? total - (ceil(total) - 1.0) : total;
}

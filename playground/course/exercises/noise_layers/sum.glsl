// generation/layered_noise/sum.glsl -- layers of random heights added up, each finer and weaker.
//
//   gives    height, for any terrain; not normalised
//   needs    generation/layered_noise/layers.glsl, noise/hash.glsl
//   units    heights without unit, 0..1
//   source   Belaiche 2010, section 1.3.9 (there "Perlin"; today called value noise) and, for
//            tiles, 4.3.4
//   tested   tests/glsl/test_layered_noise.py, against a twin in NumPy written as its loops
//
// Layer k = 0, 1, .. has frequency^(k+1) intervals a side, a random height at each of its nodes,
// and the weight persistence^(k+1). The share a of the way from a node of height y1 to the next
// one, of height y2, it is
//
//     y1 + a (y2 - y1)                                            (linear)
//     y1 (3 (1-a)^2 - 2 (1-a)^3) + y2 (3 a^2 - 2 a^3)             (smooth)
//   = y1 + (3 a^2 - 2 a^3) (y2 - y1)
//
// along x, then along y; and the terrain is the sum of weighted layers over the sum of weights.
//
// Fixed: the thesis's curve returns the second node wherever nodes are one texel apart, also at
// the first node itself (slip 4). Its bytes are floats here, so a sum wraps at 1 where bytes
// wrap after 255.
#include "generation/layered_noise/layers.glsl"
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")

uniform int frequency = 4;       //! log_slider(1, 1024) Intervals a side in the first layer;
                                 //! each next layer has this many times more
uniform int octaves = 2;         //! slider(0, 8) Layers
uniform float persistence = 0.2; //! slider(0, 1) step(0.01) Weight of the first layer;
                                 //! each next layer has this share of it
uniform uint seed = 7u;          //! slider(0, 9999) Which terrain
uniform int interpolation = 1;   //! menu("linear", "smooth") Between nodes: a line, or 3a² - 2a³
uniform int random_layers = 0;   //! menu("one", "independent") All layers read one random layer,
                                 //! or each its own
uniform int overflow = 0;        //! menu("divide", "clamp", "wrap") A sum above 1: divided by
                                 //! the weights' sum, cut, or begun again at 0 (an error to see)
uniform int layer = 0;           //! slider(0, 8) Show this layer alone, at full weight; 0: their
                                 //! sum
uniform int left_out = 0;        //! slider(0, 8) Of these layers, so many of the coarsest are left
                                 //! out
uniform int tiles = 1;           //! slider(1, 64) This is one of so many parts a side, and has its
                                 //! share of the intervals
uniform int seams = 1;           //! menu("removed", "left")
                                 //! Whether its last nodes are its first
                                 //! ones again

float curve(float a) {
    return interpolation == 0 ? a : a * a * (3.0 - 2.0 * a);
}

// One layer at a texel: the heights of the four nodes around it, interpolated along x, then y.
float layer_at(ivec2 texel, ivec2 intervals, uint which) {
    bool wraps = seams == 0 && tiles > 1;
    Nodes x = nodes_around(texel.x, size.x, intervals.x, tiles, wraps);
    Nodes y = nodes_around(texel.y, size.y, intervals.y, tiles, wraps);
    float south = mix(random(ivec2(x.first, y.first), which),
                      random(ivec2(x.second, y.first), which), curve(x.share));
    float north = mix(random(ivec2(x.first, y.second), which),
                      random(ivec2(x.second, y.second), which), curve(x.share));
    return mix(south, north, curve(y.share));
}

float within_1(float total, float weights) {
    if (overflow == 0) return weights > 0.0 ? clamp(total / weights, 0.0, 1.0) : 0.0;
    if (overflow < 2) return clamp(total, 0.0, 1.0);
    return total > 1.0 ? total - (ceil(total) - 1.0) : total;
}

float kernel(ivec2 texel) {
    // Of all layers, of those that are not left out, or one alone.
    int first = layer > 0 ? layer - 1 : left_out;
    int last = layer > 0 ? layer : octaves;
    int intervals = 1;
    float weight = 1.0;
    float weights = 0.0;
    float total = 0.0;
    for (int k = 0; k < last; k++) {
        intervals = finer(intervals, frequency, (size.x - 1) * tiles + 1);
        if (k < first) continue;
        uint which = seed_of_layer(seed, random_layers == 1 ? k : 0);
        total += weight * layer_at(texel, intervals_of_part(intervals, tiles, size), which);
        weights += 1.0;
    }
    return within_1(total, weights);
}

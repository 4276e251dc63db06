// generation/layered_noise/bands.glsl -- for each band and column, all layers as one polynomial.
//
//   gives    bands: the factors of 1, v, v² and v³, where v counts rows from the band's first
//   needs    generation/layered_noise/layers.glsl, noise/hash.glsl
//   units    heights without unit
//   source   the sum of generation/layered_noise/sum.glsl; the polynomial is derived here
//   tested   tests/glsl/test_layered_noise.py, as part of the fast variant
//
// Within a band every layer runs between two of its rows of nodes, d rows apart, from one height
// to the other along 3a² - 2a³ (or a), where a = a0 + v / d. Written out in powers of v such
// layers add up, however many they are: four numbers hold all.
#include "generation/layered_noise/layers.glsl"
#include "noise/hash.glsl"
#pragma kernel(output = "bands:rgba32f")

uniform sampler2D columns;       //! input
uniform sampler2D rows;          //! input
uniform sampler2D nodes;         //! input
uniform int octaves = 2;         //! slider(0, 8) As in the technique
uniform int left_out = 0;        //! slider(0, 8) As in the technique
uniform float persistence = 0.2; //! slider(0, 1) step(0.01) As in the technique
uniform uint seed = 7u;          //! slider(0, 9999) As in the technique
uniform int interpolation = 1;   //! menu("linear", "smooth") As in the technique
uniform int random_layers = 0;   //! menu("one", "independent") As in the technique
uniform int overflow = 0;        //! menu("divide", "clamp", "wrap") As in the technique
uniform int layer = 0;           //! slider(0, 8) As in the technique

// The curve from 0 to 1 in powers of v, where it is a0 far at v = 0 and rises by `rise` a row.
vec4 curve(float a0, float rise) {
    if (interpolation == 0) return vec4(a0, rise, 0.0, 0.0);
    vec4 powers = vec4(a0 * a0 * (3.0 - 2.0 * a0), 6.0 * a0 * (1.0 - a0), 3.0 - 6.0 * a0, -2.0);
    float squared = rise * rise;
    return powers * vec4(1.0, rise, squared, squared * rise);
}

vec4 kernel(ivec2 texel) {
    int last = layer > 0 ? layer : octaves;
    // There may be room for more bands than there are.
    if (texel.y >= int(texelFetch(rows, ivec2(0), 0).a)) last = 0;
    int first = layer > 0 ? layer - 1 : left_out;
    float weight = 1.0;
    if (layer == 0) for (int k = 0; k < first; k++) weight *= persistence;
    float weights = 0.0;
    vec4 total = vec4(0.0);
    for (int k = first; k < last; k++) {
        if (layer == 0) weight *= persistence;
        vec4 column = texelFetch(columns, ivec2(texel.x, k), 0);
        vec4 row = texelFetch(nodes, ivec2(texel.y, k), 0);
        ivec2 x = ivec2(column.xy);
        ivec2 y = ivec2(row.xy);
        uint which = seed_of_layer(seed, random_layers == 1 ? k : 0);
        // anchor: sum
        vec2 west = vec2(random(ivec2(x.x, y.x), which), random(ivec2(x.x, y.y), which));
        vec2 east = vec2(random(ivec2(x.y, y.x), which), random(ivec2(x.y, y.y), which));
        vec2 between = west + (east - west) * column.b;
        vec4 rise = (between.y - between.x) * curve(row.b, row.a);
        total += weight * (vec4(between.x, 0.0, 0.0, 0.0) + rise);
        weights += weight;
        // end: sum
    }
    return overflow == 0 && weights > 0.0 ? total / weights : total;
}

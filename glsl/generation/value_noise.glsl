// generation/value_noise.glsl -- value noise: random heights on a lattice, a passage between them.
//
//   gives    height, for any terrain
//   needs    noise/hash.glsl
//   units    heights without unit, 0..1
//   source   Belaiche 2010, section 1.3.9 (there "Perlin"); the quintic of Perlin 2002,
//            "Improving Noise" (SIGGRAPH)
//   tested   tests/glsl/test_noise.py, against interpolation in NumPy
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")

uniform int cells = 5;     //! log_slider(1, 256) Cells of the lattice along each side
uniform int passage = 1;   //! menu("line", "cubic", "quintic")
                           //! How the height passes from node to node
uniform uint seed = 7u;    //! slider(0, 9999) Which terrain

const uint SALT = 0xc61fd265u;  // CRC-32 of "lessons/value_noise"

// anchor: bent
vec2 bent(vec2 a) {
    if (passage == 0) return a;
    if (passage == 1) return a * a * (3.0 - 2.0 * a);
    return a * a * a * (a * (6.0 * a - 15.0) + 10.0);
}
// end: bent

float node_height(ivec2 node) {
    return random(node, seed + SALT);
}

// anchor: noise
float noise(vec2 place) {
    ivec2 node = ivec2(floor(place));
    vec2 a = bent(place - floor(place));
    float south = mix(node_height(node), node_height(node + ivec2(1, 0)), a.x);
    float north = mix(node_height(node + ivec2(0, 1)), node_height(node + ivec2(1, 1)), a.x);
    return mix(south, north, a.y);
}

float kernel(ivec2 texel) {
    return noise(float(cells) * vec2(texel) / vec2(max(size - 1, 1)));
}
// end: noise

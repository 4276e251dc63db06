// Value noise: random heights on a lattice, and a passage between them.
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")

uniform int cells = 5;   //! log_slider(1, 256) Cells of the lattice along each side
uniform uint seed = 7u;  //! slider(0, 9999) Which terrain

const uint SALT = 0xc61fd265u;  // CRC-32 of "lessons/value_noise"

vec2 bent(vec2 a) {
    return a * a * (3.0 - 2.0 * a);
}

float node_height(ivec2 node) {
    return random(node, seed + SALT);
}

float noise(vec2 place) {
    ivec2 node = ivec2(floor(place));
    vec2 a = bent(place - floor(place));
    float south = mix(node_height(node), node_height(node + ivec2(1, 0)), a.x);
    float north = mix(node_height(node + ivec2(0, 1)), node_height(node + ivec2(1, 1)), a.x);
    return mix(south, north, a.y);
}

float kernel(ivec2 texel) {
    return noise(float(cells) * vec2(texel) / vec2(size - 1));
}

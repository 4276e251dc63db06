// A kernel of heights: squares, each of a random height.
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")

float kernel(ivec2 texel) {
    vec2 place = 4.0 * vec2(texel) / vec2(size - 1);
    ivec2 node = ivec2(floor(place));
    return random(node, 7u);
}

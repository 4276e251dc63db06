// A kernel of heights: five octaves of noise, each half as wide and half as high.
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")

float noise(vec2 place) {
    ivec2 node = ivec2(floor(place));
    vec2 a = place - floor(place);
    a = a * a * (3.0 - 2.0 * a);
    float south = mix(random(node, 7u),
                      random(node + ivec2(1, 0), 7u), a.x);
    float north = mix(random(node + ivec2(0, 1), 7u),
                      random(node + ivec2(1, 1), 7u), a.x);
    return mix(south, north, a.y);
}

float kernel(ivec2 texel) {
    vec2 place = 4.0 * vec2(texel) / vec2(size - 1);
    float height = 0.0;
    float weight = 0.5;
    for (int k = 0; k < 5; k++) {
        height += weight * noise(place);
        place = 2.0 * place;
        weight = 0.5 * weight;
    }
    return height;
}

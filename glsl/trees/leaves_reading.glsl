// trees/leaves_reading.glsl -- the colour of a tree today, and the mean colour of a wood.
//
//   gives    MOST_LATE, late_at, colour_of_tree, colour_of_wood
//   needs    noise/gradient.glsl, trees/crown.glsl, trees/kinds.glsl; the table of trees/leaves as
//            an argument
//   units    metres; days; colours linear
//   source   made here: stands of one valley turn up to three weeks apart, by soil and frost
//   tested   tests/glsl/test_trees_species.py
#ifndef TREES_LEAVES_READING
#define TREES_LEAVES_READING
#include "noise/gradient.glsl"
#include "trees/crown.glsl"
#include "trees/kinds.glsl"

const float MOST_LATE = 12.0;
const uint LATE_SALT = 0x121d5919u;  // CRC-32 of "trees/leaves_reading"

// By how many days leaves at a place are behind those of others.
float late_at(vec2 place) {
    float wide = perlin(place / 530.0, LATE_SALT).x;
    float narrow = perlin(place / 170.0, LATE_SALT + 1u).x;
    return clamp(14.0 * (wide + 0.6 * narrow), -MOST_LATE, MOST_LATE);
}

vec3 leaves_in_row(sampler2D leaves, int row, float late) {
    int last = textureSize(leaves, 0).x - 1;
    float at = (0.5 + 0.5 * clamp(late / MOST_LATE, -1.0, 1.0)) * float(last);
    int low = int(at);
    return mix(texelFetch(leaves, ivec2(low, row), 0).rgb,
               texelFetch(leaves, ivec2(min(low + 1, last), row), 0).rgb, at - float(low));
}

vec3 colour_of_tree(sampler2D leaves, int kind, float late) {
    return leaves_in_row(leaves, kind, late);
}

// By how much of each species one sees; `others` as of trees/species.
vec3 colour_of_wood(sampler2D leaves, vec4 others, float late) {
    vec4 total = vec4(0.0);
    for (int k = 0; k < SPECIES; k++) {
        vec3 body = body_of(k);
        float seen = share_of(others, k) * body.x * body.y;
        if (seen > 0.0) total += seen * vec4(leaves_in_row(leaves, FIRST_ROCK + k, late), 1.0);
    }
    return total.rgb / total.a;
}
#endif

// trees/leaves_reading.glsl -- the colour of a tree today, and the mean colour of a wood.
//
//   gives    MAX_LATE, late_at, colour_of_tree, colour_of_wood
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

const float MAX_LATE = 12.0;
const uint LATE_SALT = 0x121d5919u;  // CRC-32 of "trees/leaves_reading"

// By how many days leaves at a place are behind those of others.
float late_at(vec2 place) {
    return clamp(18.0 * perlin(place / 310.0, LATE_SALT).x, -MAX_LATE, MAX_LATE);
}

vec3 leaves_in_row(sampler2D leaves, int row, float late) {
    int last = textureSize(leaves, 0).x - 1;
    float at = (0.5 + 0.5 * clamp(late / MAX_LATE, -1.0, 1.0)) * float(last);
    int low = int(at);
    return mix(texelFetch(leaves, ivec2(low, row), 0).rgb,
               texelFetch(leaves, ivec2(min(low + 1, last), row), 0).rgb, at - float(low));
}

vec3 colour_of_tree(sampler2D leaves, int kind, float late) {
    return leaves_in_row(leaves, kind, late);
}

// `seen`: how much of what one sees is of each species but oaks (others_in_sight).
vec3 colour_of_wood(sampler2D leaves, vec4 seen, float late) {
    return share_of_oaks(seen) * leaves_in_row(leaves, FIRST_ROCK + OAK, late)
            + seen.x * leaves_in_row(leaves, FIRST_ROCK + MAPLE, late)
            + seen.y * leaves_in_row(leaves, FIRST_ROCK + BIRCH, late)
            + seen.z * leaves_in_row(leaves, FIRST_ROCK + PINE, late)
            + seen.w * leaves_in_row(leaves, FIRST_ROCK + SPRUCE, late);
}
#endif

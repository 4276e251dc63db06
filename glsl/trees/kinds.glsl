// trees/kinds.glsl -- the kinds of what stands on the terrain, and their colours by the season.
//
//   gives    FIRST_NEEDLES, FIRST_ROCK, kind_of_tree, kind_of_rock, is_tree, colour_of_kind,
//            mean_leaf_colour
//   needs    nothing: pure functions, no uniforms, no textures
//   units    kinds as of scene/packing.glsl; days of the year from 0; colours linear
//   source   colours made here: albedos of leaves are 0.03 to 0.1 in green light, of autumn leaves
//            up to 0.2 (Hosgood and others 1994, LOPEX93)
//   tested   tests/glsl/test_trees_light.py
//
// 0 to 31 are broad leaves of so many tints, 32 to 47 needles, 48 to 55 rocks, the rest is free.
#ifndef TREES_KINDS
#define TREES_KINDS

const int FIRST_NEEDLES = 32;
const int FIRST_ROCK = 48;
const int ROCKS = 8;

// `tint`: 0 to 31.
int kind_of_tree(bool needles, int tint) { return needles ? FIRST_NEEDLES + tint / 2 : tint; }

bool is_tree(int kind) { return kind < FIRST_ROCK; }

// Leaves of broad-leaved trees. Each tree is a little early or late, by its tint, 0..1.
vec3 leaf_colour(float tint, float day) {
    float late = 22.0 * (tint - 0.5);
    float autumn = smoothstep(255.0, 315.0, day - late) * 0.95;
    vec3 green = mix(vec3(0.034, 0.052, 0.015), vec3(0.058, 0.074, 0.020), tint);
    vec3 fresh = vec3(0.085, 0.115, 0.025);
    vec3 bare = vec3(0.085, 0.070, 0.055);
    vec3 found = mix(fresh, green, smoothstep(115.0, 165.0, day - late));
    found = mix(found, vec3(0.100, 0.092, 0.022), smoothstep(0.15, 0.45, autumn));
    found = mix(found, vec3(0.200, 0.128, 0.026), smoothstep(0.45, 0.70, autumn));
    found = mix(found, vec3(0.140, 0.058, 0.022), smoothstep(0.72, 0.95, autumn));
    float own = day - late;
    float leafless = max(smoothstep(308.0, 335.0, own), 1.0 - smoothstep(85.0, 120.0, own));
    return mix(found, bare, leafless);
}

vec3 needle_colour(float tint) {
    return mix(vec3(0.020, 0.034, 0.015), vec3(0.030, 0.042, 0.018), tint);
}

// A rock's kind says how bright it is, from black to half of white; its hue is that of granite.
int kind_of_rock(float brightness) {
    return FIRST_ROCK + int(clamp(2.0 * brightness, 0.0, 0.999) * float(ROCKS));
}

vec3 rock_colour(int shade) {
    vec3 hue = vec3(0.15, 0.13, 0.11);
    float wanted = (float(min(shade, ROCKS - 1)) + 0.5) / float(2 * ROCKS);
    return hue * (wanted / dot(hue, vec3(0.2126, 0.7152, 0.0722)));
}

vec3 colour_of_kind(int kind, float day) {
    if (kind < FIRST_NEEDLES) return leaf_colour((float(kind) + 0.5) / 32.0, day);
    if (kind < FIRST_ROCK) return needle_colour((float(kind - FIRST_NEEDLES) + 0.5) / 16.0);
    return rock_colour(kind - FIRST_ROCK);
}

// Of a stand of which some trees have needles.
vec3 mean_leaf_colour(float needle_share, float day) {
    vec3 leaves = vec3(0.0);
    for (int k = 0; k < 4; k++) leaves += 0.25 * leaf_colour((float(k) + 0.5) / 4.0, day);
    return mix(leaves, needle_colour(0.5), needle_share);
}
#endif

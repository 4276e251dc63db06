// trees/kinds.glsl -- the kinds of what stands on the terrain, and their colours by the season.
//
//   gives    OAK, MAPLE, BIRCH, PINE, SPRUCE, SPECIES, TINTS, FIRST_NEEDLES, FIRST_ROCK, GRASS,
//            BARK, kind_of_tree, species_of, tint_of, kind_of_rock, is_tree, is_grass,
//            kind_of_grass, lightness_of_grass, tree_colour, colour_of_kind
//   needs    colour/luminance.glsl
//   units    kinds as of scene/packing.glsl; days of the year from 0; colours linear
//   source   single leaves: Hosgood and others 1994, LOPEX93 (green ones 0.08 to 0.16 in green
//            light, needles half of that), and Feret and others 2008, "PROSPECT-4 and 5", Remote
//            Sensing of Environment 112(6) (ANGERS: yellow ones 0.35 to 0.45 in red light and 0.3
//            in green, red ones 0.25 to 0.35 and 0.06). A crown throws back half of that and
//            less, since leaves shade leaves: 0.03 to 0.1 in green light in summer, no more than
//            0.25 in any light in autumn. Days: temperate lowland, northern hemisphere
//   tested   tests/glsl/test_trees_species.py
//
// 0 to 31 are broad leaves, 32 to 47 needles, 48 to 55 rocks, 56 to 59 grass, 60 bark;
// the rest is free. Of each species there are eight tints, which differ in brightness, in hue and
// by a few days.
#ifndef TREES_KINDS
#define TREES_KINDS
#include "colour/luminance.glsl"

const int OAK = 0;
const int MAPLE = 1;
const int BIRCH = 2;
const int PINE = 4;  // 3 is free
const int SPRUCE = 5;
const int SPECIES = 6;
const int TINTS = 8;
const int FIRST_NEEDLES = PINE * TINTS;
const int FIRST_ROCK = 48;
const int ROCKS = 8;
const int GRASS = 56;
const int BARK = 60;

// `tint`: 0 to 1.
int kind_of_tree(int species, float tint) {
    return species * TINTS + int(clamp(tint, 0.0, 0.999) * float(TINTS));
}

int species_of(int kind) { return kind / TINTS; }

float tint_of(int kind) { return (float(kind % TINTS) + 0.5) / float(TINTS); }

bool is_tree(int kind) { return kind < FIRST_ROCK; }

bool is_grass(int kind) { return kind >= GRASS && kind < BARK; }

// By how far along a blade: of four kinds, each is on as much of a triangle as any other.
int kind_of_grass(float along) {
    float rest = 1.0 - clamp(along, 0.0, 1.0);
    return GRASS + int(min(4.0 * (1.0 - rest * rest), 3.5));
}

// How light grass is, of the ground's colour: 1 on the mean of a blade.
float lightness_of_grass(int kind) { return 0.64 + 0.24 * float(kind - GRASS); }

// What leaves are one after the other, and the days between which each comes.
struct Course {
    vec3 green;
    vec3 turning;
    vec3 turned;
    vec3 bare;      // twigs
    vec4 days;      // of turning from and to, of turned from and to
    vec2 fall;
};

Course course_of(int species, float hue) {
    if (species == MAPLE) {
        // Some go by gold, others by orange to scarlet.
        return Course(vec3(0.048, 0.070, 0.018),
                      mix(vec3(0.215, 0.140, 0.025), vec3(0.200, 0.095, 0.021), hue),
                      mix(vec3(0.215, 0.110, 0.022), vec3(0.170, 0.050, 0.020), hue),
                      vec3(0.080, 0.068, 0.056), vec4(266.0, 282.0, 284.0, 299.0),
                      vec2(306.0, 322.0));
    }
    if (species == BIRCH) {
        return Course(vec3(0.056, 0.082, 0.022), vec3(0.140, 0.128, 0.027),
                      vec3(0.225, 0.158, 0.027), vec3(0.100, 0.086, 0.074),
                      vec4(263.0, 278.0, 276.0, 290.0), vec2(302.0, 318.0));
    }
    return Course(vec3(0.044, 0.066, 0.018), vec3(0.098, 0.090, 0.022),
                  mix(vec3(0.130, 0.076, 0.025), vec3(0.128, 0.056, 0.023), hue),
                  vec3(0.082, 0.068, 0.054), vec4(274.0, 294.0, 294.0, 316.0),
                  vec2(322.0, 345.0));
}

// `late`: by how many days the place is behind.
vec3 leaf_colour(int species, float tint, float late, float day) {
    Course c = course_of(species, fract(5.0 * tint));
    float own = day - late - 24.0 * (tint - 0.5);
    vec3 found = mix(vec3(0.085, 0.115, 0.025), c.green, smoothstep(115.0, 165.0, own));
    found = mix(found, c.turning, smoothstep(c.days.x, c.days.y, own));
    found = mix(found, c.turned, smoothstep(c.days.z, c.days.w, own));
    float spring = 1.0 - smoothstep(85.0, 120.0, own);
    return mix(found, c.bare, max(smoothstep(c.fall.x, c.fall.y, own), spring));
}

vec3 needle_colour(int species, float tint) {
    if (species == PINE) return mix(vec3(0.027, 0.043, 0.020), vec3(0.040, 0.054, 0.022), tint);
    return mix(vec3(0.022, 0.038, 0.021), vec3(0.031, 0.046, 0.023), tint);
}

// Of a tree of a species; its tints differ by up to 0.16 in brightness, and by nothing on the
// mean.
vec3 tree_colour(int species, float tint, float late, float day) {
    float bright = 1.0 + 0.36 * (fract(3.0 * tint) - 0.5);
    if (species >= PINE) return bright * needle_colour(species, tint);
    return bright * leaf_colour(species, tint, late, day);
}

// A rock's kind says how bright it is, from black to half of white; its hue is that of granite.
int kind_of_rock(float brightness) {
    return FIRST_ROCK + int(clamp(2.0 * brightness, 0.0, 0.999) * float(ROCKS));
}

vec3 rock_colour(int shade) {
    vec3 hue = vec3(0.15, 0.13, 0.11);
    float wanted = (float(min(shade, ROCKS - 1)) + 0.5) / float(2 * ROCKS);
    return hue * (wanted / luminance(hue));
}

vec3 colour_of_kind(int kind, float day) {
    if (is_tree(kind)) return tree_colour(species_of(kind), tint_of(kind), 0.0, day);
    if (kind == BARK) return vec3(0.110, 0.092, 0.074);
    return rock_colour(kind - FIRST_ROCK);
}
#endif

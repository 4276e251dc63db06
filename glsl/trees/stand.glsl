// trees/stand.glsl -- what a stand of trees hides, and the light on what one sees of it.
//
//   gives    Stand, stand_of, thinned, share_above, reaches, crown_light, WoodLight, wood_light,
//            crown_height
//   needs    trees/crown.glsl, trees/level.glsl
//   units    metres; trees a square metre; shares 0..1; light as a share of that on a surface
//            that faces the sun, and of that of the whole sky on open level ground
//   source   a Boolean model: of a Poisson field of opaque bodies with n a square metre, whose
//            shadows have the area A on a level plane, the share exp(-n A) of it is free (Serra
//            1982, "Image Analysis and Mathematical Morphology", chapter XIII; for woods Li and
//            Strahler 1992, "Geometric-Optical Bidirectional Reflectance Modeling of the Discrete
//            Crown Vegetation Canopy", IEEE TGRS 30(2))
//   tested   tests/glsl/test_trees.py, by rays through ellipsoids in float64, and
//            by what trees/seen draws
//
// One crown's shadow is an ellipse of the area pi a sqrt(a^2 + (b / tan e)^2) under light from the
// elevation e. Of it, what is higher than a height counts there: the part of the crown's outline
// above it. The single tree and the mean of a wood are lit by the same functions, so a wood keeps
// its colour where single trees end.
#ifndef TREES_STAND
#define TREES_STAND
#include "trees/crown.glsl"
#include "trees/level.glsl"

struct Stand {
    float dense;   // trees a square metre
    float across;  // half of the width of a crown
    float up;      // half of its height
    float middle;  // its middle over the ground
};

const float TREE_PI = 3.14159265;
const float CONE_AREA = 0.6366;     // of the ellipse around it: 2 a b / (pi a b)
const float SHRUNK_AREA = 0.8667;   // mean of shrunk(key)^2 for keys from 0 to 1
const float WRAP = 0.25;            // leaves let light through: so far round the edge they are lit
const float SKY_RUN = 1.0;          // the sky's light comes from 45 degrees on the mean

// `density`: the share of cells that hold a tree.
Stand stand_of(float density, float cell, float tallest, float shortest,
               float needle_share) {
    // The mean of the squared height, since hiding goes by areas.
    float tall = tallest * sqrt((1.0 + shortest + shortest * shortest) / 3.0 * SHRUNK_AREA);
    float wide = mix(0.5 * (NARROWEST.x + WIDEST.x), CONE_AREA * NARROWEST.y, needle_share);
    float up = mix(HALF_HEIGHT.x, HALF_HEIGHT.y, needle_share);
    float middle = mix(MIDDLE.x, MIDDLE.y, needle_share);
    return Stand(density / (cell * cell), wide * tall, up * tall, middle * tall);
}

// Those of the stand that are drawn as single trees so far away.
Stand thinned(Stand s, float away, float whole, float reach) {
    float growth = growth_of_kept(away, whole);
    float dense = s.dense * kept_share(away, whole, reach);
    return Stand(dense, s.across * growth, s.up * growth, s.middle * growth);
}

// The share of a crown's outline above a height over the ground.
float share_above(Stand s, float height) {
    float t = clamp((height - s.middle) / s.up, -1.0, 1.0);
    return (acos(t) - t * sqrt(1.0 - t * t)) / TREE_PI;
}

// What of light along `towards`, from a height on and upwards, no crown is in the way of.
float reaches(Stand s, float height, vec3 towards) {
    if (towards.z <= 0.0) return 0.0;
    float run = length(towards.xy) / towards.z;
    float shadow = TREE_PI * s.across * sqrt(s.across * s.across + s.up * s.up * run * run);
    return exp(-s.dense * shadow * share_above(s, height));
}

// Sun (x) and sky (y) that a crown gets at a height over the ground. `normal`: its sphere's.
vec2 crown_light(Stand s, vec3 normal, float height, vec3 to_sun) {
    float facing = clamp((dot(normal, to_sun) + WRAP) / (1.0 + WRAP), 0.0, 1.0);
    float open = reaches(s, height, vec3(SKY_RUN, 0.0, 1.0));
    return vec2(facing * reaches(s, height, to_sun), (0.5 + 0.5 * normal.z) * open);
}

struct WoodLight {
    vec2 light;   // sun and sky, mean over the crowns that one sees
    float cover;  // how much of the ground they hide
};

const int RINGS = 2;
const int SPOKES = 6;

// The mean over the disc of a crown, each place as often as one sees it.
WoodLight wood_light(Stand s, vec3 to_eye, vec3 to_sun) {
    vec3 total = vec3(0.0);
    for (int k = 0; k < RINGS * SPOKES; k++) {
        int ring = k / SPOKES;
        float spoke = float(k % SPOKES) + 0.5 * float(ring) + 0.25;
        float turn = 2.0 * TREE_PI * spoke / float(SPOKES);
        vec2 disc = sqrt((float(ring) + 0.5) / float(RINGS)) * vec2(cos(turn), sin(turn));
        vec3 place = visible_place(disc, to_eye, vec2(s.across, s.up));
        float height = s.middle + s.up * place.z;
        float seen = reaches(s, height, to_eye) + 1e-6;
        total += seen * vec3(crown_light(s, place, height, to_sun), 1.0);
    }
    return WoodLight(total.xy / total.z, 1.0 - reaches(s, 0.0, to_eye));
}
#endif

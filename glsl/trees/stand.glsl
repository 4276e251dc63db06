// trees/stand.glsl -- what a stand of trees hides, and the light on what one sees of it.
//
//   gives    Stand, stand_of, drawn_of_stand, thinned, share_above, rise_of, depth_towards,
//            reaches, depth_of_sky, facing_sun, facing_sky, leaf_phase, crown_light, share_in,
//            normal_in, WOOD_PLACES, WoodPlace, wood_place, wood_sums
//   needs    trees/crown.glsl, trees/level.glsl
//   units    metres; trees a square metre; shares 0..1; light as a share of that on a surface
//            that faces the sun, and of that of the whole sky on open level ground
//   source   a Boolean model: of a Poisson field of opaque bodies with n a square metre, whose
//            shadows have the area A on a level plane, the share exp(-n A) of it is free (Serra
//            1982, "Image Analysis and Mathematical Morphology", chapter XIII; for woods Li and
//            Strahler 1992, "Geometric-Optical Bidirectional Reflectance Modeling of the Discrete
//            Crown Vegetation Canopy", IEEE TGRS 30(2)); leaves that face all ways: Ross 1981,
//            "The Radiation Regime and Architecture of Plant Stands", II.4
//   tested   tests/glsl/test_trees_light.py, by rays through ellipsoids in float64, and
//            by what trees/seen draws
//
// One crown's shadow is an ellipse of the area pi a sqrt(a^2 + (b / tan e)^2) under light from the
// elevation e, on level ground. Of it, what is higher than a height counts there: the part of the
// crown's outline above it. The single tree and the mean of a wood are lit by the same functions,
// so a wood keeps its colour where single trees end.
#ifndef TREES_STAND
#define TREES_STAND
#include "trees/crown.glsl"
#include "trees/level.glsl"

struct Stand {
    float dense;    // trees a square metre
    float across;   // half of the width of a crown of mean size
    float up;       // half of its height
    float middle;   // its middle over the ground
    float least;    // the shortest trees over the tallest
    float cell;     // side of the cells that hold no more than one tree; 0: it may be anywhere
};

const float TREE_PI = 3.14159265;
const float WRAP = 0.2;  // leaves let light through: so far round the edge they are lit
const float THROUGH = 0.2;  // of the light on a crown, what leaves it on the far side of it
const vec3 SKY_FROM = vec3(0.7071, 0.0, 0.7071);  // where the sky's light comes from, mean
// Of the sky's light, what comes through a crown: exp(-G L) of leaves that face all ways (G 0.5)
// and are four square metres on one of ground (Campbell and Norman 1998, "An Introduction to
// Environmental Biophysics", chapter 15).
const float CLEAR = 0.135;
const int SIZES = 3;                // of crowns, for sums over them

// `density`: the share of cells that hold a tree; `others`: the shares of species.
Stand stand_of(float density, float cell, float tallest, float shortest, vec4 others) {
    // The mean of the squared height, since hiding goes by areas.
    float tall = tallest * sqrt((1.0 + shortest + shortest * shortest) / 3.0);
    vec3 body = tall * mean_body(others);
    return Stand(density / (cell * cell), body.x, body.y, body.z, shortest, cell);
}

// What of a stand is drawn as single trees so far away: the share, and how much these are larger;
// `limit`: of trees/list.
vec2 drawn_of_stand(float eye_distance, float whole, float reach, float limit) {
    return vec2(covering_share(kept_share(eye_distance, whole, reach), limit),
                growth_of_kept(eye_distance, whole, reach) * pow(limit, GROWTH));
}

// The stand of those trees; `drawn`: of drawn_of_stand.
Stand thinned(Stand s, vec2 drawn) {
    return Stand(s.dense * drawn.x, s.across * drawn.y, s.up * drawn.y, s.middle * drawn.y,
                 s.least, s.cell);
}

// One of three sizes of crowns as a factor of the mean one, and its weight, by area.
vec2 size_of(Stand s, int k) {
    float third = s.least + (1.0 - s.least) * (float(k) + 0.5) / float(SIZES);
    float mean = (1.0 + s.least + s.least * s.least) / 3.0;
    return vec2(third / sqrt(mean), third * third / (mean * float(SIZES)));
}

// The share of the crowns' outlines above a height over the ground.
float share_above(Stand s, float height) {
    float total = 0.0;
    for (int k = 0; k < SIZES; k++) {
        vec2 of = size_of(s, k);
        float t = clamp((height / of.x - s.middle) / max(s.up, 1e-6), -1.0, 1.0);
        total += of.y * (acos(t) - t * sqrt(1.0 - t * t)) / TREE_PI;
    }
    return min(total, 1.0);
}

// How much of a cell's side lies within a length, anywhere over the cells: the mean over those
// that it meets, each as often as it is met.
float overlap(float along, float side) {
    float whole = along / side;
    return whole < 1.0 ? whole * (1.0 - whole / 3.0) : 1.0 - 1.0 / (3.0 * whole);
}

// How fast a ray leaves ground of a slope: how much higher over it a metre farther on.
float rise_of(vec3 towards, vec2 slope) { return towards.z - dot(slope, towards.xy); }

// Minus the logarithm of what no crown is in the way of, along `towards` from the ground up.
// For trees anywhere that is n A. Where a cell holds one tree with the probability p, and the
// part f of it is in the way, what is free is (1 - p f), less than exp(-p f). Trees are upright on
// a slope as well, but the lower a ray goes over the ground, the longer it stays among them.
float depth_towards(Stand s, vec3 towards, float rise) {
    float outline = length(vec2(s.across * towards.z, s.up * length(towards.xy)));
    float shadow = TREE_PI * s.across * outline / max(rise, 1e-4);
    // A band as wide as a crown, and as long as makes the same area, anywhere over the cells.
    float wide = 2.0 * s.across;
    float side = max(JITTER * s.cell, 1e-3);
    float part = overlap(wide, side) * overlap(shadow / max(wide, 1e-6), side);
    float hit = min(s.dense * s.cell * s.cell * part, 0.95);
    return s.dense * shadow * (hit > 1e-3 ? -log(1.0 - hit) / hit : 1.0);
}

// What of light along `towards` no crown is in the way of, where such a share of them is above.
float reaches(Stand s, float share, vec3 towards, float rise) {
    return rise <= 0.0 ? 0.0 : exp(-depth_towards(s, towards, rise) * share);
}

// The same of the sky's light, as its depth.
float depth_of_sky(Stand s) {
    return (1.0 - CLEAR) * depth_towards(s, SKY_FROM, SKY_FROM.z);
}

// How much of the sun is on a crown's place: all over the sphere as much as without leaves that
// let light through.
float facing_sun(vec3 normal, vec3 to_sun) {
    float facing = dot(normal, to_sun);
    float lit = mix(max(WRAP + facing, 0.0), max(WRAP - facing, 0.0), THROUGH);
    return lit / ((1.0 + WRAP) * (1.0 + WRAP));
}

float facing_sky(vec3 normal) { return 0.5 + 0.5 * normal.z; }

// By where one stands, leaves that let through as much as they throw back and face everywhere are
// brighter along the light and against it than from the side; 1 on the mean over all sides.
float leaf_phase(vec3 to_eye, vec3 to_sun) {
    float cosine = clamp(-dot(to_eye, to_sun), -1.0, 1.0);
    float angle = acos(cosine);
    float back = (sqrt(1.0 - cosine * cosine) - angle * cosine) / (3.0 * TREE_PI);
    return 8.0 * (back + cosine / 6.0);
}

// Sun (x) and sky (y) on a crown where such a share of the others is above; `normal`: its
// sphere's; `rise`: of the way to the sun.
vec2 crown_light(Stand s, vec3 normal, float share, vec3 to_sun, float rise) {
    float open = exp(-depth_of_sky(s) * share);
    return vec2(facing_sun(normal, to_sun) * reaches(s, share, to_sun, rise),
                facing_sky(normal) * open);
}

// The share above in one stand of what is as deep in it as a share above is in the stand
// `thin`: one sees as much deeper into a thin stand. Of what one sees in a stand of depth d the
// part (1 - exp(-d share)) / (1 - exp(-d)) lies higher.
float share_in(Stand stand, Stand thin, float share, vec3 to_eye, float rise) {
    float d = depth_towards(stand, to_eye, rise);
    float t = depth_towards(thin, to_eye, rise);
    if (d < 1e-3) return share;
    float higher = t < 1e-3 ? share : (1.0 - exp(-t * share)) / (1.0 - exp(-t));
    return -log(max(1.0 - higher * (1.0 - exp(-d)), 1e-6)) / d;
}

// A crown's normal where the share of the crowns above it is another. Across the middle of a disc
// of radius 1 the share above falls by 2 / pi for each length of 1; nearer to its rim more slowly,
// but there is less of it.
vec3 normal_in(vec3 normal, float share, float other) {
    float z = clamp(normal.z + 0.5 * TREE_PI * (share - other), -1.0, 1.0);
    float across_square = max(dot(normal.xy, normal.xy), 1e-6);
    return vec3(normal.xy * sqrt((1.0 - z * z) / across_square), z);
}

const int SPOKES = 12;
const int RINGS = 5;

const int WOOD_PLACES = SIZES * RINGS * SPOKES;

// A place on a crown of one of the sizes, seen from far away.
struct WoodPlace {
    vec3 normal;   // of the crown's sphere
    float share;   // of the crowns, above it
    float weight;  // of the crown's size
};

WoodPlace wood_place(Stand s, vec3 to_eye, int k) {
    vec2 of = size_of(s, k / (RINGS * SPOKES));
    int ring = (k / SPOKES) % RINGS;
    float turn = 2.0 * TREE_PI * (float(k % SPOKES) + 0.4 * float(ring)) / float(SPOKES);
    float radius = sqrt((float(ring) + 0.5) / float(RINGS));
    vec2 disc = radius * vec2(cos(turn), sin(turn));
    vec3 place = visible_place(disc, to_eye, vec2(s.across, s.up));
    return WoodPlace(place, share_above(s, of.x * (s.middle + s.up * place.z)), of.y);
}

// Sums over the disc of a crown of each size: of sun, of sky and of 1, each place with
// exp(-depth share), where `share` of the crowns is above it.
vec3 wood_sums(Stand s, vec3 to_eye, vec3 to_sun, float depth) {
    vec3 total = vec3(0.0);
    for (int k = 0; k < WOOD_PLACES; k++) {
        WoodPlace found = wood_place(s, to_eye, k);
        float left = found.weight * exp(-depth * found.share);
        total += left * vec3(facing_sun(found.normal, to_sun), facing_sky(found.normal), 1.0);
    }
    return total / float(RINGS * SPOKES);
}
#endif

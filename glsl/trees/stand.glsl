// trees/stand.glsl -- what a stand of trees hides, and the light on what one sees of it.
//
//   gives    Stand, stand_of, thinned, share_above, share_in, hiding_towards, depth_of,
//            depth_towards, over_ground, reaches, crown_light, wood_light
//   needs    trees/crown.glsl, trees/level.glsl
//   units    metres; trees a square metre; shares 0..1; light as a share of that on a surface
//            that faces the sun, and of that of the whole sky on open level ground
//   source   a Boolean model: of a Poisson field of opaque bodies with n a square metre, whose
//            shadows have the area A on a level plane, the share exp(-n A) of it is free (Serra
//            1982, "Image Analysis and Mathematical Morphology", chapter XIII; for woods Li and
//            Strahler 1992, "Geometric-Optical Bidirectional Reflectance Modeling of the Discrete
//            Crown Vegetation Canopy", IEEE TGRS 30(2))
//   tested   tests/glsl/test_trees_light.py, by rays through ellipsoids in float64, and
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
    float dense;    // trees a square metre
    float across;   // half of the width of a crown of mean size
    float up;       // half of its height
    float middle;   // its middle over the ground
    float least;    // the shortest trees over the tallest
    float cell;     // side of the cells that hold no more than one tree; 0: it may be anywhere
};

const float TREE_PI = 3.14159265;
const float WRAP = 0.25;            // leaves let light through: so far round the edge they are lit
const vec3 SKY_FROM = vec3(0.7071, 0.0, 0.7071);  // where the sky's light comes from on the mean
const int SIZES = 3;                // of crowns, for sums over them

// `density`: the share of cells that hold a tree.
Stand stand_of(float density, float cell, float tallest, float shortest, float needle_share) {
    // The mean of the squared height, since hiding goes by areas.
    float tall = tallest * sqrt((1.0 + shortest + shortest * shortest) / 3.0);
    float wide = mix(0.5 * (NARROWEST.x + WIDEST.x), CONE_AREA * NARROWEST.y, needle_share);
    float up = mix(HALF_HEIGHT.x, HALF_HEIGHT.y, needle_share);
    float middle = mix(MIDDLE.x, MIDDLE.y, needle_share);
    return Stand(density / (cell * cell), wide * tall, up * tall, middle * tall, shortest,
                 cell);
}

// Those of the stand that are drawn as single trees so far away; `limit`: of trees/list.
Stand thinned(Stand s, float away, float whole, float reach, float limit) {
    float dense = s.dense * covering_share(kept_share(away, whole, reach), limit);
    float growth = growth_of_kept(away, whole) * pow(limit, GROWTH);
    return Stand(dense, s.across * growth, s.up * growth, s.middle * growth, s.least, s.cell);
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
        float t = clamp((height / of.x - s.middle) / s.up, -1.0, 1.0);
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

// What hides along `towards` from the ground up: the area of all shadows over that of the ground,
// and the share of a cell that a shadow takes. Both are as the density is.
//
// For trees anywhere the depth is n A. Where a cell holds one tree with the probability p, and the
// part f of it is in the way, what is free is (1 - p f), less than exp(-p f).
vec2 hiding_towards(Stand s, vec3 towards) {
    float run = length(towards.xy) / max(towards.z, 1e-4);
    float shadow = TREE_PI * s.across * length(vec2(s.across, s.up * run));
    // A band as wide as a crown, and as long as makes the same area, anywhere over the cells.
    float wide = 2.0 * s.across;
    float side = max(JITTER * s.cell, 1e-3);
    float part = overlap(wide, side) * overlap(shadow / wide, side);
    return vec2(s.dense * shadow, s.dense * s.cell * s.cell * part);
}

// Minus the logarithm of what no crown is in the way of.
float depth_of(vec2 hiding) {
    float hit = min(hiding.y, 0.95);
    return hiding.x * (hit > 1e-3 ? -log(1.0 - hit) / hit : 1.0);
}

float depth_towards(Stand s, vec3 towards) { return depth_of(hiding_towards(s, towards)); }

// A direction as it rises over ground of a slope, which is as level ground under a leaning sky.
vec3 over_ground(vec3 towards, vec2 slope) {
    return normalize(vec3(towards.xy, towards.z - dot(slope, towards.xy)));
}

// What of light along `towards` no crown is in the way of, where such a share of them is above.
float reaches(Stand s, float share, vec3 towards) {
    return towards.z <= 0.0 ? 0.0 : exp(-depth_towards(s, towards) * share);
}

// Sun (x) and sky (y) on a crown where such a share of the others is above; `normal`: its
// sphere's. All over the sphere it is as much sun as without leaves that let light through.
//
// `through`: to_sun, as over_ground has it.
vec2 crown_light(Stand s, vec3 normal, float share, vec3 to_sun, vec3 through) {
    float facing = max(dot(normal, to_sun) + WRAP, 0.0) / ((1.0 + WRAP) * (1.0 + WRAP));
    float open = reaches(s, share, SKY_FROM);
    return vec2(facing * reaches(s, share, through), (0.5 + 0.5 * normal.z) * open);
}

// The share above in the stand `all` of what is as deep in it as a share above is in the stand
// `thin`: one sees as much deeper into a thin stand. Of what one sees in a stand of depth d the
// part (1 - exp(-d share)) / (1 - exp(-d)) lies higher.
float share_in(Stand all, Stand thin, float share, vec3 to_eye) {
    float d = depth_towards(all, to_eye);
    float t = depth_towards(thin, to_eye);
    if (d < 1e-3) return share;
    float higher = t < 1e-3 ? share : (1.0 - exp(-t * share)) / (1.0 - exp(-t));
    return -log(max(1.0 - higher * (1.0 - exp(-d)), 1e-6)) / d;
}

const int SPOKES = 12;
const int RINGS = 5;

// The mean over the disc of a crown of each size, each place as often as one sees it.
vec2 wood_light(Stand s, vec3 to_eye, vec3 to_sun) {
    vec3 total = vec3(0.0);
    for (int k = 0; k < SIZES * RINGS * SPOKES; k++) {
        vec2 of = size_of(s, k / (RINGS * SPOKES));
        int ring = (k / SPOKES) % RINGS;
        float turn = 2.0 * TREE_PI * (float(k % SPOKES) + 0.4 * float(ring)) / float(SPOKES);
        float away = sqrt((float(ring) + 0.5) / float(RINGS));
        vec2 disc = away * vec2(cos(turn), sin(turn));
        vec3 place = visible_place(disc, to_eye, vec2(s.across, s.up));
        float share = share_above(s, of.x * (s.middle + s.up * place.z));
        float seen = of.y * reaches(s, share, to_eye) + 1e-6;
        total += seen * vec3(crown_light(s, place, share, to_sun, to_sun), 1.0);
    }
    return total.xy / total.z;
}
#endif

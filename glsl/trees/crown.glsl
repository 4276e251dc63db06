// trees/crown.glsl -- the shape of a tree's crown, by its place, its height and the species there.
//
//   gives    Form, form_of, share_of_oaks, body_of, others_in_sight, mean_body, shares_with,
//            needles_only, needle_share, Crown, crown_of, visible_place
//   needs    noise/hash.glsl, trees/kinds.glsl
//   units    metres; sizes of crowns as shares of the tree's height
//   source   ellipsoids, as in Max 1996, "Hierarchical Rendering of Trees from Precomputed
//            Multi-Layer Z-Buffers" (Eurographics workshop on rendering); proportions made here
//   tested   tests/glsl/test_trees_light.py, tests/glsl/test_trees_species.py
//
// All crowns are ellipsoids but the spruces', which are cones in the same box. An ellipsoid is a
// sphere that was stretched, so what an eye far away sees of it is a hemisphere of that sphere,
// stretched as well. Shares of species are four numbers, as of trees/species: of maples, birches,
// pines and spruces; the rest are oaks.
#ifndef TREES_CROWN
#define TREES_CROWN
#include "noise/hash.glsl"
#include "trees/kinds.glsl"

const uint CROWN_SALT = 0xe41e98a0u;  // CRC-32 of "trees/crown"
const float CONE_AREA = 0.6366;  // of the ellipse around it: 2 a b / (pi a b)

struct Form {
    vec2 across;   // half the width of the narrowest and of the widest
    float up;      // half the height
    float middle;  // over the foot
};

Form form_of(int species) {
    if (species == OAK) return Form(vec2(0.29, 0.39), 0.41, 0.59);
    if (species == MAPLE) return Form(vec2(0.26, 0.34), 0.42, 0.58);
    if (species == BIRCH) return Form(vec2(0.18, 0.25), 0.41, 0.59);
    if (species == PINE) return Form(vec2(0.18, 0.25), 0.37, 0.63);
    return Form(vec2(0.16, 0.20), 0.475, 0.525);
}

float share_of_oaks(vec4 others) {
    return max(1.0 - others.x - others.y - others.z - others.w, 0.0);
}

// Half the width of the ellipse that hides as much, half the height, and the middle.
vec3 body_of(int species) {
    Form form = form_of(species);
    float mean = 0.5 * (form.across.x + form.across.y);
    return vec3(species == SPRUCE ? CONE_AREA * mean : mean, form.up, form.middle);
}

float area_of(int species) {
    vec3 body = body_of(species);
    return body.x * body.y;
}

// How much of what one sees of a place is of each of the others, by areas, oaks being the rest.
vec4 others_in_sight(vec4 others) {
    vec4 seen = others * vec4(area_of(MAPLE), area_of(BIRCH), area_of(PINE), area_of(SPRUCE));
    return seen / (seen.x + seen.y + seen.z + seen.w + share_of_oaks(others) * area_of(OAK));
}

vec3 mean_body(vec4 others) {
    return share_of_oaks(others) * body_of(OAK) + others.x * body_of(MAPLE)
            + others.y * body_of(BIRCH) + others.z * body_of(PINE) + others.w * body_of(SPRUCE);
}

// Where all have broad leaves, and where none has: what trees/wood has a table for.
const vec4 ALL_LEAVES = vec4(0.30, 0.20, 0.0, 0.0);
const vec4 ALL_NEEDLES = vec4(0.0, 0.0, 0.45, 0.55);

// With so many needles, as of a place that nothing else is known of.
vec4 shares_with(float needle_share) { return mix(ALL_LEAVES, ALL_NEEDLES, needle_share); }

// How far from the lowland's mix to needles only. `metres`: above sea level.
float needles_only(float needles_from, float metres) {
    return smoothstep(needles_from - 150.0, needles_from + 150.0, metres);
}

float needle_share(float needles, float needles_from, float metres) {
    return mix(needles, 1.0, needles_only(needles_from, metres));
}

struct Crown {
    vec3 middle;
    float across;  // half of its width
    float up;      // half of its height
    int kind;      // trees/kinds.glsl
    uint key;      // random bits of its own
};

int species_by(float random, vec4 others) {
    vec4 end = vec4(others.x, others.x + others.y, others.x + others.y + others.z, 0.0);
    if (random < end.x) return MAPLE;
    if (random < end.y) return BIRCH;
    if (random < end.z) return PINE;
    return random < end.z + others.w ? SPRUCE : OAK;
}

Crown crown_of(vec4 tree, vec4 others) {
    ivec2 place = ivec2(floor(4.0 * tree.xy));
    uvec3 bits = hash3(uvec3(uint(place.x), uint(place.y), CROWN_SALT));
    int species = species_by(unit_from_bits(bits.x), others);
    Form form = form_of(species);
    float wide = mix(form.across.x, form.across.y, unit_from_bits(bits.y));
    vec3 middle = vec3(tree.xy, tree.z + tree.w * form.middle);
    int kind = kind_of_tree(species, unit_from_bits(bits.z));
    return Crown(middle, tree.w * wide, tree.w * form.up, kind, bits.z);
}

// The unit sphere's point that is seen at a place of its disc, x to the right and y up as
// somebody sees it who looks from `to_eye`; `stretch` is half the crown's width and height.
vec3 visible_place(vec2 disc, vec3 to_eye, vec2 stretch) {
    vec3 from = normalize(to_eye / stretch.xxy);
    vec3 right = vec3(1.0, 0.0, 0.0);
    if (length(to_eye.xy) > 1e-5) right = normalize(vec3(-to_eye.y, to_eye.x, 0.0));
    vec3 over = cross(from, right);
    return right * disc.x + over * disc.y + from * sqrt(max(1.0 - dot(disc, disc), 0.0));
}
#endif

// trees/crown.glsl -- the shape of a tree's crown, by its place and height alone.
//
//   gives    Crown, crown_of, needles_only, needle_share, needle_area, visible_place, NARROWEST,
//            WIDEST, HALF_HEIGHT, MIDDLE
//   needs    noise/hash.glsl, trees/kinds.glsl
//   units    metres; sizes of crowns as shares of the tree's height
//   source   ellipsoids, as in Max 1996, "Hierarchical Rendering of Trees from Precomputed
//            Multi-Layer Z-Buffers" (Eurographics workshop on rendering); proportions made here
//   tested   tests/glsl/test_trees_light.py
//
// Broad leaves are an ellipsoid, needles a cone in the same box. An ellipsoid is a sphere that was
// stretched, so what an eye far away sees of it is a hemisphere of that sphere, stretched as well.
#ifndef TREES_CROWN
#define TREES_CROWN
#include "noise/hash.glsl"
#include "trees/kinds.glsl"

const uint CROWN_SALT = 0xe41e98a0u;  // CRC-32 of "trees/crown"

// Half widths, half heights and middles over the foot; x of broad leaves, y of needles.
const vec2 NARROWEST = vec2(0.26, 0.19);
const vec2 WIDEST = vec2(0.36, 0.19);
const vec2 HALF_HEIGHT = vec2(0.44, 0.475);
const vec2 MIDDLE = vec2(0.56, 0.525);
const float CONE_AREA = 0.6366;  // of the ellipse around it: 2 a b / (pi a b)

struct Crown {
    vec3 middle;
    float across;  // half of its width
    float up;      // half of its height
    int kind;      // trees/kinds.glsl
    uint key;      // random bits of its own
};

// How far from the lowland's mix to needles only. `metres`: above sea level.
float needles_only(float needles_from, float metres) {
    return smoothstep(needles_from - 150.0, needles_from + 150.0, metres);
}

float needle_share(float needles, float needles_from, float metres) {
    return mix(needles, 1.0, needles_only(needles_from, metres));
}

// Of what one sees of them the share that is needles: cones are slim, 2 a b for pi a b.
float needle_area(float share) {
    float slim = share * CONE_AREA * NARROWEST.y * HALF_HEIGHT.y;
    return slim / (slim + (1.0 - share) * 0.5 * (NARROWEST.x + WIDEST.x) * HALF_HEIGHT.x);
}

Crown crown_of(vec4 tree, float needle_share) {
    ivec2 place = ivec2(floor(4.0 * tree.xy));
    uvec3 bits = hash3(uvec3(uint(place.x), uint(place.y), CROWN_SALT));
    bool slim = unit_from_bits(bits.x) < needle_share;
    float wide = slim ? NARROWEST.y : mix(NARROWEST.x, WIDEST.x, unit_from_bits(bits.y));
    float up = tree.w * (slim ? HALF_HEIGHT.y : HALF_HEIGHT.x);
    float middle = tree.z + tree.w * (slim ? MIDDLE.y : MIDDLE.x);
    int tint = int(bits.z >> 27u);
    return Crown(vec3(tree.xy, middle), tree.w * wide, up, kind_of_tree(slim, tint), bits.z);
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

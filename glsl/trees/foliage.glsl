// trees/foliage.glsl -- trees near the eye as meshes: sprays of leaves all over the crown.
//
//   gives    seen, over an earlier one with the crowns of trees/seen: the point, and its normal
//            and kind in one number
//   needs    noise/hash.glsl, scene/packing.glsl, trees/crown.glsl, trees/near.glsl,
//            trees/quad.glsl, trees/species_reading.glsl; a list of the trees near the eye; the
//            shares of species: oaks, where there are none
//   units    metres
//   source   clusters of leaves as cards around a body: Decaudin and Neyret 2004, "Rendering
//            Forest Scenes in Real-Time" (EGSR), for what is near; the leaves' outline made here
//   tested   tests/glsl/test_trees_near.py
//
// Farther away sprays are smaller, down to nothing, and the body of the crown as trees/seen draws
// it is larger, up to all of it: so nothing switches, and both have the crown's size, its normals
// and its kind.
#include "noise/hash.glsl"
#include "scene/packing.glsl"
#include "trees/crown.glsl"
#include "trees/near.glsl"
#include "trees/quad.glsl"
#include "trees/species_reading.glsl"
#pragma draw(mesh = "triangles", count = "2 * sprays", instances = "min(total.x, meshes)", \
             output = "seen:rgba32f", samples = 1)

uniform sampler2D tree;     //! input
uniform sampler2D total;    //! input
uniform sampler2D species;  //! input("zero")
uniform int sprays = 170;      //! slider(1, 1024) Sprays of leaves of a tree near the eye
uniform int meshes = 4096;     //! slider(1, 65536) How many trees are drawn so at most
#include "trees/parameters/near.glsl"

const uint SALT = 0x17241a6au;  // CRC-32 of "trees/foliage"
const float SPREAD = 0.26;  // half a spray, of half of the crown
const float LEAVES = 4.0;   // leaves side by side on half a spray
const int BOUGHS = 17;      // of a crown, with sprays around the end of each
const float BODY = 0.60;    // how far from the middle they end, of the crown's half
const float BOUGH = 0.36;   // half the width of what is at such an end

vec2 corner_of(vec3 corner) {
    bool second = (int(corner.x) & 1) == 1;
    int point = int(corner.y + 0.5);
    if (point == 0) return second ? vec2(1.0, 1.0) : vec2(-1.0, -1.0);
    if (point == 1) return second ? vec2(-1.0, 1.0) : vec2(1.0, -1.0);
    return second ? vec2(1.0, -1.0) : vec2(-1.0, 1.0);
}

// From -1 to 1.
vec3 signed_from(uvec3 bits) {
    vec3 found = vec3(unit_from_bits(bits.x), unit_from_bits(bits.y), unit_from_bits(bits.z));
    return 2.0 * found - 1.0;
}

vec3 on_sphere(vec2 random) {
    float turn = 3.14159265 * random.y;
    return vec3(sqrt(max(1.0 - random.x * random.x, 0.0)) * vec2(cos(turn), sin(turn)), random.x);
}

// How wide a crown is at a height from -1 to 1: an ellipsoid is a sphere that was stretched.
vec3 place_on_body(int kind, vec3 around) {
    if (species_of(kind) != SPRUCE) return around;
    float wide = clamp(0.5 - 0.5 * around.z, 0.03, 1.0);
    return vec3(normalize(around.xy + vec2(1e-6, 0.0)) * wide, around.z);
}

vec4 vertex(vec3 corner, out vec3 position, out vec3 normal, out vec2 card, out vec2 own) {
    vec4 found = tree_of(tree, gl_InstanceID);
    float grown = near_share(distance(eye, found.xyz), near);
    if (found.w <= 0.0 || grown <= 0.0) return NOWHERE;
    Crown crown = crown_of(found, species_at(species, found.xy / extent));
    int which = int(corner.x) / 2;
    uvec3 bits = hash3(uvec3(crown.key, uint(which), SALT));
    vec3 random = signed_from(bits);
    vec3 more = signed_from(hash3(bits));
    // The bough whose end the spray is at: from pole to pole, each a golden angle farther round.
    int bough = which % BOUGHS;
    vec3 own_of = signed_from(hash3(uvec3(crown.key, uint(bough), SALT + 1u)));
    float level = (2.0 * float(bough) + 1.0 + 0.6 * own_of.x) / float(BOUGHS) - 1.0;
    bool slim = species_of(crown.kind) == SPRUCE;
    // A cone has more boughs where it is wide.
    if (slim) level = 1.0 - 2.0 * sqrt(0.5 - 0.5 * clamp(level, -1.0, 1.0));
    vec3 out_along = on_sphere(vec2(level, 0.764 * float(bough) + 0.3 * own_of.y));
    vec3 around = on_sphere(random.xy);
    if (dot(around, out_along) < -0.15) around = -around;
    vec3 middle = place_on_body(crown.kind, out_along) * (BODY + 0.10 * own_of.z);
    middle += (slim ? 0.6 : 1.0) * BOUGH * (1.0 + 0.2 * own_of.x) * around;
    vec3 stretch = vec3(crown.across, crown.across, crown.up);
    around = normalize((slim ? out_along : middle) + 0.4 * around);
    vec3 out_of = normalize(around / stretch);
    vec3 face = normalize(out_of + 0.75 * more);
    vec3 right = normalize(cross(face, vec3(more.yz, 0.3)));
    vec3 over = cross(face, right);
    card = corner_of(corner);
    float half_wide = SPREAD * grown * (1.0 + 0.3 * more.x) * mix(crown.across, crown.up, 0.3);
    position = crown.middle + stretch * middle + half_wide * (right * card.x + over * card.y);
    // As the crown's there, leaning as the spray does.
    normal = normalize(around + 0.35 * face);
    own = vec2(float(crown.kind), float(bits.x & 65535u));
    return clip_from_world * vec4(position, 1.0);
}

// One leaf, or a twig with some, in a cell of a spray: 0 in its middle, 1 at its edge; and random
// numbers of its own.
vec3 leaf_at(vec2 place, bool needled, uint key) {
    vec2 cell = floor(place);
    uvec3 bits = hash3(uvec3(uint(int(cell.x)), uint(int(cell.y)), key));
    vec3 random = signed_from(bits);
    vec2 from = place - cell - 0.5 - 0.12 * random.xy;
    float turn = 3.14159265 * random.z;
    vec2 along = vec2(cos(turn), sin(turn));
    vec2 own = vec2(dot(from, along), dot(from, vec2(-along.y, along.x)));
    own *= needled ? vec2(1.4, 7.0) : vec2(1.5, 3.0);
    // Whole leaves end a spray.
    bool outside = length(cell + 0.5) > LEAVES - 0.6 + 0.5 * random.x;
    return vec3(outside ? 2.0 : length(own), random.xy);
}

vec4 fragment(vec3 position, vec3 normal, vec2 card, vec2 own) {
    int kind = int(own.x + 0.5);
    bool needled = kind >= FIRST_NEEDLES;
    uint key = uint(own.y + 0.5);
    vec3 leaf = leaf_at(LEAVES * card, needled, key);
    if (leaf.x > 1.0) leaf = leaf_at(LEAVES * card.yx + 0.5, needled, key + 1u);
    vec2 turned = 0.7 * LEAVES * vec2(card.y - card.x, card.x + card.y);
    if (leaf.x > 1.0) leaf = leaf_at(turned, needled, key + 2u);
    if (leaf.x > 1.0) discard;
    // Each leaf leans by itself, and what is outermost hangs.
    vec3 leaning = vec3(leaf.yz, 0.5 * leaf.y * leaf.z - 0.2 * dot(card, card));
    return vec4(position, packed_object(normalize(normal + 0.5 * leaning), kind));
}

// trees/billboard.glsl -- a crown as a square turned to the eye, and what each point of it shows.
//
//   gives    Billboard, billboard_of, CrownPoint, crown_point
//   needs    noise/gradient.glsl, trees/crown.glsl
//   units    metres; places on the square from -1 to 1 where the smooth crown ends
//   source   an ellipsoid's outline is an ellipse; normals and places of its front: Max 1996,
//            "Hierarchical Rendering of Trees from Precomputed Multi-Layer Z-Buffers"
//   tested   tests/glsl/test_trees_light.py, by the area that crowns cover
//
// Noise is added to the square of the radius, so that the mean area of a ragged crown is that of
// the smooth one. Normals are the sphere's that was stretched: leaves look outwards.
#ifndef TREES_BILLBOARD
#define TREES_BILLBOARD
#include "noise/gradient.glsl"
#include "trees/crown.glsl"

// Waves across a crown's half width, and how much each moves its outline.
const vec3 CROWN_WAVES = vec3(2.3, 6.1, 15.0);
const vec3 CROWN_LUMPS = vec3(0.34, 0.24, 0.12);
const float CROWN_ROOM = 1.3;  // of the square around a crown of 1

struct Billboard {
    vec3 place;    // of the square's corner
    vec2 disc;     // the same on the square
    vec4 middle;   // of the crown, and its kind
    vec4 form;     // half its width and height, a number of its own, the foot's height
};

Billboard billboard_of(vec4 tree, vec2 corner, float needle_share, vec3 eye) {
    Crown crown = crown_of(tree, needle_share);
    vec3 to_eye = normalize(eye - crown.middle);
    vec3 right = normalize(vec3(-to_eye.y, to_eye.x, 0.0) + vec3(1e-9, 0.0, 0.0));
    vec3 over = cross(to_eye, right);
    // Half the height of the outline, between that from the side and that from above.
    float tall = length(vec2(crown.up * length(to_eye.xy), crown.across * to_eye.z));
    vec2 disc = CROWN_ROOM * corner;
    vec3 place = crown.middle + right * (disc.x * crown.across) + over * (disc.y * tall);
    vec4 form = vec4(crown.across, crown.up, float(crown.key & 1023u), tree.z);
    return Billboard(place, disc, vec4(crown.middle, float(crown.kind)), form);
}

struct CrownPoint {
    bool hit;
    vec3 place;
    vec3 normal;
    int kind;
};

CrownPoint crown_point(vec2 disc, vec4 middle, vec4 form, float ragged, uint seed, vec3 eye) {
    int kind = int(middle.w + 0.5);
    vec3 coarse = perlin(disc * CROWN_WAVES.x + form.z * 7.31, seed);
    vec3 fine = perlin(disc * CROWN_WAVES.y + form.z * 3.17, seed + 1u);
    vec3 leaves = perlin(disc * CROWN_WAVES.z + form.z * 1.73, seed + 2u);
    float radius = dot(disc, disc);
    if (kind >= FIRST_NEEDLES) {
        // A cone, as wide as the box at its foot.
        float edge = disc.x / clamp(0.5 - 0.5 * disc.y, 0.01, 1.0);
        radius = max(edge * edge, abs(disc.y));
    }
    float outside = radius + ragged * dot(CROWN_LUMPS, vec3(coarse.x, fine.x, leaves.x));
    vec3 to_eye = normalize(eye - middle.xyz);
    vec2 held = disc / max(1.02 * length(disc), 1.0);
    // Lumps of leaves lean the normals.
    vec2 leaning = held - ragged * (0.13 * coarse.yz + 0.12 * fine.yz + 0.11 * leaves.yz);
    leaning /= max(1.02 * length(leaning), 1.0);
    vec3 place = middle.xyz + visible_place(held, to_eye, form.xy) * form.xxy;
    return CrownPoint(outside <= 1.0, place, visible_place(leaning, to_eye, form.xy), kind);
}
#endif

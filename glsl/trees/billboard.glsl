// trees/billboard.glsl -- a crown as a square turned to the eye, and what each point of it shows.
//
//   gives    Billboard, billboard_of, disc_of, CrownPoint, crown_point
//   needs    noise/gradient.glsl, trees/crown.glsl
//   units    metres; places on the square from -1 to 1 where the smooth crown ends
//   source   an ellipsoid's outline is an ellipse; normals and places of its front: Max 1996,
//            "Hierarchical Rendering of Trees from Precomputed Multi-Layer Z-Buffers"
//   tested   tests/glsl/test_trees_light.py, by the area that crowns cover
//
// Noise is added to the square of the radius, so that the mean area of a ragged crown is that of
// the smooth one; waves that a pixel is too wide for are left out. Normals are the sphere's that
// was stretched: leaves look outwards.
//
// A pixel works out where on the square it is (disc_of) from numbers that all of the square has:
// what is interpolated between corners has other bits in each part of a picture drawn in parts,
// which shows at the edges of leaves. Through the place (x, y) of clip space the ray from the eye
// is along A x B + x B x W + y W x A, with A, B and W the matrix's rows of x, y and w; where it
// meets the square is -d (ray u, ray v) / (ray n), with n towards the eye, d away, and u and v
// the sides, each over half its length.
#ifndef TREES_BILLBOARD
#define TREES_BILLBOARD
#include "noise/gradient.glsl"
#include "trees/crown.glsl"

// Waves across a crown's half width, and how much each moves its outline.
const vec3 CROWN_WAVES = vec3(2.3, 6.1, 15.0);
const vec3 CROWN_LUMPS = vec3(0.34, 0.24, 0.12);
const vec3 CROWN_LEANS = vec3(0.13, 0.12, 0.11);  // and its normals
const float CROWN_ROOM = 1.4;  // of the square around a crown of 1
const float TRUNK = 0.07;      // half the width of a trunk, of a crown of 1
const float TRUNK_FROM = 6.0;  // pixels of half a crown
const float TRUNK_LOW = 0.44;  // how much longer than the crown's half it goes down

// How much of an octave a crown shows, of which half is so many pixels wide: all, if a wave is as
// wide as a pixel; nothing, if it is a third of that.
float shown(float pixels, int octave) {
    return clamp(1.5 * pixels / CROWN_WAVES[octave] - 0.5, 0.0, 1.0);
}

struct Billboard {
    vec3 place;    // of the square's corner
    mat3 disc;     // of a place of clip space, (x, y, 1), the place on the square, times its third
    vec4 middle;   // of the crown, and its kind
    vec4 form;     // half its width and height, a number of its own, half its width in pixels
};

// `focal`: how many pixels wide is what is as wide as far away.
Billboard billboard_of(vec4 tree, vec2 corner, vec4 others, vec3 eye, mat4 to_clip, float focal) {
    Crown crown = crown_of(tree, others);
    vec3 to_eye = normalize(eye - crown.middle);
    vec3 right = normalize(vec3(-to_eye.y, to_eye.x, 0.0) + vec3(1e-9, 0.0, 0.0));
    vec3 over = cross(to_eye, right);
    // Half the height of the outline, between that from the side and that from above.
    float tall = length(vec2(crown.up * length(to_eye.xy), crown.across * to_eye.z));
    float eye_distance = distance(eye, crown.middle);
    float pixels = focal * crown.across / max(eye_distance, 1e-3);
    // As much room as the waves need that are shown, and the trunk.
    float lumps = CROWN_LUMPS.x * shown(pixels, 0) + CROWN_LUMPS.y * shown(pixels, 1)
            + CROWN_LUMPS.z * shown(pixels, 2);
    float room = pixels > TRUNK_FROM ? CROWN_ROOM : min(sqrt(1.0 + 1.5 * lumps), CROWN_ROOM);
    vec2 on = room * corner * vec2(crown.across, tall);
    vec3 place = crown.middle + right * on.x + over * on.y;
    mat4 rows = transpose(to_clip);
    mat3 rays = mat3(cross(rows[1].xyz, rows[3].xyz), cross(rows[3].xyz, rows[0].xyz),
                     cross(rows[0].xyz, rows[1].xyz));
    mat3 sides = mat3(-eye_distance / crown.across * right, -eye_distance / tall * over, to_eye);
    vec4 form = vec4(crown.across, crown.up, float(crown.key & 1023u), pixels);
    return Billboard(place, transpose(sides) * rays, vec4(crown.middle, float(crown.kind)), form);
}

vec2 disc_of(mat3 disc, vec2 share) {
    vec3 found = disc * vec3(2.0 * share - 1.0, 1.0);
    return found.xy / found.z;
}

struct CrownPoint {
    bool hit;
    vec3 place;
    vec3 normal;
    int kind;
};

// How much the outline moves in, and how much the normal leans: sums over the octaves that are
// shown. A software renderer runs what an `if` skips; the steps of a loop that are left out are.
vec3 lumps_at(vec2 disc, vec4 form, uint seed) {
    vec3 total = vec3(0.0);
    int octaves = form.w > CROWN_WAVES.z / 3.0 ? 3 : form.w > CROWN_WAVES.y / 3.0 ? 2 : 1;
    for (int k = 0; k < octaves; k++) {
        vec2 own = vec2(form.z * (7.31 - 2.0 * float(k)));
        vec3 noise = perlin(disc * CROWN_WAVES[k] + own, seed + uint(k));
        total += shown(form.w, k) * vec3(CROWN_LUMPS[k], CROWN_LEANS[k], CROWN_LEANS[k]) * noise;
    }
    return total;
}

// What of the square is the trunk below the crown, and as much of that as a pixel shows.
CrownPoint trunk_point(vec2 disc, vec4 middle, vec4 form, vec3 to_eye) {
    float aside = disc.x / TRUNK;
    float level = length(to_eye.xy);
    float tall = length(vec2(form.y * level, form.x * to_eye.z));
    float up = disc.y * tall / max(level, 0.05);
    bool hit = abs(aside) < 1.0 && form.w > TRUNK_FROM && disc.y < 0.0
            && up > -(1.0 + TRUNK_LOW) * form.y;
    vec3 right = vec3(-to_eye.y, to_eye.x, 0.0) / max(level, 1e-3);
    vec3 front = vec3(to_eye.xy, 0.0) / max(level, 1e-3);
    vec3 normal = right * aside + front * sqrt(max(1.0 - aside * aside, 0.0));
    vec3 place = middle.xyz + vec3(0.0, 0.0, up) + normal * (TRUNK * form.x);
    return CrownPoint(hit, place, normalize(normal + vec3(0.0, 0.0, 1e-3)), BARK);
}

CrownPoint crown_point(vec2 disc, vec4 middle, vec4 form, float ragged, uint seed, vec3 eye) {
    int kind = int(middle.w + 0.5);
    float radius = dot(disc, disc);
    vec2 around = disc;  // where on the sphere's disc its normal is
    if (species_of(kind) == SPRUCE) {
        // A cone, as wide as the box at its foot.
        float edge = disc.x / clamp(0.5 - 0.5 * disc.y, 0.01, 1.0);
        float level = disc.y * disc.y * disc.y;
        radius = max(edge * edge, level * level);
        around.x = edge * sqrt(max(1.0 - disc.y * disc.y, 0.0));
    }
    vec3 to_eye = normalize(eye - middle.xyz);
    CrownPoint found = trunk_point(disc, middle, form, to_eye);
    vec3 lumps = ragged * lumps_at(disc, form, seed);
    if (radius + lumps.x > 1.0) return found;
    vec2 clamped = disc / max(1.02 * length(disc), 1.0);
    // Lumps of leaves lean the normals.
    vec2 leaning = around / max(1.02 * length(around), 1.0) - lumps.yz;
    leaning /= max(1.02 * length(leaning), 1.0);
    found.hit = true;
    found.kind = kind;
    found.place = middle.xyz + visible_place(clamped, to_eye, form.xy) * form.xxy;
    found.normal = visible_place(leaning, to_eye, form.xy);
    return found;
}
#endif

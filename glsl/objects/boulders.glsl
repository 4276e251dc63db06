// objects/boulders.glsl -- a rock at every place of a list, each of a shape of its own.
//
//   gives    seen, over an earlier one: the point, and its normal and kind in one number
//   needs    noise/hash.glsl, scene/packing.glsl, trees/kinds.glsl, trees/quad.glsl; a list and
//            its length
//   units    metres; the list says how tall a rock is
//   source   made here: stone breaks along planes, so a rock is what some planes leave of a ball
//   tested   tests/glsl/test_undergrowth.py
//
// The ball is an octahedron whose sides are split: each corner goes outwards to the nearest plane.
#include "noise/hash.glsl"
#include "scene/packing.glsl"
#include "trees/kinds.glsl"
#include "trees/quad.glsl"
#pragma draw(mesh = "triangles", count = "72", instances = "min(total.x, objects)", \
             output = "seen:rgba32f", samples = 1)

uniform sampler2D tree;    //! input
uniform sampler2D total;   //! input
#include "objects/parameters/rocks.glsl"

const uint SALT = 0x6bdf4a9cu;  // CRC-32 of "objects/boulders"
const int SPLIT = 3;     // of a side of the octahedron: nine triangles an octant
const int PLANES = 9;

// A corner of a triangle, on the unit sphere.
vec3 corner_of(int triangle, int point) {
    int octant = triangle / (SPLIT * SPLIT);
    int part = triangle % (SPLIT * SPLIT);
    int row = part < 5 ? 0 : part < 8 ? 1 : 2;
    int along = part - (row == 0 ? 0 : row == 1 ? 5 : 8);
    // Upright ones begin at even places, those on their heads between two of them.
    ivec2 at = ivec2((along + 1) / 2, row);
    bool upright = along % 2 == 0;
    if (point == 1) at += upright ? ivec2(1, 0) : ivec2(0, 1);
    if (point == 2) at += upright ? ivec2(0, 1) : ivec2(-1, 1);
    vec3 place = vec3(vec2(at), float(SPLIT - at.x - at.y));
    vec3 signs = vec3(octant & 1, (octant >> 1) & 1, (octant >> 2) & 1) * 2.0 - 1.0;
    return normalize(place * signs);
}

vec3 random_of(uvec3 bits) {
    return vec3(unit_from_bits(bits.x), unit_from_bits(bits.y), unit_from_bits(bits.z));
}

// How far from the middle the rock ends, and the plane that it ends at.
struct Side {
    float distance_to;
    vec3 plane;
};

Side side_of(vec3 ahead, uint key) {
    Side found = Side(1.0, ahead);
    for (int k = 0; k < PLANES; k++) {
        vec3 random = random_of(hash3(uvec3(key, uint(k), SALT + 1u)));
        float level = 2.0 * random.x - 1.0;
        float turn = 6.2831853 * random.y;
        vec3 plane = vec3(sqrt(1.0 - level * level) * vec2(cos(turn), sin(turn)), level);
        float from = (0.55 + 0.35 * random.z) / max(dot(plane, ahead), 1e-3);
        if (from < found.distance_to) found = Side(from, plane);
    }
    return found;
}

vec4 vertex(vec3 corner, out vec3 position, out vec3 towards, out vec4 own) {
    vec4 found = tree_of(tree, gl_InstanceID);
    if (found.w <= 0.0) return NOWHERE;
    ivec2 at = ivec2(floor(4.0 * found.xy));
    uvec3 bits = hash3(uvec3(uint(at.x), uint(at.y), SALT));
    uint key = bits.x & 4095u;
    towards = corner_of(int(corner.x), int(corner.y + 0.5));
    vec3 place = side_of(towards, key).distance_to * towards;
    vec3 random = random_of(bits);
    own = vec4(float(key), random.y, 0.8 + 0.4 * random.z, found.w);
    // Flatter than it is wide, and turned.
    place *= vec3(1.25, own.z, 0.75) * (0.667 * found.w);
    float turn = 6.2831853 * own.y;
    mat2 turned = mat2(cos(turn), sin(turn), -sin(turn), cos(turn));
    position = found.xyz + vec3(turned * place.xy, place.z + (0.35 - sunk) * found.w);
    return clip_from_world * vec4(position, 1.0);
}

vec4 fragment(vec3 position, vec3 towards, vec4 own) {
    uint key = uint(own.x + 0.5);
    vec3 ahead = normalize(towards);
    // Broken faces are flat, and worn a little.
    vec3 normal = mix(side_of(ahead, key).plane, ahead, 0.2) / vec3(1.25, own.z, 0.75);
    float turn = 6.2831853 * own.y;
    normal.xy = mat2(cos(turn), sin(turn), -sin(turn), cos(turn)) * normal.xy;
    float light = 0.12 + 0.03 * float(key & 3u);
    return vec4(position, packed_object(normalize(normal), kind_of_rock(light)));
}

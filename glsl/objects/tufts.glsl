// objects/tufts.glsl -- tufts of grass at the places of a list, as trees/place gives it.
//
//   gives    seen, over an earlier one: the point, and its normal and kind in one number
//   needs    noise/hash.glsl, scene/packing.glsl, terrain/heightfield.glsl, trees/kinds.glsl,
//            trees/quad.glsl; a list, its length and a height
//   units    metres
//   source   blades as single triangles: Boulanger, Pattanaik and Bouatouch 2009, "Rendering Grass
//            in Real Time with Dynamic Lighting", IEEE CG&A 29(1), for what is nearest
//   tested   tests/glsl/test_undergrowth.py
//
// Blades have the colour of the ground that they stand on (scene/cover), darker at the foot and
// lighter at the tip by as much, and face where the ground does, each leaning a little: so where
// tufts end the meadow stays as light as it was.
#include "noise/hash.glsl"
#include "scene/packing.glsl"
#include "terrain/heightfield.glsl"
#include "trees/kinds.glsl"
#include "trees/quad.glsl"
#pragma draw(mesh = "triangles", count = "blades", instances = "min(total.x, tufts)", \
             output = "seen:rgba32f", samples = 1)

uniform sampler2D tree;    //! input
uniform sampler2D total;   //! input
uniform sampler2D height;  //! input
uniform int tufts = 32768;  //! slider(1, 131072) How many tufts are drawn at most
uniform int blades = 12;    //! slider(1, 32) Blades of a tuft
uniform float ends = 60.0;  //! slider(1, 200) unit("m") Where the last blades end

const uint SALT = 0x9f13d8efu;  // CRC-32 of "objects/tufts"
const float WIDE = 0.04;     // half the width of a blade's foot, of the tuft's height
const float SPREAD = 0.9;    // how far from the middle blades stand, of the tuft's height
const float LEANING = 0.55;  // how far a tip is beside its foot, of the tuft's height

vec4 vertex(vec3 corner, out vec3 position, out vec3 normal, out float along) {
    vec4 found = tree_of(tree, gl_InstanceID);
    // Farther away blades are fewer and lower: down to none.
    float nearness = 1.0 - smoothstep(0.15 * ends, 0.9 * ends, distance(eye, found.xyz));
    float rank = (float(int(corner.x)) + 0.5) / float(blades);
    float grown = clamp(4.0 * (nearness - 0.75 * rank), 0.0, 1.0);
    if (found.w <= 0.0 || grown <= 0.0) return NOWHERE;
    ivec2 key = ivec2(floor(16.0 * found.xy));
    uvec3 bits = hash3(uvec3(uint(key.x), uint(key.y), SALT + uint(int(corner.x))));
    vec3 random = vec3(unit_from_bits(bits.x), unit_from_bits(bits.y), unit_from_bits(bits.z));
    vec3 more = vec3(hash3(bits) >> 8u) / 16777216.0;
    float turn = 6.2831853 * random.x;
    vec2 aside = vec2(cos(turn), sin(turn));
    float round_by = 6.2831853 * more.x;
    vec2 foot = SPREAD * found.w * sqrt(random.y) * vec2(cos(round_by), sin(round_by));
    vec2 share = (found.xy + foot) / extent;
    vec2 at = clamp(share, 0.0, 1.0) * vec2(textureSize(height, 0) - 1);
    vec2 spacing = spacing_of(textureSize(height, 0), extent);
    vec2 slope = relief * slope_at(height, at, spacing, CENTRAL_DIFFERENCES);
    // The ground under a blade goes on as under the tuft's middle.
    position = vec3(found.xy + foot, found.z + dot(slope, foot));
    int point = int(corner.y + 0.5);
    along = point == 2 ? 1.0 : 0.0;
    float tall = grown * found.w * (0.55 + 0.45 * random.z);
    if (point == 2) position += vec3(LEANING * grown * found.w * (more.yz - 0.5) * 2.0, tall);
    else position.xy += (point == 0 ? -1.0 : 1.0) * WIDE * found.w * aside;
    normal = normalize(vec3(-slope + 0.35 * (more.yz - 0.5), 1.0));
    return clip_from_world * vec4(position, 1.0);
}

vec4 fragment(vec3 position, vec3 normal, float along) {
    return vec4(position, packed_object(normalize(normal), kind_of_grass(along)));
}

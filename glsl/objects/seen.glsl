// objects/seen.glsl -- a model at every place of a list, as trees/place gives it.
//
//   gives    seen, over an earlier one: the point, and its normal and kind in one number
//   needs    colour/luminance.glsl, noise/hash.glsl, scene/packing.glsl, trees/kinds.glsl,
//            trees/quad.glsl; a list and its length; a model of objects/model
//   units    metres; the model is made as tall as the list says, from its own height
//   source   none
//   tested   tests/glsl/test_objects.py, by where a model's corners are in the picture
//
// Each is turned about its upright by a number of its own. Only those between `nearest` and
// `farthest` from the eye: what is farther away trees/seen draws, where its `nearest` is the same.
#include "colour/luminance.glsl"
#include "noise/hash.glsl"
#include "scene/packing.glsl"
#include "trees/kinds.glsl"
#include "trees/quad.glsl"
#pragma draw(mesh = "triangles", count = "place.size.x * place.size.y // 3", \
             instances = "min(total.x, objects)", output = "seen:rgba32f", samples = 1)

uniform sampler2D tree;    //! input
uniform sampler2D total;   //! input
uniform sampler2D place;   //! input
uniform sampler2D facing;  //! input
uniform sampler2D tint;    //! input
#include "objects/parameters/rocks.glsl"
uniform float tall = 1.0;         //! log_slider(0.01, 100) unit("m") Height of the model itself
uniform float nearest = 0.0;      //! slider(0, 10000) unit("m") Nearer than this none is drawn
uniform float farthest = 100000.0;  //! log_slider(1, 100000) unit("m") Farther away none is drawn
uniform int kind = 2;             //! menu("leaves", "needles", "rock") What it is made of

const uint SALT = 0xf4e80b63u;  // CRC-32 of "objects/seen"

// Darker and lighter ones of a kind, by the model's colour at a corner.
int kind_at(vec3 colour) {
    float light = luminance(colour);
    if (kind == 2) return kind_of_rock(light);
    return kind_of_tree(kind == 1 ? SPRUCE : OAK, clamp(2.0 * light, 0.0, 0.999));
}

vec4 vertex(vec3 corner, out vec3 position, out vec3 normal, out float material) {
    vec4 found = tree_of(tree, gl_InstanceID);
    int which = 3 * int(corner.x) + int(corner.y + 0.5);
    ivec2 texels = textureSize(place, 0);
    if (found.w <= 0.0 || which >= texels.x * texels.y) return NOWHERE;
    float eye_distance = distance(eye, found.xyz);
    ivec2 texel = ivec2(which % texels.x, which / texels.x);
    vec4 own = texelFetch(place, texel, 0);
    if (own.w <= 0.0 || eye_distance < nearest || eye_distance >= farthest) return NOWHERE;
    ivec2 key = ivec2(floor(4.0 * found.xy));
    float turn = 6.2831853 * random(key, SALT);
    mat2 turned = mat2(cos(turn), sin(turn), -sin(turn), cos(turn));
    float scale = found.w / tall;
    vec3 facing_of = texelFetch(facing, texel, 0).xyz;
    normal = vec3(turned * facing_of.xy, facing_of.z);
    position = found.xyz + scale * vec3(turned * own.xy, own.z) - vec3(0.0, 0.0, sunk * found.w);
    material = float(kind_at(texelFetch(tint, texel, 0).rgb));
    return clip_from_world * vec4(position, 1.0);
}

vec4 fragment(vec3 position, vec3 normal, float material) {
    return vec4(position, packed_object(normalize(normal), int(material + 0.5)));
}

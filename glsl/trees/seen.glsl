// trees/seen.glsl -- trees as the eye sees them: crowns with ragged outlines, turned to the eye.
//
//   gives    seen, over an earlier one: the point, and its normal and kind in one number
//   needs    scene/packing.glsl, trees/billboard.glsl, trees/near.glsl,
//            trees/quad.glsl, trees/species_reading.glsl; a list of trees; the shares of species:
//            oaks, where there are none
//   units    metres
//   source   trees/billboard.glsl
//   tested   tests/glsl/test_trees_light.py, by the area that they cover; those left to
//            models: tests/glsl/test_objects.py
#include "scene/packing.glsl"
#include "trees/billboard.glsl"
#include "trees/near.glsl"
#include "trees/quad.glsl"
#include "trees/species_reading.glsl"
#pragma draw(mesh = "sheet", instances = "min(total.x, trees)", output = "seen:rgba32f", \
             samples = 1)

uniform sampler2D tree;   //! input
uniform sampler2D total;  //! input
uniform sampler2D species;  //! input("zero")
uniform float nearest = 0.0;  //! slider(0, 10000) unit("m")
                              //! Nearer than this none is drawn: there objects/seen has models
#include "trees/parameters/budget.glsl"
#include "trees/parameters/ragged.glsl"
#include "trees/parameters/near.glsl"

const uint SALT = 0xc8c979e4u;  // CRC-32 of "trees/seen"

// All numbers of a tree go to its pixels bit for bit, as only whole ones do.
vec4 vertex(vec3 corner, out ivec4 middle_bits, out ivec4 form_bits, out ivec3 x_bits,
            out ivec3 y_bits, out ivec3 one_bits) {
    vec4 found = tree_of(tree, gl_InstanceID);
    if (found.w <= 0.0 || distance(eye, found.xyz) < nearest) return NOWHERE;
    vec4 others = species_at(species, found.xy / extent);
    float focal = 0.5 * float(size.y) * length(transpose(clip_from_world)[1].xyz);
    Billboard board =
            billboard_of(found, square_of(corner), others, eye, clip_from_world, focal);
    // The body is smaller amid the sprays of trees/foliage.
    float core = 1.0 / mix(1.0, CORE, near_share(distance(eye, found.xyz), near));
    middle_bits = floatBitsToInt(board.middle);
    form_bits = floatBitsToInt(board.form);
    vec3 smaller = vec3(core, core, 1.0);
    x_bits = floatBitsToInt(smaller * board.disc[0]);
    y_bits = floatBitsToInt(smaller * board.disc[1]);
    one_bits = floatBitsToInt(smaller * board.disc[2]);
    return clip_from_world * vec4(board.place, 1.0);
}

vec4 fragment(ivec4 middle_bits, ivec4 form_bits, ivec3 x_bits, ivec3 y_bits, ivec3 one_bits) {
    mat3 seen_on = mat3(intBitsToFloat(x_bits), intBitsToFloat(y_bits), intBitsToFloat(one_bits));
    vec2 disc = disc_of(seen_on, gl_FragCoord.xy / vec2(size));
    CrownPoint point = crown_point(disc, intBitsToFloat(middle_bits), intBitsToFloat(form_bits),
                                   ragged, SALT, eye);
    if (!point.hit) discard;
    return vec4(point.place, packed_object(point.normal, point.kind));
}

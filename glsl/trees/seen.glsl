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

vec4 vertex(vec3 corner, out vec2 disc, out vec4 middle, out vec4 form) {
    vec4 found = tree_of(tree, gl_InstanceID);
    if (found.w <= 0.0 || distance(eye, found.xyz) < nearest) return NOWHERE;
    vec4 others = species_at(species, found.xy / extent);
    float focal = 0.5 * float(size.y) * length(transpose(clip_from_world)[1].xyz);
    Billboard board = billboard_of(found, square_of(corner), others, eye, focal);
    // The body is smaller amid the sprays of trees/foliage.
    disc = board.disc / mix(1.0, CORE, near_share(distance(eye, found.xyz), near));
    middle = board.middle;
    form = board.form;
    return clip_from_world * vec4(board.place, 1.0);
}

vec4 fragment(vec2 disc, vec4 middle, vec4 form) {
    CrownPoint point = crown_point(disc, middle, form, ragged, SALT, eye);
    if (!point.hit) discard;
    return vec4(point.place, packed_object(point.normal, point.kind));
}

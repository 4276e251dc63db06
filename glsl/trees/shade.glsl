// trees/shade.glsl -- the shadows that trees throw on the ground around the eye, seen from above.
//
//   gives    shade: the share of the sun that is taken away, in a square around the eye
//   needs    lighting/daylight_reading.glsl, lighting/parameters/sun.glsl, trees/crown.glsl,
//            trees/species_reading.glsl; a list of trees; the shares of species, if there are
//   units    metres; 0..1
//   source   an ellipsoid's shadow on a level plane is an ellipse: as wide as it, half its length
//            sqrt(a^2 + (b / tan e)^2), moved by how high its middle is over tan e
//   tested   tests/glsl/test_trees_light.py, against rays through ellipsoids in float64
#include "lighting/daylight_reading.glsl"
#include "trees/crown.glsl"
#include "trees/quad.glsl"
#include "trees/species_reading.glsl"
#pragma draw(mesh = "sheet", instances = "min(total.x, trees)", output = "shade:r16f", \
             depth = "none", blend = "alpha", samples = 1)

uniform sampler2D tree;   //! input
uniform sampler2D total;  //! input
uniform sampler2D species;  //! input("zero")
#include "lighting/parameters/sun.glsl"
#include "trees/parameters/budget.glsl"
#include "trees/parameters/shade.glsl"

const float SOFT = 0.3;     // of a shadow's edge, as a share of its squared radius, both ways
const float LONGEST = 8.0;  // shadows are no longer than so many heights

vec4 vertex(vec3 corner, out vec2 disc) {
    vec4 found = tree_of(tree, gl_InstanceID);
    vec3 to_sun = sun_direction(wired_daylight, daylight, towards_sun);
    if (found.w <= 0.0 || to_sun.z <= 0.0) return NOWHERE;
    Crown crown = crown_of(found, species_at(species, found.xy / extent));
    float run = min(length(to_sun.xy) / to_sun.z, LONGEST);
    vec2 along = length(to_sun.xy) > 1e-5 ? -normalize(to_sun.xy) : vec2(1.0, 0.0);
    vec2 across = vec2(-along.y, along.x);
    disc = sqrt(1.0 + SOFT) * square_of(corner);
    float longer = length(vec2(crown.across, crown.up * run));
    vec2 middle = crown.middle.xy + along * (run * (crown.middle.z - found.z));
    vec2 place = middle + along * (disc.x * longer) + across * (disc.y * crown.across);
    return vec4((place - eye.xy) / shade_wide * 2.0, 0.0, 1.0);
}

vec4 fragment(vec2 disc) {
    return vec4(1.0, 0.0, 0.0, 1.0 - smoothstep(1.0 - SOFT, 1.0 + SOFT, dot(disc, disc)));
}

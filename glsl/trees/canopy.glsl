// trees/canopy.glsl -- how high the wood stands over the ground, for what casts shadows.
//
//   gives    canopy, metres over the ground; height, 0..1, with the wood on it
//   needs    terrain/heightfield.glsl, trees/stand.glsl; a height and a density
//   units    metres; height without unit
//   source   the mean height of what one sees from above, the ground's 0: of an ellipsoid's upper
//            half that is two thirds of its half height over its middle
//   tested   tests/glsl/test_trees_light.py: by ellipsoids in float64; it takes light from
//            the ground beside it, and adds none
//
// Wire what a method of shadows makes of `height` to canopy_visibility of scene/terrain, and what
// it makes of the bare height to visibility: the wood throws its shadow on the meadow beside it,
// but for where that is known tree by tree, and the ground keeps its slopes.
#include "terrain/heightfield.glsl"
#include "trees/stand.glsl"
#pragma kernel(output = "canopy:r32f, height:r32f")

uniform sampler2D bare;     //! input
uniform sampler2D density;  //! input
#include "trees/parameters/stand.glsl"
#include "trees/parameters/species.glsl"

void kernel(ivec2 texel, out float canopy, out float height) {
    float ground = height_at(bare, place_on(textureSize(bare, 0), texel, size));
    float stands = height_at(density, place_on(textureSize(density, 0), texel, size));
    float needled = needle_share(needles, needles_from, ground * relief + base_elevation);
    vec4 others = shares_with(needled);
    Stand stand = stand_of(clamp(stands, 0.0, 1.0), cell, tallest, shortest, others);
    float covered = 1.0 - reaches(stand, 1.0, vec3(0.0, 0.0, 1.0), 1.0);
    canopy = (stand.middle + 2.0 / 3.0 * stand.up) * covered;
    height = relief > 0.0 ? ground + canopy / relief : ground;
}

// scene/water/leaves.glsl -- the colour of the woods that water mirrors: one for all of them.
//
//   gives    leaves, linear
//   needs    lighting/daylight_date.glsl, trees/kinds.glsl
//   units    see trees/kinds.glsl
//   source   see there
//   tested   tests/glsl/test_scene_water.py
#include "lighting/daylight_date.glsl"
#include "trees/kinds.glsl"
#pragma kernel(output = "leaves:rgba16f")

uniform sampler2D daylight;  //! input("black")
#include "trees/parameters/season.glsl"

const float NEEDLES = 0.15;

vec4 kernel(ivec2 texel) {
    return vec4(mean_leaf_colour(NEEDLES, day_of_year(wired_daylight, daylight, day)), 1.0);
}

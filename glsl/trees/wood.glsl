// trees/wood.glsl -- the light on what one sees of a wood, from every side, for one sun.
//
//   gives    table: sums over the crowns in sight of sun, of sky and of 1, as of wood_sums; by how
//            high the eye stands, how far its azimuth is off the sun's, and how deep the wood is;
//            all that once for broad leaves and once for needles
//   needs    lighting/daylight_reading.glsl, lighting/parameters/sun.glsl, trees/stand.glsl,
//            trees/wood_reading.glsl
//   units    as trees/stand.glsl
//   source   trees/stand.glsl
//   tested   tests/glsl/test_trees_light.py
#include "lighting/daylight_reading.glsl"
#include "trees/stand.glsl"
#include "trees/wood_reading.glsl"
#pragma kernel(output = "table:rgba32f")

#include "lighting/parameters/sun.glsl"
#include "trees/parameters/stand.glsl"

vec4 kernel(ivec2 texel) {
    ivec3 axes = axes_of(size);
    int layer = texel.y / axes.y;
    vec2 node = vec2(texel.x, texel.y % axes.y) / vec2(max(axes.xy - 1, ivec2(1)));
    float depth = depth_on_axis(float(layer % axes.z) / float(axes.z - 1));
    vec3 to_sun = sun_direction(wired_daylight, daylight, towards_sun);
    to_sun = vec3(length(to_sun.xy), 0.0, to_sun.z);
    vec4 others = layer < axes.z ? ALL_LEAVES : ALL_NEEDLES;
    Stand stand = stand_of(1.0, cell, tallest, shortest, others);
    vec3 sums = wood_sums(stand, direction_of(node.x, node.y), to_sun, depth);
    return vec4((1.0 + depth) * sums, 1.0);
}

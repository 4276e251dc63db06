// trees/wood.glsl -- the light on what one sees of a wood, from every side, for one sun.
//
//   gives    table: sun and sky on the crowns in sight, as of wood_light; by how high the eye
//            stands, and by how far its azimuth is off the sun's, for each density; all that once
//            for the lowland's mix of species and once for needles only
//   needs    trees/stand.glsl, trees/wood_reading.glsl, lighting/parameters/sun.glsl
//   units    as trees/stand.glsl
//   source   trees/stand.glsl
//   tested   tests/glsl/test_trees_light.py
#include "lighting/daylight_reading.glsl"
#include "trees/stand.glsl"
#include "trees/wood_reading.glsl"
#pragma kernel(output = "table:rg32f")

#include "lighting/parameters/sun.glsl"
#include "trees/parameters/stand.glsl"
#include "trees/parameters/needles.glsl"

vec2 kernel(ivec2 texel) {
    ivec3 axes = axes_of(size);
    vec3 node = vec3(texel.x, texel.y % axes.y, (texel.y / axes.y) % axes.z);
    node /= vec3(max(axes - 1, ivec3(1)));
    vec3 to_eye = direction_of(node.x, node.y);
    vec3 to_sun = sun_direction(wired_daylight, daylight, towards_sun);
    to_sun = direction_of(height_on_axis(to_sun), 0.0);
    float density = max(node.z, 0.02);
    bool only = texel.y / axes.y >= axes.z;
    Stand all = stand_of(density, cell, tallest, shortest, only ? 1.0 : needles);
    return wood_light(all, to_eye, to_sun);
}

// trees/wood.comp -- the table of trees/wood, all depths of a wood at once.
//
//   gives    table
//   needs    lighting/daylight_reading.glsl, lighting/parameters/sun.glsl, trees/stand.glsl,
//            trees/wood_reading.glsl
//   units    as trees/wood.glsl
//   source   trees/stand.glsl
//   tested   tests/glsl/test_fast_variants.py, against trees/wood.glsl, bit for bit
//
// How much of the crowns is above a place on one does not depend on how deep the wood is: it is
// worked out once for all depths, which takes most of the time. The header's 12 and 24 are DEPTHS
// and DEPTHS * SHAPES: with others the two forms differ, and the variant does not run.
#include "lighting/daylight_reading.glsl"
#include "trees/stand.glsl"
#include "trees/wood_reading.glsl"
#pragma compute(where = "sides = max(size.y // 24, 1); \
                         shapes = (size.y - 1) // (12 * sides) + 1", local = "8, 1", \
                groups = "(size.x + 7) // 8, sides * shapes", agrees = "exact")

#include "lighting/parameters/sun.glsl"
#include "trees/parameters/stand.glsl"

float depth_of_layer(int layer) {
    return depth_on_axis(float(layer) / float(DEPTHS - 1));
}

void main() {
    ivec3 axes = axes_of(size);
    int column = int(gl_GlobalInvocationID.x);
    int side = int(gl_GlobalInvocationID.y) % axes.y;
    int shape = int(gl_GlobalInvocationID.y) / axes.y;
    vec2 node = vec2(column, side) / vec2(max(axes.xy - 1, ivec2(1)));
    vec3 to_sun = sun_direction(wired_daylight, daylight, towards_sun);
    to_sun = vec3(length(to_sun.xy), 0.0, to_sun.z);
    Stand stand = stand_of(1.0, cell, tallest, shortest, shape == 0 ? ALL_LEAVES : ALL_NEEDLES);
    vec3 to_eye = direction_of(node.x, node.y);
    vec3 totals[DEPTHS];
    for (int layer = 0; layer < DEPTHS; layer++) totals[layer] = vec3(0.0);
    for (int k = 0; k < WOOD_PLACES; k++) {
        WoodPlace seen = wood_place(stand, to_eye, k);
        vec3 light = vec3(facing_sun(seen.normal, to_sun), facing_sky(seen.normal), 1.0);
        for (int layer = 0; layer < DEPTHS; layer++) {
            totals[layer] += seen.weight * exp(-depth_of_layer(layer) * seen.share) * light;
        }
    }
    for (int layer = 0; layer < DEPTHS; layer++) {
        int row = (shape * DEPTHS + layer) * axes.y + side;
        if (column >= size.x || row >= size.y) continue;
        vec3 sums = totals[layer] / float(RINGS * SPOKES);
        imageStore(out_table, ivec2(column, row),
                   vec4((1.0 + depth_of_layer(layer)) * sums, 1.0));
    }
}

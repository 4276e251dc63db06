// trees/leaves.glsl -- the colours that trees have today, as a table.
//
//   gives    leaves: for every kind of tree, and after these the mean of each species; by how many
//            days the place is behind others (trees/leaves_reading.glsl)
//   needs    lighting/daylight_date.glsl, trees/kinds.glsl, trees/leaves_reading.glsl; a daylight,
//            if there is one
//   units    colours linear
//   source   trees/kinds.glsl
//   tested   tests/glsl/test_trees_species.py
#include "lighting/daylight_date.glsl"
#include "trees/kinds.glsl"
#include "trees/leaves_reading.glsl"
#pragma kernel(output = "leaves:rgba16f")

uniform sampler2D daylight;  //! input("black")
#include "trees/parameters/season.glsl"

vec4 kernel(ivec2 texel) {
    float today = day_of_year(wired_daylight, daylight, day);
    float late = MAX_LATE * (2.0 * float(texel.x) / float(max(size.x - 1, 1)) - 1.0);
    if (texel.y < FIRST_ROCK) {
        int species = species_of(texel.y);
        return vec4(tree_colour(species, tint_of(texel.y), late, today), 1.0);
    }
    vec3 total = vec3(0.0);
    for (int k = 0; k < TINTS; k++) {
        float tint = (float(k) + 0.5) / float(TINTS);
        total += tree_colour(texel.y - FIRST_ROCK, tint, late, today);
    }
    return vec4(total / float(TINTS), 1.0);
}

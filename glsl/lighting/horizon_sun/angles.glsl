// lighting/horizon_sun/angles.glsl -- horizons as angles over the slope.
//
//   gives    upright, slanting: the horizons' elevations, 0 level and 1 straight up, in the order
//            first, opposite, third, seventh; second, sixth, fourth, eighth: a sun on its arc
//            asks the first texture alone; facing: the normal, by its place in the table of
//            sunlight
//   needs    terrain/maps.glsl, lighting/horizons/open_sky.glsl,
//            lighting/sun.glsl, terrain/heightfield.glsl; the horizons' tangents
//   units    shares of 90 degrees, in 16 bits
//   source   Belaiche 2010, section 3.4, figures 3.1 and 3.2
//   tested   tests/glsl/test_analytic.py, against float64
//
// They are shares of a quarter circle, as the sun's method needs them.
//
// An effective horizon is never below the slope itself, nor below the level. The sun has no
// part in this: a sun that moves finds it done.
#include "terrain/maps.glsl"
#include "lighting/horizons/open_sky.glsl"
#include "lighting/sun.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "upright:rgba16, slanting:rgba16, facing:rg8", relief = "shown")

uniform sampler2D height;     //! input
#include "lighting/parameters/eight_horizons.glsl"
#include "lighting/parameters/normal.glsl"

float angle_over(float tangent, vec2 slope, vec2 towards) {
    return atan(horizon_over_slope(tangent, slope, towards)) / 1.57079633;
}

void kernel(ivec2 texel, out vec4 upright, out vec4 slanting, out vec2 facing) {
    ivec2 grid = textureSize(height, 0);
    vec2 slope = relief * slope_at(height, place_on(grid, texel, size), spacing_of(grid, extent),
                                   normal);
    vec4 before = map_at(ahead, texel, size);
    vec4 after = map_at(behind, texel, size);
    for (int k = 0; k < 4; k++) {
        vec2 towards = cos_sin_degrees(first - 45.0 * float(k)).yx;
        before[k] = angle_over(before[k], slope, towards);
        after[k] = angle_over(after[k], slope, -towards);
    }
    upright = vec4(before.x, after.x, before.z, after.z);
    slanting = vec4(before.y, after.y, before.w, after.w);
    // Whole numbers from 1 to 255, so that a level normal is one of them.
    facing = (floor(normal_of_slope(slope).xy * 127.0 + 0.5) + 128.0) / 255.0;
}

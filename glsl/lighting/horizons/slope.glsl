// lighting/horizons/slope.glsl -- the slope at a texel of a grid that is not the heightmap's own.
//
//   gives    slope_here
//   asks     of the kernel that includes it: land_at
//   needs    terrain/heightfield.glsl
//   units    rise over run, to the east and to the north
//   source   as slope_of_node in terrain/heightfield.glsl
//   tested   tests/glsl/test_horizons.py, against brute force in float64
#ifndef LIGHTING_HORIZONS_SLOPE
#define LIGHTING_HORIZONS_SLOPE
#include "terrain/heightfield.glsl"

// The height at a texel of the grid, without unit.
float land_at(ivec2 texel);

vec2 slope_here(ivec2 texel, ivec2 grid, vec2 metres, float metres_of_relief, int method) {
    ivec2 low = max(texel - 1, ivec2(0));
    ivec2 high = min(texel + 1, grid - 1);
    int row = method == ONE_TRIANGLE ? low.y : texel.y;
    int column = method == ONE_TRIANGLE ? high.x : texel.x;
    float east = land_at(ivec2(high.x, row)) - land_at(ivec2(low.x, row));
    float north = land_at(ivec2(column, high.y)) - land_at(ivec2(column, low.y));
    vec2 run = vec2(max(high - low, ivec2(1))) * metres;
    return metres_of_relief * vec2(east, north) / run;
}
#endif

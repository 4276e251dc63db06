// terrain/slope.glsl -- slopes by differences of heights, to the east and to the north.
//
//   gives    slope: height per metre, east in red, north in green; times relief, without unit
//   needs    maths/land.glsl; a height
//   units    apart in texels of the height
//   source   derived here: the slope of the line through two heights
//   tested   tests/glsl/test_slopes.py, against planes, parabolas and the slopes of noise
//
// On both sides of a texel, errors of the second order cancel: half the distance is a quarter of
// the error. At a border one side is missing, and half the distance is half the error only.
#include "maths/land.glsl"
#pragma kernel(output = "slope:rg32f")

uniform sampler2D height;  //! input
uniform int sides = 0;     //! menu("both sides", "one side") From the texel before to the texel
                           //! after; or from this one to the texel after
uniform int apart = 1;     //! slider(1, 32) unit("texels") From this texel to those that are read

// anchor: slope
vec2 kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    ivec2 here = ivec2(place_on(grid, texel, size) + 0.5);
    ivec2 high = min(here + apart, grid - 1);   // no further than the border
    ivec2 low = max((sides == 0 ? here : high) - apart, ivec2(0));
    float west = texelFetch(height, ivec2(low.x, here.y), 0).r;
    float east = texelFetch(height, ivec2(high.x, here.y), 0).r;
    float south = texelFetch(height, ivec2(here.x, low.y), 0).r;
    float north = texelFetch(height, ivec2(here.x, high.y), 0).r;
    vec2 run = vec2(max(high - low, ivec2(1))) * spacing_of(grid, extent);
    return vec2(east - west, north - south) / run;
}
// end: slope

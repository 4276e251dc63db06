// terrain/slope.glsl -- slopes by differences of heights, to the east and to the north.
//
//   gives    slope: height per metre, east in red, north in green; times relief, metres over metres
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
uniform int way = 0;       //! menu("both sides", "one side") From the texel before to the texel
                           //! after; or from this one to the texel after
uniform int apart = 1;     //! slider(1, 32) unit("texels") From this texel to those that are read

vec2 kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    ivec2 here = ivec2(place_on(grid, texel, size) + 0.5);
    // The heights around `here` are yours to read, and their differences yours to divide.
    return vec2(0.0);
}

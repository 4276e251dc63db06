// water/texels.glsl -- numbers of texels, the eight neighbours, and the edge.
//
//   gives    NEIGHBOURS, neighbour_of, number_of, texel_of, on_edge, inside
//   needs    maths/whole.glsl
//   units    texels; numbers count from the south-western one, row by row
//   source   none: made here
//   tested   tests/glsl/test_water_texels.py, against NumPy's ravel and unravel
//
// A float holds every number of a texel up to 4096 x 4096: what gives such numbers accepts no
// more.
#ifndef WATER_TEXELS
#define WATER_TEXELS
#include "maths/whole.glsl"

const int NEIGHBOURS = 8;

// The step to a neighbour, row by row from the south-west, without the texel itself.
ivec2 neighbour_of(int k) {
    int place = k < 4 ? k : k + 1;
    int row = place / 3;
    return ivec2(place - 3 * row - 1, row - 1);
}

float number_of(ivec2 texel, ivec2 whole) {
    return float(texel.y * whole.x + texel.x);
}

// Any number is taken to the terrain's, so that a texture of something else reads no stray texel.
ivec2 texel_of(float number, ivec2 whole) {
    int n = int(clamp(number, 0.0, float(whole.x * whole.y - 1)));
    int y = quotient(n, whole.x);
    return ivec2(n - y * whole.x, y);
}

bool inside(ivec2 texel, ivec2 whole) {
    return texel.x >= 0 && texel.y >= 0 && texel.x < whole.x && texel.y < whole.y;
}

bool on_edge(ivec2 texel, ivec2 whole) {
    return texel.x <= 0 || texel.y <= 0 || texel.x >= whole.x - 1 || texel.y >= whole.y - 1;
}
#endif

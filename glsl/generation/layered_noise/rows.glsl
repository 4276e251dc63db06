// generation/layered_noise/rows.glsl -- bands: rows of texels between which no layer has a node.
//
//   gives    rows, one texel for each row of the terrain: its band, rows since the band's first;
//            then the first row of the band whose number this is, and how many bands there are
//   needs    generation/layered_noise/layers.glsl
//   units    texels
//   source   derived here
//   tested   tests/glsl/test_layered_noise.py, as part of the fast variant
//
// A band's number is how many intervals of all layers lie to the south of it. It grows with
// the row, so its first row is found by bisection. Where layers are so fine that there would be
// more bands than rows, each row is a band.
#include "generation/layered_noise/layers.glsl"
#pragma kernel(output = "rows:rgba32f")

uniform sampler2D columns; //! input
uniform int octaves = 2;   //! slider(0, 8) As in the technique
uniform int left_out = 0;  //! slider(0, 8) As in the technique
uniform int layer = 0;     //! slider(0, 8) As in the technique

int band(int row, ivec2 texels) {
    int passed = 0;
    int last = layer > 0 ? layer : octaves;
    for (int k = layer > 0 ? layer - 1 : left_out; k < last; k++) {
        int intervals = int(texelFetch(columns, ivec2(0, k), 0).a);
        passed += quotient(row * intervals_along_y(intervals, texels), texels.y);
    }
    return passed;
}

int first_row(int number, ivec2 texels) {
    int low = 0;
    int high = texels.y - 1;
    while (low < high) {
        int middle = (low + high) >> 1;
        if (band(middle, texels) >= number) high = middle;
        else low = middle + 1;
    }
    return low;
}

vec4 kernel(ivec2 texel) {
    ivec2 texels = ivec2(textureSize(columns, 0).x, size.x);
    int row = texel.x;
    int bands = band(texels.y - 1, texels) + 1;
    if (bands > texels.y) return vec4(float(row), 0.0, float(row), float(texels.y));
    int mine = band(row, texels);
    return vec4(ivec4(mine, row - first_row(mine, texels), first_row(row, texels), bands));
}

// generation/layered_noise/rows.glsl -- the bands of a land: rows of texels between which no layer has a node.
//
//   gives    rows, one texel for each row of the land: its band, rows since the band's first;
//            then the first row of the band whose number this is, and how many bands there are
//   needs    generation/layered_noise/layers.glsl
//   units    texels
//   source   derived here
//   tested   tests/glsl/test_layered_noise.py, as part of the whole
//
// A band's number is how many intervals of all layers lie to the south of it. It grows with
// the row, so its first row is found by halving. Where layers are so fine that there would be
// more bands than rows, each row is a band.
#include "generation/layered_noise/layers.glsl"
#pragma kernel(output = "rows:rgba32f")

uniform sampler2D columns; //! input
uniform int octaves = 2;   //! slider(0, 8) Layers
uniform int left_out = 0;  //! slider(0, 8) Of these, so many of the coarsest are left out
uniform int layer = 0;     //! slider(0, 8) Show this layer alone, at full weight; 0: their sum

int band(int row, ivec2 land) {
    int passed = 0;
    int last = layer > 0 ? layer : octaves;
    for (int k = layer > 0 ? layer - 1 : left_out; k < last; k++) {
        int intervals = int(texelFetch(columns, ivec2(0, k), 0).a);
        passed += quotient(row * upright(intervals, land), land.y);
    }
    return passed;
}

int first_row(int number, ivec2 land) {
    int low = 0;
    int high = land.y - 1;
    while (low < high) {
        int middle = (low + high) >> 1;
        if (band(middle, land) >= number) high = middle;
        else low = middle + 1;
    }
    return low;
}

vec4 kernel(ivec2 texel) {
    ivec2 land = ivec2(textureSize(columns, 0).x, size.x);
    int row = texel.x;
    int bands = band(land.y - 1, land) + 1;
    if (bands > land.y) return vec4(float(row), 0.0, float(row), float(land.y));
    int mine = band(row, land);
    return vec4(ivec4(mine, row - first_row(mine, land), first_row(row, land), bands));
}

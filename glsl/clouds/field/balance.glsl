// clouds/field/balance.glsl -- what is left of the beam, by the edge at which clouds begin.
//
//   gives    balance: its sum over a part of the tile's rows, and of how many texels, for edges
//            as in clouds/field/edges.glsl along x
//   needs    clouds/layer_form.glsl, clouds/field/edges.glsl; a shape by clouds/field/shape
//   units    without unit
//   source   none: the mean of clouds/field/cloud's transmittance
//   tested   tests/glsl/test_clouds.py: the clouds of each cover leave what the cover leaves
//
// Each row of the tile is in one of its rows: the tile's need be no multiple of them.
#include "clouds/layer_form.glsl"
#include "clouds/field/edges.glsl"
#pragma kernel(output = "balance:rg32f")

uniform sampler2D shape;  //! input

const int MOST = 64;  // texels of the shape that are read, on each axis

vec2 kernel(ivec2 texel) {
    float edge = edge_of(texel.x, size.x);
    ivec2 whole = textureSize(shape, 0);
    ivec2 rows = ivec2(texel.y, texel.y + 1) * whole.y / size.y;
    ivec2 largest = ivec2(whole.x, (whole.y + size.y - 1) / size.y);
    ivec2 stride = max((largest + MOST - 1) / MOST, 1);
    float total = 0.0;
    int count = 0;
    for (int row = rows.x; row < rows.y; row += stride.y) {
        for (int x = 0; x < whole.x; x += stride.x) {
            // Every row begins elsewhere, so that no column of the tile is left out.
            int column = (x + 3 * row) % whole.x;
            float thick = thickness_of(texelFetch(shape, ivec2(column, row), 0).r, edge);
            total += exp(-depth_straight_up(thick));
            count++;
        }
    }
    return vec2(total, float(count));
}

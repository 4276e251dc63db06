// clouds/field/balance.glsl -- what is left of the beam, by the edge at which clouds begin.
//
//   gives    balance: its mean over a part of the tile's rows, for edges as in
//            clouds/field/edges.glsl along x
//   needs    clouds/layer_form.glsl, clouds/field/edges.glsl; a shape by clouds/field/shape
//   units    without unit
//   source   none: the mean of clouds/field/cloud's transmittance
//   tested   tests/glsl/test_clouds.py: the clouds of each cover leave what the cover leaves
//
// Each of its rows is of as many parts of the tile's.
#include "clouds/layer_form.glsl"
#include "clouds/field/edges.glsl"
#pragma kernel(output = "balance:r32f")

uniform sampler2D shape;  //! input

const int MOST = 64;  // texels of the shape that are read, on each axis

float kernel(ivec2 texel) {
    float edge = edge_of(texel.x, size.x);
    ivec2 whole = textureSize(shape, 0);
    ivec2 part = max(ivec2(whole.x, (whole.y + size.y - 1) / size.y), 1);
    ivec2 stride = max((part + MOST - 1) / MOST, 1);
    float total = 0.0;
    int count = 0;
    for (int y = 0; y < part.y; y += stride.y) {
        int row = min(texel.y * part.y + y, whole.y - 1);
        for (int x = 0; x < part.x; x += stride.x) {
            // Every row begins elsewhere, so that no column of the tile is left out.
            int column = (x + 3 * row) % whole.x;
            float thick = thickness_of(texelFetch(shape, ivec2(column, row), 0).r, edge);
            total += exp(-CLOUD_DEPTH * thick);
            count++;
        }
    }
    return total / float(max(count, 1));
}

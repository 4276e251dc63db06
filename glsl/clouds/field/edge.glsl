// clouds/field/edge.glsl -- where clouds begin, so that they leave what their cover leaves.
//
//   gives    edge
//   needs    clouds/field/edges.glsl, sky/clouds.glsl; a table by clouds/field/balance, a cover
//   units    as of a shape by clouds/field/shape
//   source   for the beam that a cover leaves see sky/clouds.glsl; the table read backwards
//   tested   tests/glsl/test_clouds.py: the clouds of each cover leave what the cover leaves
//
// An observer's cover counts the sides of clouds too, so that seen from above they hide less of
// the ground than it says. What they leave of the beam settles it.
#include "clouds/field/edges.glsl"
#include "sky/clouds.glsl"
#pragma kernel(output = "edge:r32f")

uniform sampler2D balance;     //! input
uniform sampler2D cover;       //! input("black")
uniform float clouds = 0.4;    //! slider(0, 1) step(0.01)
                               //! Cover of cloud, if there is no daylight that says it

float balance_of(int column) {
    int rows = textureSize(balance, 0).y;
    vec2 total = vec2(0.0);
    for (int row = 0; row < rows; row++) total += texelFetch(balance, ivec2(column, row), 0).rg;
    return total.x / max(total.y, 1.0);
}

float kernel(ivec2 texel) {
    float left = beam_through_clouds(wired_cover ? texelFetch(cover, ivec2(0), 0).r : clouds);
    int columns = textureSize(balance, 0).x;
    // The table falls from column to column: halve what is in question until two are left.
    int low = 0;
    int high = max(columns - 1, 0);
    for (int k = 0; k < 16 && high - low > 1; k++) {
        int middle = (low + high) / 2;
        if (balance_of(middle) >= left) low = middle;
        else high = middle;
    }
    float above = balance_of(low);
    float below = balance_of(high);
    float part = above > below ? clamp((above - left) / (above - below), 0.0, 1.0) : 0.0;
    return mix(edge_of(low, columns), edge_of(high, columns), part);
}

// water/accumulation/area.glsl -- the area that drains through each texel, its own cell included.
//
//   gives    area
//   needs    water/texels.glsl
//   units    m^2, times the rain
//   source   water/accumulation/tree.glsl: a texel's subtree is that of its first donor, whose
//            siblings are its other donors
//   tested   tests/glsl/test_accumulation.py, against serial counting
#include "water/texels.glsl"
#pragma kernel(output = "area:r32f")

uniform sampler2D tree;    //! input
uniform sampler2D folded;  //! input

float kernel(ivec2 texel) {
    vec4 node = texelFetch(tree, texel, 0);
    float sum = node.x;
    if (node.y >= 0.0) sum += texelFetch(folded, texel_of(node.y, size), 0).x;
    return sum * (spacing.x * spacing.y);
}

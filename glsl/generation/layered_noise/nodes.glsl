// generation/layered_noise/nodes.glsl -- where the first row of each band is in each layer.
//
//   gives    nodes: which random numbers the node to the south and the one to the north read, the
//            share between them before the curve, and how much of it a row is; a layer a row
//   needs    generation/layered_noise/layers.glsl
//   units    places on the layer of random numbers, see layers.glsl; shares 0..1
//   source   Belaiche 2010, sections 1.3.9 and 4.3.4
//   tested   tests/glsl/test_layered_noise.py, as part of the fast variant
#include "generation/layered_noise/layers.glsl"
#pragma kernel(output = "nodes:rgba32f")

uniform sampler2D columns; //! input
uniform sampler2D rows;    //! input
uniform int tiles = 1;     //! slider(1, 64) As in the technique
uniform int seams = 1;     //! menu("removed", "left") As in the technique

vec4 kernel(ivec2 texel) {
    ivec2 texels = ivec2(textureSize(columns, 0).x, size.x);
    int intervals = int(texelFetch(columns, ivec2(0, texel.y), 0).a);
    int first = int(texelFetch(rows, ivec2(texel.x, 0), 0).b);
    int along_y = intervals_along_y(intervals, texels);
    Nodes nodes = nodes_around(first, texels.y, along_y, tiles, seams == 0 && tiles > 1);
    return vec4(float(nodes.first), float(nodes.second), nodes.share, 1.0 / float(nodes.apart));
}

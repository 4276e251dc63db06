// generation/layered_noise/nodes.glsl -- where the first row of each band stands between the nodes of each layer.
//
//   gives    nodes: which random numbers the node to the south and the one to the north read, the
//            part between them before the curve, and what of it a row is; a layer a row
//   needs    generation/layered_noise/layers.glsl
//   units    places on the layer of random numbers, see layers.glsl; part 0..1
//   source   Belaiche 2010, sections 1.3.9 and 4.3.4
//   tested   tests/glsl/test_layered_noise.py, as part of the whole
#include "generation/layered_noise/layers.glsl"
#pragma kernel(output = "nodes:rgba32f")

uniform sampler2D columns; //! input
uniform sampler2D rows;    //! input
uniform int tiles = 1;     //! slider(1, 64) This is one of so many parts a side
uniform int seams = 1;     //! menu("mended", "left") Whether the last nodes are the first ones again

vec4 kernel(ivec2 texel) {
    ivec2 land = ivec2(textureSize(columns, 0).x, size.x);
    int intervals = int(texelFetch(columns, ivec2(0, texel.y), 0).a);
    int first = int(texelFetch(rows, ivec2(texel.x, 0), 0).b);
    int upwards = upright(intervals, land);
    int south;
    ivec2 around;
    float part;
    nodes_around(first, land.y, upwards, south, around, part);
    vec2 numbers = vec2(numbers_around(south, upwards, tiles, seams == 0 && tiles > 1));
    return vec4(numbers, part, 1.0 / float(max(around.y - around.x, 1)));
}

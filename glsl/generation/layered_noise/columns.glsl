// generation/layered_noise/columns.glsl -- where each column of texels stands between the nodes of each layer.
//
//   gives    columns: which random numbers the node to the west and the one to the east read, the
//            part between them after the curve, and the layer's intervals; a layer a row
//   needs    generation/layered_noise/layers.glsl
//   units    places on the layer of random numbers, see layers.glsl; part 0..1
//   source   Belaiche 2010, sections 1.3.9 and 4.3.4
//   tested   tests/glsl/test_layered_noise.py, as part of the whole
#include "generation/layered_noise/layers.glsl"
#pragma kernel(output = "columns:rgba32f")

uniform int frequency = 4;     //! log_slider(1, 1024) Intervals a side in the first layer; each next layer has this many times more
uniform int interpolation = 1; //! menu("linear", "smooth") Between nodes: a line, or 3a² - 2a³
uniform int tiles = 1;         //! slider(1, 64) This is one of so many parts a side, and has its share of the intervals
uniform int seams = 1;         //! menu("mended", "left") Whether its last nodes are its first ones again

vec4 kernel(ivec2 texel) {
    int intervals = 1;
    for (int k = 0; k <= texel.y; k++) intervals = finer(intervals, frequency, (size.x - 1) * tiles + 1);
    intervals = within_a_part(intervals, tiles);
    // anchor: part
    int west;
    ivec2 nodes;
    float part;
    nodes_around(texel.x, size.x, intervals, west, nodes, part);
    if (interpolation == 1) part = part * part * (3.0 - 2.0 * part);
    // end: part
    return vec4(vec2(numbers_around(west, intervals, tiles, seams == 0 && tiles > 1)), part, float(intervals));
}

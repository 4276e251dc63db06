// generation/layered_noise/columns.glsl -- where a column of texels is in each layer.
//
//   gives    columns: which random numbers the node to the west and the one to the east read, the
//            share between them after the curve, and the layer's intervals; a layer a row
//   needs    generation/layered_noise/layers.glsl
//   units    places on the layer of random numbers, see layers.glsl; shares 0..1
//   source   Belaiche 2010, sections 1.3.9 and 4.3.4
//   tested   tests/glsl/test_layered_noise.py, as part of the fast variant
#include "generation/layered_noise/layers.glsl"
#pragma kernel(output = "columns:rgba32f")

uniform int frequency = 4;     //! log_slider(1, 1024) As in the technique
uniform int interpolation = 1; //! menu("linear", "smooth") As in the technique
uniform int tiles = 1;         //! slider(1, 64) As in the technique
uniform int seams = 1;         //! menu("removed", "left") As in the technique

vec4 kernel(ivec2 texel) {
    int intervals = 1;
    int maximum = (size.x - 1) * tiles + 1;
    for (int k = 0; k <= texel.y; k++) intervals = finer(intervals, frequency, maximum);
    intervals = intervals_of_part(intervals, tiles, size).x;
    Nodes nodes = nodes_around(texel.x, size.x, intervals, tiles, seams == 0 && tiles > 1);
    float a = nodes.share;
    if (interpolation == 1) a = a * a * (3.0 - 2.0 * a);
    return vec4(float(nodes.first), float(nodes.second), a, float(intervals));
}

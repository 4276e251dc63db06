// clouds/field/edges.glsl -- the edges at which clouds may begin, for a table of them.
//
//   gives    edge_of
//   needs    nothing: pure functions, no uniforms, no textures
//   units    as of a shape by clouds/field/shape
//   source   none: a table's axis
//   tested   tests/glsl/test_clouds.py: the clouds of each cover leave what the cover leaves
#ifndef CLOUDS_FIELD_EDGES
#define CLOUDS_FIELD_EDGES

// At the most there is no cloud; below the least all is thick.
const float LEAST_EDGE = -1.0;
const float MOST_EDGE = 1.25;

float edge_of(int column, int columns) {
    return mix(MOST_EDGE, LEAST_EDGE, float(column) / float(max(columns - 1, 1)));
}
#endif

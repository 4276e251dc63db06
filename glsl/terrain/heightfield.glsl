// terrain/heightfield.glsl -- heights and slopes anywhere on a texture of heights.
//
//   gives    height_at, height_on_line, slope_of_node, slope_at
//   needs    maths/land.glsl, maths/nodes.glsl; the texture comes as an argument, no uniform of
//            its own
//   units    places in texels of the texture, nodes on the edges; heights without unit;
//            slopes in units of height per spacing's unit (times relief: metres over metres)
//   source   the one-triangle slope: Belaiche 2010, section 3.5.3; the rest derived here
//   tested   tests/glsl/test_lighting.py, against planes and NumPy
//
// A place off the grid is moved to its edge. Fetches only, so both drivers read the same bits.
#ifndef TERRAIN_HEIGHTFIELD
#define TERRAIN_HEIGHTFIELD
#include "maths/land.glsl"
#include "maths/nodes.glsl"

// The height between the four texels around a place.
float height_at(sampler2D field, vec2 place) {
    ivec2 last = textureSize(field, 0) - 1;
    vec2 clamped = clamp(place, vec2(0.0), vec2(last));
    ivec2 low = ivec2(clamped);
    ivec2 high = min(low + 1, last);
    vec4 corner = vec4(
        texelFetch(field, low, 0).r,
        texelFetch(field, ivec2(high.x, low.y), 0).r,
        texelFetch(field, ivec2(low.x, high.y), 0).r,
        texelFetch(field, high, 0).r
    );
    return bilinear(corner, clamped - vec2(low));
}

// The same for a place that is on a line of texels: `across` is one texel along that
// line, and two fetches do, with the same bits.
float height_on_line(sampler2D field, vec2 place, ivec2 across) {
    ivec2 last = textureSize(field, 0) - 1;
    vec2 clamped = clamp(place, vec2(0.0), vec2(last));
    ivec2 low = ivec2(clamped);
    float from = texelFetch(field, low, 0).r;
    float to = texelFetch(field, min(low + across, last), 0).r;
    return from + (to - from) * dot(clamped - vec2(low), vec2(across));
}

// How to find a node's slope.
const int CENTRAL_DIFFERENCES = 0;
const int ONE_TRIANGLE = 1;  // the thesis's: south-west, south-east and north-east of the node

// The rise to the east and to the north at a node: from the node before to the one after; at
// an edge, from the edge. The one triangle looks along its southern and its eastern side.
vec2 slope_of_node(sampler2D field, ivec2 node, vec2 spacing, int method) {
    ivec2 low = max(node - 1, ivec2(0));
    ivec2 high = min(node + 1, textureSize(field, 0) - 1);
    int row = method == ONE_TRIANGLE ? low.y : node.y;
    int column = method == ONE_TRIANGLE ? high.x : node.x;
    // anchor: slope
    float west = texelFetch(field, ivec2(low.x, row), 0).r;
    float east = texelFetch(field, ivec2(high.x, row), 0).r;
    float south = texelFetch(field, ivec2(column, low.y), 0).r;
    float north = texelFetch(field, ivec2(column, high.y), 0).r;
    vec2 rise = vec2(east - west, north - south);
    // A grid one texel wide has no run, and no rise either.
    return rise / (vec2(max(high - low, ivec2(1))) * spacing);
    // end: slope
}

// The slope at a place: the nodes' slopes, interpolated.
vec2 slope_at(sampler2D field, vec2 place, vec2 spacing, int method) {
    Nodes around = nodes_around(place);
    vec2 total = vec2(0.0);
    for (int k = 0; k < around.count; k++) {
        total += weight_of(around, k) * slope_of_node(field, node_at(around, k), spacing, method);
    }
    return total;
}
#endif

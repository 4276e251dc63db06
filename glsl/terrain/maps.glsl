// terrain/maps.glsl -- a map of another size, where a texel of this pass is.
//
//   gives    map_at
//   needs    maths/land.glsl, maths/nodes.glsl; the texture comes as an argument
//   units    as the map's
//   source   interpolation, derived here
//   tested   tests/glsl/test_horizons.py, by maps finer than the light
#ifndef TERRAIN_MAPS
#define TERRAIN_MAPS
#include "maths/land.glsl"
#include "maths/nodes.glsl"

// Between the texels of the map around the place of a texel of the grid `from`.
vec4 map_at(sampler2D map, ivec2 texel, ivec2 from) {
    Nodes around = nodes_around(place_on(textureSize(map, 0), texel, from));
    vec4 total = vec4(0.0);
    for (int k = 0; k < around.count; k++) {
        total += weight_of(around, k) * texelFetch(map, node_at(around, k), 0);
    }
    return total;
}
#endif

// lighting/horizons/map_reading.glsl -- a map of horizons where a texel of another grid stands.
//
//   gives    map_at
//   needs    maths/land.glsl; the texture comes as an argument, no uniform of its own
//   units    as the map's
//   source   interpolation, derived here
//   tested   tests/glsl/test_horizons.py, by maps finer than the light
#ifndef LIGHTING_HORIZONS_MAP_READING
#define LIGHTING_HORIZONS_MAP_READING
#include "maths/land.glsl"

// Between the four texels around the place of a texel of the grid `from`.
vec4 map_at(sampler2D map, ivec2 texel, ivec2 from) {
    ivec2 grid = textureSize(map, 0);
    vec2 place = place_on(grid, texel, from);
    ivec2 low = ivec2(place);
    vec2 part = place - vec2(low);
    // On a texel this is one turn: a loop that asks at its end, because software renderers go
    // through the others once, wanted or not.
    int turns = part == vec2(0.0) ? 1 : 4;
    vec4 total = vec4(0.0);
    int k = 0;
    do {
        ivec2 corner = ivec2(k & 1, k >> 1);
        vec2 weight = mix(1.0 - part, part, vec2(corner));
        total += weight.x * weight.y * texelFetch(map, min(low + corner, grid - 1), 0);
        k++;
    } while (k < turns);
    return total;
}
#endif

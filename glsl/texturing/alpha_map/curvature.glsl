// texturing/alpha_map/curvature.glsl -- how much the terrain bends: hollows and crests.
//
//   gives    curvature_at
//   needs    terrain/heightfield.glsl; the texture comes as an argument
//   units    places in texels of the texture, metres a texel, radius in metres; units of height
//            per square metre (times relief: 1/m), above 0 in a hollow
//   source   second differences; half the sum over two directions at right angles is the mean
//            curvature of terrain that lies level (do Carmo 1976, section 3.3)
//   tested   tests/glsl/test_splat_rules.py, against paraboloids
//
// Four lines through the place, along the axes and between them. One that leaves the terrain is
// left out: past the edge the height stays what it is there, and that would count as a bend.
#ifndef TEXTURING_ALPHA_MAP_CURVATURE
#define TEXTURING_ALPHA_MAP_CURVATURE
#include "terrain/heightfield.glsl"

float curvature_at(sampler2D field, vec2 place, vec2 metres, float radius) {
    vec2 last = vec2(textureSize(field, 0) - 1);
    float middle = height_at(field, place);
    float total = 0.0;
    float lines = 0.0;
    for (int k = 0; k < 4; k++) {
        vec2 along = k == 0 ? vec2(1.0, 0.0) : k == 1 ? vec2(0.0, 1.0) : k == 2
                ? vec2(0.70710678, 0.70710678) : vec2(-0.70710678, 0.70710678);
        vec2 offset = radius * along / metres;
        vec2 low = min(place - offset, place + offset);
        vec2 high = max(place - offset, place + offset);
        if (all(greaterThanEqual(low, vec2(0.0))) && all(lessThanEqual(high, last))) {
            total += height_at(field, place + offset) + height_at(field, place - offset)
                    - 2.0 * middle;
            lines += 1.0;
        }
    }
    return lines > 0.0 ? total / (lines * radius * radius) : 0.0;
}
#endif

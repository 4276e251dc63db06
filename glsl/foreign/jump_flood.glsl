// foreign/jump_flood.glsl -- of each texel the nearest seed, found by jumps that halve.
//
//   gives    frame: the nearest seed's place in xy, 0..1 of the picture; what it carries in zw
//   needs    initial: seeds, their own place in xy; a texel whose xy is 0 is none
//   units    shares of the picture: x and y count alike, whatever its proportions
//   source   Rong and Tan 2006, "Jump flooding in GPU with applications to Voronoi diagram and
//            distance transform"; its rounds are those of glslViewer: one that stays, then
//            jumps of m/2 down to 1, for m the next power of two of the longer side
//   tested   tests/dialects/test_viewer_passes.py, against SciPy's distance transform
//
// Its error: a seed may be hidden by others on the way to a texel. Rong and Tan found fewer than
// 1 % of the texels wrong, and then by the distance to a seed nearly as near.
#pragma kernel(output = "frame:rgba32f", repeat = "1 + bits(max(size.x, size.y) - 1)")

vec4 kernel(ivec2 texel) {
    int jump = 1 << (iterations - 1 - iteration);
    vec2 here = (vec2(texel) + 0.5) / vec2(size);
    vec4 nearest = vec4(0.0);
    float least = 1e9;
    for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
            ivec2 other = texel + ivec2(x, y) * jump;
            if (any(lessThan(other, ivec2(0))) || any(greaterThanEqual(other, size))) continue;
            vec4 seed = previous(other);
            float far = distance(seed.xy, here);
            if (seed.xy != vec2(0.0) && far <= least) {
                least = far;
                nearest = seed;
            }
        }
    }
    return nearest;
}

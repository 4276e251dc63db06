// noise/solid.glsl -- Perlin's gradient noise in space, with its slopes.
//
//   gives    SOLID_SCALE, SOLID_SLOPE, solid
//   needs    noise/fade.glsl, noise/lattice.glsl
//   units    places in lattice cells; noise in [-1, 1], its slopes in noise per cell
//   source   Perlin 1985, "An Image Synthesizer" (SIGGRAPH), and 2002, "Improving Noise"
//            (SIGGRAPH), for the fade; gradients towards a cube's corners: made here
//   tested   tests/glsl/test_near.py, against corner-by-corner noise in float64, and slopes
//            against finite differences
//
// For surfaces that stand upright, where noise of the plane would be drawn out. Gradients are
// (+-1, +-1, +-1): three bits and no products. Their second moments are those of all directions.
#ifndef NOISE_SOLID
#define NOISE_SOLID
#include "noise/fade.glsl"
#include "noise/lattice.glsl"

// One over the most that those gradients can give, in the middle of a cell: 8/8 (1/2 + 1/2 + 1/2).
const float SOLID_SCALE = 0.66666667;

// Root of the mean square of the slope along an axis.
const float SOLID_SLOPE = 0.57515;

// A gradient times the way from its corner; its signs are the bits' three upper ones.
float solid_plane(uint bits, vec3 offset, out vec3 gradient) {
    uvec3 signs = uvec3(bits, bits << 1u, bits << 2u) & 0x80000000u;
    gradient = uintBitsToFloat(signs | 0x3f800000u);
    return dot(gradient, offset);
}

// The numbers of a layer and of the next one, as noise/lattice.glsl has those of rows.
uvec2 solid_layers(int z, uint seed) {
    uint key = uint(z) * 0xc2b2ae3du + seed;
    return lattice_mixed(uvec2(key, key + 0xc2b2ae3du));
}

// Noise in x, its slopes along the axes in y to w.
vec4 solid(vec3 place, uint seed) {
    vec3 cell = floor(place);
    vec3 t = place - cell;
    vec3 f = vec3(quintic(t.xy), quintic(t.z));
    vec3 rise = vec3(quintic_slope(t.xy), quintic_slope(t.z));
    uvec2 columns = lattice_columns(int(cell.x), seed);
    uvec2 rows = lattice_rows(int(cell.y), seed);
    uvec2 layers = solid_layers(int(cell.z), seed);
    float p[2];
    vec3 slopes[2];
    for (int k = 0; k < 2; k++) {
        uint layer = k == 0 ? layers.x : layers.y;
        float up = t.z - float(k);
        vec3 g00, g10, g01, g11;
        float p00 = solid_plane(columns.x * rows.x * layer, vec3(t.xy, up), g00);
        float p10 = solid_plane(columns.y * rows.x * layer, vec3(t.x - 1.0, t.y, up), g10);
        float p01 = solid_plane(columns.x * rows.y * layer, vec3(t.x, t.y - 1.0, up), g01);
        float p11 = solid_plane(columns.y * rows.y * layer, vec3(t.xy - 1.0, up), g11);
        p[k] = mix(mix(p00, p10, f.x), mix(p01, p11, f.x), f.y);
        slopes[k] = mix(mix(g00, g10, f.x), mix(g01, g11, f.x), f.y);
        slopes[k].x += rise.x * mix(p10 - p00, p11 - p01, f.y);
        slopes[k].y += rise.y * mix(p01 - p00, p11 - p10, f.x);
    }
    vec3 slope = mix(slopes[0], slopes[1], f.z);
    slope.z += rise.z * (p[1] - p[0]);
    return SOLID_SCALE * vec4(mix(p[0], p[1], f.z), slope);
}
#endif

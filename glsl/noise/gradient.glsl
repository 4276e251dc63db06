// noise/gradient.glsl -- Perlin's gradient noise in the plane, with its slopes.
//
//   gives    PERLIN_SCALE, gradient_of, perlin, perlin_in_cell
//   needs    noise/fade.glsl, noise/lattice.glsl
//   units    places in lattice cells; noise in [-1, 1], its slopes in noise per cell
//   source   Perlin 1985, "An Image Synthesizer" (SIGGRAPH), and 2002, "Improving Noise"
//            (SIGGRAPH), for the fade; the gradients: made here
//   tested   tests/glsl/test_gradient_noise.py, against corner-by-corner noise in float64,
//            and slopes against finite differences
//
// At every lattice point i a random plane through zero, whose slopes are the gradient g_i. In a
// cell, at the place t from its south-western corner, the planes of the four corners c are
// blended by the fade f(t) = 6t^5 - 15t^4 + 10t^3:
//
//     noise(t) = mix(mix(p00, p10, f(t.x)), mix(p01, p11, f(t.x)), f(t.y)),   p_c = g_c . (t - c)
//
// Gradients are unit vectors in eight directions, 22.5 degrees off the axes and the diagonals
// and 45 degrees apart. No axis and no diagonal is a gradient, so neither shows; eight even
// directions have the means of squares and of fourth powers that all directions have; and
// they take three bits, no table and no sine.
#ifndef NOISE_GRADIENT
#define NOISE_GRADIENT
#include "noise/fade.glsl"
#include "noise/lattice.glsl"

// One over the most that those gradients can give, 0.66082, in the cell at (0.5, 0.444).
const float PERLIN_SCALE = 1.513;

// One of eight directions, by the three upper bits.
vec2 gradient_of(uint bits) {
    bool steep = (bits & 0x20000000u) != 0u;
    // The cosine and the sine of 22.5 degrees; their signs are put in as bits.
    vec2 direction = steep ? vec2(0.38268343, 0.92387953) : vec2(0.92387953, 0.38268343);
    return uintBitsToFloat(floatBitsToUint(direction) ^ (uvec2(bits, bits << 1u) & 0x80000000u));
}

// Noise in x, its slopes to the east and to the north in y and z, at the place t in a cell.
// Slopes that are not read cost nothing.
vec3 perlin_in_cell(ivec2 cell, vec2 t, uint seed) {
    uvec2 columns = lattice_columns(cell.x, seed);
    uvec2 rows = lattice_rows(cell.y, seed);
    vec2 g00 = gradient_of(columns.x * rows.x);
    vec2 g10 = gradient_of(columns.y * rows.x);
    vec2 g01 = gradient_of(columns.x * rows.y);
    vec2 g11 = gradient_of(columns.y * rows.y);
    float p00 = dot(g00, t);
    float p10 = dot(g10, t - vec2(1.0, 0.0));
    float p01 = dot(g01, t - vec2(0.0, 1.0));
    float p11 = dot(g11, t - vec2(1.0, 1.0));
    vec2 f = quintic(t);
    float noise = mix(mix(p00, p10, f.x), mix(p01, p11, f.x), f.y);
    // anchor: slopes
    // By the product rule: the planes' own slopes, blended, and the change of the blend.
    vec2 slopes = mix(mix(g00, g10, f.x), mix(g01, g11, f.x), f.y);
    vec2 rises = vec2(mix(p10 - p00, p11 - p01, f.y), mix(p01 - p00, p11 - p10, f.x));
    return PERLIN_SCALE * vec3(noise, slopes + quintic_slope(t) * rises);
    // end: slopes
}

vec3 perlin(vec2 place, uint seed) {
    vec2 cell = floor(place);
    return perlin_in_cell(ivec2(cell), place - cell, seed);
}
#endif

// noise/gradient.glsl -- Perlin's gradient noise in the plane, with its slopes.
//
//   gives    perlin, perlin_across, quintic, quintic_slope, gradient_of
//   needs    noise/lattice.glsl
//   units    places in lattice cells; noise in [-1, 1], its slopes in noise per cell
//   source   Perlin 1985, "An Image Synthesizer" (SIGGRAPH), and 2002, "Improving Noise"
//            (SIGGRAPH), for the fade; gradients and the form by rows: made here
//   tested   tests/glsl/test_gradient_noise.py, against corner-by-corner noise in float64,
//            and slopes against finite differences
//
// At every lattice point a random plane through zero; between the points the planes are
// blended by fade 6t^5 - 15t^4 + 10t^3. For one place from west to east, everything between
// two lattice rows follows from two numbers a row:
//
//     noise(v) = mix(low.x + low.y v, high.x + high.y (v - 1), fade(v))            (1)
//
// with x the blended height on the row and y the blended slope to the north.
//
// Gradients are unit vectors in eight directions, 22.5 degrees off the axes and the diagonals
// and 45 degrees apart. Neither axis nor diagonal has one, so neither is drawn; eight even
// directions have the means of squares and of fourth powers that all directions have; and
// they take three bits, no table and no sine.
#ifndef NOISE_GRADIENT
#define NOISE_GRADIENT
#include "noise/lattice.glsl"

// One over the most that those gradients can give, 0.66082, in the cell at (0.5, 0.444).
const float PERLIN_SCALE = 1.513;

// One of eight directions, by the three upper bits.
vec2 gradient_of(uint bits) {
    bool steep = (bits & 0x20000000u) != 0u;
    // The cosine and the sine of 22.5 degrees; their signs are put in as bits.
    uvec2 along = floatBitsToUint(steep ? vec2(0.38268343, 0.92387953) : vec2(0.92387953, 0.38268343));
    return uintBitsToFloat(along ^ (uvec2(bits, bits << 1u) & 0x80000000u));
}

// 0 to 1 with neither slope nor bend at the ends.
float quintic(float t) {
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

float quintic_slope(float t) {
    return 30.0 * t * t * (t * (t - 2.0) + 1.0);
}

// What equation 1 needs of one lattice row: height on it and slope to the north, then how
// both change to the east. `u` is the place in the cell from west to east.
vec4 perlin_across(uvec2 columns, uint row, float u) {
    vec2 west = gradient_of(columns.x * row);
    vec2 east = gradient_of(columns.y * row);
    float fade = quintic(u);
    float slope = quintic_slope(u);
    float from = west.x * u;
    float rise = east.x * (u - 1.0) - from;
    vec2 turn = east - west;
    return vec4(from + rise * fade, west.y + turn.y * fade, west.x + turn.x * fade + rise * slope, turn.y * slope);
}

// Noise in x, its slopes to the east and to the north in y and z. Slopes that nobody reads cost nothing.
vec3 perlin(vec2 place, uint seed) {
    vec2 cell = floor(place);
    vec2 part = place - cell;
    uvec2 columns = lattice_columns(int(cell.x), seed);
    uvec2 rows = lattice_rows(int(cell.y), seed);
    vec4 low = perlin_across(columns, rows.x, part.x);
    vec4 high = perlin_across(columns, rows.y, part.x);
    float fade = quintic(part.y);
    float south = low.x + low.y * part.y;
    float north = high.x + high.y * (part.y - 1.0);
    float slope_south = low.z + low.w * part.y;
    float slope_north = high.z + high.w * (part.y - 1.0);
    return PERLIN_SCALE * vec3(
        south + (north - south) * fade,
        slope_south + (slope_north - slope_south) * fade,
        low.y + (high.y - low.y) * fade + (north - south) * quintic_slope(part.y)
    );
}
#endif

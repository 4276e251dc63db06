// noise/columns.glsl -- octaves of Perlin noise along a column of texels, as polynomials.
//
//   gives    perlin, by rows; Columns, Rows, Span, octave_span, columns_end, columns_add,
//            columns_moved, columns_height
//   needs    noise/gradient.glsl, noise/octaves.glsl, which it must come before
//   units    places in cells of the first octave; rows of texels
//   source   derived here from noise/gradient.glsl
//   tested   tests/glsl/test_gradient_noise.py, against noise/octaves.glsl at every texel
//
// Only for speed. For one place from west to east, all of Perlin's noise between two lattice
// rows follows from two numbers a row, the blended height x on the row and the blended slope y
// to the north; v is the place from the southern to the northern row, and f the fade:
//
//     noise(v) = mix(low.x + low.y v, high.x + high.y (v - 1), f(v))                 (1)
//
// That is a polynomial of degree 6. With q = v - 1/2, the heights s and n that the southern and
// the northern row's planes have in the middle, and the slopes ls and ln of those planes, it is
//
//     s + ls q + (1/2 + 15/8 q - 5 q^3 + 6 q^5) ((n - s) + (ln - ls) q)              (2)
//
// The sum of octaves is such a polynomial too, from one lattice row of any of them to the
// next. Hashes, gradients and floors are paid once for each such piece; a texel costs six
// products and six sums. Counted from the middle of a piece, no digits are lost.
#ifndef NOISE_COLUMNS
#define NOISE_COLUMNS
#define perlin perlin_by_corners  // octaves take the one by rows instead
#include "noise/gradient.glsl"
#undef perlin

// What equation 1 needs of one lattice row, at the share u of a cell from west to east.
vec2 perlin_across(uvec2 columns, uint row, float u) {
    vec2 west = gradient_of(columns.x * row);
    vec2 east = gradient_of(columns.y * row);
    float fade = quintic(u);
    float from = west.x * u;
    float rise = east.x * (u - 1.0) - from;
    return vec2(from + rise * fade, west.y + (east.y - west.y) * fade);
}

// The noise by equation 1; its slopes are left out.
vec3 perlin(vec2 place, uint seed) {
    vec2 cell = floor(place);
    vec2 part = place - cell;
    uvec2 columns = lattice_columns(int(cell.x), seed);
    uvec2 rows = lattice_rows(int(cell.y), seed);
    vec2 low = perlin_across(columns, rows.x, part.x);
    vec2 high = perlin_across(columns, rows.y, part.x);
    float south = low.x + low.y * part.y;
    float north = high.x + high.y * (part.y - 1.0);
    return vec3(PERLIN_SCALE * (south + (north - south) * quintic(part.y)), 0.0, 0.0);
}

#include "noise/octaves.glsl"

// Four columns side by side: coefficients of t^0 .. t^6, t in rows.
struct Columns {
    vec4 c0, c1, c2, c3, c4, c5, c6;
};

// Where four columns run: how far east they are, and how far north a row is of the one before.
struct Rows {
    vec4 east;
    float spacing;
};

// Octaves `from` .. `to` - 1, one at least, and the first one's frequency and strength.
struct Span {
    int from;
    int to;
    float frequency;
    float strength;
};

Span octave_span(Octaves o, int from, int to) {
    Span span = Span(from, to, 1.0, 1.0);
    for (int k = 0; k < from; k++) {
        span.frequency *= o.lacunarity;
        span.strength *= o.gain;
    }
    return span;
}

// anchor: height
vec4 columns_height(Columns c, float t) {
    vec4 high = c.c4 + t * (c.c5 + t * c.c6);
    return c.c0 + t * (c.c1 + t * (c.c2 + t * (c.c3 + t * high)));
}
// end: height

// The same polynomials, counted from t on: Horner's scheme, each time one coefficient shorter.
Columns columns_moved(Columns c, float t) {
    c.c5 += c.c6 * t; c.c4 += c.c5 * t; c.c3 += c.c4 * t; c.c2 += c.c3 * t; c.c1 += c.c2 * t;
    c.c0 += c.c1 * t;
    c.c5 += c.c6 * t; c.c4 += c.c5 * t; c.c3 += c.c4 * t; c.c2 += c.c3 * t; c.c1 += c.c2 * t;
    c.c5 += c.c6 * t; c.c4 += c.c5 * t; c.c3 += c.c4 * t; c.c2 += c.c3 * t;
    c.c5 += c.c6 * t; c.c4 += c.c5 * t; c.c3 += c.c4 * t;
    c.c5 += c.c6 * t; c.c4 += c.c5 * t;
    c.c5 += c.c6 * t;
    return c;
}

// The first row after `row` that lies beyond a lattice row of some octaves.
int columns_end(Rows rows, int row, Octaves o, Span span) {
    float frequency = span.frequency;
    float left = 1e6;
    int k = span.from;
    do {
        float there = float(row) * rows.spacing * frequency + OCTAVE_SHIFT.y;
        left = min(left, (floor(there) + 1.0 - there) / frequency);
        frequency *= o.lacunarity;
        k++;
    } while (k < span.to);
    return row + max(int(min(ceil(left / rows.spacing), 1e6)), 1);
}

// Add some octaves, around a row.
Columns columns_add(Columns c, Rows rows, float row, Octaves o, Span span) {
    float frequency = span.frequency;
    float strength = span.strength;
    int k = span.from;
    do {
        vec4 east = rows.east * frequency + OCTAVE_SHIFT.x;
        float north = row * rows.spacing * frequency + OCTAVE_SHIFT.y;
        vec4 u = east - floor(east);
        uint seed = lattice_seed(o.seed, k);
        uvec2 lines = lattice_rows(int(floor(north)), seed);
        vec4 low, low_slope, high, high_slope;
        for (int i = 0; i < 4; i++) {
            uvec2 columns = lattice_columns(int(floor(east[i])), seed);
            vec2 south = perlin_across(columns, lines.x, u[i]);
            vec2 north_of = perlin_across(columns, lines.y, u[i]);
            low[i] = south.x;
            low_slope[i] = south.y;
            high[i] = north_of.x;
            high_slope[i] = north_of.y;
        }
        vec4 middle = low + 0.5 * low_slope;
        vec4 rise = high - 0.5 * high_slope - middle;
        vec4 twist = high_slope - low_slope;
        Columns piece = Columns(middle + 0.5 * rise, low_slope + 0.5 * twist + 1.875 * rise,
                                1.875 * twist, -5.0 * rise, -5.0 * twist, 6.0 * rise, 6.0 * twist);
        piece = columns_moved(piece, north - floor(north) - 0.5);
        float pace = rows.spacing * frequency;
        vec4 powers = vec4(1.0, pace, pace * pace, pace * pace * pace);
        powers *= PERLIN_SCALE * strength * octave_weight(o.texels / frequency);
        c.c0 += powers.x * piece.c0;
        c.c1 += powers.y * piece.c1;
        c.c2 += powers.z * piece.c2;
        c.c3 += powers.w * piece.c3;
        c.c4 += pace * powers.w * piece.c4;
        c.c5 += pace * pace * powers.w * piece.c5;
        c.c6 += pace * pace * pace * powers.w * piece.c6;
        frequency *= o.lacunarity;
        strength *= o.gain;
        k++;
    } while (k < span.to);
    return c;
}
#endif

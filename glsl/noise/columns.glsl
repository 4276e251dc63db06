// noise/columns.glsl -- octaves of Perlin noise along a column of texels, as polynomials.
//
//   gives    perlin, by rows; Column, Rows, Span, octave_span, column_end, column_add,
//            column_moved, column_height
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

// Coefficients of t^0 .. t^3 and of t^4 .. t^6, t in rows.
struct Column {
    vec4 low;
    vec3 high;
};

// Where a column runs: its place at row 0, and how far north the next row is.
struct Rows {
    vec2 start;
    float step;
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
float column_height(Column c, float t) {
    float high = c.high.x + t * (c.high.y + t * c.high.z);
    return c.low.x + t * (c.low.y + t * (c.low.z + t * (c.low.w + t * high)));
}
// end: height

// The same polynomial, counted from t on: Horner's scheme, each time one coefficient shorter.
Column column_moved(Column c, float t) {
    vec4 a = c.low;
    vec3 b = c.high;
    b.y += b.z * t; b.x += b.y * t; a.w += b.x * t; a.z += a.w * t; a.y += a.z * t; a.x += a.y * t;
    b.y += b.z * t; b.x += b.y * t; a.w += b.x * t; a.z += a.w * t; a.y += a.z * t;
    b.y += b.z * t; b.x += b.y * t; a.w += b.x * t; a.z += a.w * t;
    b.y += b.z * t; b.x += b.y * t; a.w += b.x * t;
    b.y += b.z * t; b.x += b.y * t;
    b.y += b.z * t;
    return Column(a, b);
}

// The first row after `row` that lies beyond a lattice row of some octaves.
int column_end(Rows rows, int row, Octaves o, Span span) {
    float frequency = span.frequency;
    float left = 1e6;
    int k = span.from;
    do {
        float there = (rows.start.y + float(row) * rows.step) * frequency + OCTAVE_SHIFT.y;
        left = min(left, (floor(there) + 1.0 - there) / frequency);
        frequency *= o.lacunarity;
        k++;
    } while (k < span.to);
    return row + max(int(min(ceil(left / rows.step), 1e6)), 1);
}

// Add some octaves, around a row.
Column column_add(Column c, Rows rows, float row, Octaves o, Span span) {
    float frequency = span.frequency;
    float strength = span.strength;
    vec2 place = rows.start + vec2(0.0, row * rows.step);
    int k = span.from;
    do {
        vec2 there = place * frequency + OCTAVE_SHIFT;
        vec2 cell = floor(there);
        vec2 part = there - cell;
        uint seed = lattice_seed(o.seed, k);
        uvec2 columns = lattice_columns(int(cell.x), seed);
        uvec2 lines = lattice_rows(int(cell.y), seed);
        vec2 south = perlin_across(columns, lines.x, part.x);
        vec2 north = perlin_across(columns, lines.y, part.x);
        float s = south.x + 0.5 * south.y;
        float rise = north.x - 0.5 * north.y - s;
        float twist = north.y - south.y;
        Column piece = Column(
            vec4(s + 0.5 * rise, south.y + 0.5 * twist + 1.875 * rise, 1.875 * twist, -5.0 * rise),
            vec3(-5.0 * twist, 6.0 * rise, 6.0 * twist)
        );
        piece = column_moved(piece, part.y - 0.5);
        float pace = rows.step * frequency;
        vec4 powers = vec4(1.0, pace, pace * pace, pace * pace * pace);
        float weight = PERLIN_SCALE * strength * octave_weight(o.texels / frequency);
        c.low += weight * powers * piece.low;
        c.high += weight * powers.w * powers.yzw * piece.high;
        frequency *= o.lacunarity;
        strength *= o.gain;
        k++;
    } while (k < span.to);
    return c;
}
#endif

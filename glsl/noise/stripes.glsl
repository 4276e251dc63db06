// noise/stripes.glsl -- waves in a given direction whose phase is random from place to place.
//
//   gives    Cells, cells_of_width, stripes
//   needs    noise/lattice.glsl, noise/periodic.glsl
//   units    places and widths in metres; waves in turns per metre
//   source   phasor noise after Tricard et al. 2019, "Procedural Phasor Noise" (ACM TOG 38(4));
//            the triangle lattice as in Perlin 2001, "Noise hardware"; joined so: made here
//   tested   tests/glsl/test_gullies.py, against the sum over all lattice points in float64
//
// Each point i of a lattice of triangles has a random phase p_i, and adds a wave of the width w
// that runs along the unit vector `across`, faded out at r = 1, a triangle's height:
//
//     sum over i of (1 - r^2)^3 exp(2 pi i (across . (x - x_i) / w + p_i)),   r = |x - x_i| / h
//
// A point reaches no further than the triangles that touch it, so three terms are all. Of that sum
// the phase is taken; its length only where it is under 0.35 of the sum of the weights, where
// waves of opposite phases meet. So the wave is as high everywhere but at those few places.
//
// Rows of the lattice lie from west to east. Stretched by less than half a triangle in all it has
// a whole number of columns and an even number of rows on a given extent: then it tiles.
#ifndef NOISE_STRIPES
#define NOISE_STRIPES
#include "noise/lattice.glsl"
#include "noise/periodic.glsl"

const float STRIPES_CELL = 1.5;       // a triangle's side, in widths
const float STRIPES_ROW = 0.8660254;  // its height, in sides

struct Cells {
    vec2 side;     // between columns, between rows [m]
    ivec2 period;  // columns and rows after which they repeat; 0: never
};

// The lattice for waves of a width; one that tiles where the extent is not 0.
Cells cells_of_width(float width, vec2 tile) {
    vec2 side = STRIPES_CELL * width * vec2(1.0, STRIPES_ROW);
    if (tile.x <= 0.0) return Cells(side, ivec2(0));
    ivec2 period = max(ivec2(tile / (side * vec2(1.0, 2.0)) + 0.5), ivec2(1)) * ivec2(1, 2);
    return Cells(tile / vec2(period), period);
}

// Cosine and sine of turns, off by less than 1e-5, for a third of what the driver's own cost.
// Fitted to half a turn each way by least squares, weighted until the error was even.
vec2 cos_sin_turns(float turns) {
    float t = turns - floor(turns + 0.5);
    float u = t * t;
    float c = -85.272406 + u * (58.794074 + u * -21.076832);
    c = 0.99999922 + u * (-19.738983 + u * (64.928728 + u * c));
    float s = 81.366815 + u * (-74.478001 + u * 32.781394);
    s = 6.2830558 + u * (-41.331214 + u * s);
    return vec2(c, s * t);
}

// What a point of the lattice adds to a place so far from it, and how near that is, 0..1.
vec3 stripe_of_point(ivec2 point, vec2 offset, vec2 waves, Cells cells, uint seed) {
    vec2 r = offset / cells.side * vec2(1.0 / STRIPES_ROW, 1.0);
    float near = max(1.0 - dot(r, r), 0.0);
    near *= near * near;
    if (cells.period.x > 0) {
        // So many rows up, the same column is half as many columns further east.
        int up = lattice_wrapped(point, cells.period).y - point.y;
        point = lattice_wrapped(point + ivec2(-up / 2, up), cells.period);
    }
    uint bits = lattice_columns(point.x, seed).x * lattice_rows(point.y, seed).x;
    float phase = float(int(bits)) * (1.0 / 4294967296.0);
    return near * vec3(cos_sin_turns(dot(offset, waves) + phase), 1.0);
}

// Cosine and sine of the wave at a place; `waves` are its turns per metre, east and north.
vec2 stripes(vec2 place, vec2 waves, Cells cells, uint seed) {
    // Sheared so that pairs of triangles are squares: columns lean east by half a side each row.
    float row = place.y / cells.side.y;
    vec2 there = vec2(place.x / cells.side.x - 0.5 * row, row);
    vec2 low = floor(there);
    vec2 part = there - low;
    ivec2 point = ivec2(low);
    // From sheared parts back to metres.
    mat2 metres = mat2(cells.side.x, 0.0, 0.5 * cells.side.x, cells.side.y);
    bool upper = part.x + part.y > 1.0;
    ivec2 corner = upper ? ivec2(1) : ivec2(0);
    ivec2 east = ivec2(1, 0);
    ivec2 north = ivec2(0, 1);
    vec3 sum = stripe_of_point(point + corner, metres * (part - vec2(corner)), waves, cells, seed)
             + stripe_of_point(point + east, metres * (part - vec2(east)), waves, cells, seed)
             + stripe_of_point(point + north, metres * (part - vec2(north)), waves, cells, seed);
    return sum.xy / max(length(sum.xy), 0.35 * sum.z);
}
#endif
